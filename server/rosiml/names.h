// SPDX-License-Identifier: MIT
// Turns an experiment's names into unique names that are valid in coopdyn's files. One thread.
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/base/words.h"

namespace coopdyn::rosiml {

class Names {
 public:
  /// `taken`: reserved names.
  Names(std::initializer_list<const char*> taken) : taken_(taken.begin(), taken.end()) {}

  /// A unique form of `name`: NAME, NAME_2 and so on. Case-insensitive.
  std::string New(std::string_view name);

 private:
  std::set<std::string> taken_;      // lower case
  std::map<std::string, int> last_;  // last number used, by simple name in lower case
};

/// `name` as a module name: a-z, 0-9 and _, starting with a letter.
std::string ModuleName(std::string_view name);

/// DidYouMean() among the names of the first 300 `things`. Empty once further errors would not be reported.
template <typename Things, typename Name>
std::string MeantOf(std::string_view word, const Things& things, Name name, const Diagnostics& diagnostics) {
  constexpr std::size_t kMost = 300;
  if (diagnostics.all().size() >= Diagnostics::kMaxKept) return {};
  std::vector<std::string> names;
  for (const auto& thing : things) {
    if (names.size() == kMost) break;
    names.push_back(std::invoke(name, thing));
  }
  return DidYouMean(word, names);
}

}  // namespace coopdyn::rosiml
