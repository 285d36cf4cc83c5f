// SPDX-License-Identifier: MIT
#include "server/control/recording_desk.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "server/naming/run_names.h"
#include "server/record/space.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNothing = "nothing is being recorded: start begins a recording";
constexpr const char* kStopping = "the daemon is stopping";

std::tm Utc(std::time_t time) {
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  return parts;
}

bool SameFolder(const fs::path& file, const fs::path& folder) {
  std::error_code ignored;
  const fs::path parent = file.parent_path();
  return fs::equivalent(parent.empty() ? "." : parent, folder, ignored);
}

}  // namespace

RecordingDesk::RecordingDesk(RecordingOptions options, EditQueue& edits, RunControl& run,
                             const FrameBoard& frames, const Clock& clock, Logger logger)
    : options_(std::move(options)),
      edits_(edits),
      run_(run),
      frames_(frames),
      clock_(clock),
      logger_(std::move(logger)),
      thread_("recordings", logger_) {}

RecordingDesk::~RecordingDesk() {
  Close();
}

std::string RecordingDesk::MakeRecorder(const fs::path& file, bool force,
                                        std::shared_ptr<Recorder>& recorder) {
  RecorderOptions options;
  options.file = file.string();
  options.what = options_.what;
  options.pose_every = options_.pose_every;
  options.durable = options_.durable;
  options.draw = options_.draw;
  options.overwrite = force;
  options.version = options_.version;
  options.command = options_.command;
  options.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", Utc(options_.wall_clock()));
  options.on_failure = [this](const std::string& text) { Fail(text); };
  options.on_stall = [this](const std::string& text) {
    AddEvent("error", text);
    if (options_.on_failure) options_.on_failure();
  };
  options.on_room = [this](const std::string& text) { AddEvent("info", text); };
  recorder = std::make_shared<Recorder>(std::move(options), clock_, logger_);
  if (std::string error = recorder->Check(); !error.empty()) return error;
  const FramePtr frame = frames_.Latest();
  const RecordWhat what = options_.what.value_or(DefaultRecordWhat(frame->scene->robots.size()));
  const double scenario_s = frame->scene->scenario->simulation.duration_s.value_or(0);
  const double duration_s = options_.duration_s > 0 ? options_.duration_s : scenario_s;
  const double left_s = duration_s > 0 ? std::max(0.0, duration_s - frame->time_s()) : 0;
  const SpaceNeeded space = EstimateSpace(*frame, what, options_.pose_every, left_s, file.string());
  logger_->info("a recording to {} takes {}", file.string(), ToString(space));
  // A run without end needs room for at least its first seconds.
  constexpr double kLeast_s = 10;
  const double needed =
      space.bytes_in_all > 0 ? space.bytes_in_all : std::max(1e6, space.bytes_per_s * kLeast_s);
  if (force || needed <= space.bytes_free) return {};
  return fmt::format(
      "the recording cannot fit on the disk: {}; record less (--record-every, --record-what), elsewhere, or "
      "with --force",
      ToString(space));
}

std::string RecordingDesk::BeginStart() {
  if (frames_.Latest() == nullptr) return "the simulation has not begun yet";
  if (run_.playback()) return kPlayingText;
  const MutexLock lock(mutex_);
  switch (state_) {
    case State::kIdle:
      state_ = State::kStarting;
      broken_ = false;
      failure_.clear();
      return {};
    case State::kClosed:
      return kStopping;
    case State::kStopping:
      return "the last recording is being closed: start again in a moment";
    case State::kStarting:
    case State::kRecording:
      break;
  }
  return "a recording is under way: stop ends it";
}

void RecordingDesk::Set(State state, std::shared_ptr<Recorder> recorder, const fs::path& file) {
  const MutexLock lock(mutex_);
  if (state_ == State::kClosed) return;
  state_ = state;
  file_ = file;
  recorder_.swap(recorder);
}

std::shared_ptr<Recorder> RecordingDesk::TakeToStop(bool if_broken) {
  const MutexLock lock(mutex_);
  if (state_ != State::kRecording || (if_broken && !broken_)) return nullptr;
  state_ = State::kStopping;
  return recorder_;
}

std::string RecordingDesk::StartFile(const std::string& file, bool force) {
  std::error_code missing;
  if (file.ends_with('/') || fs::is_directory(file, missing)) {
    return file + " is a folder: write the name of a file, e.g. --record " +
           (fs::path(file) / "lesson1.run").string();
  }
  const fs::path path = fs::path(file).has_extension() ? file : WithRunExtension(file);
  if (std::string objection = RunNameObjection(path.filename().string()); !objection.empty())
    return objection;
  if (std::string error = BeginStart(); !error.empty()) return error;
  std::shared_ptr<Recorder> recorder;
  if (std::string error = MakeRecorder(path, force, recorder); !error.empty()) {
    Set(State::kIdle);
    return error;
  }
  Set(State::kRecording, recorder, path);
  edits_.Push({edit::SetJournal{recorder.get()}, [this, recorder, path](const EditResult& result) {
                 if (result.error == Error::kOk) return;
                 logger_->error("{} is not recorded: {}", path.string(), result.text);
                 Set(State::kIdle);
               }});
  return {};
}

std::string RecordingDesk::DefaultName() const {
  const std::string name = fmt::format("run-{:%Y%m%d-%H%M%S}", Utc(options_.wall_clock()));
  std::string free = name;
  std::error_code ignored;
  for (int i = 2; fs::exists(options_.folder / WithRunExtension(free), ignored); ++i) {
    free = fmt::format("{}_{}", name, i);
  }
  return free;
}

void RecordingDesk::Start(const std::string& name, Done done) {
  const std::string file_name = WithRunExtension(name.empty() ? DefaultName() : name);
  if (std::string objection = RunNameObjection(file_name); !objection.empty()) {
    return done({Error::kOutOfRange, std::move(objection)});
  }
  if (std::string error = BeginStart(); !error.empty()) {
    return done({Error::kNotPossible, std::move(error)});
  }
  const fs::path path = options_.folder / file_name;
  std::error_code ignored;
  std::shared_ptr<Recorder> recorder;
  std::string error =
      fs::exists(path, ignored)
          ? file_name + " is there already: choose another name, e.g. start " + path.stem().string() + "b"
          : MakeRecorder(path, false, recorder);
  if (!error.empty()) {
    Set(State::kIdle);
    return done({Error::kNotPossible, std::move(error)});
  }
  RunJournal* const journal = recorder.get();
  edits_.Push({edit::SetJournal{journal},
               [this, recorder = std::move(recorder), path, done](const EditResult& result) {
                 const bool good = result.error == Error::kOk;
                 if (good) {
                   Set(State::kRecording, recorder, path);
                 } else {
                   Set(State::kIdle);
                 }
                 // The recorder may have failed by now.
                 if (std::shared_ptr<Recorder> broken = TakeToStop(true)) PutAway(broken, {}, nullptr);
                 done({result.error, good ? path.filename().string() : result.text, result.frame});
               }});
}

void RecordingDesk::Stop(std::string page, Done done) {
  std::shared_ptr<Recorder> recorder = TakeToStop(false);
  if (recorder == nullptr) {
    std::string text = kNothing;
    {
      const MutexLock lock(mutex_);
      if (!failure_.empty()) text = "nothing is being recorded: " + failure_;
    }
    return done({Error::kNotPossible, std::move(text)});
  }
  PutAway(std::move(recorder), std::move(page), std::move(done));
}

void RecordingDesk::PutAway(std::shared_ptr<Recorder> recorder, std::string page, Done done) {
  edits_.Push({edit::SetJournal{nullptr}, [this, recorder = std::move(recorder), page = std::move(page),
                                           done = std::move(done)](const EditResult& result) {
                 // The journal is no longer used: it was removed, or stepping has ended.
                 if (result.error != Error::kOk) {
                   if (done) done(result);
                   return;  // Close() follows
                 }
                 thread_.Post([this, recorder, page, done, frame = result.frame] {
                   recorder->Close();
                   const fs::path file = recorder->status().file;
                   Set(State::kIdle);
                   logger_->info("recorded {}", file.string());
                   if (!done) return;
                   std::string name = file.filename().string();
                   const std::string url = SameFolder(file, options_.folder) ? RunUrl(page, name) : "";
                   done({Error::kOk, url.empty() ? name : name + " " + url, frame});
                 });
               }});
}

void RecordingDesk::Note(const std::string& text, Done done) {
  {
    const MutexLock lock(mutex_);
    if (state_ != State::kRecording) return done({Error::kNotPossible, kNothing});
  }
  edits_.Push({edit::Note{text}, std::move(done)});
}

void RecordingDesk::AddEvent(const char* level, const std::string& text) {
  const FramePtr frame = frames_.Latest();
  run_.AddEvent({frame == nullptr ? 0 : frame->step, frame == nullptr ? 0 : frame->time_s(), level, text});
}

void RecordingDesk::Fail(const std::string& text) {
  failed_ = true;
  AddEvent("error", text);
  {
    const MutexLock lock(mutex_);
    broken_ = true;
    failure_ = text;
  }
  // While starting or stopping, Start() and PutAway() check for the failure themselves.
  if (std::shared_ptr<Recorder> broken = TakeToStop(true)) PutAway(std::move(broken), {}, nullptr);
  if (options_.on_failure) options_.on_failure();
}

void RecordingDesk::Close() {
  thread_.Call([] {});  // waits for files being closed
  std::shared_ptr<Recorder> recorder;
  {
    const MutexLock lock(mutex_);
    state_ = State::kClosed;
    recorder.swap(recorder_);
  }
  if (recorder != nullptr) recorder->Close();
  thread_.Stop();
}

RecordingStatus RecordingDesk::status() const {
  RecordingStatus status;
  std::shared_ptr<Recorder> present;
  fs::path file;
  {
    const MutexLock lock(mutex_);
    present = recorder_;
    file = file_;
  }
  if (present == nullptr) return status;
  status.recording = true;
  status.file = present->status();
  if (status.file.file.empty()) status.file.file = file.string();  // not created yet
  status.name = fs::path(status.file.file).filename().string();
  return status;
}

}  // namespace coopdyn
