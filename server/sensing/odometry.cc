// SPDX-License-Identifier: MIT
#include "server/sensing/readings.h"

namespace coopdyn {

OdometryReading Odometry(const Frame& frame, int robot, std::size_t number) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* model = robot_model.Find<OdometryModel>(number);
  if (model == nullptr) return {};
  const std::span<const double> measured =
      MeasuredOf(frame, robot, robot_model.IndexOf<OdometryModel>(number));
  if (measured.empty()) return {};
  return {measured[0], measured[1], WrapAngle(measured[2]), measured[3], measured[4]};
}

}  // namespace coopdyn
