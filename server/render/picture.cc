// SPDX-License-Identifier: MIT
#include "server/render/picture.h"

#include <png.h>
#include <turbojpeg.h>

#include <memory>

namespace coopdyn {

std::optional<std::vector<std::uint8_t>> EncodePng(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;  // a little larger, several times faster
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr))
    return std::nullopt;
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}

std::optional<std::vector<std::uint8_t>> EncodeJpeg(const Picture& picture, int quality) {
  const std::unique_ptr<void, decltype(&tjDestroy)> turbo(tjInitCompress(), &tjDestroy);
  unsigned char* output = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(turbo.get(), picture.rgb.data(), picture.width, 0, picture.height, TJPF_RGB,
                                 &output, &size, TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(output, &tjFree);
  if (failed) return std::nullopt;
  return std::vector<std::uint8_t>(output, output + size);
}

}  // namespace coopdyn
