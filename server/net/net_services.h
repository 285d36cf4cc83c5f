// SPDX-License-Identifier: MIT
// Services that all servers of a daemon share: log, clock, encodings and client ids. Thread-safe.
#pragma once

#include <atomic>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "server/base/clock.h"
#include "server/base/ids.h"
#include "server/base/log.h"
#include "server/base/mutex.h"
#include "server/net/encoding.h"
#include "server/net/peer.h"

namespace coopdyn {

/// The error text for clients that try to change something.
inline constexpr const char* kReadOnlyText =
    "the daemon was started with --read-only: everything can be read and watched, nothing changed";
/// The error text for students who try to change something while the teacher drives.
inline constexpr const char* kTakenText =
    "the teacher has taken over or frozen this seat: watch, and try again when it is yours";

/// One per daemon; outlives every server. `clock` must outlive it.
class NetServices {
 public:
  /// `read_only`: no client may change anything (`--read-only`). `trusts_this_machine`: clients on this
  /// machine need no token (unless `--token-for-all`).
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
  /// While the teacher drives, the students of this seat may change nothing.
  bool taken() const { return taken_; }
  void SetTaken(bool taken) { taken_ = taken; }
  /// Restricts the daemon's ports to the machines of Admit(), whose users have shown the PIN of this seat and
  /// count as its students.
  void AdmitOnlyKnown() { admits_only_known_ = true; }
  bool admits_only_known() const { return admits_only_known_; }
  /// `peer`: ADDRESS:PORT; the port is ignored.
  void Admit(const std::string& peer) EXCLUDES(admitted_mutex_);
  /// Whether `peer` may connect; makes it a student of the seat if only known ones may.
  bool Admits(PeerInfo& peer) const EXCLUDES(admitted_mutex_);
  /// Why `peer` may change nothing; null if it may.
  const char* WhyReadOnly(const PeerInfo& peer) const {
    return read_only_ ? kReadOnlyText : peer.yields && taken_ ? kTakenText : nullptr;
  }
  /// Returns a connection id that is unique in this daemon.
  ClientId NextClient() { return ++last_client_; }
  /// Logs that a resource, such as open files, has run out: once, until it has not happened for kOver.
  void LogExhausted(const std::string& what);
  static constexpr Nanoseconds kOver = 60 * kNanosecondsPerSecond;
  /// Logs one line about `peer`, unless there were too many within this second.
  void LogPeer(spdlog::level::level_enum level, const std::string& peer, const std::string& text);

 private:
  Logger logger_;
  const Clock& clock_;
  const Encodings encodings_;
  const bool read_only_, trusts_this_machine_;
  std::atomic<bool> taken_{false};
  std::atomic<bool> admits_only_known_{false};
  mutable Mutex admitted_mutex_;
  std::set<std::string> admitted_ GUARDED_BY(admitted_mutex_);  // NetworkOf()
  PeerLogLimiter limiter_;
  std::atomic<ClientId> last_client_{0};
  std::atomic<Nanoseconds> exhausted_{std::numeric_limits<Nanoseconds>::min()};  // time of the last
                                                                                 // LogExhausted(); min: never
};

}  // namespace coopdyn
