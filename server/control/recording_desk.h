// SPDX-License-Identifier: MIT
// Whether, and to which file, the run is being recorded: for /recorder, `--record FILE`, the page and
// get_status. Files are opened between two steps and closed on a thread of the desk's own, so that neither
// the run nor /recorder waits for a disk. All calls from any thread, unless they say otherwise.
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
  std::filesystem::path folder = ".";  // of recordings that have a bare name
  std::optional<RecordWhat> what;      // empty: DefaultRecordWhat()
  Nanoseconds pose_every = 0;          // poses and readings only so often; 0: each step
  bool durable = false;                // each step is on the disk before it is answered
  DrawImage draw;                      // of cameras, if `what` has images
  double duration_s = 0;               // simulated time at which the run ends; 0: as the scenario says
  std::string version, command;        // for the file: of the program, its command line
  /// Seconds since 1970, for default names and for what the file says of its start.
  std::function<std::time_t()> wall_clock = [] { return std::time(nullptr); };
  /// Called, on any thread, after a recording has failed, or finds no room: `--on-record-failure stop` ends
  /// the daemon here.
  std::function<void()> on_failure;
};

/// What is being recorded now.
struct RecordingStatus {
  bool recording = false;
  std::string name;  // of the file, without folders; empty: none
  RecorderStatus file;
};

class RecordingDesk {
 public:
  /// Called exactly once, on any thread, without locks.
  using Done = std::function<void(const EditResult&)>;

  /// All outlive it.
  RecordingDesk(RecordingOptions options, EditQueue& edits, RunControl& run, const FrameBoard& frames,
                const Clock& clock, Logger logger);
  /// Close().
  ~RecordingDesk();
  RecordingDesk(const RecordingDesk&) = delete;
  RecordingDesk& operator=(const RecordingDesk&) = delete;

  /// Records to `file`, a path, from the first step on. An error text, empty if so. After the first frame has
  /// been published, before the stepping thread runs. `force`: what is there is overwritten, and a disk that
  /// is too small is no error.
  std::string StartFile(const std::string& file, bool force) EXCLUDES(mutex_);
  /// Records to `name` in the folder, empty: `run-YYYYMMDD-HHMMSS`. Overwrites nothing. Answers with the name
  /// of the file.
  void Start(const std::string& name, Done done) EXCLUDES(mutex_);
  /// Answers when the file is closed, with its name and, if it lies in the folder, its address at `page`, the
  /// URL of the page (empty: none).
  void Stop(std::string page, Done done) EXCLUDES(mutex_);
  /// Marks the present time with `text`.
  void Note(const std::string& text, Done done) EXCLUDES(mutex_);
  /// Closes the file, if one is open. When the stepping thread has stopped; later calls get error 5.
  void Close() EXCLUDES(mutex_);

  RecordingStatus status() const EXCLUDES(mutex_);
  /// The name of the present file; empty: nothing is recorded.
  std::string recording() const { return status().name; }
  /// A recording has ended because it could not go on: exit code 4.
  bool failed() const { return failed_; }

 private:
  enum class State { kIdle, kStarting, kRecording, kStopping, kClosed };

  /// Makes `recorder` for `file` and says in the log how much it will write. An error text if it cannot.
  std::string MakeRecorder(const std::filesystem::path& file, bool force,
                           std::shared_ptr<Recorder>& recorder);
  /// Takes the right to start; an error text, empty if taken.
  std::string BeginStart() EXCLUDES(mutex_);
  /// Nothing after Close().
  void Set(State state, std::shared_ptr<Recorder> recorder = nullptr, const std::filesystem::path& file = {})
      EXCLUDES(mutex_);
  /// The recorder, if one is recording, for PutAway(); `if_broken`: and only if it has failed. Else null.
  std::shared_ptr<Recorder> TakeToStop(bool if_broken) EXCLUDES(mutex_);
  std::string DefaultName() const;
  /// Takes the journal away from the stepping thread, then closes it on the desk's; answers as Stop().
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
  std::string failure_ GUARDED_BY(mutex_);                 // of the last recording; empty: it went well
  bool broken_ GUARDED_BY(mutex_) = false;                 // the present recorder has failed
  std::shared_ptr<Recorder> recorder_ GUARDED_BY(mutex_);  // while recording or stopping
  std::filesystem::path file_ GUARDED_BY(mutex_);          // its first file
  IoThread thread_;                                        // last: what it runs uses the rest
};

}  // namespace coopdyn
