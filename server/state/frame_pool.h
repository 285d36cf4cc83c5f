// SPDX-License-Identifier: MIT
// Reuses the buffers of frames without holders: a swarm's frame has hundreds of kilobytes, which
// the system's allocator would map and clear in every step.
#pragma once

#include <memory>

#include "server/state/frame.h"

namespace coopdyn {

class FramePool {
 public:
  FramePool();
  /// Returns an empty frame. Its buffers return to the pool when the last reader releases it, on any thread,
  /// even if the pool is gone. Stepping thread.
  std::shared_ptr<Frame> Take();

 private:
  class Store;
  std::shared_ptr<Store> store_;
};

}  // namespace coopdyn
