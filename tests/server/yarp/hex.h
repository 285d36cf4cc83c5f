// SPDX-License-Identifier: MIT
// Bytes written as hexadecimal digits, as captures of the wire show them.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace coopdyn {

/// "59 41 'is\0'…": pairs of digits, and literal text in single quotes; `_` in it is a zero byte.
inline std::string Hex(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\'') {
      for (++i; text[i] != '\''; ++i) bytes += text[i] == '_' ? '\0' : text[i];
    } else if (text[i] != ' ' && text[i] != '\n') {
      unsigned value = 0;
      std::from_chars(text.data() + i, text.data() + i + 2, value, 16);
      bytes += static_cast<char>(value);
      ++i;
    }
  }
  return bytes;
}

}  // namespace coopdyn
