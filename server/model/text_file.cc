// SPDX-License-Identifier: MIT
#include "server/model/text_file.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "server/base/printable.h"

namespace coopdyn {

namespace {

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = Utf8CharacterLength(text);
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
    int line = 0;
    for (std::string_view before = bytes.substr(0, nul + 1); !before.empty(); TakeLine(before)) ++line;
    diagnostics.Error({where.file, where.line > 0 ? where.line : line},
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

bool IsXml(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
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

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end);
  text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
  return line;
}

bool IsPipe(const std::string& name) {
  std::error_code code;
  const auto type = std::filesystem::status(name, code).type();
  return name == kPipe || type == std::filesystem::file_type::fifo ||
         type == std::filesystem::file_type::character;
}

std::optional<std::string> ReadPipe(const std::string& name, Diagnostics& diagnostics) {
  const SourceLine where{kPipe, 0};
  std::optional<std::string> text = ReadTextFile(name == kPipe ? "/dev/stdin" : name, where, diagnostics);
  if (text && text->find_first_not_of(" \t\r\n") == std::string::npos) {
    diagnostics.Error(where, "nothing came through the pipe: write e.g. ./make_scenario | coopdyn serve -");
    return std::nullopt;
  }
  return text;
}

}  // namespace coopdyn
