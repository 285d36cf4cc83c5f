// SPDX-License-Identifier: MIT
// Pseudo-random numbers that are the same on every machine: hashes of the values that they depend on. Pure;
// any thread.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "server/base/portable_math.h"

namespace coopdyn {

/// The increment of SplitMix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, OOPSLA
/// 2014).
inline constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;

/// SplitMix64's finaliser: every bit of `x` changes every bit of the result with probability one half.
constexpr std::uint64_t MixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// Mixes `value` into `state`. The result can be used as random bits or absorb more values.
constexpr std::uint64_t AbsorbBits(std::uint64_t state, std::uint64_t value) {
  return MixBits(state + kGolden + MixBits(value + kGolden));
}

/// A number in the open interval (0, 1).
constexpr double UniformOf(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

/// The SplitMix64 sequence.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}
  /// A number in [0, 1).
  double Next() { return static_cast<double>(MixBits(state_ += kGolden) >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

/// A normal deviate of mean 0 and standard deviation 1, from two numbers in (0, 1) (Box, Muller: A Note on
/// the Generation of Random Normal Deviates, 1958).
inline double NormalOf(double u, double v) {
  return std::sqrt(-2 * portable::Log(u)) * portable::Cos(2 * std::numbers::pi * v);
}

/// Incremental FNV-1a hash of bytes. Not for input that an attacker may choose.
class BytesHash {
 public:
  void Add(const void* data, std::size_t bytes) {
    const auto* const byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ byte[i]) * 0x100000001b3;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

inline std::uint64_t HashOfBytes(std::string_view bytes) {
  BytesHash hash;
  hash.Add(bytes.data(), bytes.size());
  return hash.value();
}

}  // namespace coopdyn
