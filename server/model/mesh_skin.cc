// SPDX-License-Identifier: MIT
#include "server/model/mesh_skin.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <span>
#include <utility>

#include "server/base/printable.h"
#include "server/model/image_file.h"
#include "server/model/mesh_file.h"

namespace coopdyn {

namespace {

/// A file that is in memory.
class HeldFile : public Assimp::IOStream {
 public:
  explicit HeldFile(std::string own) : own_(std::move(own)), bytes_(own_) {}
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
  const std::string own_;
  const std::string_view bytes_;
  std::size_t at_ = 0;
};

class MeshFiles : public Assimp::IOSystem {
 public:
  MeshFiles(const std::filesystem::path& file, const std::string& bytes, const Resources& resources)
      : file_(file), bytes_(bytes), resources_(resources) {}

  bool Exists(const char* name) const override { return name == file_.string() || Find(name).has_value(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr) return nullptr;
    if (name == file_.string()) return new HeldFile(std::string_view(bytes_));  // the library closes it
    const auto file = Find(name);
    std::error_code code;
    if (!file || !std::filesystem::is_regular_file(*file, code)) return nullptr;
    const auto size = std::filesystem::file_size(*file, code);
    if (code || size > kMaxMeshFileBytes) return nullptr;
    std::string bytes(size, '\0');
    std::ifstream stream(*file, std::ios::binary);
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) return nullptr;
    return new HeldFile(std::move(bytes));
  }
  void Close(Assimp::IOStream* file) override { delete file; }

 private:
  std::optional<std::filesystem::path> Find(const std::string& name) const {
    std::string why;
    return name.empty()
               ? std::nullopt
               : resources_.Find(std::filesystem::path(name).lexically_proximate(file_.parent_path()), file_,
                                 why);
  }

  const std::filesystem::path& file_;
  const std::string& bytes_;
  const Resources& resources_;
};

std::uint64_t Mix(std::uint64_t hash, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

}  // namespace

std::unique_ptr<Assimp::IOSystem> MakeMeshFiles(const std::filesystem::path& file, const std::string& bytes,
                                                const Resources& resources) {
  return std::make_unique<MeshFiles>(file, bytes, resources);
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
    // Writers of textures leave the colour black, or at any other value.
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
    // Gazebo's models keep them apart from the meshes.
    auto file = resources_.Find(name, file_, why);
    std::string ignored;
    const std::string bare = std::filesystem::path(name).filename().string();
    if (!file && !bare.empty()) file = resources_.Find("../materials/textures/" + bare, file_, ignored);
    const auto bytes = file ? ReadImageFile(*file, why) : std::nullopt;
    if (bytes) texture = DecodeTexture(*bytes, why);
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
