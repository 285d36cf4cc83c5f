// SPDX-License-Identifier: MIT
// Looks from any thread whether the input of a session's socket has ended.
#pragma once

#include "server/base/input_end.h"
#include "server/base/mutex.h"
#include "server/net/peer.h"

namespace coopdyn {

class SocketEnd final : public InputEnd {
 public:
  explicit SocketEnd(int fd) : fd_(fd) {}

  /// The session is about to close its socket or to give it away.
  void Forget() {
    const MutexLock lock(mutex_);
    fd_ = -1;
    Note();
  }

 private:
  bool HasCome() override {
    const MutexLock lock(mutex_);
    return fd_ < 0 || PeerHasEnded(fd_);
  }

  Mutex mutex_;
  int fd_ GUARDED_BY(mutex_);  // open; −1: not the session's any more
};

}  // namespace coopdyn
