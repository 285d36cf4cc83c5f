// SPDX-License-Identifier: MIT
// Force and torque through a joint: measured by physics, with noise.
#include "server/sensing/readings.h"
#include "server/state/noise.h"

namespace coopdyn {

std::optional<WrenchReading> Wrench(const Frame& frame, int robot, std::size_t number) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* model = robot_model.Find<WrenchModel>(number);
  if (model == nullptr) return std::nullopt;
  WrenchReading reading;
  const std::span<const double> measured = MeasuredOf(frame, robot, robot_model.IndexOf<WrenchModel>(number));
  if (measured.empty()) return reading;
  NoiseKey key{frame.seed,
               NoiseKind::kWrench,
               frame.scene->robots[static_cast<std::size_t>(robot)].id.value,
               static_cast<std::uint32_t>(number + 1),
               frame.step,
               0};
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    key.sample = axis;
    reading.force_S[axis] = Noisy(measured[axis], model->force_noise[axis], key);
    key.sample = axis + 3;
    reading.torque_S[axis] = Noisy(measured[axis + 3], model->torque_noise[axis], key);
  }
  return reading;
}

}  // namespace coopdyn
