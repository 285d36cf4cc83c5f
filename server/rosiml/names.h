// SPDX-License-Identifier: MIT
// Names as coopdyn's files can have them: the simple form of what the experiment says, none twice. One
// thread.
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
  /// `taken`: names that are no names of these things.
  Names(std::initializer_list<const char*> taken) : taken_(taken.begin(), taken.end()) {}

  /// `name`, or NAME_2 and so on; case makes no difference.
  std::string New(std::string_view name);

 private:
  std::set<std::string> taken_;      // in lower case
  std::map<std::string, int> last_;  // the number that was given last, by the simple name in lower case
};

/// A module's name: a-z, 0-9 and _, a letter first.
std::string ModuleName(std::string_view name);

/// DidYouMean() of the first hundreds of what is called so; nothing once more is wrong than is told.
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
