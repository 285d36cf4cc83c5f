// SPDX-License-Identifier: MIT
#include <algorithm>

#include "protocol/ascii.h"
#include "protocol/codec.h"

namespace coopdyn {

FirstBytes SniffEncoding(std::string_view bytes) {
  constexpr std::string_view kFamily = "CDS";
  constexpr std::size_t kMaxMethodBytes = 32;
  if (bytes.starts_with(kBinaryMagic)) return FirstBytes::kBinary;
  if (kFamily.starts_with(bytes) || bytes == kFamily) return FirstBytes::kUndecided;
  if (bytes.starts_with(kFamily)) return FirstBytes::kWrongMagic;

  // Our words are lower-case, so only METHOD SP can begin an HTTP request; then the whole first line decides,
  // because the name server's `OPEN /robot1/motors` looks like one.
  const auto letters =
      static_cast<std::size_t>(std::find_if_not(bytes.begin(), bytes.end(), IsUpper) - bytes.begin());
  if (letters == 0 || letters > kMaxMethodBytes) return FirstBytes::kText;
  if (letters == bytes.size()) return FirstBytes::kUndecided;
  if (bytes[letters] != ' ') return FirstBytes::kText;
  const std::string_view seen = bytes.substr(0, kMaxSniffBytes);
  const std::string_view line = seen.substr(0, seen.find('\n'));
  if (line.find("HTTP/") != std::string_view::npos) return FirstBytes::kHttp;
  if (line.size() < seen.size()) return FirstBytes::kText;
  return bytes.size() < kMaxSniffBytes ? FirstBytes::kUndecided : FirstBytes::kHttp;
}

}  // namespace coopdyn
