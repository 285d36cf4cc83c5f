// SPDX-License-Identifier: MIT
#include "server/model/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "server/model/image_file.h"
#include "server/model/mesh_file.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMaxTextureBytes = 8u << 20;  // recordings contain the file
constexpr const char* kTexture = "texture";

/// Two by two squares, or grid lines, in `color` and a darker shade.
std::shared_ptr<const Image> MakePattern(bool checker, const Color& color) {
  constexpr int kSide = 64, kLine = 2;
  constexpr double kDark = 0.55;
  auto image = std::make_shared<Image>();
  image->width = image->height = kSide;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool dark = checker ? (x < kSide / 2) != (y < kSide / 2) : x < kLine || y < kLine;
      for (const double part : {color.r, color.g, color.b}) {
        image->rgb.push_back(
            static_cast<std::uint8_t>(std::lround(std::clamp(part * (dark ? kDark : 1), 0.0, 1.0) * 255)));
      }
    }
  }
  return image;
}

}  // namespace

std::shared_ptr<const Image> PatternOf(const std::string& name, const Color& color) {
  return name == "checker" || name == "grid" ? MakePattern(name == "checker", color) : nullptr;
}

std::shared_ptr<const Image> EmbeddedTexture(const SourceText& source) {
  const auto bytes = FromBase64(source.text);
  std::string why;
  if (!bytes) return nullptr;
  return FileReader().ReadTexture(*bytes, why);
}

Textures::Textures(const RobotLibrary& library, const std::string& file, const std::string& world,
                   bool beside)
    : library_(&library), file_(file), world_(world), beside_(beside) {
  files_.emplace(library.path(), beside ? std::filesystem::path(file) : std::filesystem::path());
}

Textures::Loaded Textures::Load(const std::string& name, std::string& why) {
  if (library_ == nullptr) {
    why = "this text came without files: write texture checker, or texture grid";
    return {};
  }
  std::string bytes, found = name;
  const std::string key = world_.empty() ? name : world_ + ":" + name;
  const SourceText* embedded = library_->Embedded(kTexture, key);
  if (embedded != nullptr) {
    found = embedded->file;
    const auto decoded = FromBase64(embedded->text);
    if (!decoded) {
      why = "the recording's copy is damaged";
      return {};
    }
    bytes = *decoded;
  } else {
    if (!beside_ && !IsBareName(name)) {
      why = "a scenario sent over a socket names a texture by the bare name of a file on the search path";
      return {};
    }
    auto path = files_->Find(name, file_, why);
    std::string ignored;
    if (!path) path = files_->Find("textures/" + name, file_, ignored);
    if (!path) return {};
    found = path->string();
    auto content = ReadImageFile(*path, why);
    if (!content) return {};
    bytes = std::move(*content);
  }
  if (bytes.size() > kMaxTextureBytes) {
    why = "a texture has at most " + std::to_string(kMaxTextureBytes >> 20) + " MiB: make it smaller";
    return {};
  }
  auto image = reader_.ReadTexture(bytes, why);
  if (image == nullptr) return {};
  sources_.push_back({kTexture, key, found, ToBase64(bytes)});
  return {std::move(image), std::make_shared<const SourceText>(sources_.back())};
}

Texture Textures::Read(SectionReader& reader, const Color& color) {
  Texture texture;
  const std::optional<std::string> name = reader.Text(kTexture);
  const bool has_size = reader.Has("texture_size");
  const auto size = reader.Numbers("texture_size", Quantity::kLength, {1, 2}, "width height", kMinFileSize_m,
                                   kMaxFileLength_m);
  if (!name) {
    if (has_size && !reader.Has(kTexture))
      reader.ErrorAt("texture_size",
                     "'texture_size' is that of a 'texture': write one, for example: texture checker");
    return texture;
  }
  texture.name = *name;
  texture.image = PatternOf(*name, color);
  if (texture.image == nullptr) {
    auto known = known_.find(*name);
    if (known == known_.end()) {
      std::string why;
      known = known_.emplace(*name, Load(*name, why)).first;
      if (known->second.image == nullptr) {
        constexpr std::string_view kModels = "the model's folder";
        if (const std::size_t at = why.find(kModels); at != std::string::npos)
          why.replace(at, kModels.size(), "the scenario's folder");
        reader.ErrorAt(kTexture, "the texture '" + *name + "' cannot be read: " + why);
      }
    }
    texture.image = known->second.image;
    texture.source = known->second.source;
  }
  if (texture.image == nullptr) return texture;
  texture.width_m = size ? (*size)[0] : 1;
  // Without a height, keep the picture's aspect ratio.
  texture.height_m =
      size && size->size() == 2 ? (*size)[1] : texture.width_m * texture.image->height / texture.image->width;
  return texture;
}

}  // namespace coopdyn
