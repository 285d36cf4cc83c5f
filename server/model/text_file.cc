// SPDX-License-Identifier: MIT
#include "server/model/text_file.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace coopdyn {

namespace {

/// Length of the well-formed UTF-8 character at the start of `text`; 0 if there is none.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates and beyond U+10FFFF.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) ||
      (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

std::optional<std::string> DecodeText(std::string_view bytes, const SourceLine& where,
                                      Diagnostics& diagnostics) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    diagnostics.Error(where, "the file is UTF-16: save it as UTF-8 (in the editor's Save As)");
    return std::nullopt;
  }
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  if (const auto nul = bytes.find('\0'); nul != std::string_view::npos) {
    const auto before = SplitLines(bytes.substr(0, nul + 1)).size();
    diagnostics.Error({where.file, where.line > 0 ? where.line : static_cast<int>(before)},
                      "there is a NUL byte: this is no text file, or it is UTF-16 (save it as UTF-8)");
    return std::nullopt;
  }
  if (IsUtf8(bytes)) return std::string(bytes);
  std::string out;
  out.reserve(bytes.size() + bytes.size() / 8);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6));
      out += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

std::optional<std::string> ReadTextFile(const std::string& file, const SourceLine& where,
                                        Diagnostics& diagnostics) {
  const std::string shown = where.file == file ? "" : " '" + file + "'";
  std::error_code code;
  if (std::filesystem::is_directory(file, code)) {
    diagnostics.Error(where, "is a folder, not a file" + (shown.empty() ? "" : ":" + shown));
    return std::nullopt;
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    diagnostics.Error(where, "cannot read the file" + shown + " (" +
                                 std::error_code(errno, std::generic_category()).message() + ")");
    return std::nullopt;
  }
  std::string bytes;
  char buffer[1 << 16];
  while (stream.read(buffer, sizeof buffer) || stream.gcount() > 0) {
    bytes.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (bytes.size() > kMaxTextBytes) {
      diagnostics.Error(where, "the file" + shown + " is larger than 16 MiB");
      return std::nullopt;
    }
  }
  return DecodeText(bytes, {file, 0}, diagnostics);
}

std::vector<std::string_view> SplitLines(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    if (end == std::string_view::npos) {
      lines.push_back(text);
      break;
    }
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end + (text.substr(end).starts_with("\r\n") ? 2 : 1));
  }
  return lines;
}

}  // namespace coopdyn
