// SPDX-License-Identifier: MIT
#include "server/render/meshes.h"

#include <cmath>
#include <numbers>

namespace coopdyn {

namespace {

class MeshBuilder {
 public:
  explicit MeshBuilder(Meshes& meshes) : meshes_(meshes) {}

  void Begin(MeshId id) {
    range_ = &meshes_.ranges[static_cast<std::size_t>(id)];
    range_->first_index = static_cast<std::uint32_t>(meshes_.indices.size());
    base_ = meshes_.vertices.size();
  }
  void End() { range_->count = static_cast<std::uint32_t>(meshes_.indices.size()) - range_->first_index; }

  void Vertex(std::array<double, 3> p, std::array<double, 3> n) {
    MeshVertex vertex;
    for (std::size_t i = 0; i < 3; ++i) {
      vertex.position[i] = static_cast<float>(p[i]);
      vertex.normal[i] = static_cast<float>(n[i]);
    }
    meshes_.vertices.push_back(vertex);
  }
  /// Vertex indices count from Begin().
  void Triangle(int a, int b, int c) {
    for (const int i : {a, b, c})
      meshes_.indices.push_back(static_cast<std::uint16_t>(base_ + static_cast<std::size_t>(i)));
  }

 private:
  Meshes& meshes_;
  MeshRange* range_ = nullptr;
  std::size_t base_ = 0;
};

void AddBox(MeshBuilder& build) {
  build.Begin(MeshId::kBox);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        std::array<double, 3> p{}, n{};
        const auto a = static_cast<std::size_t>(axis);
        n[a] = side;
        p[a] = side / 2;
        p[(a + 1) % 3] = u * side;  // mirrored on the lower side, so that the order stays counter-clockwise
        p[(a + 2) % 3] = v;
        build.Vertex(p, n);
      }
    }
  }
  for (int face = 0; face < 6; ++face) {
    build.Triangle(4 * face, 4 * face + 1, 4 * face + 2);
    build.Triangle(4 * face, 4 * face + 2, 4 * face + 3);
  }
  build.End();
}

void AddCylinder(MeshBuilder& build, MeshId id, int segments) {
  build.Begin(id);
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    const double x = std::cos(angle), y = std::sin(angle);
    for (const double side : {-1.0, 1.0}) {
      build.Vertex({x / 2, y / 2, side / 2}, {x, y, 0});
      build.Vertex({x / 2, y / 2, side / 2}, {0, 0, side});
    }
  }
  for (int i = 0; i < segments; ++i) {
    const int low = 4 * i, next = 4 * ((i + 1) % segments);
    build.Triangle(low, next, next + 2);
    build.Triangle(low, next + 2, low + 2);
    if (i == 0 || i == segments - 1) continue;
    build.Triangle(1, next + 1, low + 1);  // the bottom, from below
    build.Triangle(3, low + 3, next + 3);
  }
  build.End();
}

void AddSphere(MeshBuilder& build, MeshId id, int segments) {
  const int rings = segments / 2;
  build.Begin(id);
  for (int ring = 0; ring <= rings; ++ring) {
    const double latitude = std::numbers::pi * (static_cast<double>(ring) / rings - 0.5);
    for (int i = 0; i < segments; ++i) {
      const double angle = 2 * std::numbers::pi * i / segments;
      const std::array<double, 3> n{std::cos(latitude) * std::cos(angle),
                                    std::cos(latitude) * std::sin(angle), std::sin(latitude)};
      build.Vertex({n[0] / 2, n[1] / 2, n[2] / 2}, n);
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < segments; ++i) {
      const int a = ring * segments + i, b = ring * segments + (i + 1) % segments;
      if (ring > 0) build.Triangle(a, b, b + segments);
      if (ring < rings - 1) build.Triangle(a, b + segments, a + segments);
    }
  }
  build.End();
}

}  // namespace

Meshes MakeMeshes() {
  Meshes meshes;
  MeshBuilder build(meshes);
  AddBox(build);
  AddCylinder(build, MeshId::kCylinder8, 8);
  AddCylinder(build, MeshId::kCylinder16, 16);
  AddCylinder(build, MeshId::kCylinder40, 40);
  AddSphere(build, MeshId::kSphere8, 8);
  AddSphere(build, MeshId::kSphere16, 16);
  AddSphere(build, MeshId::kSphere32, 32);
  return meshes;
}

}  // namespace coopdyn
