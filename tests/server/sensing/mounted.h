// SPDX-License-Identifier: MIT
// A sensor on top of the sample robot.
#pragma once

#include <limits>
#include <memory>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::range_sensors {

inline constexpr double kEye_m = 0.5;  // height of the sensors, above the sample robot
inline constexpr double kInf = std::numeric_limits<double>::infinity();

inline Pose Stands(double x, double y, double z) {
  return {{x, y, z}, Quaternion::Identity()};
}

/// On the chassis, whose frame is 5 cm above R.
inline Mount OnTop(const Quaternion& q = Quaternion::Identity()) {
  return {0, {{0, 0, kEye_m - 0.05}, q}};
}

template <typename Kind>
std::shared_ptr<RobotModel> With(const Kind& sensor) {
  auto model = SampleRobot();
  model->AddSensor("sensor", sensor);
  return model;
}

}  // namespace coopdyn::range_sensors
