// SPDX-License-Identifier: MIT
#include "server/record/recorder.h"

#include <csignal>
#include <ctime>
#include <utility>

#include "server/base/mutex.h"
#include "server/record/record_queue.h"
#include "server/record/recording_files.h"
#include "server/record/run_writer.h"

namespace coopdyn {

namespace {

/// Most steps per commit: free mode makes thousands within commit_every.
constexpr std::uint64_t kStepsAtOnce = 256;

/// After each failed attempt to continue, the next one waits twice as long, at most this long.
constexpr Nanoseconds kMostRetry = 32 * kNanosecondsPerSecond;

double ThreadCpu_s() {
  timespec used{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

}  // namespace

class Recorder::Impl {
 public:
  Impl(RecorderOptions options, const Clock& clock, Logger logger)
      : options_(std::move(options)),
        clock_(clock),
        logger_(std::move(logger)),
        files_(options_),
        queue_(options_.max_queue_bytes, options_.durable ? CrashCost{.steps = 0} : CrashCost()),
        thread_([this] { Run(); }) {}

  ~Impl() { Close(); }

  void Close() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }

  const RecorderOptions& options() const { return options_; }
  const RecordingFiles& files() const { return files_; }
  RecordQueue& queue() { return queue_; }

  RecorderStatus status() const EXCLUDES(mutex_) {
    const std::uint64_t lost = queue_.lost();
    const MutexLock lock(mutex_);
    RecorderStatus status = status_;
    status.lost = lost;
    if (coming_.order == made_ || !status.failure.empty()) return status;
    status.file = coming_.file;
    status.steps = status.bytes = 0;
    status.begin = status.end = coming_.begin;
    return status;
  }

  // --- Called by the holder of the baton.
  void Begin(const SavedStatePtr& state) EXCLUDES(mutex_) {
    const bool drops_present = number_ > 0 && !has_content_;
    // Skips names that are taken, except the one that the user gave.
    if (!drops_present) {
      do ++number_;
      while (number_ > 1 && files_.IsTaken(number_));
    }
    has_content_ = false;
    {
      const MutexLock lock(mutex_);
      coming_ = {++begun_, files_.Name(number_), state->frame->time};
    }
    queue_.PushBegin({state, number_, begun_, drops_present});
  }
  void Step(QueuedStep step) {
    has_content_ = true;
    queue_.PushStep(std::move(step));
  }
  void Note(Event event) {
    has_content_ = has_content_ || event.level == "note" || event.level == kLogLevel;
    queue_.PushEvent(std::move(event));
  }

 private:
  /// The file begun last.
  struct Coming {
    int order = 0;
    std::string file;
    Nanoseconds begin = 0;
  };
  struct Moment {
    std::uint64_t step = 0;
    double time_s = 0;  // simulated
  };

  // --- All below run on the recorder's thread.
  void Run() {
    try {
      WriteAll();
    } catch (const std::exception& error) {  // e.g. no more memory
      if (!failed_) Fail(error.what());
    }
    ReportCpu();
  }

  void WriteAll() {
    while (!queue_.ended()) {
      if (!stall_.empty()) {
        if (queue_.WaitStalled()) break;
        if (clock_.Now() >= retry_at_) TryToResume();
        continue;
      }
      const bool is_dirty = writer_ != nullptr && writer_->dirty();
      std::optional<QueuedItem> item = queue_.Pop(!is_dirty);
      if (item && !failed_) Write(*item);
      item.reset();
      if (writes()) CommitIfDue();
    }
    if (writer_ != nullptr && writes()) NoteLostAfter(queue_.TakeLostAtEnd());
    if (writes()) CloseFile();
    if (!stall_.empty()) Fail(stall_);
  }

  bool writes() const { return !failed_ && stall_.empty(); }

  void Write(QueuedItem& item) {
    if (auto* begin = std::get_if<QueuedBegin>(&item.what)) {
      owed_ += item.lost_before;
      begin_ = std::move(*begin);
      BeginFile();
    } else if (writer_ == nullptr) {
      return;
    } else if (auto* step = std::get_if<QueuedStep>(&item.what)) {
      WriteStep(*step, item.lost_before);
    } else if (const auto* input = std::get_if<RunInput>(&item.what)) {
      Check(writer_->AddInput(*input));
    } else if (auto* event = std::get_if<Event>(&item.what)) {
      events_.push_back(std::move(*event));
      Check(writer_->AddEvent(events_.back()));
    }
  }

  void WriteStep(QueuedStep& step, std::uint64_t lost_before) {
    const Frame& frame = *step.frame;
    last_ = {frame.step, frame.time_s()};
    if (!std::exchange(is_dirty_, true)) dirty_since_ = step.now;
    ++taken_;
    NoteLost(lost_before);
    if (!writes() || !Check(writer_->AddStep(frame)) || !Check(writer_->AddImages(step.frame))) return;
    if (step.keyframe != nullptr && !Check(writer_->AddKeyframe(*step.keyframe))) return;
    const MutexLock lock(mutex_);
    status_.steps = writer_->steps();
    status_.end = writer_->end();
  }

  /// Ends the current file and makes the file of `begin_`.
  void BeginFile() {
    EndFile(*begin_);
    if (writes()) OpenFile(*begin_);
    if (writes()) begin_.reset();
  }

  /// After a reset, load or restore: ends the current file with a note of the file in which the run
  /// continues. A file without steps is removed and its name reused.
  void EndFile(const QueuedBegin& begin) {
    if (writer_ == nullptr || failed_) return CloseFile();
    const std::string file = writer_->file();
    const bool drops = begin.drops_present && begin.order == made_order_ + 1;
    if (!drops) {
      NoteLostAfter(0);
      const std::string next = files_.Name(begin.number);
      if (!writes() ||
          !Check(writer_->AddEvent({last_.step, last_.time_s, "info", "the run starts again in " + next}))) {
        return;
      }
    }
    CloseFile();
    if (drops && writes()) RemoveRunFile(file);
  }

  void OpenFile(const QueuedBegin& begin) {
    const SavedState& state = *begin.state;
    std::string error;
    writer_ = files_.Make(state, begin.number, error);
    if (writer_ == nullptr) return files_.HasRoom() ? Fail(error) : Stall(error);
    // From now on the file can be read, whatever happens.
    if (!Check(writer_->Commit())) return;
    files_.NoteMade();
    made_order_ = begin.order;
    committed_steps_ = taken_ = noted_ = owed_ = 0;
    events_.clear();
    logger_->info("recording to {}", writer_->file());
    last_ = committed_ = {state.frame->step, state.frame->time_s()};
    is_dirty_ = false;
    const MutexLock lock(mutex_);
    made_ = begin.order;
    status_.file = writer_->file();
    status_.steps = 0;
    status_.begin = status_.end = writer_->begin();
    status_.bytes = writer_->bytes();
  }

  void CloseFile() {
    if (writer_ == nullptr) return;
    std::string remark;
    if (!Check(writer_->Close(remark))) return;
    queue_.NoteCommitted();
    if (!remark.empty()) logger_->warn("{}", remark);
    LetFileGo();
  }

  void LetFileGo() {
    const std::uint64_t bytes = writer_->bytes();
    writer_.reset();
    const MutexLock lock(mutex_);
    status_.bytes = bytes;
  }

  void CommitIfDue() {
    if (writer_ == nullptr || !writer_->dirty()) {
      is_dirty_ = false;
      return;
    }
    const Nanoseconds now = clock_.Now();
    if (!std::exchange(is_dirty_, true)) dirty_since_ = now;
    // A full disk rolls back the current transaction, so commit often.
    const bool many = writer_->steps() >= committed_steps_ + kStepsAtOnce;
    const bool due = options_.durable ? !queue_.HasMore() : now - dirty_since_ >= options_.commit_every;
    if (!due && !many) return;
    is_dirty_ = false;
    committed_steps_ = writer_->steps();
    if (!Check(writer_->Commit())) return;
    queue_.NoteCommitted();
    committed_ = last_;
    events_.clear();
    const std::uint64_t bytes = writer_->bytes();
    ReportCpu();
    const MutexLock lock(mutex_);
    status_.bytes = bytes;
  }

  std::string LostText(std::uint64_t steps) const {
    return (steps == 1 ? "1 step was" : std::to_string(steps) + " steps were") + " not recorded: " +
           (was_full_ ? "there was no room for " + std::string(steps == 1 ? "it" : "them")
                      : "the disk did not keep up");
  }

  /// Notes the steps lost before the step that is being written.
  void NoteLost(std::uint64_t steps) { NoteLost(steps, "", &RunWriter::AddLost); }
  /// Notes the steps lost after the last step of the file.
  void NoteLostAfter(std::uint64_t steps) { NoteLost(steps, "after ", &RunWriter::AddLostAfter); }
  void NoteLost(std::uint64_t steps, const char* where, bool (RunWriter::*add)(std::uint64_t)) {
    steps += std::exchange(owed_, 0);
    if (steps == 0) return;
    noted_ += steps;
    const std::string text = LostText(steps);
    was_full_ = false;
    logger_->warn("{}step {}: {}", where, last_.step, text);
    if (Check((*writer_.*add)(steps))) Check(writer_->AddEvent({last_.step, last_.time_s, "warning", text}));
  }

  /// If `written` is false, stalls or ends the recording. Returns `written`.
  bool Check(bool written) {
    if (written) return true;
    if (writer_->full()) {
      Stall(writer_->error());
    } else {
      Fail(writer_->error());
    }
    return false;
  }

  /// Steps since the last commit are lost, as are further steps until there is room.
  void Stall(const std::string& reason) {
    const Nanoseconds now = clock_.Now();
    const bool soon = retry_after_ > 0 && now - went_on_at_ < kMostRetry;
    retry_after_ = soon ? std::min(2 * retry_after_, kMostRetry) : options_.retry_every;
    retry_at_ = now + retry_after_;
    stall_ = reason;
    was_full_ = true;
    is_dirty_ = false;
    std::uint64_t lost = 0;
    if (writer_ != nullptr) {
      lost = taken_ - writer_->steps();
      owed_ += lost + noted_ - writer_->lost();
      taken_ = writer_->steps();
      noted_ = writer_->lost();
      committed_steps_ = writer_->steps();
      last_ = committed_;
    }
    queue_.Stall(lost);
    const std::string text =
        "nothing is recorded for now: " + reason + "; it goes on by itself when there is room";
    logger_->error("{}", text);
    {
      const MutexLock lock(mutex_);
      status_.stall = text;
      if (writer_ != nullptr) {
        status_.steps = writer_->steps();
        status_.end = writer_->end();
      }
    }
    if (options_.on_stall) options_.on_stall(text);
  }

  void TryToResume() {
    retry_at_ = clock_.Now() + retry_after_;
    if (!files_.HasRoom()) return;
    if (writer_ != nullptr) {
      writer_->Resume();
      bool written = true;
      for (const Event& event : events_) written = written && writer_->AddEvent(event);
      if (!written || !writer_->Commit()) {
        retry_after_ = std::min(2 * retry_after_, kMostRetry);
        return;
      }
      events_.clear();
    }
    went_on_at_ = clock_.Now();
    stall_.clear();
    if (begin_) BeginFile();
    if (!writes()) return;
    queue_.Resume();
    const std::string text = "there is room again: recording to " + writer_->file() + " resumes";
    logger_->info("{}", text);
    {
      const MutexLock lock(mutex_);
      status_.stall.clear();
    }
    if (options_.on_room) options_.on_room(text);
  }

  void Fail(const std::string& reason) {
    failed_ = true;
    queue_.Fail();
    std::string text = "the recording ends: " + reason;
    if (writer_ != nullptr) {
      text += fmt::format("; {} holds the run up to {:.2f} s, step {}", writer_->file(), committed_.time_s,
                          committed_.step);
    }
    logger_->error("{}", text);
    {
      const MutexLock lock(mutex_);
      status_.failure = text;
      status_.stall.clear();
    }
    // Report first: closing a file can take seconds on a busy or full disk.
    if (options_.on_failure) options_.on_failure(text);
    if (writer_ == nullptr) return;
    if (!std::exchange(stall_, "").empty()) {
      // If there is room for two rows, the file says how many steps are missing.
      std::string ignored;
      const std::uint64_t lost = owed_ + queue_.TakeLostAtEnd();
      writer_->Resume();
      const bool said =
          lost == 0 || (writer_->AddLostAfter(lost) &&
                        writer_->AddEvent({last_.step, last_.time_s, "warning", LostText(lost)}));
      if (said) writer_->Close(ignored);
    }
    LetFileGo();
  }

  void ReportCpu() {
    const double used_s = ThreadCpu_s();
    const MutexLock lock(mutex_);
    status_.cpu_s = used_s;
  }

  const RecorderOptions options_;
  const Clock& clock_;
  const Logger logger_;
  RecordingFiles files_;
  RecordQueue queue_;
  mutable Mutex mutex_;
  RecorderStatus status_ GUARDED_BY(mutex_);
  Coming coming_ GUARDED_BY(mutex_);
  int made_ GUARDED_BY(mutex_) = 0;  // order of the file in status_

  // Used only by the holder of the baton.
  int number_ = 0;            // of the current file
  int begun_ = 0;             // files
  bool has_content_ = false;  // the current file has steps or notes

  // Used only by the recorder's thread.
  std::unique_ptr<RunWriter> writer_;
  std::uint64_t committed_steps_ = 0;
  int made_order_ = 0;   // of the file made last
  bool failed_ = false;  // no more is written
  bool is_dirty_ = false;
  Nanoseconds dirty_since_ = 0;  // wall clock
  Moment last_, committed_;
  std::optional<QueuedBegin> begin_;  // its file is not made yet
  std::vector<Event> events_;         // since the last commit
  // Of the current file: steps taken from the queue, steps noted as lost, and lost steps still to be noted.
  std::uint64_t taken_ = 0, noted_ = 0, owed_ = 0;
  std::string stall_;      // why nothing can be written for now; empty while writing
  bool was_full_ = false;  // the last lost steps were lost because the disk was full
  Nanoseconds retry_at_ = 0, retry_after_ = 0, went_on_at_ = 0;  // wall clock

  std::thread thread_;  // last: uses all other members
};

Recorder::Recorder(RecorderOptions options, const Clock& clock, Logger logger) {
  // Exceeding a file size limit must fail the recording, not kill the process.
  std::signal(SIGXFSZ, SIG_IGN);
  impl_ = std::make_unique<Impl>(std::move(options), clock, std::move(logger));
}

Recorder::~Recorder() = default;

std::string Recorder::Check() const {
  return impl_->files().WhyNone();
}

void Recorder::Close() {
  impl_->Close();
}

RecorderStatus Recorder::status() const {
  return impl_->status();
}

void Recorder::Begin(const SavedStatePtr& state) {
  impl_->Begin(state);
}

bool Recorder::WantsKeyframe(std::uint64_t step) {
  return impl_->queue().WantsKeyframe(step, impl_->options().keyframe_steps);
}

void Recorder::Step(const FramePtr& frame, Mode mode, SavedStatePtr keyframe, Nanoseconds now) {
  impl_->Step({frame, mode, std::move(keyframe), now});
}

void Recorder::Input(RunInput input) {
  impl_->queue().PushInput(std::move(input));
}

void Recorder::Note(Event event) {
  impl_->Note(std::move(event));
}

}  // namespace coopdyn
