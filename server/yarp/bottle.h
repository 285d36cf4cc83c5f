// SPDX-License-Identifier: MIT
// YARP's Bottle: a list of values, as bytes in both dialects and as text. Pure functions; any thread.
//
// The layout of the bytes follows YARP 3.12 and 4.0: YARP 4 has other tags for floating-point numbers, all
// else is the same in both.
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

/// Whose tags binary floating-point numbers have.
enum class YarpDialect { k3, k4 };

/// A word of up to 4 characters that travels as an int32 ("vocab"); "1" is true and "" is false.
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
  /// Null: it is of another type.
  template <typename Type>
  const Type* As() const {
    return std::get_if<Type>(&value);
  }
  /// The word of a string or vocab, which programs use alike; empty if it is neither.
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

/// Nothing: it is no number.
std::optional<double> NumberOf(const BottleValue& value);
/// The word of the item `at`; empty if there is none, as there is if it is a number.
std::string_view WordAt(const Bottle& bottle, std::size_t at);
/// The number that a vocab travels as.
std::int32_t VocabCode(std::string_view word);

inline constexpr std::size_t kMaxBottleDepth = 32;

/// Reads one whole binary Bottle. `dialect`: what is tried first; afterwards what the numbers in it showed.
/// Nothing: not a Bottle, nested too deeply, or more bytes than it has.
std::optional<Bottle> DecodeBottle(std::string_view bytes, YarpDialect& dialect);
/// Appends the bytes. Items of one primitive type are written without their tags, as YARP does.
void EncodeBottle(const Bottle& bottle, YarpDialect dialect, std::string& out);

/// Reads text as YARP does: what is no number, vocab, list or blob is a string. Nothing: a list, blob or
/// quoted string does not end, or lists are nested too deeply.
std::optional<Bottle> ParseBottle(std::string_view text);
/// Follows a text message, each character once: it continues on the next line while it is open.
class OpenBottle {
 public:
  void Take(char c);
  /// A list, a blob or a quote is open, or the last character is a backslash.
  bool open() const { return quoted_ || lists_ > 0 || last_ == '\\'; }

 private:
  int lists_ = 0;  // and blobs
  bool quoted_ = false, escaped_ = false;
  char last_ = '\0';
};
/// The text of YARP: `[ok] 1 2.5 "two words" (3 4)`.
std::string BottleText(const Bottle& bottle);

}  // namespace coopdyn
