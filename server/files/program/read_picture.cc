// SPDX-License-Identifier: MIT
#include "server/files/program/read_picture.h"

#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace coopdyn {

namespace {

bool IsPng(std::span<const unsigned char> bytes) {
  constexpr unsigned char kSignature[] = {0x89, 'P', 'N', 'G'};
  return bytes.size() > 8 && std::equal(kSignature, kSignature + 4, bytes.begin());
}
bool IsJpeg(std::span<const unsigned char> bytes) {
  return bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8;
}

/// True if the picture's size is allowed. Call it before decompression.
bool IsSize(long width, long height, std::string& why) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide) return true;
  why = "the picture has " + std::to_string(width) + " x " + std::to_string(height) + " points, at most " +
        std::to_string(kMaxImageSide) + " x " + std::to_string(kMaxImageSide) +
        " are allowed: make it smaller";
  return false;
}

/// Decoded samples; 16-bit grey for heights.
struct Raw {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;  // instead of bytes
};

std::optional<Raw> FromPng(std::span<const unsigned char> bytes, bool grey, std::string& why) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) {
    why = std::string("it is no good PNG: ") + image.message;
    return std::nullopt;
  }
  Raw raw{static_cast<int>(image.width), static_cast<int>(image.height), {}, {}};
  if (!IsSize(image.width, image.height, why)) {
    png_image_free(&image);
    return std::nullopt;
  }
  const bool deep = grey && (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  image.format = deep ? PNG_FORMAT_LINEAR_Y : grey ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  void* to = nullptr;
  if (deep) {
    raw.words.resize(PNG_IMAGE_SIZE(image) / 2);
    to = raw.words.data();
  } else {
    raw.bytes.resize(PNG_IMAGE_SIZE(image));
    to = raw.bytes.data();
  }
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&image, &black, to, 0, nullptr)) {
    why = std::string("it is no good PNG: ") + image.message;
    return std::nullopt;
  }
  return raw;
}

std::optional<Raw> FromJpeg(std::span<const unsigned char> bytes, bool grey, std::string& why) {
  const std::unique_ptr<void, decltype(&tjDestroy)> turbo(tjInitDecompress(), &tjDestroy);
  int width = 0, height = 0, sampling = 0, colors = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(turbo.get(), bytes.data(), size, &width, &height, &sampling, &colors) != 0) {
    why = std::string("it is no good JPEG: ") + tjGetErrorStr2(turbo.get());
    return std::nullopt;
  }
  if (!IsSize(width, height, why)) return std::nullopt;
  Raw raw{width, height, {}, {}};
  raw.bytes.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (grey ? 1 : 3));
  if (tjDecompress2(turbo.get(), bytes.data(), size, raw.bytes.data(), width, 0, height,
                    grey ? TJPF_GRAY : TJPF_RGB, 0) != 0 &&
      tjGetErrorCode(turbo.get()) == TJERR_FATAL) {
    why = std::string("it is no good JPEG: ") + tjGetErrorStr2(turbo.get());
    return std::nullopt;
  }
  return raw;
}

std::optional<Raw> Decode(std::span<const unsigned char> bytes, bool grey, std::string& why) {
  if (IsPng(bytes)) return FromPng(bytes, grey, why);
  if (IsJpeg(bytes)) return FromJpeg(bytes, grey, why);
  why = "pictures are read from .png and .jpg: convert it";
  return std::nullopt;
}

}  // namespace

std::shared_ptr<const Image> DecodeTexture(std::span<const unsigned char> bytes, std::string& why) {
  const auto raw = Decode(bytes, false, why);
  if (!raw) return nullptr;
  // Each pixel of a scaled-down texture is the mean of a square.
  const int by = (std::max(raw->width, raw->height) + kMaxTextureSide - 1) / kMaxTextureSide;
  auto image = std::make_shared<Image>();
  image->width = std::max(1, raw->width / by);
  image->height = std::max(1, raw->height / by);
  const auto index = [](int y, int width, int x, int c) {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 3 +
           static_cast<std::size_t>(c);
  };
  image->rgb.resize(index(image->height, image->width, 0, 0));
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      for (int c = 0; c < 3; ++c) {
        int sum = 0, count = 0;
        for (int v = y * by; v < std::min((y + 1) * by, raw->height); ++v) {
          for (int u = x * by; u < std::min((x + 1) * by, raw->width); ++u, ++count)
            sum += raw->bytes[index(v, raw->width, u, c)];
        }
        image->rgb[index(y, image->width, x, c)] = static_cast<std::uint8_t>(sum / std::max(count, 1));
      }
    }
  }
  return image;
}

std::optional<Heights> DecodeHeights(std::span<const unsigned char> bytes, std::string& why) {
  auto raw = Decode(bytes, true, why);
  if (!raw) return std::nullopt;
  Heights heights{raw->width, raw->height, std::move(raw->words)};
  for (const std::uint8_t byte : raw->bytes) heights.values.push_back(static_cast<std::uint16_t>(byte * 257));
  return heights;
}

}  // namespace coopdyn
