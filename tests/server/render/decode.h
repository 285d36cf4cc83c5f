// SPDX-License-Identifier: MIT
// Decodes pictures.
#pragma once

#include <png.h>
#include <turbojpeg.h>

#include <memory>
#include <vector>

#include "server/render/picture.h"

namespace coopdyn {

inline Picture DecodePng(const std::vector<std::uint8_t>& bytes) {
  Picture picture;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return picture;
  image.format = PNG_FORMAT_RGB;
  picture = {static_cast<int>(image.width), static_cast<int>(image.height), {}};
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr)) return {};
  return picture;
}

/// Returns an empty picture if `bytes` is not a JPEG.
inline Picture DecodeJpeg(const std::vector<std::uint8_t>& bytes) {
  Picture picture;
  const std::unique_ptr<void, decltype(&tjDestroy)> turbo(tjInitDecompress(), &tjDestroy);
  int subsampling = 0, colours = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(turbo.get(), bytes.data(), size, &picture.width, &picture.height, &subsampling,
                          &colours) != 0)
    return {};
  picture.rgb.resize(3UL * static_cast<unsigned>(picture.width) * static_cast<unsigned>(picture.height));
  if (tjDecompress2(turbo.get(), bytes.data(), size, picture.rgb.data(), picture.width, 0, picture.height,
                    TJPF_RGB, 0) != 0)
    return {};
  return picture;
}

}  // namespace coopdyn
