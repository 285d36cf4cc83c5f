// SPDX-License-Identifier: MIT
// The pose memory: one writer (physics or player), any number of readers. A reader holds a whole frame, so it
// never sees half a step and never blocks physics for longer than one pointer copy.
#pragma once

#include <cstdint>

#include "server/base/mutex.h"
#include "server/state/frame.h"

namespace coopdyn {

class FrameBoard {
 public:
  /// Makes `frame` the newest. Writer only.
  void Publish(FramePtr frame) EXCLUDES(mutex_);
  /// The newest frame, or null before the first Publish(). Any thread.
  FramePtr Latest() const EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  FramePtr latest_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
