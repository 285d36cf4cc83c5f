// SPDX-License-Identifier: MIT
#include "server/rosiml/names.h"

#include <algorithm>

#include "server/base/words.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

std::string Names::New(std::string_view name) {
  constexpr std::size_t kMost = 40;
  const std::string simple = Simple(name, kMost);
  std::string unique = simple;
  int& last = last_[ToLower(simple)];
  if (last > 0) unique += "_" + std::to_string(++last);
  while (!taken_.insert(ToLower(unique)).second) {
    last = std::max(last, 1) + 1;
    unique = simple + "_" + std::to_string(last);
  }
  last = std::max(last, 1);
  return unique;
}

std::string ModuleName(std::string_view name) {
  constexpr std::size_t kMost = 28;
  std::string out = ToLower(Simple(name, kMost));
  std::ranges::replace(out, '-', '_');
  return out;
}

}  // namespace coopdyn::rosiml
