// SPDX-License-Identifier: MIT
// Who may change the world: connections from this machine, and those that say the token. Any thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "server/base/wrong_tokens.h"

namespace coopdyn {

class TokenGuard {
 public:
  /// `required`: strangers need the token for commands that change something. An empty token matches nothing.
  /// `wrong`: counts wrong tokens of all guards together, and outlives them; null: nobody is slowed down.
  TokenGuard(std::string token, bool required, WrongTokens* wrong = nullptr)
      : token_(std::move(token)), required_(required), wrong_(wrong) {}

  bool required() const { return required_; }
  /// True if `given` is the token; takes the same time for every wrong one of the same length.
  bool Matches(std::string_view given) const;
  /// What becomes of a token that `peer` (ADDRESS:PORT) says at `now`.
  TokenVerdict Judge(std::string_view given, const std::string& peer, Nanoseconds now) const;
  /// As of WrongTokens.
  std::string WaitText(const std::string& peer, Nanoseconds now) const {
    return wrong_ == nullptr ? std::string() : wrong_->WaitText(peer, now);
  }

 private:
  std::string token_;
  bool required_;
  WrongTokens* wrong_;
};

}  // namespace coopdyn
