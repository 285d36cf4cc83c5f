// SPDX-License-Identifier: MIT
// Inertial measurement units.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"
#include "server/model/sensor_text.h"

namespace coopdyn {

void ImuModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  mount = source.ReadMount(attributes);
  ValueNoise turn, acceleration;
  ReadNoise(attributes, "turn_", turn);
  ReadNoise(attributes, "acceleration_", acceleration);
  turn_noise.fill(turn);
  acceleration_noise.fill(acceleration);
  if (auto v = attributes.Number("orientation_noise_stddev_deg", 0, 180))
    orientation_noise_stddev_rad = *v * kRadPerDeg;
}

std::string ImuModel::Text(const RobotModel& robot) const {
  return On(mount, robot);
}

}  // namespace coopdyn
