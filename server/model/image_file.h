// SPDX-License-Identifier: MIT
// Reads and encodes image files. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/geometry/image.h"

namespace coopdyn {

inline constexpr std::size_t kMaxImageBytes = 64u << 20;

/// The picture as PNG; empty if out of memory.
std::string EncodeTexture(const Image& image);

/// The content of an image file. Returns nullopt if it cannot be read; `why` then says what to do.
std::optional<std::string> ReadImageFile(const std::filesystem::path& file, std::string& why);

}  // namespace coopdyn
