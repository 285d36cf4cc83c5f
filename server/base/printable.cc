// SPDX-License-Identifier: MIT
#include "server/base/printable.h"

#include <algorithm>
#include <array>

namespace coopdyn {

namespace {

struct CodeRange {
  char32_t first, last;
};

/// Characters that a terminal obeys or a reader cannot see: controls, zero-width characters, direction
/// changes, tags.
constexpr std::array kHidden = {
    CodeRange{0x00, 0x1F},     CodeRange{0x7F, 0x9F},       CodeRange{0xAD, 0xAD},
    CodeRange{0x61C, 0x61C},   CodeRange{0x180E, 0x180E},   CodeRange{0x200B, 0x200F},
    CodeRange{0x2028, 0x202E}, CodeRange{0x2060, 0x206F},   CodeRange{0xFEFF, 0xFEFF},
    CodeRange{0xFFF9, 0xFFFB}, CodeRange{0xE0000, 0xE007F},
};

/// The code point of one well-formed character.
char32_t CodePoint(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return first;
  char32_t code = first & (0x7Fu >> character.size());
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  return code;
}

bool IsHidden(std::string_view character) {
  const char32_t code = CodePoint(character);
  return std::any_of(kHidden.begin(), kHidden.end(),
                     [code](const CodeRange& range) { return code >= range.first && code <= range.last; });
}

/// Moves the next character of `text` to `shown`, as ? if it is unsafe.
void TakeCharacter(std::string_view& text, bool lines, std::string& shown) {
  const std::size_t length = Utf8CharacterLength(text);
  const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
  const bool fine = length > 0 && (!IsHidden(character) || (lines && character == "\n"));
  shown += fine ? character : "?";
  text.remove_prefix(character.size());
}

std::string Shown(std::string_view text, bool lines, std::size_t max_bytes) {
  const std::size_t size = text.size();
  std::string shown;
  shown.reserve(std::min(size, max_bytes));
  while (!text.empty()) {
    if (size - text.size() + std::max<std::size_t>(Utf8CharacterLength(text), 1) > max_bytes) {
      return shown + "… (" + std::to_string(size) + " bytes)";
    }
    TakeCharacter(text, lines, shown);
  }
  return shown;
}

}  // namespace

std::string Printable(std::string_view text, std::size_t max_bytes) {
  return Shown(text, false, max_bytes);
}

std::string PrintableLines(std::string_view text, std::size_t max_bytes) {
  return Shown(text, true, max_bytes);
}

std::size_t Utf8CharacterLength(std::string_view text) {
  if (text.empty()) return 0;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates and code points beyond U+10FFFF.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) ||
      (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

}  // namespace coopdyn
