// SPDX-License-Identifier: MIT
// Pixels and their encoding as PNG and JPEG in memory. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace coopdyn {

/// Pixels of three bytes (red, green, blue), row by row from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  std::uint8_t* at(int x, int y) { return rgb.data() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x); }
  const std::uint8_t* at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
};

/// Nullopt if memory is short. @pre the picture is not empty.
std::optional<std::vector<std::uint8_t>> EncodePng(const Picture& picture);
/// `quality` 1…100.
std::optional<std::vector<std::uint8_t>> EncodeJpeg(const Picture& picture, int quality);

}  // namespace coopdyn
