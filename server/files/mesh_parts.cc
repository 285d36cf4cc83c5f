// SPDX-License-Identifier: MIT
#include "server/files/mesh_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace coopdyn {

namespace {

constexpr std::uint32_t kSkinMark = 0x4e494b53, kTextureMark = 0x54584554;

template <typename T>
void PutBytes(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
template <typename T>
bool TakeBytes(std::string_view& bytes, T& value) {
  if (bytes.size() < sizeof(value)) return false;
  std::memcpy(&value, bytes.data(), sizeof(value));
  bytes.remove_prefix(sizeof(value));
  return true;
}

bool SameImage(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.rgb == b.rgb;
}

/// Writes a skin with textures: for each material its texture's index in `textures` + 1 (0: none) and its
/// tint, for each vertex its texture coordinates. Writes nothing for a skin without textures.
void PutTextures(const MeshSkin& skin, MeshTextures& textures, std::string& bytes) {
  const auto has_none = [](const MeshSkin::Material& one) { return one.texture == nullptr; };
  if (std::ranges::all_of(skin.materials, has_none)) return;
  PutBytes(bytes, kTextureMark);
  for (const MeshSkin::Material& material : skin.materials) {
    std::size_t number = 0;
    if (material.texture != nullptr) {
      const auto known =
          std::ranges::find_if(textures, [&](const auto& one) { return SameImage(*one, *material.texture); });
      number = static_cast<std::size_t>(known - textures.begin()) + 1;
      if (known == textures.end()) textures.push_back(material.texture);
    }
    PutBytes(bytes, static_cast<std::uint32_t>(number));
    PutBytes(bytes, material.tint);
  }
  for (const MeshSkin::Corner& corner : skin.corners) PutBytes(bytes, corner.uv);
}

/// Reads the output of PutTextures(), if any.
bool TakeTextures(std::string_view& bytes, const MeshTextures& textures, MeshSkin& skin) {
  if (bytes.size() < sizeof(kTextureMark)) return true;  // zero padding of the last word
  std::uint32_t mark = 0, number = 0;
  bool good = TakeBytes(bytes, mark) && mark == kTextureMark;
  for (MeshSkin::Material& material : skin.materials) {
    good = good && TakeBytes(bytes, number) && number <= textures.size() && TakeBytes(bytes, material.tint);
    for (const double part : material.tint) good = good && part >= 0 && part <= 1;
    if (good && number > 0) material.texture = textures[number - 1];
  }
  for (MeshSkin::Corner& corner : skin.corners)
    good = good && TakeBytes(bytes, corner.uv) && std::isfinite(corner.uv[0]) && std::isfinite(corner.uv[1]);
  return good;
}

/// Rounds to about a nanometre and to a float, so that subtracting and re-adding the middle of such numbers
/// is exact. Not inline: g++ 12 at -O2 drops casts to float and back where it vectorizes two at once.
[[gnu::noinline]] double Rounded(double length_m) {
  constexpr double kGrid_m = 0x1p-30;
  return static_cast<double>(static_cast<float>(std::nearbyint(length_m / kGrid_m) * kGrid_m));
}

}  // namespace

MeshParts Settled(MeshParts parts) {
  // Triangles in any order give the same mesh.
  std::ranges::sort(parts.triangles);
  for (Vector3& v : parts.vertices) v = v.unaryExpr(&Rounded);
  return parts;
}

std::string MeshToBytes(const MeshParts& parts, MeshTextures& textures) {
  std::string bytes;
  PutBytes(bytes, static_cast<std::uint32_t>(parts.vertices.size()));
  PutBytes(bytes, static_cast<std::uint32_t>(parts.triangles.size()));
  PutBytes(bytes, static_cast<std::uint32_t>(parts.color.has_value()));
  for (const double part : parts.color.value_or(std::array<double, 3>{})) PutBytes(bytes, part);
  for (const Vector3& v : parts.vertices) {
    for (int i = 0; i < 3; ++i) PutBytes(bytes, static_cast<float>(v[i]));
  }
  for (const auto& triangle : parts.triangles) PutBytes(bytes, triangle);
  if (parts.skin != nullptr) {
    PutBytes(bytes, kSkinMark);
    PutBytes(bytes, static_cast<std::uint32_t>(parts.skin->materials.size()));
    for (const MeshSkin::Material& material : parts.skin->materials) PutBytes(bytes, material.color);
    for (const MeshSkin::Corner& corner : parts.skin->corners) PutBytes(bytes, corner.material);
    PutTextures(*parts.skin, textures, bytes);
  }
  return bytes;
}

std::optional<MeshParts> MeshFromBytes(std::string_view bytes, const MeshTextures& textures) {
  std::string_view rest = bytes;
  std::uint32_t vertex_count = 0, triangle_count = 0, has_color = 0;
  std::array<double, 3> color{};
  bool good = TakeBytes(rest, vertex_count) && TakeBytes(rest, triangle_count) &&
              TakeBytes(rest, has_color) && TakeBytes(rest, color) && triangle_count > 0 &&
              triangle_count <= kMaxMeshTriangles &&
              rest.size() >= std::size_t{vertex_count} * 12 + std::size_t{triangle_count} * 12;
  std::vector<Vector3> vertices(good ? vertex_count : 0);
  std::vector<MeshData::Triangle> triangles(good ? triangle_count : 0);
  for (Vector3& v : vertices) {
    std::array<float, 3> p{};
    good = good && TakeBytes(rest, p);
    v = Vector3(p[0], p[1], p[2]);
    good = good && v.allFinite() && v.cwiseAbs().maxCoeff() < kMaxVertex_m;
  }
  for (auto& triangle : triangles) {
    good = good && TakeBytes(rest, triangle);
    for (const std::uint32_t v : triangle) good = good && v < vertex_count;
  }
  for (const double part : color) good = good && part >= 0 && part <= 1;
  std::uint32_t mark = 0, material_count = 0;
  std::shared_ptr<MeshSkin> skin;
  if (good && TakeBytes(rest, mark) && mark == kSkinMark) {
    skin = std::make_shared<MeshSkin>();
    good = TakeBytes(rest, material_count) && material_count <= rest.size();
    skin->materials.resize(good ? material_count : 0);
    for (MeshSkin::Material& material : skin->materials) {
      good = good && TakeBytes(rest, material.color);
      for (const double part : material.color) good = good && part >= 0 && part <= 1;
    }
    skin->corners.resize(vertices.size());
    for (MeshSkin::Corner& corner : skin->corners)
      good = good && TakeBytes(rest, corner.material) && corner.material < material_count;
    good = good && TakeTextures(rest, textures, *skin);
  }
  if (!good) return std::nullopt;
  return MeshParts{std::move(vertices), std::move(triangles),
                   has_color != 0 ? std::optional(color) : std::nullopt, std::move(skin)};
}

MeshSkin::Material TexturedMaterial(std::shared_ptr<const Image> texture, const std::array<double, 3>& tint) {
  MeshSkin::Material made;
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < texture->rgb.size(); ++i) sum[i % 3] += texture->rgb[i];
  const std::size_t pixels = texture->rgb.size() / 3;
  for (std::size_t c = 0; c < 3; ++c)
    made.color[c] = std::clamp(sum[c] / (255.0 * static_cast<double>(pixels)), 0.0, 1.0) * tint[c];
  made.tint = tint;
  made.texture = std::move(texture);
  return made;
}

}  // namespace coopdyn
