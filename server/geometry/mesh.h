// SPDX-License-Identifier: MIT
// Triangle meshes: rays against them, the convex hull of one. Constant once made; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/image.h"
#include "server/geometry/ray.h"
#include "server/geometry/ray_tree.h"
#include "server/geometry/shape.h"

namespace coopdyn {

/// How a mesh looks, vertex by vertex.
struct MeshSkin {
  struct Material {
    std::array<double, 3> color{0.5, 0.5, 0.5};  // of a texture its mean
    std::array<double, 3> tint{1, 1, 1};         // by which a texture is multiplied
    std::shared_ptr<const Image> texture;        // null: none
  };
  struct Corner {
    std::array<float, 2> uv{};   // 0 0: the lower left of the texture
    std::uint32_t material = 0;  // index into materials
  };
  std::vector<Material> materials;
  std::vector<Corner> corners;  // of MeshData::vertices
};

struct MeshData {
  using Triangle = RayTree::Triangle;

  std::vector<Vector3> vertices;               // about the middle of their box
  std::vector<Triangle> triangles;             // counter-clockwise from outside
  Vector3 half_m = Vector3::Zero();            // of the box about the vertices
  double radius_m = 0;                         // of the sphere about the middle
  double volume_m3 = 0;                        // if it is closed
  Vector3 inertia_m5 = Vector3::Zero();        // of the solid of density 1 about the axes, if it is closed
  std::uint64_t id = 0;                        // of its content
  std::optional<std::array<double, 3>> color;  // of the file it came from
  std::shared_ptr<const MeshSkin> skin;        // null: `color` all over
  RayTree tree;                                // of the triangles
};

/// A mesh of these triangles, moved so that the middle of its box is the origin; `middle` is where that was.
/// @pre indices are good, all finite, at least one triangle
MeshData MakeMesh(std::vector<Vector3> vertices, std::vector<MeshData::Triangle> triangles, Vector3& middle);

/// The convex hull of the points, closely: of those that lie furthest in some 300 directions. Nothing if they
/// lie in a plane. `middle` as above.
std::optional<MeshData> ConvexHull(std::span<const Vector3> points, Vector3& middle);

/// Distance along `ray` (in the mesh's frame) to the nearest triangle from either side, m; kNoHit if it
/// misses.
double RayToMesh(const Ray& ray, const MeshData& mesh);

}  // namespace coopdyn
