// SPDX-License-Identifier: MIT
// All that decides how a run goes on: what `save` keeps, a keyframe of a recording holds, and a restore
// takes. Immutable once published; any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "server/model/scenario.h"
#include "server/state/frame.h"

namespace coopdyn {

struct SavedState {
  FramePtr frame;                      // exact
  std::vector<std::byte> controllers;  // ControllerDriver::Save(); empty: nothing is loaded
  Mode mode = Mode::kRealtime;         // in force then
  bool paused = false;
};

using SavedStatePtr = std::shared_ptr<const SavedState>;

}  // namespace coopdyn
