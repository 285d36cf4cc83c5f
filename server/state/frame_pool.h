// SPDX-License-Identifier: MIT
// Makes frames out of the buffers of frames that nobody holds any more: a swarm's frame is hundreds of
// kilobytes, which the system's allocator would map and clear afresh each step.
#pragma once

#include <memory>

#include "server/state/frame.h"

namespace coopdyn {

class FramePool {
 public:
  FramePool();
  /// An empty frame. Its buffers come back when the last reader lets it go, on whatever thread, also when the
  /// pool is gone. The stepping thread.
  std::shared_ptr<Frame> Take();

 private:
  class Store;
  std::shared_ptr<Store> store_;
};

}  // namespace coopdyn
