// SPDX-License-Identifier: MIT
#include "server/model/made_meshes.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace coopdyn {

ModelMesh MakeHeights(const Heights& heights, int columns, int rows, const Vector3& size,
                      const Vector3& pos) {
  const auto most = static_cast<float>(*std::ranges::max_element(heights.values)) / 65535;
  const double per_value = most > 0 ? size.z() / most : 0;
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = static_cast<double>(column) / (columns - 1), y = static_cast<double>(row) / (rows - 1);
      vertices.push_back(pos +
                         Vector3((x - 0.5) * size.x(), (0.5 - y) * size.y(), heights.At(x, y) * per_value));
      if (row == 0 || column == 0) continue;
      const auto here = static_cast<std::uint32_t>(vertices.size() - 1);
      const auto above = here - static_cast<std::uint32_t>(columns);
      triangles.push_back({above - 1, here - 1, here});
      triangles.push_back({above - 1, here, above});
    }
  }
  ModelMesh mesh = MakeModelMesh({std::move(vertices), std::move(triangles), std::nullopt, nullptr});
  mesh.is_heights = true;
  return mesh;
}

ModelMesh MakePictureBox(const Vector3& size) {
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  auto skin = std::make_shared<MeshSkin>();
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto base = static_cast<std::uint32_t>(vertices.size());
      for (const auto& [u, v] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        // On the sides the picture is upright when seen from outside.
        const double across = (u - 0.5) * side;
        const Vector3 p = axis == 0   ? Vector3(side / 2, across, v - 0.5)
                          : axis == 1 ? Vector3(-across, side / 2, v - 0.5)
                                      : Vector3(across, v - 0.5, side / 2);
        vertices.push_back(p.cwiseProduct(size));
        skin->corners.push_back({{static_cast<float>(u), static_cast<float>(v)}, 0});
      }
      triangles.push_back({base, base + 1, base + 2});
      triangles.push_back({base, base + 2, base + 3});
    }
  }
  skin->materials.resize(1);
  return MakeModelMesh({std::move(vertices), std::move(triangles), std::nullopt, std::move(skin)});
}

ModelMesh InMaterial(const ModelMesh& bare, const MeshSkin::Material& material) {
  MeshData data = *bare.data;
  auto skin = std::make_shared<MeshSkin>();
  skin->materials.push_back(material);
  skin->corners.resize(data.vertices.size());
  for (std::size_t i = 0; i < skin->corners.size(); ++i) {
    if (data.skin != nullptr) {
      skin->corners[i].uv = data.skin->corners[i].uv;
    } else {
      // Without texture coordinates, project the picture from above.
      const Vector3& v = data.vertices[i];
      for (Eigen::Index c = 0; c < 2; ++c)
        skin->corners[i].uv[static_cast<std::size_t>(c)] =
            static_cast<float>(0.5 + v[c] / (2 * std::max(data.half_m[c], 1e-9)));
    }
  }
  data.color = skin->materials.front().color;
  SetSkin(std::move(skin), data);
  ModelMesh made = bare;
  made.data = std::make_shared<const MeshData>(std::move(data));
  return made;
}

}  // namespace coopdyn
