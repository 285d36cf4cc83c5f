// SPDX-License-Identifier: MIT
// Concave solids as triangles, bitwise equal on every machine.
#pragma once

#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "server/base/portable_math.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

struct Triangles {
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;

  void AddFace(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  void AddBox(const Vector3& low, const Vector3& high) {
    const auto o = static_cast<std::uint32_t>(vertices.size());
    for (int i = 0; i < 8; ++i)
      vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                            i & 4 ? high.z() : low.z());
    AddFace(o, o + 2, o + 3, o + 1);
    AddFace(o + 4, o + 5, o + 7, o + 6);
    AddFace(o, o + 1, o + 5, o + 4);
    AddFace(o + 2, o + 6, o + 7, o + 3);
    AddFace(o, o + 4, o + 6, o + 2);
    AddFace(o + 1, o + 3, o + 7, o + 5);
  }
  double Volume() const {
    Vector3 middle;
    return MakeMesh(vertices, triangles, middle).volume_m3;
  }
};

/// The solid of revolution of a closed or open line of (radius, z) about z, in `sides` steps.
inline Triangles Turned(const std::vector<std::pair<double, double>>& line, std::uint32_t sides) {
  Triangles made;
  for (const auto& [r, z] : line) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      made.vertices.emplace_back(r * portable::Cos(angle), r * portable::Sin(angle), z);
    }
  }
  for (std::uint32_t k = 0; k + 1 < line.size(); ++k) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t a = k * sides + i, b = k * sides + (i + 1) % sides;
      made.AddFace(a, b, b + sides, a + sides);
    }
  }
  return made;
}

/// 8 cm wide, 10 cm high, walls of 4 mm, a bottom of 5 mm, standing on z = 0.
inline Triangles Cup() {
  return Turned({{0, 0}, {0.04, 0}, {0.04, 0.1}, {0.036, 0.1}, {0.036, 0.005}, {0, 0.005}}, 32);
}
/// A tube of 0.4 m bent to a ring of 2 m.
inline Triangles Ring(std::uint32_t sides = 48) {
  std::vector<std::pair<double, double>> line;
  for (int i = 0; i <= 16; ++i) {
    const double angle = 2 * std::numbers::pi * i / 16;
    line.emplace_back(1 + 0.2 * portable::Cos(angle), 0.2 * portable::Sin(angle));
  }
  return Turned(line, sides);
}
/// An inverted U: legs of 10 cm, 8 cm apart, under a bar; 2 x 2 cm thick; about x = y = 0.
inline Triangles Hook() {
  Triangles made;
  made.AddBox({-0.06, -0.01, 0}, {-0.04, 0.01, 0.1});
  made.AddBox({0.04, -0.01, 0}, {0.06, 0.01, 0.1});
  made.AddBox({-0.06, -0.01, 0.1}, {0.06, 0.01, 0.12});
  return made;
}

}  // namespace coopdyn
