// SPDX-License-Identifier: MIT
// From a recording that is played to a live run: makes the exact state of a recorded step on a thread of its
// own, which can take seconds, then hands it to the stepping thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "protocol/message.h"
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

/// Any thread.
class BranchDesk {
 public:
  using Done = std::function<void(const EditResult&)>;

  /// Starts its thread, on which `make` is called. `edits` and `run` outlive it.
  BranchDesk(MakeBranchState make, EditQueue& edits, const RunControl& run, Logger logger);
  /// Waits for a branch that is being made. While `edits` still answers, or is closed.
  ~BranchDesk();
  BranchDesk(const BranchDesk&) = delete;
  BranchDesk& operator=(const BranchDesk&) = delete;

  /// Ends the playback: the run goes on live from the step shown or from `time_s`, paused if the recording
  /// stood. `done` is called once, on any thread: with error 5 at once if nothing is played or a branch is
  /// under way.
  void Branch(std::optional<double> time_s, Done done);

 private:
  const MakeBranchState make_;
  EditQueue& edits_;
  const RunControl& run_;
  const Logger logger_;
  const std::shared_ptr<std::atomic<bool>> busy_;  // shared with the edit that is under way
  IoThread thread_;
};

}  // namespace coopdyn
