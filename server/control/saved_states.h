// SPDX-License-Identifier: MIT
// The states that `save` has kept, by name. One thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

class SavedStates {
 public:
  static constexpr std::size_t kMaxStates = 100;
  static constexpr std::size_t kMaxName = 63;
  /// The name of the start, which is always there.
  static constexpr std::string_view kStart = "start";

  /// Why nothing can be kept under `name`; empty if it can.
  std::string Objection(const std::string& name) const;
  /// @pre no Objection(). Replaces what is called the same.
  void Keep(const std::string& name, SavedStatePtr state);
  /// Null if there is none of that name.
  SavedStatePtr Find(std::string_view name) const;
  /// In the order in which they were first kept, without the start.
  const std::vector<std::pair<std::string, SavedStatePtr>>& all() const { return states_; }
  /// All names with that of the start, separated by blanks.
  std::string Names() const;

 private:
  std::vector<std::pair<std::string, SavedStatePtr>> states_;
};

}  // namespace coopdyn
