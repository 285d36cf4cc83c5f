// SPDX-License-Identifier: MIT
// The common form of .world and .scenario: `[SECTION]` and `key values`, before the words have a meaning.
// Pure; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"

namespace coopdyn {

/// `key value`, without `=` or `:` after the key and without comment.
struct Entry {
  std::string key;  // lower case
  std::string value;
  int line = 0;
};

struct Section {
  std::string name;  // as written, e.g. WALL_1
  std::string word;  // lower case
  int line = 0;
  std::vector<Entry> entries;
};

/// What nobody writes by hand, and few programs do.
inline constexpr std::size_t kMaxFileSections = 100'000;
inline constexpr std::size_t kMaxFileLines = 1'000'000;

/// Splits `text` (decoded) into sections in file order. Errors: lines that are neither, keys before the first
/// section, sections that stand there twice (both are returned), names that are none. It stops reading when
/// there are too many errors, sections or lines.
std::vector<Section> ReadSections(const std::string& text, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn
