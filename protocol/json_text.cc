// SPDX-License-Identifier: MIT
#include "protocol/json_text.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <boost/json/value.hpp>

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

/// Length of the well-formed character at the start of `text`; 0 if the start is malformed.
std::size_t CharacterBytes(std::string_view text) {
  for (std::size_t n = 1; n <= std::min<std::size_t>(4, text.size()); ++n) {
    if (IsCleanUtf8(text.substr(0, n))) return n;
  }
  return 0;
}

void AppendString(std::string_view text, std::string& out) {
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

void AppendNumber(double value, std::string& out) {
  if (std::isfinite(value)) {
    AppendDouble(value, out);
  } else {
    out += "null";
  }
}

void Append(const boost::json::value& value, std::string& out) {
  switch (value.kind()) {
    case boost::json::kind::null:
      out += "null";
      break;
    case boost::json::kind::bool_:
      out += value.get_bool() ? "true" : "false";
      break;
    case boost::json::kind::int64:
      out += std::to_string(value.get_int64());
      break;
    case boost::json::kind::uint64:
      out += std::to_string(value.get_uint64());
      break;
    case boost::json::kind::double_:
      AppendNumber(value.get_double(), out);
      break;
    case boost::json::kind::string:
      AppendString(value.get_string(), out);
      break;
    case boost::json::kind::array:
      out += '[';
      for (const boost::json::value& item : value.get_array()) {
        if (out.back() != '[') out += ',';
        Append(item, out);
      }
      out += ']';
      break;
    case boost::json::kind::object:
      out += '{';
      for (const auto& [key, item] : value.get_object()) {
        if (out.back() != '{') out += ',';
        AppendString(key, out);
        out += ':';
        Append(item, out);
      }
      out += '}';
      break;
  }
}

}  // namespace

std::string JsonText(const boost::json::value& value) {
  std::string out;
  Append(value, out);
  return out;
}

}  // namespace coopdyn
