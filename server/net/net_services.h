// SPDX-License-Identifier: MIT
// What every server of one daemon shares: the log, the clock, the encodings and the ids of clients. Any
// thread.
#pragma once

#include <atomic>
#include <limits>
#include <string>
#include <utility>

#include "server/base/clock.h"
#include "server/base/ids.h"
#include "server/base/log.h"
#include "server/net/encoding.h"

namespace coopdyn {

/// What who wants to change something is told.
inline constexpr const char* kReadOnlyText =
    "the daemon was started with --read-only: everything can be read and watched, nothing changed";

/// One per daemon; outlives every server. `clock` must outlive it.
class NetServices {
 public:
  /// `read_only`: no client may change anything (`--read-only`). `trusts_this_machine`: whoever connects from
  /// this machine needs no token (not with `--token-for-all`).
  NetServices(Logger logger, const Clock& clock, Encodings encodings = StandardEncodings(),
              bool read_only = false, bool trusts_this_machine = true)
      : logger_(std::move(logger)),
        clock_(clock),
        encodings_(std::move(encodings)),
        read_only_(read_only),
        trusts_this_machine_(trusts_this_machine) {}

  const Logger& logger() const { return logger_; }
  const Clock& clock() const { return clock_; }
  const Encodings& encodings() const { return encodings_; }
  bool read_only() const { return read_only_; }
  bool trusts_this_machine() const { return trusts_this_machine_; }
  /// An id that no other connection of this daemon has or had.
  ClientId NextClient() { return ++last_client_; }
  /// Says in the log what cannot be done for want of something, such as open files: once, until that has been
  /// over for kOver.
  void LogExhausted(const std::string& what);
  static constexpr Nanoseconds kOver = 60 * kNanosecondsPerSecond;
  /// One log line about `peer`, unless it has caused too many within this second.
  void LogPeer(spdlog::level::level_enum level, const std::string& peer, const std::string& text);

 private:
  Logger logger_;
  const Clock& clock_;
  const Encodings encodings_;
  const bool read_only_, trusts_this_machine_;
  PeerLogLimiter limiter_;
  std::atomic<ClientId> last_client_{0};
  std::atomic<Nanoseconds> exhausted_{std::numeric_limits<Nanoseconds>::min()};  // last; min: never
};

}  // namespace coopdyn
