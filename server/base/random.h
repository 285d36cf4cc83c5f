// SPDX-License-Identifier: MIT
// Numbers that look random and are the same on every machine: by mixing what they are to depend on. Pure; any
// thread.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "server/base/portable_math.h"

namespace coopdyn {

/// The step of SplitMix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, OOPSLA 2014).
inline constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;

/// Its finaliser: every bit of `x` changes every bit of the result with probability one half.
constexpr std::uint64_t MixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// The state after `value`, from which bits are taken or more is absorbed.
constexpr std::uint64_t AbsorbBits(std::uint64_t state, std::uint64_t value) {
  return MixBits(state + kGolden + MixBits(value + kGolden));
}

/// In (0, 1), never an end.
constexpr double UniformOf(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

/// A sequence by counting (SplitMix64).
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}
  /// In [0, 1).
  double Next() { return static_cast<double>(MixBits(state_ += kGolden) >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

/// Of mean 0 and standard deviation 1, from two numbers in (0, 1) (Box, Muller: A Note on the Generation of
/// Random Normal Deviates, 1958).
inline double NormalOf(double u, double v) {
  return std::sqrt(-2 * portable::Log(u)) * portable::Cos(2 * std::numbers::pi * v);
}

/// FNV-1a: a hash of bytes that comes in parts. Not for what an enemy may choose.
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
