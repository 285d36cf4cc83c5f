// SPDX-License-Identifier: MIT
// /R/motors: two motorised wheels on one axle. Constant; any thread.
// Commands become wheel speeds as server/model/drive.h says; if they had to be scaled the reply's text says
// to what. Wheel angles (rad) count from the start of the run and are not wrapped; wheel speeds (rad/s) are
// those of the last step. No noise.
#pragma once

#include <optional>

#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class MotorsDevice final : public Device {
 public:
  /// `table` outlives it.
  /// `first_channel`: of the left wheel among the robot's; the right one follows.
  MotorsDevice(const CommandTable& table, const DriveModel& drive, std::size_t first_channel)
      : Device(table), drive_(drive), first_channel_(first_channel) {}

  bool is_actuator() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<Actuation> Actuate(const Message& request) const override;

 private:
  const DriveModel drive_;
  const std::size_t first_channel_;
};

}  // namespace coopdyn
