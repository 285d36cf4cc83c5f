// SPDX-License-Identifier: MIT
// Pictures from PNG and JPEG files, by libpng and libjpeg-turbo. Any thread.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "server/files/wire.h"

namespace coopdyn {

/// A picture for a texture; null, and `why` says what to do, for what is none.
std::shared_ptr<const Image> DecodeTexture(std::span<const unsigned char> bytes, std::string& why);
std::optional<Heights> DecodeHeights(std::span<const unsigned char> bytes, std::string& why);

}  // namespace coopdyn
