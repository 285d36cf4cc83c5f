// SPDX-License-Identifier: MIT
// The support that gives way under a load.
#include "server/model/sensor_models.h"

#include <algorithm>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void SupportModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("link");
  attributes.Require("height");
  if (auto v = attributes.Text("link")) link = *v;
  if (auto v = attributes.Number("height", 0, kMaxSensorLength_m)) height_m = *v;
  if (auto v = attributes.Number("noise_stddev", 0, kMaxSensorLength_m)) noise_stddev_m = *v;
  if (auto v = attributes.Number("angle_noise_stddev_deg", 0, 180)) angle_noise_stddev_rad = *v * kRadPerDeg;
  if (!link.empty() &&
      std::ranges::find(source.robot.links, link, &LinkModel::name) == source.robot.links.end()) {
    std::vector<std::string> names;
    for (const LinkModel& one : source.robot.links) names.push_back(one.name);
    attributes.Error("there is no link '" + link + "'" + DidYouMean(link, names));
  }
}

std::string SupportModel::Text(const RobotModel& /*robot*/) const {
  return "of " + link;
}

}  // namespace coopdyn
