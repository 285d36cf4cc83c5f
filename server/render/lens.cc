// SPDX-License-Identifier: MIT
#include "server/render/lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "server/base/portable_math.h"
#include "server/base/random.h"

namespace coopdyn {

namespace {

constexpr std::size_t kQuantiles = 4096;

/// Equally likely points of the normal distribution with mean 0 and standard deviation 1. A table is ten
/// times as fast as a formula, and a picture has a million values.
const std::array<float, kQuantiles>& NormalQuantiles() {
  static const std::array<float, kQuantiles> table = [] {
    // Inverts the distribution function, integrated from the density with the midpoint rule.
    constexpr double kFrom = -6, kStep = 1e-4;
    std::array<double, kQuantiles> quantiles{};
    double below = 0, x = kFrom;
    const auto density = [](double at) { return portable::Exp(-at * at / 2) / std::sqrt(2 * M_PI); };
    for (std::size_t i = 0; i < kQuantiles / 2; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / kQuantiles;
      while (below < share) {
        below += kStep * density(x + kStep / 2);
        x += kStep;
      }
      quantiles[i] = x;
      quantiles[kQuantiles - 1 - i] = -x;
    }
    double squares = 0;
    for (const double q : quantiles) squares += q * q;
    const double deviation = std::sqrt(squares / kQuantiles);
    std::array<float, kQuantiles> scaled{};
    for (std::size_t i = 0; i < kQuantiles; ++i) scaled[i] = static_cast<float>(quantiles[i] / deviation);
    return scaled;
  }();
  return table;
}

/// 64 well-mixed bits of pixel `index`.
std::uint64_t PixelBits(std::uint64_t base, std::uint64_t index) {
  return MixBits(base + kGolden * (index + 1));
}

/// Part `k` (0, 1 or 2) of `bits` as a uniform sample from -1 to 1.
float Centred(std::uint64_t bits, std::size_t k) {
  constexpr std::uint64_t kParts = 1u << 20;
  return static_cast<float>((bits >> (20 * k)) & (kParts - 1)) * (2.0f / (kParts - 1)) - 1;
}

/// The constant part of the noise.
double BiasOf(const ValueNoise& noise, NoiseKey key) {
  if (noise.bias_stddev <= 0) return noise.bias_mean;
  key.step = kBiasStep;
  return noise.bias_mean + noise.bias_stddev * GaussianNoise(key);
}

}  // namespace

void AddNoise(const ValueNoise& noise, const NoiseKey& key, Picture& picture) {
  if (noise.exact()) return;
  const std::array<float, kQuantiles>& normal = NormalQuantiles();
  const std::uint64_t base = NoiseBits(key);
  const auto bias = static_cast<float>(255 * BiasOf(noise, key) + 0.5);
  const auto stddev = static_cast<float>(255 * noise.stddev),
             uniform = static_cast<float>(255 * noise.uniform),
             unit = static_cast<float>(255 * noise.resolution);
  const std::size_t pixels = picture.rgb.size() / 3;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint64_t bits = PixelBits(base, i), more = uniform > 0 ? PixelBits(~base, i) : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint8_t& value = picture.rgb[3 * i + k];
      float noisy = static_cast<float>(value) + bias + stddev * normal[(bits >> (20 * k)) & (kQuantiles - 1)];
      if (uniform > 0) noisy += uniform * Centred(more, k);
      if (unit > 0) noisy = std::round((noisy - 0.5f) / unit) * unit + 0.5f;
      value = static_cast<std::uint8_t>(std::clamp(noisy, 0.0f, 255.0f));
    }
  }
}

void AddNoise(const ValueNoise& noise, const NoiseKey& key, std::span<float> depth_m) {
  if (noise.exact()) return;
  const std::array<float, kQuantiles>& normal = NormalQuantiles();
  const std::uint64_t base = NoiseBits(key);
  const double bias = BiasOf(noise, key);
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    if (!std::isfinite(depth_m[i]) || !(depth_m[i] > 0)) continue;
    double noisy = static_cast<double>(depth_m[i]) + bias +
                   noise.stddev * static_cast<double>(normal[PixelBits(base, i) & (kQuantiles - 1)]);
    if (noise.uniform > 0) noisy += noise.uniform * static_cast<double>(Centred(PixelBits(~base, i), 0));
    if (noise.resolution > 0) noisy = std::round(noisy / noise.resolution) * noise.resolution;
    depth_m[i] = static_cast<float>(std::max(noisy, 0.0));
  }
}

}  // namespace coopdyn
