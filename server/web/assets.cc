// SPDX-License-Identifier: MIT
#include "server/web/assets.h"

#include <array>
#include <cstdint>
#include <utility>

namespace coopdyn {

const Asset* FindAsset(std::string_view path) {
  if (path == "/") path = "/index.html";
  for (const Asset& asset : Assets()) {
    if (asset.path == path) return &asset;
  }
  return nullptr;
}

std::string_view ContentType(std::string_view path) {
  using Pair = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Pair, 7> kTypes = {{{".html", "text/html; charset=utf-8"},
                                           {".js", "text/javascript; charset=utf-8"},
                                           {".css", "text/css; charset=utf-8"},
                                           {".svg", "image/svg+xml"},
                                           {".png", "image/png"},
                                           {".py", "text/x-python; charset=utf-8"},
                                           {".zip", "application/zip"}}};
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

std::string EntityTag(const Asset& asset) {
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
  for (const char c : asset.bytes) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string tag = "\"";
  for (int shift = 60; shift >= 0; shift -= 4) tag += kDigits[(hash >> shift) & 15U];
  return tag + "\"";
}

}  // namespace coopdyn
