// SPDX-License-Identifier: MIT
// Checks from any thread whether a session's socket has reached the end of its input.
#pragma once

#include "server/base/input_end.h"
#include "server/base/mutex.h"
#include "server/net/peer.h"

namespace coopdyn {

class SocketEnd final : public InputEnd {
 public:
  explicit SocketEnd(int fd) : fd_(fd) {}

  /// Call before the session closes its socket or gives it away.
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
  int fd_ GUARDED_BY(mutex_);  // −1 after Forget()
};

}  // namespace coopdyn
