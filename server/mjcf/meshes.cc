// SPDX-License-Identifier: MIT
#include "server/mjcf/meshes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <utility>
#include <vector>

#include "server/files/reduce_mesh.h"

namespace coopdyn::mjcf {

namespace {

using Corner = std::array<float, 3>;

constexpr int kMostTriangles = 400'000;  // coopdyn accepts 500,000 in a model
constexpr std::size_t kFewTriangles = 200;

std::string FileName(std::string name) {
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '-' || c == '_' || c == '.';
    if (!is_plain) c = '_';
  }
  constexpr std::size_t kLongest = 100;
  if (name.size() > kLongest) name.erase(0, name.size() - kLongest);  // keep the extension
  return name.starts_with('.') ? "_" + name : name;
}

}  // namespace

struct Meshes::Triangles {
  std::vector<std::array<Corner, 3>> all;
};

std::string Meshes::NewFile(const std::string& name) {
  const std::filesystem::path plain = FileName(name);
  std::string file = plain.string();
  for (int i = 2; !files_.insert(file).second; ++i)
    file = plain.stem().string() + "_" + std::to_string(i) + plain.extension().string();
  return file;
}

/// Writes STL without normals: nothing uses them.
std::string Meshes::Write(const std::string& name, const Triangles& triangles) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint32_t>(triangles.all.size()));
  for (const auto& triangle : triangles.all) {
    append(Corner{});
    for (const Corner& corner : triangle) append(corner);
    append(std::uint16_t{0});
  }
  std::error_code code;
  std::filesystem::create_directories(folder_, code);
  const std::string file = NewFile(name + ".stl");
  std::ofstream stream(folder_ / file, std::ios::binary);
  stream << bytes;
  stream.close();
  failed_ = failed_ || !stream.good();
  return prefix_ + file;
}

/// Returns the name as written if the file is missing: then the SDF reader reports it.
std::string Meshes::Copy(const UnreadMesh& mesh) {
  if (mesh.name.empty() || mesh.file.empty()) return mesh.name;
  const auto [copied, is_new] = copied_.try_emplace(mesh.file);
  if (!is_new) return prefix_ + copied->second;
  copied->second = NewFile(std::filesystem::path(mesh.name).filename().string());
  std::error_code code;
  std::filesystem::create_directories(folder_, code);
  std::filesystem::copy_file(mesh.file, folder_ / copied->second, code);
  failed_ = failed_ || code;
  return prefix_ + copied->second;
}

Meshes::Named Meshes::Mesh(int mesh) {
  const mjModel& m = source_.model();
  const std::string name = source_.NameOf(mjOBJ_MESH, mesh, "mesh");
  const auto [known, is_new] = written_.try_emplace("mesh " + std::to_string(mesh));
  if (!is_new) return known->second;
  const char* const own_name = mj_id2name(&m, mjOBJ_MESH, mesh);
  const auto unread = source_.loaded().unread_meshes.find(own_name == nullptr ? "" : own_name);
  if (unread != source_.loaded().unread_meshes.end())
    return known->second = {Copy(unread->second), unread->second.scale};
  MeshParts parts;
  const float* const vertices = m.mesh_vert + 3 * m.mesh_vertadr[mesh];
  const int* const faces = m.mesh_face + 3 * m.mesh_faceadr[mesh];
  for (int i = 0; i < m.mesh_vertnum[mesh]; ++i)
    parts.vertices.push_back({vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]});
  for (int face = 0; face < m.mesh_facenum[mesh]; ++face) {
    const auto corner = [&](int i) { return static_cast<std::uint32_t>(faces[3 * face + i]); };
    parts.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  if (m.nmeshface > kMostTriangles) {
    const double share = static_cast<double>(kMostTriangles) / m.nmeshface;
    const auto most = std::max(kFewTriangles, static_cast<std::size_t>(share * m.mesh_facenum[mesh]));
    source_.words().Say("the meshes have more than " + std::to_string(kMostTriangles) +
                            " triangles together: fewer stand for each",
                        false);
    if (parts.triangles.size() > most) parts = Reduce(std::move(parts), most).parts;
  }
  Triangles triangles;
  for (const auto& indices : parts.triangles) {
    auto& triangle = triangles.all.emplace_back();
    for (std::size_t i = 0; i < triangle.size(); ++i) {
      for (Eigen::Index c = 0; c < 3; ++c)
        triangle[i][static_cast<std::size_t>(c)] = static_cast<float>(parts.vertices[indices[i]][c]);
    }
  }
  return known->second = {Write(name, triangles), ""};
}

Meshes::Named Meshes::Heights(int field) {
  const mjModel& m = source_.model();
  const std::string name = source_.NameOf(mjOBJ_HFIELD, field, "hfield");
  const auto [known, is_new] = written_.try_emplace("hfield " + std::to_string(field));
  if (!is_new) return known->second;
  const int rows = m.hfield_nrow[field], columns = m.hfield_ncol[field];
  const mjtNum* const size = m.hfield_size + 4 * field;
  // As in libmujoco, row 0 is at −y.
  const auto at = [&](int row, int column) -> Corner {
    return {static_cast<float>(size[0] * (2.0 * column / (columns - 1) - 1)),
            static_cast<float>(size[1] * (2.0 * row / (rows - 1) - 1)),
            static_cast<float>(size[2] * m.hfield_data[m.hfield_adr[field] + row * columns + column])};
  };
  Triangles triangles;
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const Corner a = at(row, column), b = at(row, column + 1), c = at(row + 1, column + 1),
                   d = at(row + 1, column);
      triangles.all.push_back({a, b, c});
      triangles.all.push_back({a, c, d});
    }
  }
  return known->second = {Write("heights_" + name, triangles), ""};
}

}  // namespace coopdyn::mjcf
