// SPDX-License-Identifier: MIT
// The end of what a client sends: it has shut down its sending side, closed its connection, or died. Whoever
// wants what the client owns may look for it, before the connection's own thread has read it.
#pragma once

#include <atomic>

namespace coopdyn {

/// Of one connection. Any thread.
class InputEnd {
 public:
  InputEnd() = default;
  virtual ~InputEnd() = default;
  InputEnd(const InputEnd&) = delete;
  InputEnd& operator=(const InputEnd&) = delete;

  /// Somebody has seen it. Without lock.
  bool is_known() const { return known_.load(std::memory_order_acquire); }
  void Note() { known_.store(true, std::memory_order_release); }
  /// Looks for it; once it has come it is known. Takes a lock: never to be called with one held.
  bool Look() {
    if (!is_known() && HasCome()) Note();
    return is_known();
  }

 private:
  virtual bool HasCome() = 0;

  std::atomic<bool> known_{false};
};

}  // namespace coopdyn
