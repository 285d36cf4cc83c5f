// SPDX-License-Identifier: MIT
// Flat marks over the shapes of a picture: lines, dots, triangles and marks on the floor. Does not use GL.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "server/geometry/rgba.h"
#include "server/render/camera.h"

namespace coopdyn {

/// Converts `values` for the driver.
template <std::size_t N>
std::array<float, N> ToFloats(const double* values) {
  std::array<float, N> floats;
  for (std::size_t i = 0; i < N; ++i) floats[i] = static_cast<float>(values[i]);
  return floats;
}

/// One corner of a flat mark, in clip coordinates. The memory layout is that of the vertex attributes.
struct OverlayVertex {
  std::array<float, 4> clip;
  std::array<float, 2> uv;  // −1…1 across the mark
  std::array<float, 4> color;
  float kind = 0;  // 0: plain; 1: fades towards its rim; 2: disc with a ring; 3: disc
};

/// Collects marks as triangles of three corners.
class Overlay {
 public:
  /// `frustum` must outlive the overlay.
  explicit Overlay(const Frustum& frustum) : frustum_(frustum) {}

  /// A square of 2 × `radius_m` on the floor.
  void AddOnFloor(const Vector3& p_W, double radius_m, const Rgba& color, int kind);
  void AddTriangle(const Vector3& a_W, const Vector3& b_W, const Vector3& c_W, const Rgba& color);
  void AddLine(const Vector3& from_W, const Vector3& to_W, double width_px, const Rgba& color);
  /// Adds a round dot that faces the camera, drawn over surfaces up to `lift_m` in front of it.
  void AddDot(const Vector3& p_W, double radius_px, const Rgba& color, double lift_m = 0);

  std::vector<OverlayVertex> Take() { return std::move(vertices_); }

 private:
  static OverlayVertex Corner(const Eigen::Vector4d& clip, double u, double v, const Rgba& color, int kind);
  void AddQuad(const std::array<OverlayVertex, 4>& corners);

  const Frustum& frustum_;
  std::vector<OverlayVertex> vertices_;
};

}  // namespace coopdyn
