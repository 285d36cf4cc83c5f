// SPDX-License-Identifier: MIT
// The compass: the heading of the robot's x axis in the world.
#include "server/sensing/readings.h"
#include "server/state/noise.h"

namespace coopdyn {

double CompassHeading(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<CompassModel>(number);
  if (model == nullptr) return std::numeric_limits<double>::quiet_NaN();
  double heading_rad = Heading(RobotPose(frame, robot).q);
  if (model->noise_stddev_rad > 0) {
    const std::uint32_t id = frame.scene->robots[static_cast<std::size_t>(robot)].id.value;
    const auto sensor = static_cast<std::uint32_t>(number + 1);
    const NoiseKey key{frame.seed, NoiseKind::kCompass, id, sensor, frame.step, 0};
    heading_rad += model->noise_stddev_rad * GaussianNoise(key);
  }
  return WrapAngle(heading_rad);
}

}  // namespace coopdyn
