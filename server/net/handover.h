// SPDX-License-Identifier: MIT
// What goes over to the module that takes another one's place: its port, and the connections that outlive it.
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

/// The answer to Incoming::ask, which may come while its connection is between two modules. Any thread.
class AskedAnswer {
 public:
  /// At most once.
  void Give(const Message& answer) {
    const MutexLock lock(mutex_);
    answer_ = answer;
    if (to_) to_(answer);
  }
  /// From now on it is `to` that gets it, at once if it has come; null: nobody for now. `to` only posts.
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

/// A connection without a module.
struct LooseConnection {
  UniqueFd fd = {};
  std::string already_read = {};
  PeerInfo peer = {};
  std::unique_ptr<Encoding> encoding = nullptr;  // null: the first bytes choose
  std::string unsent = {};
  std::shared_ptr<AskedAnswer> awaited = nullptr;  // null: it waits for none
  std::optional<Message> request = {};             // comes before what has been read
};

/// A port that goes on listening: who connects waits until a module accepts.
struct LoosePort {
  int port = 0;
  std::vector<UniqueFd> listening = {};
  std::vector<LooseConnection> connections = {};
};

}  // namespace coopdyn
