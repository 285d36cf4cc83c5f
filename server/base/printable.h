// SPDX-License-Identifier: MIT
// Makes untrusted text safe for a terminal. Pure; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace coopdyn {

/// Default limit; longer texts are cut.
inline constexpr std::size_t kMaxPrintableBytes = 1000;

/// `text` in one line, with ? for each control character (including line ends), for each character that hides
/// text or changes its direction, and for each byte that is not UTF-8. Text longer than `max_bytes` is cut
/// and ends in `… (N bytes)`.
std::string Printable(std::string_view text, std::size_t max_bytes = kMaxPrintableBytes);
/// The same, but keeps line ends and cuts only at `max_bytes`, if given.
std::string PrintableLines(std::string_view text, std::size_t max_bytes = std::string_view::npos);

/// Length of the well-formed UTF-8 character at the start of `text`; 0 if the start is malformed.
std::size_t Utf8CharacterLength(std::string_view text);

}  // namespace coopdyn
