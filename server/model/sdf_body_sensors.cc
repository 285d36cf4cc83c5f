// SPDX-License-Identifier: MIT
// Reads coopdyn's elements of proprioceptive sensors: compass, support, IMU, wrench, contact, battery and
// odometry.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void ReadInto(PoseModel& /*sensor*/, const SensorSource& /*source*/) {}

void ReadInto(CompassModel& sensor, const SensorSource& source) {
  if (auto v = source.attributes.Number("noise_stddev_deg", 0, 180))
    sensor.noise_stddev_rad = *v * kRadPerDeg;
}

void ReadInto(SupportModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("link");
  attributes.Require("height");
  if (auto v = attributes.Text("link")) sensor.link = *v;
  if (auto v = attributes.Number("height", 0, kMaxSensorLength_m)) sensor.height_m = *v;
  if (auto v = attributes.Number("noise_stddev", 0, kMaxSensorLength_m)) sensor.noise_stddev_m = *v;
  if (auto v = attributes.Number("angle_noise_stddev_deg", 0, 180))
    sensor.angle_noise_stddev_rad = *v * kRadPerDeg;
  const auto is_it = [&sensor](const LinkModel& link) { return link.name == sensor.link; };
  if (!sensor.link.empty() && std::ranges::none_of(source.robot.links, is_it)) {
    std::vector<std::string> names;
    for (const LinkModel& link : source.robot.links) names.push_back(link.name);
    attributes.Error("there is no link '" + sensor.link + "'" + DidYouMean(sensor.link, names));
  }
}

void ReadInto(ImuModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  sensor.mount = source.ReadMount(attributes);
  ValueNoise turn, acceleration;
  ReadNoise(attributes, "turn_", turn);
  ReadNoise(attributes, "acceleration_", acceleration);
  sensor.turn_noise.fill(turn);
  sensor.acceleration_noise.fill(acceleration);
  if (auto v = attributes.Number("orientation_noise_stddev_deg", 0, 180))
    sensor.orientation_noise_stddev_rad = *v * kRadPerDeg;
}

void ReadInto(WrenchModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("joint");
  sensor.joint = attributes.Text("joint").value_or("");
  const std::string frame_word = attributes.Text("frame").value_or("child");
  const std::string direction = attributes.Text("direction").value_or("child_to_parent");
  Pose X_JS;
  const auto pose = attributes.Numbers("pose", 6);
  if (pose && frame_word != "sensor")
    attributes.Error("a pose needs frame=\"sensor\": without it the axes are those of a link");
  if (const auto& v = pose)
    X_JS = {Vector3((*v)[0], (*v)[1], (*v)[2]), FromRollPitchYaw((*v)[3], (*v)[4], (*v)[5])};
  ValueNoise force, torque;
  ReadNoise(attributes, "force_", force);
  ReadNoise(attributes, "torque_", torque);
  sensor.force_noise.fill(force);
  sensor.torque_noise.fill(torque);
  const auto frame = ParseWrenchFrame(frame_word);
  if (!frame) attributes.Error("frame is child, parent or sensor, not '" + frame_word + "'");
  if (direction != "child_to_parent" && direction != "parent_to_child") {
    attributes.Error(
        "direction is child_to_parent (what the child does to the parent) or parent_to_child, not '" +
        direction + "'");
  }
  sensor.on_parent = direction != "parent_to_child";
  if (sensor.joint.empty() || !frame) return;
  const std::string wrong = AttachWrench(source.robot, source.assembly, *frame, X_JS, sensor);
  if (!wrong.empty()) attributes.Error(wrong);
}

void ReadInto(ContactModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  const std::string links = attributes.Text("links").value_or("");
  const std::string collisions = attributes.Text("collisions").value_or("");
  if (auto v = attributes.Number("threshold", 0, 1e9)) sensor.threshold_n = *v;
  const auto add = [&sensor](const std::vector<ContactModel::Part>& parts) {
    for (const ContactModel::Part& part : parts) {
      const bool known = std::ranges::any_of(sensor.parts, [&part](const ContactModel::Part& other) {
        return other.link == part.link && other.collision == part.collision;
      });
      if (!known) sensor.parts.push_back(part);
    }
  };
  for (const std::string& name : SplitWords(links)) {
    const auto link = source.FindLink(attributes, name);
    if (!link) continue;
    const auto parts = CollisionsOf(source.robot, source.assembly, *link);
    if (parts.empty()) attributes.Error("the link '" + name + "' has no <collision>");
    add(parts);
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
    const auto parts = CollisionsOf(source.robot, source.assembly, *link, own);
    if (parts.empty())
      attributes.Error("link '" + name.substr(0, colons) + "' has no collision '" + own + "'" +
                       DidYouMean(own, source.assembly.links[*link].collisions));
    add(parts);
  }
  if (SplitWords(links).empty() && SplitWords(collisions).empty()) {
    for (std::size_t i = 0; i < source.robot.frames.size(); ++i)
      add(CollisionsOf(source.robot, source.assembly, i));
  }
  source.ForEachChild({"coopdyn:zone"}, [&](XmlAttributes& child, std::string_view) {
    child.Require("bearing_deg");
    child.Require("opening_deg");
    ContactModel::Zone zone;
    zone.bearing_rad = WrapAngle(child.Number("bearing_deg", -180, 180).value_or(0) * kRadPerDeg);
    zone.opening_rad = child.Number("opening_deg", 0.1, 360).value_or(1) * kRadPerDeg;
    sensor.zones.push_back(zone);
  });
  std::stable_sort(sensor.zones.begin(), sensor.zones.end(),
                   [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
}

void ReadInto(BatteryModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("capacity");
  sensor.capacity_j = attributes.Number("capacity", 1e-3, 1e12).value_or(1);
  if (auto v = attributes.Number("start", 0, 1)) sensor.start = *v;
  if (auto v = attributes.Number("idle", 0, 1e9)) sensor.idle_w = *v;
  if (auto v = attributes.Number("efficiency", 0.01, 1)) sensor.efficiency = *v;
}

void ReadInto(OdometryModel& sensor, const SensorSource& source) {
  if (auto v = source.attributes.Number("resolution_deg", 0, 180)) sensor.resolution_rad = *v * kRadPerDeg;
  if (auto v = source.attributes.Number("slip_stddev", 0, 10)) sensor.slip_stddev = *v;
  if (source.robot.drive() == nullptr)
    source.attributes.Error("needs a <coopdyn:drive>, whose wheels it counts");
}

}  // namespace coopdyn
