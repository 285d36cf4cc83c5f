// SPDX-License-Identifier: MIT
// Triangle meshes, ray casts against them, and convex hulls. Immutable; thread-safe.
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

/// The appearance of a mesh, per vertex.
struct MeshSkin {
  struct Material {
    std::array<double, 3> color{0.5, 0.5, 0.5};  // with a texture, its mean colour
    std::array<double, 3> tint{1, 1, 1};         // multiplies the texture
    std::shared_ptr<const Image> texture;        // null if none
  };
  struct Corner {
    std::array<float, 2> uv{};   // 0 0: the lower left of the texture
    std::uint32_t material = 0;  // index into materials
  };
  std::vector<Material> materials;
  std::vector<Corner> corners;  // parallel to MeshData::vertices
};

struct MeshData {
  using Triangle = RayTree::Triangle;

  std::vector<Vector3> vertices;               // relative to the centre of their bounding box
  std::vector<Triangle> triangles;             // counter-clockwise from outside
  Vector3 half_m = Vector3::Zero();            // half extents of the bounding box
  double radius_m = 0;                         // of the bounding sphere about the origin
  double volume_m3 = 0;                        // valid if the mesh is closed
  Vector3 inertia_m5 = Vector3::Zero();        // about the axes, for density 1; valid if the mesh is closed
  std::uint64_t id = 0;                        // hash of the content
  std::optional<std::array<double, 3>> color;  // from the mesh's file
  std::shared_ptr<const MeshSkin> skin;        // null: uniform `color`
  RayTree tree;                                // of the triangles
};

/// Makes a mesh of these triangles, moved so that its bounding box is centred at the origin. Sets `middle` to
/// the box's previous centre.
/// @pre valid indices, all finite, at least one triangle
MeshData MakeMesh(std::vector<Vector3> vertices, std::vector<MeshData::Triangle> triangles, Vector3& middle);

/// The approximate convex hull of the points: the hull of the furthest points in 300 directions. Returns
/// nullopt if they lie in a plane. `middle` as above.
std::optional<MeshData> ConvexHull(std::span<const Vector3> points, Vector3& middle);

/// Distance along `ray` (in the mesh's frame) to the nearest triangle from either side, m; kNoHit if the ray
/// misses.
double RayToMesh(const Ray& ray, const MeshData& mesh);

}  // namespace coopdyn
