// SPDX-License-Identifier: MIT
// Locale-independent character classes. Pure; any thread.
#pragma once

namespace coopdyn {

constexpr bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool IsLower(char c) {
  return c >= 'a' && c <= 'z';
}
constexpr bool IsUpper(char c) {
  return c >= 'A' && c <= 'Z';
}
/// Letters; bytes of UTF-8 sequences count as letters, so that `get_target grün` works.
constexpr bool IsLetter(char c) {
  return IsLower(c) || IsUpper(c) || static_cast<unsigned char>(c) >= 0x80;
}
constexpr bool IsBlank(char c) {
  return c == ' ' || c == '\t';
}
constexpr char ToLower(char c) {
  return IsUpper(c) ? static_cast<char>(c - 'A' + 'a') : c;
}

/// The letter that stands for `c` after a backslash in the text form and in JSON, e.g. n for a line feed;
/// '\0' if `c` has no escape.
constexpr char EscapeLetter(char c) {
  switch (c) {
    case '"':
    case '\\':
      return c;
    case '\n':
      return 'n';
    case '\r':
      return 'r';
    case '\t':
      return 't';
    default:
      return '\0';
  }
}

/// The character that `letter` stands for after a backslash; '\0' if none.
constexpr char EscapedBy(char letter) {
  for (const char c : {'"', '\\', '\n', '\r', '\t'}) {
    if (EscapeLetter(c) == letter) return c;
  }
  return '\0';
}

}  // namespace coopdyn
