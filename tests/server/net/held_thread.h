// SPDX-License-Identifier: MIT
// Makes a thread read no sockets for a while, as if busy.
#pragma once

#include <future>

#include "server/net/io_thread.h"

namespace coopdyn {

/// Holds the thread during its lifetime.
class HeldThread {
 public:
  explicit HeldThread(IoThread& thread) {
    std::promise<void> begun;
    thread.Post([&begun, go_on = go_on_.get_future().share()] {
      begun.set_value();
      go_on.wait();
    });
    begun.get_future().wait();
  }
  ~HeldThread() { go_on_.set_value(); }
  HeldThread(const HeldThread&) = delete;
  HeldThread& operator=(const HeldThread&) = delete;

 private:
  std::promise<void> go_on_;
};

}  // namespace coopdyn
