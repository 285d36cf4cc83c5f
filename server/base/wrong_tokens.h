// SPDX-License-Identifier: MIT
// Wrong tokens, counted by the address that they come from: who has tried several waits before the next is
// looked at, so that nobody finds a token by trying. Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/mutex.h"

namespace coopdyn {

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

}  // namespace coopdyn
