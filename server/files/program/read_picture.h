// SPDX-License-Identifier: MIT
// Decodes PNG and JPEG files with libpng and libjpeg-turbo. Any thread.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/files/wire.h"

namespace coopdyn {

/// Decodes a texture or a height map. Return null or nullopt if `bytes` is not a valid picture; `why` then
/// says what to do.
std::shared_ptr<const Image> DecodeTexture(std::span<const unsigned char> bytes, std::string& why);
std::optional<Heights> DecodeHeights(std::span<const unsigned char> bytes, std::string& why);

}  // namespace coopdyn
