// SPDX-License-Identifier: MIT
// What the stepping thread tells of a run, so that it can be written down; server/record has the one
// implementation. All calls by the holder of the step baton.
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

  /// The run goes on from `state`: when the journal is put in force, and after each reset, load and restore.
  virtual void Begin(const SavedStatePtr& state) = 0;
  /// Whether the exact state after step `step` is wanted with Step().
  virtual bool WantsKeyframe(std::uint64_t step) = 0;
  /// A step has run, at `now` by the wall clock, and is not answered yet. `keyframe`: the state after it, if
  /// one was wanted, else null. In real time it never waits; in the other modes it slows the run rather than
  /// lose a step.
  virtual void Step(const FramePtr& frame, Mode mode, SavedStatePtr keyframe, Nanoseconds now) = 0;
  virtual void Input(RunInput input) = 0;
  virtual void Note(Event event) = 0;
};

}  // namespace coopdyn
