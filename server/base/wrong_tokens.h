// SPDX-License-Identifier: MIT
// Wrong tokens, counted by the address that they come from: who has tried several waits before the next is
// looked at, so that nobody finds a token by trying. Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/mutex.h"

namespace coopdyn {

/// The address in `peer` (ADDRESS:PORT); of IPv6 the network, in which one machine has as many addresses as
/// it likes.
std::string NetworkOf(const std::string& peer);

enum class TokenVerdict { kRight, kWrong, kTooSoon };

class WrongTokens {
 public:
  static constexpr int kFree = 3;  // wrong ones without a wait; then 1 s, 2 s, 4 s, ...
  static constexpr Nanoseconds kLongestWait = 60 * kNanosecondsPerSecond;
  static constexpr std::size_t kMaxAddresses = 1024;

  explicit WrongTokens(Logger logger) : logger_(std::move(logger)) {}

  /// The verdict on a token from `peer` (ADDRESS:PORT) at `now`. `right`: whether it is the token. Too soon:
  /// the verdict does not say whether it is right.
  TokenVerdict Judge(bool right, const std::string& peer, Nanoseconds now) EXCLUDES(mutex_);
  /// What to tell `peer` at `now` if its next token would come too soon; empty: it would not.
  std::string WaitText(const std::string& peer, Nanoseconds now) const EXCLUDES(mutex_);

 private:
  struct Tries {
    int wrong = 0;
    Nanoseconds last = 0, next = 0;  // the last wrong one; when another is read
  };
  /// Drops the addresses that have not tried for long; if there are none, the one that tried longest ago.
  void MakeRoom(Nanoseconds now) REQUIRES(mutex_);

  const Logger logger_;
  mutable Mutex mutex_;
  std::unordered_map<std::string, Tries> tries_ GUARDED_BY(mutex_);  // by address
};

/// Who may change the world: connections from this machine, and those that say the token.
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
