// SPDX-License-Identifier: MIT
#include "server/render/sensor_marks.h"

#include <algorithm>

#include "server/sensing/sensor_shapes.h"

namespace coopdyn {

std::vector<OverlayVertex> SensorMarks(const Frame& frame, const Frustum& frustum) {
  const SensorShapes shapes = ShapesOfSensors(
      frame, [&](const Vector3& p_W, double radius_m) { return frustum.Sees(p_W, radius_m); });
  Overlay overlay(frustum);
  const double scale = std::max(1.0, frustum.height() / 480.0);
  for (const auto& [corners_W, color] : shapes.triangles)
    overlay.AddTriangle(corners_W[0], corners_W[1], corners_W[2], color);
  for (const auto& [from_W, to_W, color, width_px] : shapes.lines)
    overlay.AddLine(from_W, to_W, width_px * scale, color);
  for (const auto& [p_W, color, radius_px, lift_m] : shapes.dots)
    overlay.AddDot(p_W, radius_px * scale, color, lift_m);
  return overlay.Take();
}

}  // namespace coopdyn
