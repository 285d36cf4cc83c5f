// SPDX-License-Identifier: MIT
// The support: how far its load has moved it from its place on the robot.
#include <algorithm>

#include "server/sensing/readings.h"
#include "server/state/noise.h"

namespace coopdyn {

SupportReading Support(const Frame& frame, int robot, std::size_t number) {
  SupportReading reading;
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* model = robot_model.Find<SupportModel>(number);
  if (model == nullptr) return reading;
  const auto link = std::ranges::find(robot_model.links, model->link, &LinkModel::name);
  if (link == robot_model.links.end()) return reading;
  const auto index = static_cast<int>(link - robot_model.links.begin());
  const Pose X_RL = RobotPose(frame, robot).Inverse() * LinkPose(frame, robot, index);
  const Vector3 moved = X_RL.p - link->X_RL.p;
  reading = {moved.x(), moved.y(), Heading(X_RL.q * link->X_RL.q.conjugate())};
  const std::uint32_t id = frame.scene->robots[static_cast<std::size_t>(robot)].id.value;
  const auto noise = [&](double stddev, std::uint32_t sample) {
    const auto sensor = static_cast<std::uint32_t>(number + 1);
    return stddev > 0
               ? stddev * GaussianNoise({frame.seed, NoiseKind::kSupport, id, sensor, frame.step, sample})
               : 0;
  };
  reading.x_m += noise(model->noise_stddev_m, 0);
  reading.y_m += noise(model->noise_stddev_m, 1);
  reading.angle_rad = WrapAngle(reading.angle_rad + noise(model->angle_noise_stddev_rad, 2));
  return reading;
}

}  // namespace coopdyn
