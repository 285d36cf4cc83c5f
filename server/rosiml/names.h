// SPDX-License-Identifier: MIT
// Names as coopdyn's files can have them: the simple form of what the experiment says, none twice. One
// thread.
#pragma once

#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <string_view>

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

}  // namespace coopdyn::rosiml
