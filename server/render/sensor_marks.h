// SPDX-License-Identifier: MIT
// Marks the view of robots' sensors: rays, lidar scans, sonar cones, cameras' fields of view. Shows the
// ranges that robots read, computed on demand. Pure; any thread.
#pragma once

#include <vector>

#include "server/render/overlay.h"
#include "server/state/frame.h"

namespace coopdyn {

/// The marks of all robots that may be visible in `frustum`.
std::vector<OverlayVertex> SensorMarks(const Frame& frame, const Frustum& frustum);

}  // namespace coopdyn
