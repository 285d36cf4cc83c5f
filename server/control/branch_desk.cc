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

BranchDesk::BranchDesk(MakeBranchState make, EditQueue& edits, const RunControl& run, Logger logger)
    : make_(std::move(make)),
      edits_(edits),
      run_(run),
      logger_(std::move(logger)),
      busy_(std::make_shared<std::atomic<bool>>(false)),
      thread_("branch", logger_) {}

BranchDesk::~BranchDesk() = default;

void BranchDesk::Branch(std::optional<double> time_s, Done done) {
  const std::optional<PlaybackStatus> playback = run_.playback();
  if (!playback) return done({Error::kNotPossible, kNotPlayingText});
  if (busy_->exchange(true)) return done({Error::kNotPossible, "a branch is under way: wait for its end"});
  thread_.Post([this, file = playback->file, step = playback->step, paused = !playback->playing, time_s,
                done = std::move(done)] {
    std::string error;
    const SavedStatePtr made = make_(file, step, time_s, error);
    if (made == nullptr) {
      *busy_ = false;
      return done({Error::kNotPossible, error});
    }
    logger_->info("goes on live from step {} of {}", made->frame->step, file);
    auto state = std::make_shared<SavedState>(*made);
    state->paused = paused;
    edits_.Push({edit::Restore{std::move(state)}, [busy = busy_, done](const EditResult& result) {
                   *busy = false;
                   done(result);
                 }});
  });
}

}  // namespace coopdyn
