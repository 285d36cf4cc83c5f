// SPDX-License-Identifier: MIT
// The newest frame: one writer at a time (the holder of the step baton, in playback the player), any number
// of readers. A reader holds a whole frame, so it never sees half a step. It blocks the writer for one
// pointer copy at most.
#pragma once

#include <utility>

#include "server/base/mutex.h"
#include "server/state/frame.h"

namespace coopdyn {

class FrameBoard {
 public:
  /// Makes `frame` the newest. Writer only.
  void Publish(FramePtr frame) EXCLUDES(mutex_) {
    {
      const MutexLock lock(mutex_);
      std::swap(latest_, frame);
    }
    // The frame before is let go here, outside the lock: freeing it must not hold up readers.
  }
  /// The newest frame, or null before the first Publish(). Any thread.
  FramePtr Latest() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return latest_;
  }

 private:
  mutable Mutex mutex_;
  FramePtr latest_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
