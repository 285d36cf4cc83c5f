// SPDX-License-Identifier: MIT
// /R/pose: where the robot is and how it moves: ground truth in the world frame W, of frame R (on the floor
// under the middle of the axle, x forward). get_pose: x, y (m), heading (rad, in (−π, π]), forward speed
// along the heading (m/s), turn rate about the vertical (rad/s). get_pose_3d: position (m), quaternion w x y
// z, velocity of R's origin (m/s), angular velocity (rad/s). No noise. Constant; any thread.
#pragma once

#include "server/devices/device.h"

namespace coopdyn {

class PoseDevice final : public Device {
 public:
  /// `table` outlives it.
  explicit PoseDevice(const CommandTable& table) : table_(table) {}

  const CommandTable& table() const override { return table_; }
  command::Id first_reading() const override { return command::kGetPose; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;

 private:
  const CommandTable& table_;
};

}  // namespace coopdyn
