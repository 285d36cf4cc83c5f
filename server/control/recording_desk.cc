// SPDX-License-Identifier: MIT
#include "server/control/recording_desk.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "server/record/run_reader.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".run";
constexpr const char* kNothing = "nothing is being recorded: start begins a recording";
constexpr const char* kStopping = "the daemon is stopping";

RecordingDesk::Result Refusal(Error error, std::string text) {
  return {error, std::move(text)};
}

std::string WithExtension(const std::string& name) {
  return name.ends_with(kExtension) ? name : name + std::string(kExtension);
}

/// Why no recording can be called so; empty if one can. `name` ends with .run.
std::string NameObjection(const std::string& name) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
  const std::size_t length = name.size() - kExtension.size();
  const bool good = length >= 1 && length <= RecordingDesk::kMaxName && name.front() != '.' &&
                    name.find_first_not_of(kAllowed) == std::string::npos;
  if (good) return {};
  return fmt::format("the name of a recording is letters, digits, _, - and ., at most {}: start lesson1",
                     RecordingDesk::kMaxName);
}

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

std::shared_ptr<Recorder> RecordingDesk::MakeRecorder(const fs::path& file, bool overwrite) {
  RecorderOptions options;
  options.file = file.string();
  options.what = options_.what;
  options.pose_every = options_.pose_every;
  options.overwrite = overwrite;
  options.version = options_.version;
  options.command = options_.command;
  options.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", Utc(options_.wall_clock()));
  options.on_failure = [this](const std::string& text) { Fail(text); };
  return std::make_shared<Recorder>(std::move(options), clock_, logger_);
}

std::string RecordingDesk::CheckFile(const Recorder& recorder, const fs::path& file, bool force) const {
  if (std::string error = recorder.Check(); !error.empty()) return error;
  const FramePtr frame = frames_.Latest();
  const RecordWhat what = options_.what.value_or(DefaultRecordWhat(frame->scene->robots.size()));
  const double left_s = options_.duration_s > 0 ? std::max(0.0, options_.duration_s - frame->time_s()) : 0;
  const SpaceNeeded space = EstimateSpace(*frame, what, options_.pose_every, left_s, file.string());
  logger_->info("recording to {}: {}", file.string(), ToString(space));
  // A run without an end needs room for its first seconds at least.
  constexpr double kLeast_s = 10;
  const double needed =
      space.bytes_in_all > 0 ? space.bytes_in_all : std::min(1e6, space.bytes_per_s * kLeast_s);
  if (force || needed <= space.bytes_free) return {};
  return fmt::format(
      "the recording cannot fit on the disk: {}; record less (--record-every, --record-what), or elsewhere",
      ToString(space));
}

std::string RecordingDesk::BeginStart() {
  if (frames_.Latest() == nullptr) return "the simulation has not begun yet";
  const MutexLock lock(mutex_);
  switch (state_) {
    case State::kIdle:
      state_ = State::kStarting;
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

void RecordingDesk::EndStart(State state, std::shared_ptr<Recorder> recorder) {
  const MutexLock lock(mutex_);
  state_ = state;
  recorder_.swap(recorder);
}

std::string RecordingDesk::StartFile(const std::string& file, bool force) {
  if (std::string error = BeginStart(); !error.empty()) return error;
  const fs::path path = fs::path(file).has_extension() ? file : file + std::string(kExtension);
  const std::shared_ptr<Recorder> recorder = MakeRecorder(path, force);
  std::string error = CheckFile(*recorder, path, force);
  if (!error.empty()) {
    EndStart(State::kIdle, nullptr);
    return error;
  }
  EndStart(State::kRecording, recorder);
  edits_.Push({edit::SetJournal{recorder.get()}, [this, recorder](const EditResult& result) {
                 if (result.error == Error::kOk) return;
                 logger_->error("{} is not recorded: {}", recorder->status().file, result.text);
                 EndStart(State::kIdle, nullptr);
               }});
  return {};
}

std::string RecordingDesk::DefaultName() const {
  const std::string name = fmt::format("run-{:%Y%m%d-%H%M%S}", Utc(options_.wall_clock()));
  std::string free = name;
  std::error_code ignored;
  for (int i = 2; fs::exists(options_.folder / WithExtension(free), ignored); ++i) {
    free = fmt::format("{}_{}", name, i);
  }
  return free;
}

void RecordingDesk::Start(const std::string& name, Done done) {
  const std::string file_name = WithExtension(name.empty() ? DefaultName() : name);
  if (std::string objection = NameObjection(file_name); !objection.empty()) {
    return done(Refusal(Error::kOutOfRange, std::move(objection)));
  }
  if (std::string error = BeginStart(); !error.empty()) {
    return done(Refusal(Error::kNotPossible, std::move(error)));
  }
  const fs::path path = options_.folder / file_name;
  std::error_code ignored;
  std::string error;
  std::shared_ptr<Recorder> recorder;
  if (fs::exists(path, ignored)) {
    error = file_name + " is there already: take another name, e.g. start " +
            file_name.substr(0, file_name.size() - kExtension.size()) + "b";
  } else {
    recorder = MakeRecorder(path, false);
    error = CheckFile(*recorder, path, false);
  }
  if (!error.empty()) {
    EndStart(State::kIdle, nullptr);
    return done(Refusal(Error::kNotPossible, std::move(error)));
  }
  RunJournal* const journal = recorder.get();
  edits_.Push({edit::SetJournal{journal},
               [this, recorder = std::move(recorder), file_name, done](const EditResult& result) {
                 const bool good = result.error == Error::kOk;
                 EndStart(good ? State::kRecording : State::kIdle, good ? recorder : nullptr);
                 done({result.error, good ? file_name : result.text, true, result.frame});
               }});
}

void RecordingDesk::Stop(Done done) {
  std::shared_ptr<Recorder> recorder;
  {
    const MutexLock lock(mutex_);
    if (state_ == State::kRecording) {
      state_ = State::kStopping;
      recorder = recorder_;
    }
  }
  if (recorder == nullptr) return done(Refusal(Error::kNotPossible, kNothing));
  PutAway(std::move(recorder), std::move(done));
}

void RecordingDesk::PutAway(std::shared_ptr<Recorder> recorder, Done done) {
  edits_.Push({edit::SetJournal{nullptr},
               [this, recorder = std::move(recorder), done = std::move(done)](const EditResult& result) {
                 // The journal is not in use any more: taken away, or nothing steps any more.
                 if (result.error != Error::kOk && done) done(Refusal(result.error, result.text));
                 if (result.error != Error::kOk) return;  // Close() follows
                 thread_.Post([this, recorder, done, frame = result.frame] {
                   recorder->Close();
                   const fs::path file = recorder->status().file;
                   EndStart(State::kIdle, nullptr);
                   logger_->info("recorded {}", file.string());
                   if (!done) return;
                   done({Error::kOk, file.filename().string(), SameFolder(file, options_.folder), frame});
                 });
               }});
}

void RecordingDesk::Note(const std::string& text, Done done) {
  std::shared_ptr<Recorder> journal;
  {
    const MutexLock lock(mutex_);
    if (state_ == State::kRecording) journal = recorder_;
  }
  if (journal == nullptr) return done(Refusal(Error::kNotPossible, kNothing));
  // A journal is written to on the stepping thread only, and this edit changes nothing: its answer comes
  // there, with the frame that the note belongs to.
  edits_.Push({edit::Save{}, [journal, text, done = std::move(done)](const EditResult& result) {
                 if (result.error == Error::kOk) {
                   journal->Note({result.frame->step, result.frame->time_s(), "note", text});
                 }
                 done({result.error, result.text, false, result.frame});
               }});
}

void RecordingDesk::Fail(const std::string& text) {
  std::shared_ptr<Recorder> recorder;
  {
    const MutexLock lock(mutex_);
    recorder = recorder_;
    if (state_ == State::kRecording) state_ = State::kStopping;
  }
  failed_ = true;
  const std::string said = "the recording ended: " + text;
  logger_->error("{}", said);
  const FramePtr frame = frames_.Latest();
  run_.AddEvent({frame == nullptr ? 0 : frame->step, frame == nullptr ? 0 : frame->time_s(), "error", said});
  PutAway(std::move(recorder), nullptr);
  if (options_.on_failure) options_.on_failure();
}

void RecordingDesk::Close() {
  thread_.Call([] {});  // what waits to be closed
  std::shared_ptr<Recorder> recorder;
  {
    const MutexLock lock(mutex_);
    state_ = State::kClosed;
    recorder.swap(recorder_);
  }
  if (recorder != nullptr) recorder->Close();
  thread_.Stop();
}

std::shared_ptr<Recorder> RecordingDesk::recorder() const {
  const MutexLock lock(mutex_);
  return recorder_;
}

RecordingStatus RecordingDesk::status() const {
  RecordingStatus status;
  if (const std::shared_ptr<Recorder> present = recorder()) {
    status.recording = true;
    status.file = present->status();
    status.name = fs::path(status.file.file).filename().string();
  }
  return status;
}

RecordingDesk::Found RecordingDesk::Find(const std::string& name) const {
  const fs::path file = options_.folder / name;
  std::error_code ignored;
  if (!name.ends_with(kExtension) || !NameObjection(name).empty() || !fs::is_regular_file(file, ignored)) {
    return {Error::kNoSuchName, "there is no recording " + name, {}};
  }
  const RecordingStatus present = status();
  if (present.recording && fs::equivalent(file, present.file.file, ignored)) {
    return {Error::kNotPossible, name + " is being recorded: stop the recording first", {}};
  }
  return {Error::kOk, {}, file};
}

RunFile RecordingDesk::Look(const fs::directory_entry& entry) {
  std::error_code ignored;
  const std::string name = entry.path().filename().string();
  Known& known = known_[name];
  const std::uint64_t bytes = entry.file_size(ignored);
  const fs::file_time_type written = entry.last_write_time(ignored);
  if (known.file.name == name && known.bytes == bytes && known.written == written && !known.file.recording) {
    return known.file;
  }
  known = {bytes, written, {name, bytes, {}, {}, false}};
  std::string error;
  if (const std::unique_ptr<RunReader> reader = RunReader::Open(entry.path().string(), error)) {
    const RunExtent extent = reader->extent();
    known.file.seconds = ToSeconds(extent.end - extent.begin);
    known.file.steps = extent.steps;
    known.file.recording = reader->growing();
  }
  return known.file;
}

void RecordingDesk::List(std::function<void(std::vector<RunFile>)> done) {
  thread_.Post([this, done = std::move(done)] {
    std::vector<fs::directory_entry> entries;
    std::error_code failed;
    for (fs::directory_iterator it(options_.folder, failed), end; !failed && it != end;
         it.increment(failed)) {
      std::error_code ignored;
      if (it->path().extension() == kExtension && it->is_regular_file(ignored)) entries.push_back(*it);
    }
    const auto newer = [](const fs::directory_entry& a, const fs::directory_entry& b) {
      std::error_code ignored;
      const auto time_a = a.last_write_time(ignored), time_b = b.last_write_time(ignored);
      return time_a != time_b ? time_a > time_b : a.path() < b.path();
    };
    std::sort(entries.begin(), entries.end(), newer);
    if (entries.size() > kMaxListed) entries.resize(kMaxListed);
    const RecordingStatus present = status();
    std::vector<RunFile> files;
    for (const fs::directory_entry& entry : entries) {
      std::error_code ignored;
      if (present.recording && fs::equivalent(entry.path(), present.file.file, ignored)) {
        files.push_back({present.name, present.file.bytes, ToSeconds(present.file.end - present.file.begin),
                         present.file.steps, true});
      } else {
        files.push_back(Look(entry));
      }
    }
    done(std::move(files));
  });
}

}  // namespace coopdyn
