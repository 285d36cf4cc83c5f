// SPDX-License-Identifier: MIT
#include "server/state/noise.h"

#include <cmath>

#include "server/base/random.h"

namespace coopdyn {

std::uint64_t NoiseBits(const NoiseKey& key) {
  std::uint64_t state = AbsorbBits(0, key.seed);
  state = AbsorbBits(state, static_cast<std::uint64_t>(key.kind) << 32 | key.sample);
  state = AbsorbBits(state, static_cast<std::uint64_t>(key.robot) << 32 | key.sensor);
  return AbsorbBits(state, key.step);
}

double UniformNoise(const NoiseKey& key) {
  return UniformOf(NoiseBits(key));
}

double GaussianNoise(const NoiseKey& key) {
  const std::uint64_t bits = NoiseBits(key);
  return NormalOf(UniformOf(bits), UniformOf(MixBits(bits + kGolden)));
}

double CentredNoise(const NoiseKey& key) {
  return 2 * UniformOf(MixBits(NoiseBits(key) + 2 * kGolden)) - 1;
}

double Noisy(double value, const ValueNoise& noise, const NoiseKey& key) {
  value += noise.bias_mean;
  if (noise.bias_stddev > 0) {
    NoiseKey bias = key;
    bias.step = kBiasStep;
    value += noise.bias_stddev * GaussianNoise(bias);
  }
  if (noise.stddev > 0) value += noise.stddev * GaussianNoise(key);
  if (noise.uniform > 0) value += noise.uniform * CentredNoise(key);
  if (noise.resolution > 0) value = std::round(value / noise.resolution) * noise.resolution;
  return value;
}

}  // namespace coopdyn
