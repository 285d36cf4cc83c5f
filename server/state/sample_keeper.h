// SPDX-License-Identifier: MIT
// Keeps the frames shown by sensors with a rate or a delay: copies the frame in which a sample is taken and
// keeps the copy while any sensor shows it. Costs nothing in a scene without such sensors. Stepping thread.
#pragma once

#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

class SampleKeeper {
 public:
  /// Adds the samples to `frame`, which follows the last one. A new epoch begins with a sample.
  void AddTo(Frame& frame);
  /// Continues from `frame`, as a frame of `epoch`.
  void Continue(const Frame& frame, std::uint64_t epoch) {
    epoch_ = epoch;
    held_ = frame.samples;
  }

  /// Adapts the samples to the scene of `now`: keeps the state of things in both scenes; a sensor with a new
  /// timing starts with a sample of `now`. `before`: the old scene's clocks.
  void Refit(const Frame& now, const std::vector<SensorTiming>& before);

  /// The number, from 0, of the last sample taken at or before `time`.
  static std::int64_t SampleAt(const SensorTiming& timing, Nanoseconds time);
  /// The number of steps from the sample shown at `time` to `time`, if all steps last `length`.
  static std::uint64_t StepsBack(const SensorTiming& timing, Nanoseconds time, Nanoseconds length);
  /// A copy of the parts of `frame` that sensing needs, without samples.
  static FramePtr Copy(const Frame& frame);

 private:
  std::uint64_t epoch_ = 0;
  std::vector<FrameSamples> held_;  // as Scene::clocks
};

}  // namespace coopdyn
