// SPDX-License-Identifier: MIT
#include "server/sensing/readings.h"

namespace coopdyn {

BatteryReading Battery(const Frame& frame, int robot, std::size_t number) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* model = robot_model.Find<BatteryModel>(number);
  if (model == nullptr) return {};
  const std::span<const double> measured =
      MeasuredOf(frame, robot, robot_model.IndexOf<BatteryModel>(number));
  if (measured.empty()) return {};
  return {measured[0], model->capacity_j > 0 ? measured[0] / model->capacity_j : 0, measured[1]};
}

}  // namespace coopdyn
