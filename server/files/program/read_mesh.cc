// SPDX-License-Identifier: MIT
#include "server/files/program/read_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstring>
#include <utility>

#include "server/base/printable.h"
#include "server/files/program/mesh_skin.h"
#include "server/files/reduce_mesh.h"

namespace coopdyn {

namespace {

std::string TooMany(std::size_t triangles) {
  return "the mesh has " + std::to_string(triangles) + " triangles, at most " +
         std::to_string(kMaxReadTriangles) + " are read: simplify it (in Blender: Modifier, Decimate)";
}

/// Errors that coopdyn finds before a library reads the file; empty if none.
std::string CheckBytes(const std::string& bytes, const std::string& name) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  const bool is_stl = name.ends_with(".stl") || name.ends_with(".STL");
  if (!is_stl || bytes.size() < kHeader || bytes.starts_with("solid")) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  if (count > kMaxReadTriangles) return TooMany(count);
  if (bytes.size() < kHeader + std::size_t{count} * kTriangle)
    return "the mesh is truncated: it announces " + std::to_string(count) + " triangles and contains fewer";
  return {};
}

class Collector {
 public:
  Collector(const aiScene& scene, const MeshRequest& request, SkinBuilder& skin)
      : scene_(scene), scale_(request.scale.data()), part_(request.part), skin_(skin) {}

  void Visit(const aiNode& node, const aiMatrix4x4& above, bool wanted) {
    const aiMatrix4x4 here = above * node.mTransformation;
    wanted = wanted || part_.empty() || part_ == node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (wanted || part_ == mesh.mName.C_Str()) Add(mesh, here);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) Visit(*node.mChildren[i], here, wanted);
  }

  MeshParts parts;
  bool finite = true;

 private:
  void Add(const aiMesh& mesh, const aiMatrix4x4& place) {
    if (parts.triangles.size() > kMaxReadTriangles || mesh.mNumFaces == 0) return;
    const auto base = static_cast<std::uint32_t>(parts.vertices.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = place * mesh.mVertices[i];
      const Vector3 v = Vector3(p.x, p.y, p.z).cwiseProduct(scale_);
      finite = finite && v.allFinite() && v.cwiseAbs().maxCoeff() < kMaxVertex_m;
      parts.vertices.push_back(v);
    }
    const bool mirrored = scale_.prod() * place.Determinant() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;
      MeshData::Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = base + face.mIndices[k];
      if (mirrored) std::swap(triangle[1], triangle[2]);
      parts.triangles.push_back(triangle);
    }
    skin_.Add(scene_, mesh);
  }

  const aiScene& scene_;
  const Vector3 scale_;
  const std::string& part_;
  SkinBuilder& skin_;
};

}  // namespace

std::optional<MeshAnswer> ReadMesh(const MeshRequest& request, const AskForFile& ask, std::string& why) {
  why = CheckBytes(request.bytes, request.name);
  if (!why.empty()) return std::nullopt;
  Assimp::Importer importer;
  importer.SetIOHandler(MakeMeshFiles(request, ask).release());  // takes ownership
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES,
                           true);  // identify parts by name, not id
  // Use coordinates unchanged, with z up, as for all other formats.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(
      request.name, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    why = "it cannot be read: " + Printable(std::string(importer.GetErrorString()).substr(0, 200));
    return std::nullopt;
  }
  SkinBuilder skin(ask);
  Collector all(*scene, request, skin);
  all.Visit(*scene->mRootNode, aiMatrix4x4(), false);
  if (all.parts.triangles.size() > kMaxReadTriangles) {
    why = TooMany(all.parts.triangles.size());
  } else if (all.parts.triangles.empty()) {
    why = request.part.empty() ? "it has no triangles" : "it has no part called '" + request.part + "'";
  } else if (!all.finite) {
    why = "it has vertices that are not finite or more than 10 km away";
  }
  if (!why.empty()) return std::nullopt;
  all.parts.color = skin.color();
  all.parts.skin = skin.Take();
  const std::size_t count = all.parts.triangles.size();
  ReducedMesh reduced = Reduce(std::move(all.parts), kMaxMeshTriangles);
  std::vector<std::string> warnings = skin.missing();
  if (count > kMaxMeshTriangles) warnings.push_back(ReductionText(count, reduced));
  return MeshAnswer{std::move(warnings), Settled(std::move(reduced.parts))};
}

}  // namespace coopdyn
