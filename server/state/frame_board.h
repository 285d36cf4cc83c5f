// SPDX-License-Identifier: MIT
// The newest frame: one writer at a time (the holder of the step baton, in playback the player), any number
// of readers. A reader holds a whole frame, so it never sees half a step. It blocks the writer for one
// pointer copy at most.
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
