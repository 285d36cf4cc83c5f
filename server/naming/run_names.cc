// SPDX-License-Identifier: MIT
#include "server/naming/run_names.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "protocol/ascii.h"
#include "protocol/codec.h"

namespace coopdyn {
namespace {

bool IsControl(unsigned char c) {
  return c < ' ' || c == 0x7f;
}

int HexDigit(char c) {
  if (IsDigit(c)) return c - '0';
  const char lower = ToLower(c);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

}  // namespace

std::string WithRunExtension(const std::string& name) {
  return name.ends_with(kRunExtension) ? name : name + std::string(kRunExtension);
}

bool IsRunName(std::string_view name) {
  return !name.empty() && name.front() != '.' && name.front() != '-' && name.find('/') == name.npos &&
         std::none_of(name.begin(), name.end(), IsControl) && IsCleanUtf8(name);
}

std::string RunNameObjection(std::string_view name) {
  if (IsRunName(name) && name.size() <= kMaxRunName + kRunExtension.size()) return {};
  return fmt::format(
      "the name of a recording has at most {} bytes of UTF-8, begins with neither '.' nor '-', and has no "
      "'/' and no control characters: write for example lesson1",
      kMaxRunName);
}

std::string RunUrl(const std::string& page, const std::string& name) {
  const bool served = !page.empty() && name.ends_with(kRunExtension) && IsRunName(name);
  return served ? page + "runs/" + PercentEncode(name) : "";
}

std::string PercentEncode(std::string_view text) {
  std::string coded;
  for (const char c : text) {
    const bool unreserved =
        IsDigit(c) || IsLower(c) || IsUpper(c) || c == '-' || c == '.' || c == '_' || c == '~';
    coded += unreserved ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return coded;
}

std::optional<std::string> PercentDecode(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? HexDigit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? HexDigit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    decoded += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return decoded;
}

}  // namespace coopdyn
