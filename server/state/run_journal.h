// SPDX-License-Identifier: MIT
// Receives the stepping thread's account of a run, for recording; implemented in server/record. All calls by
// the holder of the step baton.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/state/frame.h"
#include "server/state/run_control.h"
#include "server/state/run_input.h"

namespace coopdyn {

class RunJournal {
 public:
  virtual ~RunJournal() = default;

  /// The run continues from `state`. Called when the journal is put in force, and after each reset, load and
  /// restore.
  virtual void Begin(const SavedStatePtr& state) = 0;
  /// Whether Step() should receive the exact state after step `step`.
  virtual bool WantsKeyframe(std::uint64_t step) = 0;
  /// A step has run, at wall-clock time `now`, and is not answered yet. `keyframe`: the state after it if
  /// WantsKeyframe(), else null. Never waits in real time; in other modes it slows the run rather than lose a
  /// step.
  virtual void Step(const FramePtr& frame, Mode mode, SavedStatePtr keyframe, Nanoseconds now) = 0;
  virtual void Input(RunInput input) = 0;
  virtual void Note(Event event) = 0;
};

}  // namespace coopdyn
