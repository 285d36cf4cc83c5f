// SPDX-License-Identifier: MIT
// Damages an SQLite file as a bad disk does: each page in turn, in several ways.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace coopdyn {

/// The page size in the header of an SQLite file.
inline std::size_t PageSizeOf(const std::string& bytes) {
  const std::size_t size =
      static_cast<unsigned char>(bytes.at(16)) * 256U + static_cast<unsigned char>(bytes.at(17));
  return size == 1 ? 65536 : size;
}

/// Writes `whole` to `file` with one damage after another, and calls `use` with the damage's name. Restores
/// the file at the end.
inline void ForEachDamage(const std::string& whole, const std::string& file,
                          const std::function<void(const std::string& what)>& use) {
  const std::size_t size = PageSizeOf(whole);
  ASSERT_GE(size, 512U);
  const auto write = [&file](const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  };
  using Damage = std::pair<std::string, std::function<void(std::string&, std::size_t)>>;
  const auto flip = [](std::string& bytes, std::size_t at, int mask) {
    bytes[at] = static_cast<char>(bytes[at] ^ mask);
  };
  const std::vector<Damage> damages{
      {"zeroed", [&](std::string& bytes, std::size_t at) { bytes.replace(at, size, size, '\0'); }},
      {"half zeroed",
       [&](std::string& bytes, std::size_t at) { bytes.replace(at + size / 2, size / 2, size / 2, '\0'); }},
      {"all bits flipped",
       [&](std::string& bytes, std::size_t at) {
         for (std::size_t i = at; i < at + size; ++i) flip(bytes, i, 0xff);
       }},
      {"another kind of page", [&](std::string& bytes, std::size_t at) { flip(bytes, at, 0x08); }},
      {"fewer cells",
       [&](std::string& bytes, std::size_t at) { bytes[at + 4] = static_cast<char>(bytes[at + 4] / 2); }},
      {"one cell less", [&](std::string& bytes, std::size_t at) { --bytes[at + 4]; }},
      {"another cell first", [&](std::string& bytes, std::size_t at) { bytes[at + 9] = bytes[at + 11]; }},
      {"another last child", [&](std::string& bytes, std::size_t at) { flip(bytes, at + 11, 0x01); }},
      {"a bit near the start", [&](std::string& bytes, std::size_t at) { flip(bytes, at + 13, 0x01); }},
      {"a bit in the middle", [&](std::string& bytes, std::size_t at) { flip(bytes, at + size / 2, 0x10); }},
      {"a bit near the end", [&](std::string& bytes, std::size_t at) { flip(bytes, at + size - 7, 0x04); }},
  };
  for (std::size_t at = 0; at + size <= whole.size(); at += size) {
    for (const auto& [what, damage] : damages) {
      std::string bytes = whole;
      damage(bytes, at);
      if (bytes == whole) continue;
      write(bytes);
      use("page " + std::to_string(at / size + 1) + " " + what);
    }
  }
  write(whole);
}

}  // namespace coopdyn
