// SPDX-License-Identifier: MIT
// Odometry.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"

namespace coopdyn {

void OdometryModel::Read(const SensorSource& source) {
  if (auto v = source.attributes.Number("resolution_deg", 0, 180)) resolution_rad = *v * kRadPerDeg;
  if (auto v = source.attributes.Number("slip_stddev", 0, 10)) slip_stddev = *v;
  if (source.robot.drive() == nullptr)
    source.attributes.Error("needs a <coopdyn:drive>, whose wheels it counts");
}

}  // namespace coopdyn
