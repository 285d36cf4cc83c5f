// SPDX-License-Identifier: MIT
#include "server/state/noise.h"

#include <cmath>
#include <numbers>

namespace coopdyn {

namespace {

// The finaliser of SplitMix64: every input bit changes every output bit with probability one half.
std::uint64_t Mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

std::uint64_t Absorb(std::uint64_t state, std::uint64_t value) {
  return Mix(state + 0x9e3779b97f4a7c15 + Mix(value + 0x9e3779b97f4a7c15));
}

// In (0, 1), never an end.
double ToUnit(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

}  // namespace

std::uint64_t NoiseBits(const NoiseKey& key) {
  std::uint64_t state = Absorb(0, key.seed);
  state = Absorb(state, static_cast<std::uint64_t>(key.kind) << 32 | key.sample);
  state = Absorb(state, static_cast<std::uint64_t>(key.robot) << 32 | key.sensor);
  return Absorb(state, key.step);
}

double UniformNoise(const NoiseKey& key) {
  return ToUnit(NoiseBits(key));
}

double GaussianNoise(const NoiseKey& key) {
  const std::uint64_t bits = NoiseBits(key);
  const double u = ToUnit(bits);
  const double v = ToUnit(Mix(bits + 0x9e3779b97f4a7c15));
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);  // Box–Muller
}

double CentredNoise(const NoiseKey& key) {
  return 2 * ToUnit(Mix(NoiseBits(key) + 2 * 0x9e3779b97f4a7c15)) - 1;
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
