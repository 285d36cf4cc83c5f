// SPDX-License-Identifier: MIT
// Pictures in files. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/geometry/image.h"

namespace coopdyn {

inline constexpr std::size_t kMaxImageBytes = 64u << 20;

/// A PNG of the picture; empty if there is no memory.
std::string EncodeTexture(const Image& image);

/// The content of an image file; nothing, and `why` says what to do, if it cannot be read.
std::optional<std::string> ReadImageFile(const std::filesystem::path& file, std::string& why);

}  // namespace coopdyn
