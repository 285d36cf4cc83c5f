// SPDX-License-Identifier: MIT
// All that decides how a run goes on: what `save` keeps, a keyframe of a recording holds, and a restore
// takes. Immutable once published; any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/model/scenario.h"
#include "server/state/frame.h"

namespace coopdyn {

struct SavedState {
  FramePtr frame;                      // exact
  std::vector<std::byte> controllers;  // ControllerDriver::Save(); empty: nothing is loaded
  Mode mode = Mode::kRealtime;         // in force then
  bool paused = false;
  // What edits after the frame's step have changed; a recording has them as inputs instead.
  std::optional<Nanoseconds> step_length;  // of steps to come; empty: as in the frame
  std::vector<Setpoint> setpoints;         // in force, by the scene's channels; empty: likewise
  std::string warning = {};                // lines: what is to be told when it is put in force
};

using SavedStatePtr = std::shared_ptr<const SavedState>;

}  // namespace coopdyn
