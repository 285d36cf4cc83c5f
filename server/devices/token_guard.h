// SPDX-License-Identifier: MIT
// Who may change the world: connections from this machine, and those that say the token. Constant; any
// thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace coopdyn {

class TokenGuard {
 public:
  /// `required`: strangers need the token for commands that change something. An empty token matches nothing.
  TokenGuard(std::string token, bool required) : token_(std::move(token)), required_(required) {}

  bool required() const { return required_; }
  /// True if `given` is the token; takes the same time for every wrong one of the same length.
  bool Matches(std::string_view given) const;

 private:
  std::string token_;
  bool required_;
};

}  // namespace coopdyn
