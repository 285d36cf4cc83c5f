// SPDX-License-Identifier: MIT
// State passed to a module's successor: its port, and the connections that outlive the module.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/mutex.h"
#include "server/net/encoding.h"
#include "server/net/endpoint.h"
#include "server/net/peer.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

/// The answer to Incoming::ask, which may arrive while its connection is between two modules. Thread-safe.
class PendingAnswer {
 public:
  /// Call at most once.
  void Give(const Message& answer) {
    const MutexLock lock(mutex_);
    answer_ = answer;
    if (to_) to_(answer);
  }
  /// Redirects the answer to `to`, at once if it has arrived; null holds it back. `to` must only post.
  void GoTo(ReplyFunction to) {
    const MutexLock lock(mutex_);
    to_ = std::move(to);
    if (to_ && answer_) to_(*answer_);
  }

 private:
  Mutex mutex_;
  ReplyFunction to_ GUARDED_BY(mutex_);
  std::optional<Message> answer_ GUARDED_BY(mutex_);
};

/// A connection that belongs to no module.
struct DetachedConnection {
  UniqueFd fd = {};
  std::string already_read = {};
  PeerInfo peer = {};
  std::unique_ptr<Encoding> encoding = nullptr;  // null: the first bytes choose
  std::string unsent = {};
  std::shared_ptr<PendingAnswer> awaited = nullptr;  // null: no answer is pending
  std::optional<Message> request = {};               // handled before already_read
};

/// A port that keeps listening: new connections wait until a module accepts them.
struct LoosePort {
  int port = 0;
  std::vector<UniqueFd> listening = {};
  std::vector<DetachedConnection> connections = {};
};

}  // namespace coopdyn
