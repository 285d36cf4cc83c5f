// SPDX-License-Identifier: MIT
// What a view draws of robots' sensors: rays, lidar scans, sonar cones, cameras' fields of view, at the
// ranges that robots read, computed on demand. World frame, m. Pure; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "server/geometry/rgba.h"
#include "server/state/frame.h"

namespace coopdyn {

struct SensorShapes {
  struct Line {
    Vector3 from_W, to_W;
    Rgba color;
    double width_px;  // in a view 480 pixels high
  };
  struct Dot {
    Vector3 p_W;
    Rgba color;
    double radius_px;   // likewise
    double lift_m = 0;  // seen through surfaces up to so far in front of it
  };
  struct Triangle {
    std::array<Vector3, 3> corners_W;
    Rgba color;
  };

  std::vector<Line> lines;
  std::vector<Dot> dots;
  std::vector<Triangle> triangles;
};

/// Whether a ball of this radius (m) about a point of the world may be seen.
using SeesBall = std::function<bool(const Vector3& p_W, double radius_m)>;

/// The shapes of the sensors of all robots; does not read those out of sight. If the shapes of all might have
/// more than about `most` vertices, takes only each n-th robot. A ray of a lidar counts as three vertices.
SensorShapes ShapesOfSensors(const Frame& frame, const SeesBall& sees,
                             std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace coopdyn
