// SPDX-License-Identifier: MIT
#include "server/render/label_painter.h"

#include <algorithm>
#include <cmath>

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

namespace coopdyn {

namespace {

// DejaVu Sans Condensed Bold, ASCII only: label_font.ttf.
constexpr unsigned char kFontFile[] = {
#include "label_font.inc"
};

const stbtt_fontinfo& Font() {
  static const stbtt_fontinfo font = [] {
    stbtt_fontinfo read;
    stbtt_InitFont(&read, kFontFile, 0);
    return read;
  }();
  return font;
}

constexpr Color kPlate{0.11, 0.13, 0.17};
constexpr Color kText{0.98, 0.98, 0.98};
constexpr std::size_t kMaxLetters = 24;
constexpr std::size_t kCrowd = 8;  // with more names, the text is smaller
constexpr int kMaxNames = 80;      // beyond this the farthest robots get no name

void Blend(Picture& picture, int x, int y, const Color& color, double alpha) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height || alpha <= 0) return;
  std::uint8_t* pixel = picture.at(x, y);
  const double channels[] = {color.r, color.g, color.b};
  for (int i = 0; i < 3; ++i) {
    pixel[i] = static_cast<std::uint8_t>(
        std::lround(pixel[i] + (channels[i] * 255 - pixel[i]) * std::min(alpha, 1.0)));
  }
}

/// Paints a thin line from a name to its pixel.
void PaintLeader(Picture& picture, const Label& label, double cap_px) {
  if (!label.at_px) return;
  const double x = label.x_px, y = label.y_px - cap_px;
  const double dx = (*label.at_px)[0] - x, dy = (*label.at_px)[1] - y;
  const double far_px = 2.0 * (picture.width + picture.height);
  if (!(std::abs(x) < far_px && std::abs(y) < far_px && std::hypot(dx, dy) < far_px)) return;
  const int dots = static_cast<int>(std::max(std::abs(dx), std::abs(dy))) + 1;
  for (int i = 0; i <= dots; ++i) {
    const double at_x = x + dx * i / dots, at_y = y + dy * i / dots;
    const int left = static_cast<int>(std::floor(at_x)), top = static_cast<int>(std::floor(at_y));
    const bool is_flat = std::abs(dx) >= std::abs(dy);
    const double part = is_flat ? at_y - top : at_x - left;
    Blend(picture, left, top, kPlate, 0.5 * (1 - part));
    Blend(picture, left + (is_flat ? 0 : 1), top + (is_flat ? 1 : 0), kPlate, 0.5 * part);
  }
}

// The covered share of a pixel whose centre lies `inside_px` inside a rounded rectangle's edge.
double EdgeCover(double inside_px) {
  return std::clamp(inside_px + 0.5, 0.0, 1.0);
}

struct Plate {
  double left, top, right, bottom, radius;

  double Cover(double x, double y) const {
    const double dx = std::abs(x - (left + right) / 2) - (right - left) / 2 + radius;
    const double dy = std::abs(y - (top + bottom) / 2) - (bottom - top) / 2 + radius;
    const double outside =
        std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0) - radius;
    return EdgeCover(-outside);
  }
};

}  // namespace

const LabelPainter::Mask& LabelPainter::MaskOf(char c, double cap_px) {
  const auto [found, is_new] = masks_.try_emplace({c, static_cast<int>(std::lround(10 * cap_px))});
  Mask& mask = found->second;
  if (!is_new) return mask;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0, advance = 0, bearing = 0;
  stbtt_GetCodepointBox(&Font(), 'H', &x0, &y0, &x1, &y1);
  const auto scale = static_cast<float>(cap_px / y1);
  stbtt_GetCodepointHMetrics(&Font(), c, &advance, &bearing);
  stbtt_GetCodepointBitmapBox(&Font(), c, scale, scale, &mask.left, &mask.top, &x1, &y1);
  mask.width = x1 - mask.left;
  mask.height = y1 - mask.top;
  mask.advance_px = static_cast<double>(scale) * advance;
  mask.cover.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  stbtt_MakeCodepointBitmap(&Font(), mask.cover.data(), mask.width, mask.height, mask.width, scale, scale, c);
  return mask;
}

void LabelPainter::Paint(Picture& picture, const std::vector<Label>& labels) {
  const double crowd = labels.size() > kCrowd ? 0.85 : 1;
  const double cap_px = std::clamp(crowd * picture.height / 54.0, 6.0, 18.0);
  const auto first = labels.size() > kMaxNames ? labels.end() - kMaxNames : labels.begin();
  for (auto label = first; label != labels.end(); ++label) PaintLeader(picture, *label, cap_px);
  for (auto label = first; label != labels.end(); ++label) PaintOne(picture, *label, cap_px);
}

void LabelPainter::PaintOne(Picture& picture, const Label& label, double cap_px) {
  const std::string text =
      label.text.size() <= kMaxLetters ? label.text : label.text.substr(0, kMaxLetters - 2) + "--";
  double text_px = 0;
  for (const char c : text) text_px += MaskOf(c, cap_px).advance_px;

  const double pad_px = 0.55 * cap_px, stripe_px = std::max(2.0, 0.22 * cap_px);
  Plate plate;
  plate.left = std::round(label.x_px - (text_px + 2 * pad_px) / 2);
  plate.right = plate.left + std::ceil(text_px + 2 * pad_px);
  plate.bottom = std::round(label.y_px - 0.5 * cap_px);
  plate.top = plate.bottom - std::ceil(cap_px + 2 * pad_px * 0.85 + stripe_px);
  plate.radius = 0.35 * cap_px;
  // Outside the picture there is nothing to paint, and far outside pixel numbers may overflow int.
  if (!(plate.right > 0 && plate.left < picture.width && plate.bottom > 0 && plate.top < picture.height))
    return;
  for (int y = static_cast<int>(plate.top) - 1; y <= static_cast<int>(plate.bottom); ++y) {
    for (int x = static_cast<int>(plate.left) - 1; x <= static_cast<int>(plate.right); ++x) {
      const double cover = plate.Cover(x + 0.5, y + 0.5);
      const double stripe = EdgeCover(y + 0.5 - (plate.bottom - stripe_px));
      Blend(picture, x, y, kPlate, 0.74 * cover * (1 - stripe));
      Blend(picture, x, y, label.color, cover * stripe);
    }
  }

  const int baseline = static_cast<int>(std::round(plate.top + 0.85 * pad_px + cap_px));
  double pen_x = plate.left + pad_px;
  for (const char c : text) {
    const Mask& mask = MaskOf(c, cap_px);
    const unsigned char* cover = mask.cover.data();
    for (int y = baseline + mask.top; y < baseline + mask.top + mask.height; ++y) {
      const int left = static_cast<int>(std::round(pen_x)) + mask.left;
      for (int x = left; x < left + mask.width; ++x) Blend(picture, x, y, kText, *cover++ / 255.0);
    }
    pen_x += mask.advance_px;
  }
}

}  // namespace coopdyn
