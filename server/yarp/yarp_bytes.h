// SPDX-License-Identifier: MIT
// Little-endian numbers in a string. Pure; any thread.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace coopdyn {

static_assert(std::endian::native == std::endian::little, "the wire is little-endian");

template <typename Number>
void AppendBytes(Number number, std::string& out) {
  char bytes[sizeof number];
  std::memcpy(bytes, &number, sizeof number);
  out.append(bytes, sizeof number);
}

/// Reads values from bytes; returns nullopt beyond the end.
class ByteScanner {
 public:
  explicit ByteScanner(std::string_view bytes) : rest_(bytes) {}

  std::size_t size() const { return rest_.size(); }
  std::string_view rest() const { return rest_; }
  template <typename Number>
  std::optional<Number> Take() {
    const std::optional<std::string_view> bytes = TakeBytes(sizeof(Number));
    if (!bytes) return {};
    Number number;
    std::memcpy(&number, bytes->data(), sizeof number);
    return number;
  }
  /// A negative `count` also counts as beyond the end.
  std::optional<std::string_view> TakeBytes(std::int64_t count) {
    if (count < 0 || static_cast<std::uint64_t>(count) > rest_.size()) return {};
    const std::string_view bytes = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(bytes.size());
    return bytes;
  }

 private:
  std::string_view rest_;
};

}  // namespace coopdyn
