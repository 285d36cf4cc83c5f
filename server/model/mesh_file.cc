// SPDX-License-Identifier: MIT
#include "server/model/mesh_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <span>
#include <utility>

#include "server/model/image_file.h"
#include "server/model/resources.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

std::optional<std::string> ReadWhole(const std::filesystem::path& file, std::string& why) {
  std::error_code code;
  const auto size = std::filesystem::file_size(file, code);
  if (!code && size > kMaxMeshFileBytes) {
    why = "the file has " + std::to_string(size >> 20) + " MiB, at most " +
          std::to_string(kMaxMeshFileBytes >> 20) +
          " are allowed: simplify it (in Blender: Modifier, Decimate)";
    return std::nullopt;
  }
  if (!code) {  // otherwise it may be a pipe, which would block
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(size, '\0');
    if (stream.read(bytes.data(), static_cast<std::streamsize>(size))) return bytes;
  }
  why = "it cannot be read";
  return std::nullopt;
}

/// The content of the file that the mesh `file` calls `name`.
std::optional<std::string> Supply(bool is_texture, const std::string& name, const std::filesystem::path& file,
                                  const Resources& resources, std::string& why) {
  if (is_texture) {
    // Gazebo's models keep textures in a separate folder.
    auto found = resources.Find(name, file, why);
    std::string ignored;
    const std::string bare = std::filesystem::path(name).filename().string();
    if (!found && !bare.empty()) found = resources.Find("../materials/textures/" + bare, file, ignored);
    return found ? ReadImageFile(*found, why) : std::nullopt;
  }
  if (name.empty()) return std::nullopt;
  const auto found =
      resources.Find(std::filesystem::path(name).lexically_proximate(file.parent_path()), file, why);
  return found ? ReadWhole(*found, why) : std::nullopt;
}

std::uint64_t Mix(std::uint64_t hash, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

/// True if the triangles enclose a solid (each edge occurs equally often in both directions) but face
/// inwards.
bool LooksInward(const MeshParts& parts) {
  using Point = std::array<double, 3>;  // exporters repeat a corner for each face
  double volume = 0;
  for (const auto& [a, b, c] : parts.triangles) {
    volume += parts.vertices[a].dot(parts.vertices[b].cross(parts.vertices[c]));
  }
  if (!(volume < 0)) return false;
  std::map<std::pair<Point, Point>, int> edges;
  for (const auto& triangle : parts.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 &p = parts.vertices[triangle[i]], &q = parts.vertices[triangle[(i + 1) % 3]];
      const Point from{p.x(), p.y(), p.z()}, to{q.x(), q.y(), q.z()};
      if (from < to) ++edges[{from, to}];
      if (to < from) --edges[{to, from}];
    }
  }
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 0; });
}

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string ToBase64(const std::string& bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[three >> shift & 63u];
  }
  return text;  // trailing zeros are harmless
}

std::optional<std::string> FromBase64(std::string_view text) {
  std::array<int, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  if (text.size() % 4 != 0) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int value = values[static_cast<unsigned char>(text[i + k])];
      if (value < 0) return std::nullopt;
      three = three << 6 | static_cast<std::uint32_t>(value);
    }
    for (int shift = 16; shift >= 0; shift -= 8) bytes += static_cast<char>(three >> shift & 255u);
  }
  return bytes;
}

ModelMesh MakeModelMesh(MeshParts parts) {
  parts = Settled(std::move(parts));
  ModelMesh mesh;
  MeshData data = MakeMesh(std::move(parts.vertices), std::move(parts.triangles), mesh.middle);
  data.color = parts.color;
  SetSkin(std::move(parts.skin), data);
  mesh.data = std::make_shared<const MeshData>(std::move(data));
  return mesh;
}

bool IsMeshType(const std::filesystem::path& file) {
  constexpr std::string_view kTypes[] = {".stl", ".obj", ".dae", ".glb", ".gltf", ".ply"};
  return std::ranges::find(kTypes, ToLower(file.extension().string())) != std::end(kTypes);
}

std::optional<ModelMesh> LoadMesh(const std::filesystem::path& file, const Vector3& scale,
                                  const std::string& submesh, const Resources& resources, FileReader& reader,
                                  const SourceLine& where, Diagnostics& diagnostics) {
  const std::string name = "mesh '" + file.filename().string() + "': ";
  std::string why;
  std::optional<MeshAnswer> read;
  if (!IsMeshType(file)) {
    why = "meshes are read from .stl, .obj, .dae, .glb, .gltf and .ply: convert it, for example with Blender";
  } else if (auto bytes = ReadWhole(file, why)) {
    const MeshRequest request{file.string(), std::move(*bytes), {scale.x(), scale.y(), scale.z()}, submesh};
    const auto supply = [&](bool is_texture, const std::string& wanted, std::string& why_not) {
      return Supply(is_texture, wanted, file, resources, why_not);
    };
    read = reader.ReadMesh(request, supply, why);
  }
  if (!read) {
    diagnostics.Error(where, name + why);
    return std::nullopt;
  }
  for (const std::string& warning : read->warnings) diagnostics.Note(where, name + warning);
  if (LooksInward(read->parts)) {
    diagnostics.Mended(where, name + "its triangles look inwards: they are turned");
    for (auto& triangle : read->parts.triangles) std::swap(triangle[1], triangle[2]);
  }
  return MakeModelMesh(std::move(read->parts));
}

std::string MeshToText(const ModelMesh& mesh, MeshTextures& textures) {
  const MeshData& data = *mesh.data;
  MeshParts parts{data.vertices, data.triangles, data.color, data.skin};
  for (Vector3& v : parts.vertices) v += mesh.middle;
  return ToBase64(MeshToBytes(parts, textures));
}

std::optional<ModelMesh> MeshFromText(std::string_view text, const MeshTextures& textures) {
  const auto bytes = FromBase64(text);
  auto parts = bytes ? MeshFromBytes(*bytes, textures) : std::nullopt;
  if (!parts) return std::nullopt;
  return MakeModelMesh(std::move(*parts));
}

void SetSkin(std::shared_ptr<const MeshSkin> skin, MeshData& mesh) {
  mesh.skin = std::move(skin);
  if (mesh.skin == nullptr) return;
  const auto bytes_of = [](const auto& all) {
    return std::span(reinterpret_cast<const std::uint8_t*>(all.data()), all.size() * sizeof(all[0]));
  };
  mesh.id = Mix(mesh.id, bytes_of(mesh.skin->corners));
  for (const MeshSkin::Material& material : mesh.skin->materials) {
    mesh.id = Mix(mesh.id, bytes_of(material.color));
    if (material.texture != nullptr) mesh.id = Mix(mesh.id, material.texture->rgb);
  }
}

}  // namespace coopdyn
