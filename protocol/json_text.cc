// SPDX-License-Identifier: MIT
#include "protocol/json_text.h"

#include <algorithm>
#include <cmath>

#include "protocol/ascii.h"
#include "protocol/codec.h"

namespace coopdyn {
namespace {

void AppendEscape(unsigned char c, std::string& out) {
  constexpr std::string_view kHex = "0123456789abcdef";
  out += "\\u00";
  out += kHex[c >> 4];
  out += kHex[c & 15];
}

/// Bytes of the well-formed character that `text` starts with; 0 if it starts with none.
std::size_t CharacterBytes(std::string_view text) {
  for (std::size_t n = 1; n <= std::min<std::size_t>(4, text.size()); ++n) {
    if (IsCleanUtf8(text.substr(0, n))) return n;
  }
  return 0;
}

}  // namespace

void AppendJsonString(std::string_view text, std::string& out) {
  out += '"';
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) {
      const std::size_t n = CharacterBytes(text.substr(i));
      out += n == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(i, n);
      i += std::max<std::size_t>(n, 1);
      continue;
    }
    ++i;
    if (const char letter = EscapeLetter(c); letter != '\0') {
      out += '\\';
      out += letter;
    } else if (byte < 0x20 || byte == 0x7F || c == '<' || c == '>' || c == '&') {
      AppendEscape(byte, out);
    } else {
      out += c;
    }
  }
  out += '"';
}

std::string JsonString(std::string_view text) {
  std::string out;
  AppendJsonString(text, out);
  return out;
}

void AppendJsonNumber(double value, std::string& out) {
  if (std::isfinite(value)) {
    AppendDouble(value, out);
  } else {
    out += "null";
  }
}

}  // namespace coopdyn
