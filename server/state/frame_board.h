// SPDX-License-Identifier: MIT
// Holds the newest frame: one writer at a time (the holder of the step baton, in playback the player), any
// number of readers. A reader holds a whole frame and never sees half a step. It blocks the writer for at
// most one pointer copy.
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
    // Releases the previous frame outside the lock: freeing it must not block readers.
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
