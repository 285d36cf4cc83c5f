// SPDX-License-Identifier: MIT
// Robots nearby, and what they broadcast.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void NeighboursModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("range");
  if (auto v = attributes.Number("range", 1e-3, kMaxSensorLength_m)) range_m = *v;
  message_range_m = attributes.Number("message_range", 0, kMaxSensorLength_m).value_or(range_m);
  if (auto v = attributes.Number("loss", 0, 1)) loss = *v;
  if (auto v = attributes.Integer("delay_steps", 0, kMaxDelaySteps)) delay_steps = *v;
  ReadSightNoise(*this, attributes);
}

std::string NeighboursModel::Text(const RobotModel& /*robot*/) const {
  return "to " + Rounded4(range_m) + " m";
}

}  // namespace coopdyn
