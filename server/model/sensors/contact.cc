// SPDX-License-Identifier: MIT
// Bumpers, and other sensors of contacts.
#include "server/model/sensor_models.h"

#include <algorithm>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void ContactModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  const std::string links = attributes.Text("links").value_or("");
  const std::string collisions = attributes.Text("collisions").value_or("");
  if (auto v = attributes.Number("threshold", 0, 1e9)) threshold_n = *v;
  const auto add = [this](const std::vector<Part>& found) {
    for (const Part& part : found) {
      const bool known = std::ranges::any_of(parts, [&part](const Part& other) {
        return other.link == part.link && other.collision == part.collision;
      });
      if (!known) parts.push_back(part);
    }
  };
  for (const std::string& name : SplitWords(links)) {
    const auto link = source.FindLink(attributes, name);
    if (!link) continue;
    const auto found = CollisionsOf(source.robot, source.assembly, *link);
    if (found.empty()) attributes.Error("the link '" + name + "' has no <collision>");
    add(found);
  }
  for (const std::string& name : SplitWords(collisions)) {
    const std::size_t colons = name.rfind("::");
    if (colons == std::string::npos) {
      attributes.Error("a collision is named with its link, chassis::body, not '" + name + "'");
      continue;
    }
    const auto link = source.FindLink(attributes, name.substr(0, colons));
    if (!link) continue;
    const std::string own = name.substr(colons + 2);
    const auto found = CollisionsOf(source.robot, source.assembly, *link, own);
    if (found.empty())
      attributes.Error("link '" + name.substr(0, colons) + "' has no collision '" + own + "'" +
                       DidYouMean(own, source.assembly.links[*link].collisions));
    add(found);
  }
  if (SplitWords(links).empty() && SplitWords(collisions).empty()) {
    for (std::size_t i = 0; i < source.robot.frames.size(); ++i)
      add(CollisionsOf(source.robot, source.assembly, i));
  }
  source.ForEachChild({"coopdyn:zone"}, [&](XmlAttributes& child, std::string_view) {
    child.Require("bearing_deg");
    child.Require("opening_deg");
    Zone zone;
    zone.bearing_rad = WrapAngle(child.Number("bearing_deg", -180, 180).value_or(0) * kRadPerDeg);
    zone.opening_rad = child.Number("opening_deg", 0.1, 360).value_or(1) * kRadPerDeg;
    zones.push_back(zone);
  });
  std::stable_sort(zones.begin(), zones.end(),
                   [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
}

std::string ContactModel::Text(const RobotModel& /*robot*/) const {
  return CountOf(parts.size(), "shape") + (zones.empty() ? "" : ", " + CountOf(zones.size(), "zone"));
}

}  // namespace coopdyn
