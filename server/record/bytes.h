// SPDX-License-Identifier: MIT
// Little-endian numbers to and from bytes, for the codecs of run files. Any machine; pure.
// A value whose bytes are described once for both ways has a function template `void CodeThing(auto& codec,
// auto& thing)`, which names each field in order: a ByteWriter writes them where a ByteReader reads and
// checks them.
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
  explicit ByteWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename Number>
  void Put(Number number) {
    if constexpr (std::is_same_v<Number, double>) {
      Put(std::bit_cast<std::uint64_t>(number));
    } else if constexpr (std::is_same_v<Number, float>) {
      Put(std::bit_cast<std::uint32_t>(number));
    } else {
      static_assert(std::is_integral_v<Number>);
      PutLow(static_cast<std::uint64_t>(number), sizeof(Number));
    }
  }
  /// The lowest `count` bytes of `number`.
  void PutLow(std::uint64_t number, std::size_t count) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + count);
    for (std::size_t i = 0; i < count; ++i) bytes_[at + i] = static_cast<std::byte>(number >> (8 * i));
  }
  template <typename Numbers>
  void PutAll(const Numbers& numbers) {
    for (const auto number : numbers) Put(number);
  }
  /// u32 length, then the text.
  void PutText(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    PutBytes(std::as_bytes(std::span(text)));
  }
  void PutBytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  // --- for both ways
  static constexpr bool kReads = false;
  void Number(auto number) { Put(number); }
  template <typename Numbers>
  void Finite(const Numbers& numbers) {
    if constexpr (std::floating_point<Numbers>) {
      Put(numbers);
    } else {
      PutAll(numbers);
    }
  }
  void AtLeast(double /*least*/, double number) { Put(number); }
  void Size(double size) { Put(size); }
  void Bool(bool value) { Put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  template <typename Enum>
  void Word(Enum word, Enum /*last*/) {
    Put(static_cast<std::uint8_t>(word));
  }
  void Text(std::string_view text) { PutText(text); }
  void Bytes(const std::vector<std::byte>& bytes) {
    Put(static_cast<std::uint32_t>(bytes.size()));
    PutBytes(bytes);
  }
  template <typename Items, typename Code>
  void List(const Items& items, std::size_t /*bytes_each*/, Code code) {
    Put(static_cast<std::uint32_t>(items.size()));
    for (const auto& item : items) code(item);
  }

 private:
  std::vector<std::byte>& bytes_;
};

/// Reads bytes that may be anything: past the end it gives zeros, and ok() is false from then on.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }
  /// Everything was read, and it was there.
  bool finished() const { return ok_ && bytes_.empty(); }
  void Fail() {
    ok_ = false;
    bytes_ = {};
  }

  template <typename Number>
  Number Get() {
    if constexpr (std::is_same_v<Number, double>) {
      return std::bit_cast<double>(GetLow(8));
    } else if constexpr (std::is_same_v<Number, float>) {
      return std::bit_cast<float>(static_cast<std::uint32_t>(GetLow(4)));
    } else {
      static_assert(std::is_integral_v<Number>);
      return static_cast<Number>(GetLow(sizeof(Number)));
    }
  }
  /// A number of `count` ≤ 8 bytes.
  std::uint64_t GetLow(std::size_t count) {
    if (bytes_.size() < count) {
      Fail();
      return 0;
    }
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < count; ++i) number |= std::to_integer<std::uint64_t>(bytes_[i]) << (8 * i);
    bytes_ = bytes_.subspan(count);
    return number;
  }
  template <typename Numbers>
  void GetAll(Numbers& numbers) {
    for (auto& number : numbers) number = Get<std::remove_reference_t<decltype(number)>>();
  }
  /// A u32 count of things that take at least `bytes_each` ≥ 1; 0 and failed if fewer can follow.
  std::size_t GetCount(std::size_t bytes_each) {
    const std::size_t count = Get<std::uint32_t>();
    if (count <= bytes_.size() / bytes_each) return count;
    Fail();
    return 0;
  }
  std::string GetText() {
    const std::span<const std::byte> text = GetBytes(GetCount(1));
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  std::span<const std::byte> GetBytes(std::size_t count) {
    if (bytes_.size() < count) {
      Fail();
      return {};
    }
    const std::span<const std::byte> read = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return read;
  }

  // --- for both ways
  static constexpr bool kReads = true;
  void Require(bool holds) {
    if (!holds) Fail();
  }
  template <typename Value>
  void Number(Value& number) {
    number = Get<Value>();
  }
  /// A number or several.
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
  /// A length that a thing can have.
  void Size(double& size) {
    Finite(size);
    Require(size > 0);
  }
  void Bool(bool& value) {
    const auto byte = Get<std::uint8_t>();
    Require(byte <= 1);
    value = byte != 0;
  }
  /// A word of an enum whose last one is `last`.
  template <typename Enum>
  void Word(Enum& word, Enum last) {
    const auto byte = Get<std::uint8_t>();
    Require(byte <= static_cast<std::uint8_t>(last));
    word = ok_ ? static_cast<Enum>(byte) : last;
  }
  void Text(std::string& text) { text = GetText(); }
  void Bytes(std::vector<std::byte>& bytes) {
    const std::span<const std::byte> read = GetBytes(GetCount(1));
    bytes.assign(read.begin(), read.end());
  }
  /// A u32 count and things of at least `bytes_each` ≥ 1, so that no more memory is taken than there are
  /// bytes.
  template <typename Items, typename Code>
  void List(Items& items, std::size_t bytes_each, Code code) {
    const std::size_t count = GetCount(bytes_each);
    items.reserve(count);
    for (std::size_t i = 0; ok_ && i < count; ++i) code(items.emplace_back());
  }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace coopdyn
