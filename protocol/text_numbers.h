// SPDX-License-Identifier: MIT
// Numbers of the text form, independent of the locale. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace coopdyn {

/// What a token is when read as a number.
enum class NumberRead {
  kOk,
  kNotNumber,   // not by the grammar
  kOutOfRange,  // a whole number outside int32, or finite digits beyond the largest double
  kHasPoint,    // a number, but not a whole one (ReadInt32 only)
};

/// Reads `[+-]digits`.
NumberRead ReadInt32(std::string_view token, std::int32_t& value);
/// Reads `[+-](digits[.digits*] | .digits)[e int]` or `[+-](inf | nan)`, any case. Digits too small for a
/// double give 0.
NumberRead ReadDouble(std::string_view token, double& value);

/// Says why `token` is not a number and what to write instead, e.g. `'0,5' is not a number: write 0.5`.
std::string NotANumber(std::string_view token);
/// `token` in quotes, cut after 40 bytes at the border of a character.
std::string Quoted(std::string_view token);

}  // namespace coopdyn
