// SPDX-License-Identifier: MIT
// YARP's Bottle: a list of values, as bytes in both dialects and as text. Pure functions; any thread.
//
// The byte layout follows YARP 3.12 and 4.0. YARP 4 has other tags for floating-point numbers; otherwise both
// are the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace coopdyn {

/// Determines the tags of binary floating-point numbers.
enum class YarpDialect { k3, k4 };

/// A word of up to 4 characters, sent as an int32 ("vocab"); "1" is true and "" is false.
struct YarpVocab {
  std::string text;
  bool operator==(const YarpVocab&) const = default;
};
/// Raw bytes.
struct YarpBlob {
  std::string bytes;
  bool operator==(const YarpBlob&) const = default;
};

struct BottleValue;
using Bottle = std::vector<BottleValue>;

struct BottleValue {
  std::variant<std::int32_t, std::int64_t, double, std::string, YarpVocab, YarpBlob, Bottle> value;

  bool operator==(const BottleValue&) const = default;
  /// Null if the value has another type.
  template <typename Type>
  const Type* As() const {
    return std::get_if<Type>(&value);
  }
  /// The text of a string or vocab, which programs use interchangeably; else empty.
  std::string_view word() const;
};

/// A Bottle of these values.
template <typename... Values>
Bottle BottleOf(Values&&... values) {
  Bottle bottle;
  bottle.reserve(sizeof...(values));
  (bottle.emplace_back(std::forward<Values>(values)), ...);
  return bottle;
}

/// Nullopt if the value is not a number.
std::optional<double> NumberOf(const BottleValue& value);
/// The word at index `at`; empty if there is none or it is a number.
std::string_view WordAt(const Bottle& bottle, std::size_t at);
/// The number sent for a vocab.
std::int32_t VocabCode(std::string_view word);

inline constexpr std::size_t kMaxBottleDepth = 32;

/// Decodes one complete binary Bottle. `dialect`: tried first, and updated if numbers in the Bottle show the
/// other one. Nullopt if the bytes are not a Bottle, are nested too deeply, or have a remainder.
std::optional<Bottle> DecodeBottle(std::string_view bytes, YarpDialect& dialect);
/// Appends the Bottle's bytes. Omits the tags of items of one primitive type, as YARP does.
void EncodeBottle(const Bottle& bottle, YarpDialect dialect, std::string& out);

/// Parses text as YARP does: anything but a number, vocab, list or blob is a string. Nullopt if a list, blob
/// or quoted string does not end, or if lists are nested too deeply.
std::optional<Bottle> ParseBottle(std::string_view text);
/// Scans a text message, each character once: an open message continues on the next line.
class OpenBottle {
 public:
  void Take(char c);
  /// True while a list, blob or quote is open, or after a backslash.
  bool open() const { return quoted_ || lists_ > 0 || last_ == '\\'; }

 private:
  int lists_ = 0;  // including blobs
  bool quoted_ = false, escaped_ = false;
  char last_ = '\0';
};
/// The Bottle as YARP's text: `[ok] 1 2.5 "two words" (3 4)`.
std::string BottleText(const Bottle& bottle);

}  // namespace coopdyn
