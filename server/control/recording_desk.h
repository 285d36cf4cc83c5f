// SPDX-License-Identifier: MIT
// Whether the run is being recorded, and to which file: for /recorder, `--record FILE`, the page and
// get_status. Opens files between two steps and closes them on the desk's own thread: neither the run nor
// /recorder waits for a disk. Thread-safe unless a member says otherwise.
#pragma once

#include <atomic>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "server/base/mutex.h"
#include "server/net/io_thread.h"
#include "server/record/recorder.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/image_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

struct RecordingOptions {
  std::filesystem::path folder = ".";  // for recordings with a bare name
  std::optional<RecordWhat> what;      // nullopt: DefaultRecordWhat()
  Nanoseconds pose_every = 0;          // interval of poses and readings; 0: every step
  bool durable = false;                // write each step to disk before it is answered
  DrawImage draw;                      // camera pictures, if `what` has images
  double duration_s = 0;               // simulated time at which the run ends; 0: as in the scenario
  std::string version, command;        // written to the file: the program's version and command line
  /// Seconds since 1970, for default names and the file's start time.
  std::function<std::time_t()> wall_clock = [] { return std::time(nullptr); };
  /// Called, on any thread, after a recording has failed or the disk is full: `--on-record-failure stop` ends
  /// the daemon here.
  std::function<void()> on_failure;
};

/// The current recording.
struct RecordingStatus {
  bool recording = false;
  std::string name;  // file name without folders; empty: none
  RecorderStatus file;
};

class RecordingDesk {
 public:
  /// Called exactly once, on any thread, without locks.
  using Done = std::function<void(const EditResult&)>;

  /// All arguments outlive it.
  RecordingDesk(RecordingOptions options, EditQueue& edits, RunControl& run, const FrameBoard& frames,
                const Clock& clock, Logger logger);
  /// Calls Close().
  ~RecordingDesk();
  RecordingDesk(const RecordingDesk&) = delete;
  RecordingDesk& operator=(const RecordingDesk&) = delete;

  /// Records to the path `file`, from the first step on. Call it after the first frame has been published and
  /// before the stepping thread runs. Returns an error text, or empty on success. `force`: overwrites an
  /// existing file and ignores a lack of disk space.
  std::string StartFile(const std::string& file, bool force) EXCLUDES(mutex_);
  /// Records to `name` in the folder; empty: `run-YYYYMMDD-HHMMSS`. Overwrites nothing. Answers with the
  /// file's name.
  void Start(const std::string& name, Done done) EXCLUDES(mutex_);
  /// Answers once the file is closed, with its name and, if it is in the folder, its URL on `page`, the
  /// page's URL (empty: none).
  void Stop(std::string page, Done done) EXCLUDES(mutex_);
  /// Adds a note at the present time.
  void Note(const std::string& text, Done done) EXCLUDES(mutex_);
  /// Closes the file, if one is open. Call it after the stepping thread has stopped; later calls fail with
  /// error 5.
  void Close() EXCLUDES(mutex_);

  RecordingStatus status() const EXCLUDES(mutex_);
  /// The name of the current file; empty: no recording.
  std::string recording() const { return status().name; }
  /// True if a recording has ended by a failure: exit code 4.
  bool failed() const { return failed_; }

 private:
  enum class State { kIdle, kStarting, kRecording, kStopping, kClosed };

  /// Creates `recorder` for `file` and logs how much it will write. Returns an error text.
  std::string MakeRecorder(const std::filesystem::path& file, bool force,
                           std::shared_ptr<Recorder>& recorder);
  /// Reserves the start of a recording. Returns an error text, or empty on success.
  std::string BeginStart() EXCLUDES(mutex_);
  /// Does nothing after Close().
  void Set(State state, std::shared_ptr<Recorder> recorder = nullptr, const std::filesystem::path& file = {})
      EXCLUDES(mutex_);
  /// The active recorder, to be passed to PutAway(); null if there is none or, with `if_broken`, if it has
  /// not failed.
  std::shared_ptr<Recorder> TakeToStop(bool if_broken) EXCLUDES(mutex_);
  std::string DefaultName() const;
  /// Removes the journal from the stepping thread, then closes it on the desk's; answers like Stop().
  void PutAway(std::shared_ptr<Recorder> recorder, std::string page, Done done);
  void Fail(const std::string& text) EXCLUDES(mutex_);
  void AddEvent(const char* level, const std::string& text);

  const RecordingOptions options_;
  EditQueue& edits_;
  RunControl& run_;
  const FrameBoard& frames_;
  const Clock& clock_;
  const Logger logger_;
  std::atomic<bool> failed_{false};
  mutable Mutex mutex_;
  State state_ GUARDED_BY(mutex_) = State::kIdle;
  std::string failure_ GUARDED_BY(mutex_);                 // of the last recording; empty: no failure
  bool broken_ GUARDED_BY(mutex_) = false;                 // the current recorder has failed
  std::shared_ptr<Recorder> recorder_ GUARDED_BY(mutex_);  // while recording or stopping
  std::filesystem::path file_ GUARDED_BY(mutex_);          // the current recording's first file
  IoThread thread_;                                        // last: its work uses all other members
};

}  // namespace coopdyn
