// SPDX-License-Identifier: MIT
// Switches between a live run and a playback, and continues live from a step of a recording. Reading files
// and computing the exact state of a recorded step can take seconds, so both happen on the desk's own thread.
// The stepping thread then receives the result.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "protocol/message.h"
#include "server/base/mutex.h"
#include "server/model/readers.h"
#include "server/net/io_thread.h"
#include "server/replay/state_at.h"
#include "server/state/edit_queue.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// Computes the exact state after step `step` of the recording `file` or, with `time_s`, after the newest
/// step at or before that time. Null with `error` on failure.
using MakeBranchState = std::function<SavedStatePtr(const std::string& file, std::uint64_t step,
                                                    std::optional<double> time_s, std::string& error)>;

/// The standard implementation: opens the file again and repeats its steps since the last keyframe.
MakeBranchState BranchStateMaker(ReplayServices services);

/// Opens a recording and its scenario. Null with `error` on failure.
using OpenRecording = std::function<std::shared_ptr<RunReader>(const std::string& file, std::string& error)>;

/// The standard implementation; looks for loaded controllers on `path`.
OpenRecording OpenOn(SearchPath path);

/// Thread-safe.
class BranchDesk {
 public:
  using Done = std::function<void(const EditResult&)>;
  /// Functions called on the desk's thread.
  struct Work {
    MakeBranchState make;
    OpenRecording open;
  };

  /// Starts its thread. `edits` and `run` outlive it.
  BranchDesk(Work work, EditQueue& edits, const RunControl& run, Logger logger);
  /// Waits for a running branch. Destroy it while `edits` still answers or is closed.
  ~BranchDesk();
  BranchDesk(const BranchDesk&) = delete;
  BranchDesk& operator=(const BranchDesk&) = delete;

  /// Ends the playback and continues live from the step shown or from `time_s`, paused if the playback was.
  /// Calls `done` once, on any thread: at once with error 5 if nothing is played or a branch is running.
  void Branch(std::optional<double> time_s, Done done) EXCLUDES(mutex_);
  /// Plays the recording `file`. Keeps a live run for Resume(). `done` as in Branch().
  void Play(const std::string& file, Done done) EXCLUDES(mutex_);
  /// Ends the playback and resumes the kept run. `done` as in Branch().
  void Resume(Done done) EXCLUDES(mutex_);

 private:
  /// Starts a switch. Returns false, after calling `done`, if another one is running.
  bool Begin(const Done& done);
  void Restore(SavedStatePtr state, Done done) EXCLUDES(mutex_);

  const Work work_;
  EditQueue& edits_;
  const RunControl& run_;
  const Logger logger_;
  std::atomic<bool> busy_{false};
  Mutex mutex_;
  SavedStatePtr live_ GUARDED_BY(mutex_);  // the run kept for Resume(); null: none
  IoThread thread_;
};

}  // namespace coopdyn
