// SPDX-License-Identifier: MIT
// /R/target: the vision module. Distance (m, in the plane, from the middle of the axle) and bearing (rad, 0
// ahead, left positive, in (−π, π]) of targets and of other robots. Range, hiding and Gaussian noise as the
// robot's model says; the noise is a function of (seed, thing seen, step). Constant; any thread.
#pragma once

#include "server/devices/device.h"

namespace coopdyn {

class TargetDevice final : public Device {
 public:
  /// `table` outlives it.
  explicit TargetDevice(const CommandTable& table) : table_(table) {}

  const CommandTable& table() const override { return table_; }
  command::Id first_reading() const override { return command::kGetTargets; }
  /// get_target: error 10 if no such target is seen.
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;

 private:
  static Message ReadTarget(const Message& request, const Frame& frame, int robot);

  const CommandTable& table_;
};

}  // namespace coopdyn
