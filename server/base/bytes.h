// SPDX-License-Identifier: MIT
// Serializes values as little-endian bytes, for recordings. Portable; pure.
// A type describes its bytes once for both directions, in a function template `void CodeThing(auto& codec,
// auto& thing)` that names each field in order: a ByteWriter writes the fields, a ByteReader reads and checks
// them.
#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace coopdyn {

/// Appends to a vector of bytes.
class ByteWriter {
 public:
  static constexpr bool kReads = false;

  explicit ByteWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  bool ok() const { return true; }
  void Require(bool /*holds*/) {}
  /// Writes the lowest `count` bytes of `number`.
  void Low(std::uint64_t number, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count);
    for (std::size_t i = 0; i < count; ++i) bytes_[at + i] = static_cast<std::byte>(number >> (8 * i));
  }
  template <typename Value>
  void Number(Value number) {
    if constexpr (std::is_same_v<Value, double>) {
      Low(std::bit_cast<std::uint64_t>(number), 8);
    } else if constexpr (std::is_same_v<Value, float>) {
      Low(std::bit_cast<std::uint32_t>(number), 4);
    } else {
      static_assert(std::is_integral_v<Value>);
      Low(static_cast<std::uint64_t>(number), sizeof(Value));
    }
  }
  template <typename Numbers>
  void Finite(const Numbers& numbers) {
    if constexpr (std::floating_point<Numbers>) {
      Number(numbers);
    } else {
      for (const auto number : numbers) Number(number);
    }
  }
  void AtLeast(double /*least*/, double number) { Number(number); }
  void Size(double size) { Number(size); }
  void Bool(bool value) { Low(value ? 1 : 0, 1); }
  template <typename Enum>
  void Word(Enum word, Enum /*last*/) {
    Low(static_cast<std::uint64_t>(word), 1);
  }
  void Text(std::string_view text) { Bytes(std::as_bytes(std::span(text))); }
  void Bytes(std::span<const std::byte> bytes) {
    Low(bytes.size(), 4);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <typename Items, typename Code>
  void List(const Items& items, std::size_t /*bytes_each*/, Code code) {
    Low(items.size(), 4);
    for (const auto& item : items) code(item);
  }

 private:
  std::vector<std::byte>& bytes_;
};

/// Reads untrusted bytes. A read past the end returns zeros and makes ok() false for good.
class ByteReader {
 public:
  static constexpr bool kReads = true;

  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }
  /// True if all bytes have been read without an error.
  bool finished() const { return ok_ && bytes_.empty(); }
  void Require(bool holds) {
    if (holds) return;
    ok_ = false;
    bytes_ = {};
  }
  /// Reads a number of `count` ≤ 8 bytes.
  std::uint64_t Low(std::size_t count) {
    std::uint64_t number = 0;
    const std::span<const std::byte> bytes = Take(count);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      number |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
    return number;
  }
  template <typename Value>
  void Number(Value& number) {
    if constexpr (std::is_same_v<Value, double>) {
      number = std::bit_cast<double>(Low(8));
    } else if constexpr (std::is_same_v<Value, float>) {
      number = std::bit_cast<float>(static_cast<std::uint32_t>(Low(4)));
    } else {
      static_assert(std::is_integral_v<Value>);
      number = static_cast<Value>(Low(sizeof(Value)));
    }
  }
  /// Reads one number or several; requires finite values.
  template <typename Numbers>
  void Finite(Numbers& numbers) {
    if constexpr (std::floating_point<Numbers>) {
      Number(numbers);
      Require(std::isfinite(numbers));
    } else {
      for (auto& number : numbers) Finite(number);
    }
  }
  void AtLeast(double least, double& number) {
    Finite(number);
    Require(number >= least);
  }
  /// Reads a length; requires a finite, positive value.
  void Size(double& size) {
    Finite(size);
    Require(size > 0);
  }
  void Bool(bool& value) {
    const std::uint64_t byte = Low(1);
    Require(byte <= 1);
    value = byte != 0;
  }
  /// Reads a value of an enum whose last enumerator is `last`.
  template <typename Enum>
  void Word(Enum& word, Enum last) {
    const std::uint64_t byte = Low(1);
    Require(byte <= static_cast<std::uint64_t>(last));
    word = ok_ ? static_cast<Enum>(byte) : last;
  }
  void Text(std::string& text) {
    const std::span<const std::byte> read = Take(Low(4));
    text.assign(reinterpret_cast<const char*>(read.data()), read.size());
  }
  void Bytes(std::vector<std::byte>& bytes) {
    const std::span<const std::byte> read = Take(Low(4));
    bytes.assign(read.begin(), read.end());
  }
  /// Reads a u32 count and that number of items of at least `bytes_each` ≥ 1 bytes. Rejects a count that the
  /// remaining bytes cannot hold, so that a wrong count cannot force a large allocation.
  template <typename Items, typename Code>
  void List(Items& items, std::size_t bytes_each, Code code) {
    const std::size_t count = Low(4);
    Require(count <= bytes_.size() / bytes_each);
    if (ok_) items.reserve(count);
    for (std::size_t i = 0; ok_ && i < count; ++i) code(items.emplace_back());
  }

 private:
  std::span<const std::byte> Take(std::size_t count) {
    Require(count <= bytes_.size());
    if (!ok_) return {};
    const std::span<const std::byte> read = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return read;
  }

  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace coopdyn
