// SPDX-License-Identifier: MIT
#include "server/render/image_codec.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <memory>
// libjpeg needs cstdio before it
#include <jpeglib.h>
#include <png.h>

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

namespace {

// libjpeg ends the process on an error unless its handler jumps out.
struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf escape;
};

void Escape(j_common_ptr jpeg) {
  std::longjmp(reinterpret_cast<JpegErrors*>(jpeg->err)->escape, 1);
}

// No object with a destructor lives across the jump. `*output` is malloc'ed by libjpeg.
bool Compress(const Picture& picture, int quality, unsigned char** output, unsigned long* size) {
  jpeg_compress_struct jpeg{};
  JpegErrors errors{};
  jpeg.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = Escape;
  if (setjmp(errors.escape)) {
    jpeg_destroy_compress(&jpeg);
    return false;
  }
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, output, size);
  jpeg.image_width = static_cast<JDIMENSION>(picture.width);
  jpeg.image_height = static_cast<JDIMENSION>(picture.height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(picture.at(0, static_cast<int>(jpeg.next_scanline)));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  return true;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> EncodeJpeg(const Picture& picture, int quality) {
  unsigned char* output = nullptr;
  unsigned long size = 0;
  const bool ok = Compress(picture, quality, &output, &size);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owner(output, &std::free);
  if (!ok) return std::nullopt;
  return std::vector<std::uint8_t>(output, output + size);
}

}  // namespace coopdyn
