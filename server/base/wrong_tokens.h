// SPDX-License-Identifier: MIT
// Counts wrong tokens by client address and by what they would open. After several wrong ones the address
// must wait before its next one is checked, which prevents guessing. Any thread.
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

/// The address in `peer` (ADDRESS:PORT). For IPv6 only the network, because one machine can use any number of
/// addresses in it.
std::string NetworkOf(const std::string& peer);

enum class TokenVerdict { kRight, kWrong, kTooSoon };

class WrongTokens {
 public:
  /// Wrong tokens without a wait, for one thing and for all together; then 1 s, 2 s, 4 s, ... Many students
  /// may share an address.
  static constexpr int kFree = 3, kFreeForAll = 30;
  static constexpr Nanoseconds kLongestWait = 60 * kNanosecondsPerSecond;
  static constexpr std::size_t kMaxCounts = 4096;

  explicit WrongTokens(Logger logger) : logger_(std::move(logger)) {}

  /// The verdict on a token from `peer` (ADDRESS:PORT) at `now`. `right`: whether the token matches. kTooSoon
  /// does not reveal whether it does. `what` the token opens: a right one only forgives wrong ones for the
  /// same thing, so that nobody can guess another's between two of their own.
  TokenVerdict Judge(bool right, const std::string& peer, Nanoseconds now, const std::string& what = {})
      EXCLUDES(mutex_);
  /// The message for `peer` if a token at `now` would be too soon; else empty.
  std::string WaitText(const std::string& peer, Nanoseconds now, const std::string& what = {}) const
      EXCLUDES(mutex_);

 private:
  struct Tries {
    int wrong = 0;
    Nanoseconds last = 0, next = 0;  // time of the last wrong token; earliest time of the next check
  };
  static constexpr const char* kAll = " ";  // ends the key of all tokens from an address
  static std::string KeyOf(const std::string& address, const std::string& what) {
    return address + (what.empty() ? "" : ' ' + what);
  }
  /// How long to wait for a token, for one thing or because of all.
  Nanoseconds WaitOf(const std::string& address, const std::string& what, Nanoseconds now) const
      REQUIRES(mutex_);
  /// Counts a wrong token; returns the number so far.
  int Count(const std::string& key, int free, Nanoseconds now) REQUIRES(mutex_);
  /// Drops all counts without recent tries; if there are none, the one whose last try is oldest.
  void MakeRoom(Nanoseconds now) REQUIRES(mutex_);

  const Logger logger_;
  mutable Mutex mutex_;
  std::unordered_map<std::string, Tries> tries_ GUARDED_BY(mutex_);  // by KeyOf(), or address + kAll
};

/// Decides who may change the world: connections from this machine, and connections that send the token.
class TokenGuard {
 public:
  /// `required`: other machines need the token for commands that change something. An empty token matches
  /// nothing. `wrong`: counts wrong tokens for all guards and outlives them; null: no waits.
  TokenGuard(std::string token, bool required, WrongTokens* wrong = nullptr)
      : token_(std::move(token)), required_(required), wrong_(wrong) {}

  bool required() const { return required_; }
  /// True if `given` is the token. Constant time for wrong tokens of the same length.
  bool Matches(std::string_view given) const;
  /// The verdict on a token that `peer` (ADDRESS:PORT) sends at `now`.
  TokenVerdict Judge(std::string_view given, const std::string& peer, Nanoseconds now) const;
  /// See WrongTokens::WaitText().
  std::string WaitText(const std::string& peer, Nanoseconds now) const {
    return wrong_ == nullptr ? std::string() : wrong_->WaitText(peer, now);
  }

 private:
  std::string token_;
  bool required_;
  WrongTokens* wrong_;
};

}  // namespace coopdyn
