// SPDX-License-Identifier: MIT
// A small recording in closed form, for the tests of reader and player: two robots and a ball. Step k is at
// k × 10 ms; body i moves along x at 0.2 (i + 1) m/s from x = i and turns about z at 0.5 rad/s. Every third
// step a client gives robot 0 the set-points {0.01 k, −0.01 k}; every fifth step robot 1 broadcasts {k}.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/model/readers.h"
#include "server/record/run_writer.h"
#include "server/state/frame.h"
#include "tests/server/base/temp_folder.h"

namespace coopdyn {

/// The folder of the shipped robots.
SearchPath SourcePath();

class SampleRun {
 public:
  explicit SampleRun(const std::string& text = kText);
  const std::shared_ptr<const Scenario>& scenario() const { return scene_->scenario; }
  /// The exact frame of step k of the run.
  FramePtr FrameAt(std::uint64_t step) const;
  SavedState StateAt(std::uint64_t step) const;

  struct Options {
    std::uint64_t steps = 20;                  // after the first frame
    std::uint64_t keyframe_every = 8;          // steps
    Nanoseconds pose_every = 0;                // simulated time
    std::uint64_t lost_from = 0, lost_to = 0;  // steps left out; 0: none
    bool close = true;
    std::size_t page_size = 0;
    bool channels = true;  // are recorded
  };
  /// Writes steps 0 … options.steps to `file`; returns the writer, committed unless it was closed.
  std::unique_ptr<RunWriter> Write(const std::string& file, const Options& options) const;
  std::unique_ptr<RunWriter> Write(const std::string& file) const { return Write(file, Options()); }
  /// Adds steps first … last, and a keyframe each `keyframe_every`, and commits.
  void Append(RunWriter& writer, std::uint64_t first, std::uint64_t last,
              std::uint64_t keyframe_every = 8) const;

  static constexpr Nanoseconds kStep = 10'000'000;
  static const char* const kText;

 private:
  std::shared_ptr<const Scene> scene_;
};

}  // namespace coopdyn
