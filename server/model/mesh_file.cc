// SPDX-License-Identifier: MIT
#include "server/model/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/model/mesh_skin.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kMaxVertex_m = 1e4;
constexpr std::uint32_t kSkinMark = 0x4e494b53, kTextureMark = 0x54584554;

std::string TooMany(std::size_t triangles) {
  return "the mesh has " + std::to_string(triangles) + " triangles, at most " +
         std::to_string(kMaxMeshTriangles) + " are taken: simplify it (in Blender: Modifier, Decimate)";
}

/// What is wrong with a file before a library reads it; empty: nothing.
std::string CheckBytes(const std::string& bytes, const std::string& extension) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (extension != "stl" || bytes.size() < kHeader || bytes.starts_with("solid")) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  if (count > kMaxMeshTriangles) return TooMany(count);
  if (bytes.size() < kHeader + std::size_t{count} * kTriangle)
    return "the mesh is cut off: it says " + std::to_string(count) + " triangles and holds fewer";
  return {};
}

class Collector {
 public:
  Collector(const aiScene& scene, const Vector3& scale, const std::string& submesh, SkinBuilder& skin)
      : scene_(scene), scale_(scale), submesh_(submesh), skin_(skin) {}

  void Visit(const aiNode& node, const aiMatrix4x4& above, bool wanted) {
    const aiMatrix4x4 here = above * node.mTransformation;
    wanted = wanted || submesh_.empty() || submesh_ == node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (wanted || submesh_ == mesh.mName.C_Str()) Add(mesh, here);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) Visit(*node.mChildren[i], here, wanted);
  }

  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  bool finite = true;

 private:
  void Add(const aiMesh& mesh, const aiMatrix4x4& place) {
    if (triangles.size() > kMaxMeshTriangles || mesh.mNumFaces == 0) return;
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = place * mesh.mVertices[i];
      const Vector3 v = Vector3(p.x, p.y, p.z).cwiseProduct(scale_);
      finite = finite && v.allFinite() && v.cwiseAbs().maxCoeff() < kMaxVertex_m;
      vertices.push_back(v);
    }
    const bool mirrored = scale_.prod() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      MeshData::Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = base + face.mIndices[k];
      if (mirrored) std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
    }
    skin_.Add(scene_, mesh);
  }

  const aiScene& scene_;
  const Vector3 scale_;
  const std::string& submesh_;
  SkinBuilder& skin_;
};

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

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

/// Of a skin with pictures: for each material its picture's place in `textures` + 1 and its tint, for each
/// vertex its place on the picture.
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

/// What PutTextures() wrote, if it wrote something.
bool TakeTextures(std::string_view& bytes, const MeshTextures& textures, MeshSkin& skin) {
  if (bytes.size() < sizeof(kTextureMark)) return true;  // zeros that fill up the word
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

}  // namespace

std::string ToBase64(const std::string& bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[three >> shift & 63u];
  }
  return text;  // zeros at the end do no harm
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

namespace {

/// To a nanometre, and to a float: such numbers less the middle of some, and plus it again, are what they
/// were. Not inline: g++ 12 at -O2 leaves out casts to float and back where it can do two at once.
[[gnu::noinline]] double Rounded(double length_m) {
  constexpr double kGrid_m = 0x1p-30;
  return static_cast<double>(static_cast<float>(std::nearbyint(length_m / kGrid_m) * kGrid_m));
}

}  // namespace

ModelMesh MakeModelMesh(std::vector<Vector3> vertices, std::vector<MeshData::Triangle> triangles,
                        const std::optional<std::array<double, 3>>& color,
                        std::shared_ptr<const MeshSkin> skin) {
  // A recording, whose triangles have another order, gives the same mesh.
  std::ranges::sort(triangles);
  for (Vector3& v : vertices) v = v.unaryExpr(&Rounded);
  ModelMesh mesh;
  MeshData data = MakeMesh(std::move(vertices), std::move(triangles), mesh.middle);
  data.color = color;
  SetSkin(std::move(skin), data);
  mesh.data = std::make_shared<const MeshData>(std::move(data));
  return mesh;
}

std::optional<ModelMesh> LoadMesh(const std::filesystem::path& file, const Vector3& scale,
                                  const std::string& submesh, const Resources& resources,
                                  const SourceLine& where, Diagnostics& diagnostics) {
  const std::string name = file.filename().string();
  const auto fail = [&](const std::string& text) {
    diagnostics.Error(where, "mesh '" + name + "': " + text);
    return std::nullopt;
  };
  std::string extension = ToLower(file.extension().string());
  if (!extension.empty()) extension.erase(0, 1);
  if (extension != "stl" && extension != "obj" && extension != "dae" && extension != "glb" &&
      extension != "gltf" && extension != "ply")
    return fail(
        "meshes are read from .stl, .obj, .dae, .glb, .gltf and .ply: convert it, for example with Blender");
  std::error_code code;
  const auto size = std::filesystem::file_size(file, code);
  if (code) return fail("it cannot be read");
  if (size > kMaxMeshFileBytes) {
    return fail("the file has " + std::to_string(size >> 20) + " MiB, at most " +
                std::to_string(kMaxMeshFileBytes >> 20) +
                " are taken: simplify it (in Blender: Modifier, Decimate)");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) return fail("it cannot be read");
  if (const std::string wrong = CheckBytes(bytes, extension); !wrong.empty()) return fail(wrong);
  Assimp::Importer importer;
  importer.SetIOHandler(MakeMeshFiles(file, bytes, resources).release());  // it owns them
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES,
                           true);  // a part goes by its name, not its id
  // Z is up here, as the numbers of all other formats are taken.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(
      file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr)
    return fail("it cannot be read: " + Printable(std::string(importer.GetErrorString()).substr(0, 200)));
  SkinBuilder skin(file, resources);
  Collector all(*scene, scale, submesh, skin);
  all.Visit(*scene->mRootNode, aiMatrix4x4(), false);
  if (all.triangles.size() > kMaxMeshTriangles) return fail(TooMany(all.triangles.size()));
  if (all.triangles.empty())
    return fail(submesh.empty() ? "it has no triangles" : "it has no part called '" + submesh + "'");
  if (!all.finite) return fail("it has vertices that are not finite or more than 10 km away");
  for (const std::string& missing : skin.missing())
    diagnostics.Warning(where, "mesh '" + name + "': " + missing);
  return MakeModelMesh(std::move(all.vertices), std::move(all.triangles), skin.color(), skin.Take());
}

std::string MeshToText(const ModelMesh& mesh, MeshTextures& textures) {
  std::string bytes;
  const MeshData& data = *mesh.data;
  PutBytes(bytes, static_cast<std::uint32_t>(data.vertices.size()));
  PutBytes(bytes, static_cast<std::uint32_t>(data.triangles.size()));
  PutBytes(bytes, static_cast<std::uint32_t>(data.color.has_value()));
  for (const double part : data.color.value_or(std::array<double, 3>{})) PutBytes(bytes, part);
  for (const Vector3& v : data.vertices) {
    for (int i = 0; i < 3; ++i) PutBytes(bytes, static_cast<float>(v[i] + mesh.middle[i]));
  }
  for (const auto& triangle : data.triangles) PutBytes(bytes, triangle);
  if (data.skin != nullptr) {
    PutBytes(bytes, kSkinMark);
    PutBytes(bytes, static_cast<std::uint32_t>(data.skin->materials.size()));
    for (const MeshSkin::Material& material : data.skin->materials) PutBytes(bytes, material.color);
    for (const MeshSkin::Corner& corner : data.skin->corners) PutBytes(bytes, corner.material);
    PutTextures(*data.skin, textures, bytes);
  }
  return ToBase64(bytes);
}

std::optional<ModelMesh> MeshFromText(std::string_view text, const MeshTextures& textures) {
  const auto bytes = FromBase64(text);
  if (!bytes) return std::nullopt;
  std::string_view rest = *bytes;
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
  return MakeModelMesh(std::move(vertices), std::move(triangles),
                       has_color != 0 ? std::optional(color) : std::nullopt, std::move(skin));
}

}  // namespace coopdyn
