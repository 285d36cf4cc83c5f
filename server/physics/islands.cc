// SPDX-License-Identifier: MIT
#include "server/physics/islands.h"

#include <utility>

namespace coopdyn {

void Islands::Resize(std::size_t count) {
  parents_.assign(count, -1);
  first_.assign(count, kNone);
  last_.assign(count, kNone);
  next_.assign(count, kNone);
}

std::uint32_t Islands::RootOf(std::uint32_t thing) {
  while (parents_[thing] >= 0) {
    const std::uint32_t parent = static_cast<std::uint32_t>(parents_[thing]);
    if (parents_[parent] >= 0) parents_[thing] = parents_[parent];
    thing = parent;
  }
  return thing;
}

void Islands::Join(std::uint32_t a, std::uint32_t b) {
  a = RootOf(a);
  b = RootOf(b);
  if (a == b) return;
  if (a > b) std::swap(a, b);
  parents_[a] += parents_[b] + 1;
  parents_[b] = static_cast<int>(a);
}

void Islands::List(std::span<const std::uint32_t> active) {
  roots_.clear();
  for (const std::uint32_t thing : active) first_[thing] = kNone;
  for (const std::uint32_t thing : active) {
    const std::uint32_t root = RootOf(thing);
    next_[thing] = kNone;
    if (first_[root] == kNone) {
      roots_.push_back(root);
      first_[root] = thing;
    } else {
      next_[last_[root]] = thing;
    }
    last_[root] = thing;
  }
}

}  // namespace coopdyn
