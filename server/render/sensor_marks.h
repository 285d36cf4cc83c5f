// SPDX-License-Identifier: MIT
// What robots' sensors see, for the view: rays, scans of lidars, cones of sonars, fields of view of cameras.
// Ranges are those that robots read, computed now if nobody has asked for them. Pure; any thread.
#pragma once

#include <vector>

#include "server/render/overlay.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Those of all robots that may be seen through `frustum`.
std::vector<OverlayVertex> SensorMarks(const Frame& frame, const Frustum& frustum);

}  // namespace coopdyn
