// SPDX-License-Identifier: MIT
#include "server/control/branch_desk.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

#include "server/record/run_reader.h"

namespace coopdyn {

MakeBranchState BranchStateMaker(ReplayServices services) {
  return [services = std::move(services)](const std::string& file, std::uint64_t step,
                                          std::optional<double> time_s, std::string& error) -> SavedStatePtr {
    const std::unique_ptr<RunReader> reader = RunReader::Open(file, error);
    if (reader == nullptr) return nullptr;
    Diagnostics diagnostics;
    if (reader->LoadScenario(services.path, diagnostics) == nullptr) {
      error = diagnostics.ToString();
      return nullptr;
    }
    if (time_s) {
      const std::optional<std::uint64_t> found = FindStep(*reader, fmt::format("{}", *time_s), error);
      if (!found) return nullptr;
      step = *found;
    }
    return StateAt(*reader, step, services, error);
  };
}

OpenRecording OpenOn(SearchPath path) {
  return [path = std::move(path)](const std::string& file, std::string& error) -> std::shared_ptr<RunReader> {
    std::shared_ptr<RunReader> reader = RunReader::Open(file, error);
    if (reader == nullptr) return nullptr;
    Diagnostics diagnostics;
    if (reader->LoadScenario(path, diagnostics) != nullptr) return reader;
    error = diagnostics.ToString();
    return nullptr;
  };
}

BranchDesk::BranchDesk(Work work, EditQueue& edits, const RunControl& run, Logger logger)
    : work_(std::move(work)),
      edits_(edits),
      run_(run),
      logger_(std::move(logger)),
      thread_("branch", logger_) {}

BranchDesk::~BranchDesk() = default;

bool BranchDesk::Begin(const Done& done) {
  if (!busy_.exchange(true)) return true;
  done({Error::kNotPossible, "a branch, or an opening of a recording, is under way: wait for its end"});
  return false;
}

void BranchDesk::Branch(std::optional<double> time_s, Done done) {
  const std::optional<PlaybackStatus> playback = run_.playback();
  if (!playback) return done({Error::kNotPossible, kNotPlayingText});
  if (!Begin(done)) return;
  thread_.Post([this, file = playback->file, step = playback->step, paused = !playback->playing, time_s,
                done = std::move(done)] {
    std::string error;
    const SavedStatePtr made = work_.make(file, step, time_s, error);
    if (made == nullptr) {
      busy_ = false;
      return done({Error::kNotPossible, error});
    }
    logger_->info("continues live from step {} of {}", made->frame->step, file);
    auto state = std::make_shared<SavedState>(*made);
    state->paused = paused;
    Restore(std::move(state), done);
  });
}

void BranchDesk::Play(const std::string& file, Done done) {
  if (!Begin(done)) return;
  thread_.Post([this, file, done = std::move(done)] {
    std::string error;
    std::shared_ptr<RunReader> recording = work_.open(file, error);
    if (recording == nullptr) {
      busy_ = false;
      return done({Error::kNotPossible, error});
    }
    edits_.Push({edit::Play{std::move(recording)}, [this, done](const EditResult& result) {
                   if (result.saved != nullptr) {
                     const MutexLock lock(mutex_);
                     live_ = result.saved;
                   }
                   busy_ = false;
                   done(result);
                 }});
  });
}

void BranchDesk::Resume(Done done) {
  if (!run_.playback()) return done({Error::kNotPossible, kNotPlayingText});
  SavedStatePtr live;
  {
    const MutexLock lock(mutex_);
    live = live_;
  }
  if (live == nullptr) {
    return done({Error::kNotPossible, "no live run is suspended: branch continues live from the step shown"});
  }
  if (!Begin(done)) return;
  Restore(std::move(live), std::move(done));
}

void BranchDesk::Restore(SavedStatePtr state, Done done) {
  edits_.Push({edit::Restore{std::move(state)}, [this, done = std::move(done)](const EditResult& result) {
                 if (result.error == Error::kOk) {
                   const MutexLock lock(mutex_);
                   live_ = nullptr;
                 }
                 busy_ = false;
                 done(result);
               }});
}

}  // namespace coopdyn
