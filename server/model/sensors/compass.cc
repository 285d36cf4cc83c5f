// SPDX-License-Identifier: MIT
// The compass.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"

namespace coopdyn {

void CompassModel::Read(const SensorSource& source) {
  if (auto v = source.attributes.Number("noise_stddev_deg", 0, 180)) noise_stddev_rad = *v * kRadPerDeg;
}

}  // namespace coopdyn
