// SPDX-License-Identifier: MIT
// Pictures from PNG and JPEG files: textures, and the heights of heightmaps. Any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/image.h"

namespace coopdyn {

inline constexpr int kMaxImageSide = 8192;    // of a file
inline constexpr int kMaxTextureSide = 1024;  // larger textures are made smaller
inline constexpr std::size_t kMaxImageBytes = 64u << 20;

/// A picture for a texture; null, and `why` says what to do, for what is none.
std::shared_ptr<const Image> DecodeTexture(std::span<const unsigned char> bytes, std::string& why);
/// A PNG that DecodeTexture() makes the same picture of; empty if there is no memory.
std::string EncodeTexture(const Image& image);

/// Heights from 0 to 1, row by row, the uppermost first.
struct Heights {
  int width = 0, height = 0;
  std::vector<float> values;

  /// Between the points: x and y from 0 to 1.
  double At(double x, double y) const;
};
std::optional<Heights> DecodeHeights(std::span<const unsigned char> bytes, std::string& why);

/// The content of an image file; nothing, and `why` says what to do, if it cannot be read.
std::optional<std::vector<unsigned char>> ReadImageFile(const std::filesystem::path& file, std::string& why);

}  // namespace coopdyn
