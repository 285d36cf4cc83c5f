// SPDX-License-Identifier: MIT
#include "server/record/recorder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <system_error>
#include <utility>

#include "server/base/mutex.h"
#include "server/record/record_queue.h"
#include "server/record/run_writer.h"

namespace coopdyn {

namespace {

/// Steps of one commit at most: free mode makes thousands in the time of commit_every.
constexpr std::uint64_t kStepsAtOnce = 256;

/// lesson1-2.run for lesson1.run and 2; that itself for 1.
std::string NumberedName(const std::string& file, int number) {
  if (number == 1) return file;
  const std::string end = file.ends_with(".run") ? ".run" : "";
  return file.substr(0, file.size() - end.size()) + "-" + std::to_string(number) + end;
}

bool Exists(const std::string& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) == 0;
}

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
        queue_(options_.max_queue_bytes),
        thread_([this] { Run(); }) {}

  ~Impl() { Close(); }

  void Close() {
    queue_.Close();
    if (thread_.joinable()) thread_.join();
  }

  const RecorderOptions& options() const { return options_; }
  RecordQueue& queue() { return queue_; }

  RecorderStatus status() const EXCLUDES(mutex_) {
    const std::uint64_t lost = queue_.lost();
    const MutexLock lock(mutex_);
    RecorderStatus status = status_;
    status.lost = lost;
    if (coming_.files == 0 || !status.failure.empty()) return status;
    status.file = coming_.file;
    status.steps = status.bytes = 0;
    status.begin = status.end = coming_.begin;
    return status;
  }

  // --- the holder of the baton
  void Begin(const SavedStatePtr& state) EXCLUDES(mutex_) {
    const bool drops_present = number_ > 0 && !has_content_;
    // A name that is taken is left alone, but for the one that the user has given.
    if (!drops_present) {
      do ++number_;
      while (number_ > 1 && Exists(NumberedName(options_.file, number_)));
    }
    has_content_ = false;
    {
      const MutexLock lock(mutex_);
      coming_ = {coming_.files + 1, NumberedName(options_.file, number_), state->frame->time};
    }
    queue_.PushBegin({state, number_, drops_present});
  }
  void Step(QueuedStep step) {
    has_content_ = true;
    queue_.PushStep(std::move(step));
  }
  void Note(Event event) {
    has_content_ = has_content_ || event.level == "note";
    queue_.PushEvent(std::move(event));
  }

 private:
  /// Files that were begun and are not yet made, and the last of them.
  struct Coming {
    int files = 0;
    std::string file;
    Nanoseconds begin = 0;
  };
  struct Moment {
    std::uint64_t step = 0;
    double time_s = 0;  // simulated
  };

  // --- all below: the recorder's thread
  void Run() {
    while (!queue_.ended()) {
      const bool is_dirty = writer_ != nullptr && writer_->dirty();
      std::optional<QueuedItem> item = queue_.Pop(!is_dirty);
      if (item && !failed_) Write(*item);
      item.reset();
      if (!failed_) CommitIfDue();
    }
    if (writer_ != nullptr && !failed_) NoteLost(queue_.TakeLostAtEnd(), last_);
    CloseFile();
    ReportCpu();
  }

  void Write(QueuedItem& item) {
    if (const auto* begin = std::get_if<QueuedBegin>(&item.what)) {
      if (writer_ != nullptr) NoteLost(item.lost_before, last_);
      EndFile(*begin);
      if (!failed_) OpenFile(*begin);
    } else if (writer_ == nullptr) {
      return;
    } else if (auto* step = std::get_if<QueuedStep>(&item.what)) {
      WriteStep(*step, item.lost_before);
    } else if (const auto* input = std::get_if<RunInput>(&item.what)) {
      Check(writer_->AddInput(*input));
    } else if (const auto* event = std::get_if<Event>(&item.what)) {
      Check(writer_->AddEvent(*event));
    }
  }

  void WriteStep(QueuedStep& step, std::uint64_t lost_before) {
    const Frame& frame = *step.frame;
    last_ = {frame.step, frame.time_s()};
    NoteLost(lost_before, last_);
    if (failed_ || !Check(writer_->AddStep(frame))) return;
    if (step.keyframe) {
      SavedState state;
      state.frame = step.frame;
      state.controllers = std::move(step.controllers);
      state.mode = step.mode;
      Check(writer_->AddKeyframe(state));
    }
    if (failed_) return;
    const MutexLock lock(mutex_);
    status_.steps = writer_->steps();
    status_.end = writer_->end();
  }

  /// After a reset, load or restore: ends the present file, which says where the run goes on. One without
  /// steps is dropped, and its name used again.
  void EndFile(const QueuedBegin& begin) {
    if (writer_ == nullptr || failed_) return CloseFile();
    const std::string file = writer_->file();
    if (!begin.drops_present) {
      const std::string next = NumberedName(options_.file, begin.number);
      Check(writer_->AddEvent({last_.step, last_.time_s, "info", "the run begins anew in " + next}));
    }
    CloseFile();
    if (begin.drops_present && !failed_) RemoveRunFile(file);
  }

  void OpenFile(const QueuedBegin& begin) {
    const SavedState& state = *begin.state;
    std::string error;
    writer_ = MakeFile(state, begin.number, error);
    if (writer_ == nullptr) return Fail(error);
    // So that it can be read from now on, whatever happens.
    if (!Check(writer_->Commit())) return;
    has_made_ = true;
    committed_steps_ = 0;
    logger_->info("recording to {}", writer_->file());
    last_ = committed_ = {state.frame->step, state.frame->time_s()};
    is_dirty_ = false;
    const MutexLock lock(mutex_);
    --coming_.files;
    status_.file = writer_->file();
    status_.steps = 0;
    status_.begin = status_.end = writer_->begin();
    status_.bytes = writer_->bytes();
  }

  std::unique_ptr<RunWriter> MakeFile(const SavedState& state, int number, std::string& error) {
    RunWriterOptions options;
    options.overwrite = options_.overwrite && !has_made_;
    const RecordWhat what = options_.what.value_or(DefaultRecordWhat(state.frame->robots.size()));
    options.header = HeaderOf(*state.frame, state.mode, what, options_.pose_every);
    options.header.version = options_.version;
    options.header.command = options_.command;
    options.header.started = options_.started;
    options.header.build = build_;
    options.header.cpu = CpuName();
    while (true) {
      const std::string file = NumberedName(options_.file, number++);
      std::unique_ptr<RunWriter> writer = RunWriter::Create(file, options, state, error);
      // Somebody may have taken the name of a later file meanwhile.
      if (writer != nullptr || !has_made_ || !Exists(file)) return writer;
    }
  }

  void CloseFile() {
    if (writer_ == nullptr) return;
    std::string remark;
    if (!Check(writer_->Close(remark))) return;
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
    if (!is_dirty_) dirty_since_ = now;
    is_dirty_ = true;
    // A disk that is full takes the present transaction with it.
    const bool many = writer_->steps() >= committed_steps_ + kStepsAtOnce;
    if (now - dirty_since_ < options_.commit_every && !many) return;
    is_dirty_ = false;
    committed_steps_ = writer_->steps();
    if (!Check(writer_->Commit())) return;
    committed_ = last_;
    const std::uint64_t bytes = writer_->bytes();
    ReportCpu();
    const MutexLock lock(mutex_);
    status_.bytes = bytes;
  }

  void NoteLost(std::uint64_t steps, const Moment& at) {
    if (steps == 0) return;
    const std::string text = (steps == 1 ? "1 step was" : std::to_string(steps) + " steps were") +
                             " not recorded: the disk did not keep up";
    logger_->warn("step {}: {}", at.step, text);
    if (Check(writer_->AddLost(steps))) Check(writer_->AddEvent({at.step, at.time_s, "warning", text}));
  }

  /// False, and the recording has ended, if it was not written.
  bool Check(bool written) {
    if (written) return true;
    const std::string until = fmt::format("{:.2f} s, step {}", committed_.time_s, committed_.step);
    Fail(writer_->error() + "; " + writer_->file() + " holds the run up to " + until);
    return false;
  }

  void Fail(const std::string& reason) {
    failed_ = true;
    queue_.Fail();
    const std::string text = "the recording ends: " + reason;
    logger_->error("{}", text);
    {
      const MutexLock lock(mutex_);
      status_.failure = text;
    }
    // First: to close a file can take seconds on a disk that is busy, or full.
    if (options_.on_failure) options_.on_failure(text);
    if (writer_ != nullptr) LetFileGo();
  }

  void ReportCpu() {
    const double used_s = ThreadCpu_s();
    const MutexLock lock(mutex_);
    status_.cpu_s = used_s;
  }

  const RecorderOptions options_;
  const Clock& clock_;
  const Logger logger_;
  RecordQueue queue_;
  mutable Mutex mutex_;
  RecorderStatus status_ GUARDED_BY(mutex_);
  Coming coming_ GUARDED_BY(mutex_);

  // The holder of the baton only.
  int number_ = 0;            // of the present file
  bool has_content_ = false;  // steps or notes, in the present file

  // The recorder's thread only.
  std::unique_ptr<RunWriter> writer_;
  const std::string build_ = BuildId();  // before the run, as it reads the whole program
  std::uint64_t committed_steps_ = 0;
  bool has_made_ = false;  // the first file
  bool failed_ = false;    // nothing is written any more
  bool is_dirty_ = false;
  Nanoseconds dirty_since_ = 0;  // wall clock
  Moment last_, committed_;

  std::thread thread_;  // last: it uses the rest
};

Recorder::Recorder(RecorderOptions options, const Clock& clock, Logger logger) {
  // A limit on the size of files is an error of the recording, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);
  impl_ = std::make_unique<Impl>(std::move(options), clock, std::move(logger));
}

Recorder::~Recorder() = default;

std::string Recorder::Check() const {
  const std::string& file = impl_->options().file;
  if (const std::string error = WhyNoRunFile(file, impl_->options().overwrite); !error.empty()) return error;
  struct stat found {};
  if (::lstat(file.c_str(), &found) == 0) return {};
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return "cannot make " + file + ": " + std::generic_category().message(errno);
  ::close(descriptor);
  ::unlink(file.c_str());
  return {};
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

void Recorder::Step(const FramePtr& frame, Mode mode, bool keyframe, std::vector<std::byte> controllers) {
  impl_->Step({frame, mode, keyframe, std::move(controllers)});
}

void Recorder::Input(RunInput input) {
  impl_->queue().PushInput(std::move(input));
}

void Recorder::Note(Event event) {
  impl_->Note(std::move(event));
}

}  // namespace coopdyn
