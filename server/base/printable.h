// SPDX-License-Identifier: MIT
// Text of others, fit for a terminal. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace coopdyn {

/// Longer texts are cut.
inline constexpr std::size_t kMaxPrintableBytes = 1000;

/// `text` in one line: ? for each control character (ends of lines too), for what hides text or turns its
/// direction, and for each byte that is not UTF-8. What is longer than `max_bytes` ends in `… (N bytes)`.
std::string Printable(std::string_view text, std::size_t max_bytes = kMaxPrintableBytes);
/// The same with its line ends, and uncut unless `max_bytes` says otherwise.
std::string PrintableLines(std::string_view text, std::size_t max_bytes = std::string_view::npos);

/// Length of the well-formed UTF-8 character at the start of `text`; 0 if there is none.
std::size_t Utf8CharacterLength(std::string_view text);

}  // namespace coopdyn
