// SPDX-License-Identifier: MIT
// The bytes of YARS's two protocols: numbers are little endian, floats IEEE 754. Pure; any thread.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"

namespace coopdyn {

/// A motor or a value of a channel in YARS's terms.
struct YarsEntry {
  std::string name;
  double internal_min = 0, internal_max = 0, external_min = 0, external_max = 0;
  bool auxiliary = false;
  std::int32_t segment = 1;  // the body that it belongs to, from 1
};

/// The motors and values of a robot's module `channel`.
struct YarsChannel {
  std::vector<YarsEntry> motors, values;
  std::int32_t segments = 1;

  /// Parses the reply to get_channel.
  static YarsChannel Of(const Message& reply);
};

inline void PutInt(std::int32_t number, std::string& out) {
  const auto bits = static_cast<std::uint32_t>(number);
  for (int i = 0; i < 4; ++i) out += static_cast<char>(bits >> (8 * i));
}
inline void PutFloat(float number, std::string& out) {
  PutInt(static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(number)), out);
}
inline void PutDouble(double number, std::string& out) {
  const auto bits = std::bit_cast<std::uint64_t>(number);
  for (int i = 0; i < 8; ++i) out += static_cast<char>(bits >> (8 * i));
}

/// Reads numbers from the front of `bytes`; nullopt if too few bytes are left.
class YarsReader {
 public:
  explicit YarsReader(std::string_view bytes) : bytes_(bytes) {}

  std::optional<std::int32_t> Int() {
    const auto bits = Low(4);
    if (!bits) return std::nullopt;
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(*bits));
  }
  std::optional<float> Float() {
    const auto bits = Low(4);
    if (!bits) return std::nullopt;
    return std::bit_cast<float>(static_cast<std::uint32_t>(*bits));
  }
  std::optional<double> Double() {
    const auto bits = Low(8);
    if (!bits) return std::nullopt;
    return std::bit_cast<double>(*bits);
  }
  std::optional<std::string_view> Bytes(std::size_t count) {
    if (bytes_.size() < count) return std::nullopt;
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::optional<std::uint64_t> Low(std::size_t count) {
    const auto bytes = Bytes(count);
    if (!bytes) return std::nullopt;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < count; ++i)
      bits |= std::uint64_t{static_cast<unsigned char>((*bytes)[i])} << (8 * i);
    return bits;
  }

  std::string_view bytes_;
};

}  // namespace coopdyn
