// SPDX-License-Identifier: MIT
// The moments that sensors with a rate or a delay show: keeps a copy of the frame in which a sample was taken
// for as long as one of them shows it. A scene without such sensors costs nothing. The stepping thread's.
#pragma once

#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

class SampleKeeper {
 public:
  /// Gives `frame`, which follows the last one, its samples. A new epoch begins with a sample.
  void AddTo(Frame& frame);
  /// Goes on from `frame`, as a frame of `epoch`.
  void Continue(const Frame& frame, std::uint64_t epoch) {
    epoch_ = epoch;
    held_ = frame.samples;
  }

  /// The scene is that of `now` from here on: what the samples have of it is kept; a sensor with a new timing
  /// begins with `now`.
  void Refit(const Frame& now, const std::vector<SensorTiming>& before);

  /// Which sample was taken last at `time`, counted from 0.
  static std::int64_t SampleAt(const SensorTiming& timing, Nanoseconds time);
  /// How many steps before `time` the sample was taken that is shown then, if all steps last `length`.
  static std::uint64_t StepsBack(const SensorTiming& timing, Nanoseconds time, Nanoseconds length);
  /// What sensing needs of `frame`, without samples.
  static FramePtr Copy(const Frame& frame);

 private:
  std::uint64_t epoch_ = 0;
  std::vector<FrameSamples> held_;  // as Scene::clocks
};

}  // namespace coopdyn
