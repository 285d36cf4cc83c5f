// SPDX-License-Identifier: MIT
// From a live run to a recording that is played, and back, or on from a step of the recording: reads files
// and makes the exact state of a recorded step on a thread of its own, which can take seconds, then hands it
// to the stepping thread.
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

/// Makes the exact state after step `step` of the recording `file` or, if `time_s` is given, after the newest
/// step at or before that time. Null with `error`.
using MakeBranchState = std::function<SavedStatePtr(const std::string& file, std::uint64_t step,
                                                    std::optional<double> time_s, std::string& error)>;

/// The real one: opens the file again and repeats its steps since the last keyframe.
MakeBranchState BranchStateMaker(ReplayServices services);

/// Opens a recording and its scenario. Null with `error`.
using OpenRecording = std::function<std::shared_ptr<RunReader>(const std::string& file, std::string& error)>;

/// The real one; loaded controllers are found on `path`.
OpenRecording OpenOn(SearchPath path);

/// Any thread.
class BranchDesk {
 public:
  using Done = std::function<void(const EditResult&)>;
  /// What is called on the desk's thread.
  struct Work {
    MakeBranchState make;
    OpenRecording open;
  };

  /// Starts its thread. `edits` and `run` outlive it.
  BranchDesk(Work work, EditQueue& edits, const RunControl& run, Logger logger);
  /// Waits for a branch that is being made. While `edits` still answers, or is closed.
  ~BranchDesk();
  BranchDesk(const BranchDesk&) = delete;
  BranchDesk& operator=(const BranchDesk&) = delete;

  /// Ends the playback: the run goes on live from the step shown or from `time_s`, paused if the recording
  /// stood. `done` is called once, on any thread: with error 5 at once if nothing is played or a branch is
  /// under way.
  void Branch(std::optional<double> time_s, Done done) EXCLUDES(mutex_);
  /// Plays the recording `file`. A live run is put aside for Resume(). `done` as in Branch().
  void Play(const std::string& file, Done done) EXCLUDES(mutex_);
  /// Ends the playback: the run that was put aside goes on. `done` as in Branch().
  void Resume(Done done) EXCLUDES(mutex_);

 private:
  /// Takes the right to change what runs; false, and `done` has been called, if another has it.
  bool Begin(const Done& done);
  void Restore(SavedStatePtr state, Done done) EXCLUDES(mutex_);

  const Work work_;
  EditQueue& edits_;
  const RunControl& run_;
  const Logger logger_;
  std::atomic<bool> busy_{false};
  Mutex mutex_;
  SavedStatePtr live_ GUARDED_BY(mutex_);  // the run that was put aside; null: none
  IoThread thread_;
};

}  // namespace coopdyn
