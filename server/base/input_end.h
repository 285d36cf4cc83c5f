// SPDX-License-Identifier: MIT
// The end of a client's input: the client has shut down its sending side, closed its connection, or died.
// A client that wants something that another one owns can check for the owner's end of input before the
// owner's connection thread has read it.
#pragma once

#include <atomic>

namespace coopdyn {

/// The end of input of one connection. Any thread.
class InputEnd {
 public:
  InputEnd() = default;
  virtual ~InputEnd() = default;
  InputEnd(const InputEnd&) = delete;
  InputEnd& operator=(const InputEnd&) = delete;

  /// True once the end has been noted. Lock-free.
  bool is_known() const { return known_.load(std::memory_order_acquire); }
  void Note() { known_.store(true, std::memory_order_release); }
  /// Checks for the end and notes it. Takes a lock: never call it with a lock held.
  bool Look() {
    if (!is_known() && HasCome()) Note();
    return is_known();
  }

 private:
  virtual bool HasCome() = 0;

  std::atomic<bool> known_{false};
};

}  // namespace coopdyn
