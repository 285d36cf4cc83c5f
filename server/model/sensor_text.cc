// SPDX-License-Identifier: MIT
#include "server/model/sensor_text.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/model/values.h"

namespace coopdyn {

namespace {

std::string Rounded4(double value) {
  return FormatNumber(std::round(value * 1e4) / 1e4);
}
std::string Several(std::size_t count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}
std::string Span(double min_m, double max_m) {
  return Rounded4(min_m) + " to " + Rounded4(max_m) + " m";
}
std::string On(const Mount& mount, const RobotModel& robot) {
  return "on " + robot.links[static_cast<std::size_t>(mount.link)].name;
}

struct Describer {
  const RobotModel& robot;

  std::string operator()(const DistanceModel& one) const {
    double most_m = 0;
    for (const SectorModel& sector : one.sectors) most_m = std::max(most_m, sector.max_range_m);
    return Several(one.sectors.size(), "sector") + ", to " + Rounded4(most_m) + " m";
  }
  std::string operator()(const TargetModel& one) const {
    return std::isfinite(one.max_range_m) ? "to " + Rounded4(one.max_range_m) + " m" : "";
  }
  std::string operator()(const PoseModel& /*one*/) const { return ""; }
  std::string operator()(const NeighboursModel& one) const { return "to " + Rounded4(one.range_m) + " m"; }
  std::string operator()(const CompassModel& /*one*/) const { return ""; }
  std::string operator()(const SupportModel& one) const { return "of " + one.link; }
  std::string operator()(const ImuModel& one) const { return On(one.mount, robot); }
  std::string operator()(const WrenchModel& one) const {
    double mass_kg = one.part.mass_kg;
    for (const int link : one.beyond) mass_kg += robot.links[static_cast<std::size_t>(link)].mass_kg;
    return "at " + one.joint + ", on which " + Rounded4(mass_kg) + " kg hang";
  }
  std::string operator()(const LidarModel& one) const {
    return Several(one.rays(), "ray") + ", " + Span(one.min_range_m, one.max_range_m) + ", " +
           On(one.mount, robot);
  }
  std::string operator()(const ContactModel& one) const {
    return Several(one.parts.size(), "shape") +
           (one.zones.empty() ? "" : ", " + Several(one.zones.size(), "zone"));
  }
  std::string operator()(const SonarModel& one) const {
    if (one.beams.empty()) return "";
    return Several(one.beams.size(), "beam") + ", " +
           Span(one.beams.front().min_range_m, one.beams.front().max_range_m);
  }
  std::string operator()(const InfraredModel& one) const {
    return Several(one.eyes.size(), "eye") + ", to " + Rounded4(one.max_range_m) + " m";
  }
  std::string operator()(const LightModel& one) const { return Several(one.eyes.size(), "eye"); }
  std::string operator()(const CameraModel& one) const {
    return std::to_string(one.width) + " x " + std::to_string(one.height) + ", " +
           Rounded4(one.horizontal_fov_rad * 180 / std::numbers::pi) + " degrees wide, " +
           Span(one.near_m, one.far_m) + ", " + On(one.mount, robot);
  }
  std::string operator()(const BatteryModel& one) const { return Rounded4(one.capacity_j) + " J"; }
  std::string operator()(const OdometryModel& /*one*/) const { return ""; }
  std::string operator()(const ChannelModel& one) const {
    return Several(one.motors.size(), "motor") + ", " + Several(one.values.size(), "value") +
           (one.steps > 1 ? ", every " + Several(static_cast<std::size_t>(one.steps), "step") : "");
  }
};

}  // namespace

std::string Describe(const SensorModel& sensor, const RobotModel& robot) {
  std::string text = std::visit(Describer{robot}, sensor.kind);
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
  if (sensor.timing.rate_hz > 0) add(Rounded4(sensor.timing.rate_hz) + " Hz");
  if (sensor.timing.delay_s > 0) add(Rounded4(sensor.timing.delay_s) + " s late");
  return text;
}

}  // namespace coopdyn
