// SPDX-License-Identifier: MIT
#include "server/render/gl_mesh.h"

#include <algorithm>
#include <array>

#include "server/render/meshes.h"

namespace coopdyn {

GlMesh::GlMesh(const GlApi& gl, const MeshData& mesh)
    : vertices(gl), indices(gl), coordinates(gl), count(static_cast<GLsizei>(3 * mesh.triangles.size())) {
  std::vector<MeshVertex> corners;
  std::vector<std::uint32_t> order;
  std::vector<std::array<float, 2>> uvs;
  std::vector<MeshData::Triangle> triangles = mesh.triangles;
  const auto material = [&mesh](const MeshData::Triangle& t) {
    return mesh.skin == nullptr ? 0 : mesh.skin->corners[t[0]].material;
  };
  std::ranges::stable_sort(triangles, {}, material);
  for (const auto& triangle : triangles) {
    if (ranges.empty() || ranges.back().material != material(triangle))
      ranges.push_back({material(triangle), order.size(), 0});
    ranges.back().count += 3;
    const Vector3& a = mesh.vertices[triangle[0]];
    const Vector3 n = (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).normalized();
    for (const std::uint32_t v : triangle) {
      MeshVertex corner{};
      for (std::size_t i = 0; i < 3; ++i) {
        corner.position[i] = static_cast<float>(mesh.vertices[v][static_cast<Eigen::Index>(i)]);
        corner.normal[i] = static_cast<float>(n[static_cast<Eigen::Index>(i)]);
      }
      order.push_back(static_cast<std::uint32_t>(corners.size()));
      corners.push_back(corner);
      if (mesh.skin != nullptr) uvs.push_back(mesh.skin->corners[v].uv);
    }
  }
  vertices.Bind();
  vertices.Upload(corners.data(), corners.size() * sizeof(MeshVertex), GL_STATIC_DRAW);
  vertices.Attribute(0, 3, sizeof(MeshVertex), offsetof(MeshVertex, position));
  vertices.Attribute(1, 3, sizeof(MeshVertex), offsetof(MeshVertex, normal));
  if (!uvs.empty()) {
    gl.BindBuffer(GL_ARRAY_BUFFER, coordinates.buffer());
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(uvs.size() * sizeof(uvs[0])), uvs.data(),
                  GL_STATIC_DRAW);
    gl.EnableVertexAttribArray(8);
    gl.VertexAttribPointer(8, 2, GL_FLOAT, GL_FALSE, sizeof(uvs[0]), nullptr);
  }
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.buffer());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(order.size() * sizeof(std::uint32_t)),
                order.data(), GL_STATIC_DRAW);
}

}  // namespace coopdyn
