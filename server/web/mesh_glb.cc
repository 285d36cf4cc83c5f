// SPDX-License-Identifier: MIT
#include "server/web/mesh_glb.h"

#include <algorithm>
#include <bit>
#include <boost/json.hpp>
#include <charconv>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/geometry/mesh.h"
#include "server/state/world_change.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

constexpr int kFloat = 5126, kUint = 5125;  // glTF's component types

template <typename Number>
void AppendNumber(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

/// The contents of a glb file.
class GlbWriter {
 public:
  explicit GlbWriter(const MeshData& mesh) : mesh_(mesh) {
    for (const Vector3& v : mesh.vertices) {
      for (const double x : v) AppendNumber(binary_, static_cast<float>(x));
    }
    json::object positions = View("VEC3", kFloat, mesh.vertices.size());
    positions["min"] = json::array{-mesh.half_m.x(), -mesh.half_m.y(), -mesh.half_m.z()};
    positions["max"] = json::array{mesh.half_m.x(), mesh.half_m.y(), mesh.half_m.z()};
    attributes_["POSITION"] = Accessor(std::move(positions));
    if (mesh.skin != nullptr && mesh.skin->corners.size() == mesh.vertices.size()) {
      AddSkin(*mesh.skin);
    } else {
      AddPrimitive(mesh.triangles, attributes_);
    }
  }

  std::string Glb() && {
    json::object gltf{{"asset", {{"version", "2.0"}}},
                      {"scene", 0},
                      {"scenes", json::array{{{"nodes", json::array{0}}}}},
                      {"nodes", json::array{{{"mesh", 0}}}},
                      {"meshes", json::array{{{"primitives", std::move(primitives_)}}}},
                      {"accessors", std::move(accessors_)},
                      {"bufferViews", std::move(views_)},
                      {"buffers", json::array{{{"byteLength", binary_.size()}}}}};
    if (!materials_.empty()) gltf["materials"] = std::move(materials_);
    std::string chunks;
    AppendChunk(chunks, 0x4E4F534A, JsonText(gltf), ' ');
    AppendChunk(chunks, 0x004E4942, std::move(binary_), '\0');
    std::string glb = "glTF";
    AppendNumber(glb, std::uint32_t{2});
    AppendNumber(glb, static_cast<std::uint32_t>(12 + chunks.size()));
    return glb + chunks;
  }

 private:
  /// Appends a chunk, padded to 4 bytes.
  static void AppendChunk(std::string& glb, std::uint32_t kind, std::string bytes, char filler) {
    while (bytes.size() % 4 != 0) bytes += filler;
    AppendNumber(glb, static_cast<std::uint32_t>(bytes.size()));
    AppendNumber(glb, kind);
    glb += bytes;
  }

  /// Makes a view of the bytes since the last one; its accessor.
  json::object View(const char* type, int component, std::size_t count) {
    views_.push_back({{"buffer", 0}, {"byteOffset", viewed_}, {"byteLength", binary_.size() - viewed_}});
    viewed_ = binary_.size();
    return {
        {"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}};
  }

  std::size_t Accessor(json::object accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  void AddPrimitive(const std::vector<MeshData::Triangle>& triangles, json::object attributes,
                    std::optional<std::size_t> material = std::nullopt) {
    for (const MeshData::Triangle& triangle : triangles) {
      for (const auto vertex : triangle) AppendNumber(binary_, static_cast<std::uint32_t>(vertex));
    }
    json::object primitive{{"attributes", std::move(attributes)},
                           {"indices", Accessor(View("SCALAR", kUint, 3 * triangles.size()))}};
    if (material) primitive["material"] = *material;
    primitives_.push_back(std::move(primitive));
  }

  void AddSkin(const MeshSkin& skin) {
    std::vector<MeshData::Triangle> plain;
    std::map<std::uint32_t, std::vector<MeshData::Triangle>> textured;  // by material
    for (const MeshData::Triangle& triangle : mesh_.triangles) {
      const std::uint32_t material = skin.corners[triangle[0]].material;
      (skin.materials[material].texture == nullptr ? plain : textured[material]).push_back(triangle);
    }
    if (!plain.empty()) {
      for (const MeshSkin::Corner& corner : skin.corners) {
        for (const double part : skin.materials[corner.material].color)
          AppendNumber(binary_, static_cast<float>(part));
      }
      json::object attributes = attributes_;
      attributes["COLOR_0"] = Accessor(View("VEC3", kFloat, skin.corners.size()));
      AddPrimitive(plain, std::move(attributes));
    }
    if (textured.empty()) return;
    for (const MeshSkin::Corner& corner : skin.corners) {
      AppendNumber(binary_, corner.uv[0]);
      AppendNumber(binary_, 1 - corner.uv[1]);  // glTF's begin at the upper left
    }
    attributes_["TEXCOORD_0"] = Accessor(View("VEC2", kFloat, skin.corners.size()));
    for (const auto& [number, triangles] : textured) {
      const auto& tint = skin.materials[number].tint;
      std::string name(kMeshTexture);
      name += HashText(mesh_.id) + ":" + std::to_string(number);
      materials_.push_back(
          {{"pbrMetallicRoughness", {{"baseColorFactor", json::array{tint[0], tint[1], tint[2], 1}}}},
           {"extras", {{"texture", name}}}});
      AddPrimitive(triangles, attributes_, materials_.size() - 1);
    }
  }

  const MeshData& mesh_;
  std::string binary_;
  std::size_t viewed_ = 0;  // bytes that have a view
  json::array views_, accessors_, primitives_, materials_;
  json::object attributes_;
};

const MeshData* FindMesh(const Scene& scene, std::uint64_t id) {
  const RobotModel* looked_at = nullptr;
  for (const SceneRobot& robot : scene.robots) {
    if (robot.entry.model.get() == looked_at) continue;
    looked_at = robot.entry.model.get();
    for (const LinkModel& link : looked_at->links) {
      for (const auto* shapes : {&link.visuals, &link.collisions}) {
        for (const LinkShape& shape : *shapes) {
          const auto* mesh = std::get_if<Mesh>(&shape.shape);
          if (mesh != nullptr && mesh->data->id == id) return mesh->data;
        }
      }
    }
  }
  return nullptr;
}

}  // namespace

std::string MeshGlb(const Scene& scene, std::uint64_t id) {
  const MeshData* mesh = FindMesh(scene, id);
  return mesh == nullptr ? "" : GlbWriter(*mesh).Glb();
}

std::shared_ptr<const Image> MeshTexture(const Scene& scene, std::string_view name) {
  name.remove_prefix(std::min(kMeshTexture.size(), name.size()));
  const char *begin = name.data(), *end = begin + name.size();
  std::uint64_t id = 0;
  std::size_t number = 0;
  const auto [colon, bad_id] = std::from_chars(begin, end, id, 16);
  if (bad_id != std::errc() || colon == end || *colon != ':') return nullptr;
  const auto [rest, bad_number] = std::from_chars(colon + 1, end, number);
  const MeshData* mesh = bad_number == std::errc() && rest == end ? FindMesh(scene, id) : nullptr;
  const bool known = mesh != nullptr && mesh->skin != nullptr && number < mesh->skin->materials.size();
  return known ? mesh->skin->materials[number].texture : nullptr;
}

}  // namespace coopdyn
