// SPDX-License-Identifier: MIT
#include "server/net/net_services.h"

#include "server/base/wrong_tokens.h"

namespace coopdyn {

void NetServices::LogExhausted(const std::string& what) {
  const Nanoseconds now = clock_.Now();
  const Nanoseconds before = exhausted_.exchange(now);
  if (before != std::numeric_limits<Nanoseconds>::min() && now - before < kOver) return;
  logger_->error("{} (raise `ulimit -n`)", what);
}

void NetServices::Admit(const std::string& peer) {
  const MutexLock lock(admitted_mutex_);
  admitted_.insert(NetworkOf(peer));
}

bool NetServices::Admits(PeerInfo& peer) const {
  if (!admits_only_known_) return true;
  peer.trusted = true;
  peer.yields = true;
  const MutexLock lock(admitted_mutex_);
  return admitted_.contains(NetworkOf(peer.text));
}

void NetServices::LogPeer(spdlog::level::level_enum level, const std::string& peer, const std::string& text) {
  if (!logger_->should_log(level)) return;
  std::int64_t suppressed = 0;
  // By address, not by port: a peer that reconnects for every line is one peer.
  if (!limiter_.Allow(peer.substr(0, peer.rfind(':')), clock_.Now(), suppressed)) return;
  if (suppressed > 0) {
    logger_->log(level, "{}: {} ({} lines about it left out)", peer, text, suppressed);
  } else {
    logger_->log(level, "{}: {}", peer, text);
  }
}

}  // namespace coopdyn
