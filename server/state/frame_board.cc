// SPDX-License-Identifier: MIT
#include "server/state/frame_board.h"

#include <utility>

namespace coopdyn {

void FrameBoard::Publish(FramePtr frame) {
  {
    const MutexLock lock(mutex_);
    std::swap(latest_, frame);
  }
  // The frame before is let go here, outside the lock: freeing it must not hold up readers.
}

FramePtr FrameBoard::Latest() const {
  const MutexLock lock(mutex_);
  return latest_;
}

}  // namespace coopdyn
