// SPDX-License-Identifier: MIT
// Batteries.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void BatteryModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("capacity");
  capacity_j = attributes.Number("capacity", 1e-3, 1e12).value_or(1);
  if (auto v = attributes.Number("start", 0, 1)) start = *v;
  if (auto v = attributes.Number("idle", 0, 1e9)) idle_w = *v;
  if (auto v = attributes.Number("efficiency", 0.01, 1)) efficiency = *v;
}

std::string BatteryModel::Text(const RobotModel& /*robot*/) const {
  return Rounded4(capacity_j) + " J";
}

}  // namespace coopdyn
