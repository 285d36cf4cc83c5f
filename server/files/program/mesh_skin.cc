// SPDX-License-Identifier: MIT
#include "server/files/program/mesh_skin.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "server/base/printable.h"
#include "server/files/program/read_picture.h"

namespace coopdyn {

namespace {

/// A file in memory.
class HeldFile : public Assimp::IOStream {
 public:
  explicit HeldFile(std::string_view bytes) : bytes_(bytes) {}

  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    count = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, size * count);
    at_ += size * count;
    return count;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (from + offset > bytes_.size()) return aiReturn_FAILURE;
    at_ = from + offset;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  const std::string_view bytes_;
  std::size_t at_ = 0;
};

class MeshFiles : public Assimp::IOSystem {
 public:
  MeshFiles(const MeshRequest& request, const AskForFile& ask) : request_(request), ask_(ask) {}

  bool Exists(const char* name) const override { return ContentOf(name) != nullptr; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const std::string* content = std::strchr(mode, 'w') != nullptr ? nullptr : ContentOf(name);
    return content == nullptr ? nullptr : new HeldFile(*content);  // the library closes it
  }
  void Close(Assimp::IOStream* file) override { delete file; }

 private:
  /// Null if the file is unavailable.
  const std::string* ContentOf(const std::string& name) const {
    if (name == request_.name) return &request_.bytes;
    const auto [known, is_new] = known_.emplace(name, std::nullopt);
    std::string ignored;
    if (is_new) known->second = ask_(FileTalk::kNeedFile, name, ignored);
    return known->second ? &*known->second : nullptr;
  }

  const MeshRequest& request_;
  const AskForFile& ask_;
  mutable std::map<std::string, std::optional<std::string>> known_;  // answers of ask_, by name
};

}  // namespace

std::unique_ptr<Assimp::IOSystem> MakeMeshFiles(const MeshRequest& request, const AskForFile& ask) {
  return std::make_unique<MeshFiles>(request, ask);
}

void SkinBuilder::Add(const aiScene& scene, const aiMesh& mesh) {
  const std::uint32_t material = MaterialOf(scene, mesh.mMaterialIndex);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    MeshSkin::Corner corner{{}, material};
    if (mesh.HasTextureCoords(0)) {
      const aiVector3D& uv = mesh.mTextureCoords[0][i];
      if (std::isfinite(uv.x) && std::isfinite(uv.y)) corner.uv = {uv.x, uv.y};
    }
    skin_->corners.push_back(corner);
  }
}

std::uint32_t SkinBuilder::MaterialOf(const aiScene& scene, unsigned index) {
  const auto [known, is_new] = numbers_.emplace(index, skin_->materials.size());
  if (!is_new) return known->second;
  MeshSkin::Material made;
  if (index < scene.mNumMaterials) {
    const aiMaterial& material = *scene.mMaterials[index];
    aiColor4D diffuse;
    const bool has_color = aiGetMaterialColor(&material, AI_MATKEY_COLOR_DIFFUSE, &diffuse) == AI_SUCCESS;
    const auto part = [](float x) { return std::isfinite(x) ? std::clamp<double>(x, 0, 1) : 0.5; };
    if (has_color) made.color = {part(diffuse.r), part(diffuse.g), part(diffuse.b)};
    aiString name;
    std::shared_ptr<const Image> texture;
    for (const aiTextureType type : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}) {
      if (texture == nullptr && material.GetTexture(type, 0, &name) == aiReturn_SUCCESS)
        texture = TextureOf(scene, name.C_Str());
    }
    // Exporters of textures leave the colour black or arbitrary: ignore it.
    if (texture != nullptr) made = TexturedMaterial(std::move(texture), {1, 1, 1});
    if (!color_ && (has_color || made.texture != nullptr)) color_ = made.color;
  }
  skin_->materials.push_back(std::move(made));
  return known->second;
}

std::shared_ptr<const Image> SkinBuilder::TextureOf(const aiScene& scene, const std::string& name) {
  if (const auto known = textures_.find(name); known != textures_.end()) return known->second;
  std::shared_ptr<const Image>& texture = textures_[name];
  std::string why;
  if (const aiTexture* inside = scene.GetEmbeddedTexture(name.c_str())) {
    if (inside->mHeight != 0) {
      why = "it is not packed as PNG or JPEG";
    } else {
      texture = DecodeTexture({reinterpret_cast<const unsigned char*>(inside->pcData), inside->mWidth}, why);
    }
  } else {
    const auto bytes = ask_(FileTalk::kNeedPicture, name, why);
    if (bytes)
      texture = DecodeTexture({reinterpret_cast<const unsigned char*>(bytes->data()), bytes->size()}, why);
  }
  if (texture == nullptr) missing_.push_back("the texture '" + Printable(name) + "' is not drawn: " + why);
  return texture;
}

std::shared_ptr<const MeshSkin> SkinBuilder::Take() {
  const auto& materials = skin_->materials;
  const bool plain = std::ranges::all_of(materials, [&](const MeshSkin::Material& one) {
    return one.texture == nullptr && one.color == materials.front().color;
  });
  return plain ? nullptr : std::move(skin_);
}

}  // namespace coopdyn
