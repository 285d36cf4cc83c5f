// SPDX-License-Identifier: MIT
// Clips polygons at axis-aligned planes. Pure; any thread.
#pragma once

#include <utility>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn {

/// Keeps the part of the polygon where sign * (coordinate - limit) ≤ 0: I. E. Sutherland, G. W. Hodgman
/// (1974), "Reentrant polygon clipping". `scratch` is a buffer that saves allocations.
inline void ClipPolygon(Eigen::Index axis, double sign, double limit, std::vector<Vector3>& polygon,
                        std::vector<Vector3>& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double of_p = sign * (p[axis] - limit), of_q = sign * (q[axis] - limit);
    if (of_p <= 0) scratch.push_back(p);
    if ((of_p <= 0) != (of_q <= 0)) {
      Vector3 cut = p + (q - p) * (of_p / (of_p - of_q));
      cut[axis] = limit;
      scratch.push_back(cut);
    }
  }
  std::swap(polygon, scratch);
}

}  // namespace coopdyn
