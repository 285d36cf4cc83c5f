// SPDX-License-Identifier: MIT
// /R/motors: two motorised wheels on one axle. Constant; any thread.
//
//   left  = (linear − angular · track / 2) / wheel radius        rad/s
//   right = (linear + angular · track / 2) / wheel radius        rad/s
//
// linear in m/s forward, angular in rad/s, left positive. If a wheel would be faster than its limit both are
// scaled by the same factor, so that the curvature stays, and the reply's text says to what. Wheel angles
// (rad) count from the start of the run and are not wrapped; wheel speeds (rad/s) are those of the last step.
// No noise.
#pragma once

#include <optional>

#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class MotorsDevice final : public Device {
 public:
  /// `table` outlives it.
  MotorsDevice(const CommandTable& table, const DriveModel& drive) : table_(table), drive_(drive) {}

  const CommandTable& table() const override { return table_; }
  command::Id first_reading() const override { return command::kGetWheels; }
  bool is_actuator() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<Actuation> Actuate(const Message& request) const override;

 private:
  /// Wheel speeds for forward speed and turn rate, scaled into the limits; `factor`: by how much, 1 = not at
  /// all.
  Setpoint WheelSpeeds(double linear_m_s, double angular_rad_s, double& factor) const;
  /// Scales both by one factor into the limits.
  Setpoint Limit(Setpoint wheels, double& factor) const;

  const CommandTable& table_;
  const DriveModel drive_;
};

}  // namespace coopdyn
