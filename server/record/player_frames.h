// SPDX-License-Identifier: MIT
// Makes frames of a recording: recorded poses and wheels (nan if they were not recorded), velocities from the
// difference to the poses before, set-points and broadcasts as they were in force. Of the first step, whose
// exact state is there, the exact velocities. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "server/record/player_inputs.h"
#include "server/record/run_reader.h"
#include "server/state/frame_pool.h"

namespace coopdyn {

class PlayFrames {
 public:
  explicit PlayFrames(RunReader& reader) : reader_(reader), inputs_(reader) {}

  /// The frame of `step`, which has poses. Null, and the reader's error() says why, if the file is damaged.
  std::shared_ptr<Frame> Make(std::uint64_t step);

 private:
  std::optional<RecordedStep> Read(std::uint64_t step);
  /// Fills in the velocities of the bodies of `frame`; false if the file is damaged.
  bool AddVelocities(const RecordedStep& now, Frame& frame);

  RunReader& reader_;
  PlayInputs inputs_;
  FramePool pool_;
  std::optional<RecordedStep> newest_;  // made last: mostly the one before
};

/// The angular velocity, rad/s in the world, that turns `from` into `to` within `seconds` the short way.
Vector3 AngularVelocity(const Quaternion& from, const Quaternion& to, double seconds);

}  // namespace coopdyn
