// SPDX-License-Identifier: MIT
#include "server/model/image_file.h"

#include <png.h>

#include <fstream>
#include <system_error>

namespace coopdyn {

std::string EncodeTexture(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;  // encoding dominates the loading time of a room with textures
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) return {};
  bytes.resize(size);
  return bytes;
}

std::optional<std::string> ReadImageFile(const std::filesystem::path& file, std::string& why) {
  std::error_code code;
  const auto size = std::filesystem::file_size(file, code);
  if (code || size > kMaxImageBytes) {
    why = code ? "it cannot be read"
               : "the file has more than " + std::to_string(kMaxImageBytes >> 20) + " MiB: make it smaller";
    return std::nullopt;
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
    why = "it cannot be read";
    return std::nullopt;
  }
  return bytes;
}

}  // namespace coopdyn
