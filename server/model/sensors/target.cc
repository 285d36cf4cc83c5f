// SPDX-License-Identifier: MIT
// Vision of targets and other robots.
#include "server/model/sensor_models.h"

#include <cmath>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void TargetModel::Read(const SensorSource& source) {
  if (auto v = source.attributes.Number("max_range", 1e-3, kMaxSensorLength_m)) max_range_m = *v;
  if (auto v = source.attributes.Flag("see_through")) see_through = *v;
  ReadSightNoise(*this, source.attributes);
}

std::string TargetModel::Text(const RobotModel& /*robot*/) const {
  return std::isfinite(max_range_m) ? "to " + Rounded4(max_range_m) + " m" : "";
}

}  // namespace coopdyn
