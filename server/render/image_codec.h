// SPDX-License-Identifier: MIT
// Pictures to PNG and JPEG, from memory to memory. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/render/picture.h"

namespace coopdyn {

/// Nothing if memory is short. @pre the picture is not empty.
std::optional<std::vector<std::uint8_t>> EncodePng(const Picture& picture);
/// `quality` 1…100.
std::optional<std::vector<std::uint8_t>> EncodeJpeg(const Picture& picture, int quality);

}  // namespace coopdyn
