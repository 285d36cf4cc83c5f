// SPDX-License-Identifier: MIT
// Sonars.
#include "server/model/sensor_models.h"

#include <numbers>

#include "server/base/portable_math.h"
#include "server/model/sdf_sensors.h"
#include "server/model/sensor_text.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Reads values of `<coopdyn:sonar>` for all beams, or of a single beam.
void ReadBeamAttributes(XmlAttributes& attributes, SonarModel::Beam& beam) {
  if (auto v = attributes.Number("opening_deg", 0, 360)) beam.opening_rad = *v * kRadPerDeg;
  ReadNoise(attributes, "", beam.noise);
  if (auto v = attributes.Number("opening_up_deg", 0, 360)) beam.opening_up_rad = *v * kRadPerDeg;
  if (auto v = attributes.Integer("rays", 0, 1000)) beam.rays = *v;
  if (auto v = attributes.Number("min_range", 0, kMaxSensorLength_m)) beam.min_range_m = *v;
  if (auto v = attributes.Number("max_range", 1e-3, kMaxSensorLength_m)) beam.max_range_m = *v;
}

}  // namespace

void SonarModel::Read(const SensorSource& source) {
  Beam common;
  constexpr double kUsualOpening_deg = 30;
  constexpr double kWidestCone_rad = 170 * kRadPerDeg;
  common.opening_rad = kUsualOpening_deg * kRadPerDeg;
  common.opening_up_rad = -1;  // default: equal to opening_rad
  ReadBeamAttributes(source.attributes, common);
  source.ForEachChild({"coopdyn:beam"}, [&](XmlAttributes& child, std::string_view) {
    Beam beam = common;
    beam.mount = source.ReadMount(child);
    ReadBeamAttributes(child, beam);
    if (beam.rays == 0 && beam.opening_up_rad >= 0)
      child.Error("opening_up_deg is that of rays: write rays=\"5\" too, or leave it out");
    if (beam.rays == 0 && beam.opening_rad > kWidestCone_rad)
      child.Error("a cone opens 170 degrees at most: write a smaller opening_deg, or rays=\"5\"");
    if (beam.opening_up_rad < 0) beam.opening_up_rad = beam.opening_rad;
    if (beam.max_range_m <= 0) child.Error("needs 'max_range' in m, here or in <coopdyn:sonar>");
    if (beam.max_range_m > 0 && beam.min_range_m >= beam.max_range_m)
      child.Error("the least range must lie below the largest");
    beams.push_back(beam);
  });
  if (beams.empty())
    source.attributes.Error("write at least one <coopdyn:beam pose=\"x y z roll pitch yaw\"/>");
}

std::string SonarModel::Text(const RobotModel& /*robot*/) const {
  if (beams.empty()) return "";
  return CountOf(beams.size(), "beam") + ", " + Span(beams.front().min_range_m, beams.front().max_range_m);
}

Vector3 SonarModel::Beam::Direction(int index) const {
  if (index == 0 || rays < 2) return Vector3::UnitX();
  const double round_rad = 2 * std::numbers::pi * (index - 1) / (rays - 1);
  const double left_rad = opening_rad / 2 * portable::Cos(round_rad),
               up_rad = opening_up_rad / 2 * portable::Sin(round_rad);
  const double angle_rad = portable::Hypot(left_rad, up_rad);
  if (angle_rad <= 0) return Vector3::UnitX();
  const double part = portable::Sin(angle_rad) / angle_rad;
  return {portable::Cos(angle_rad), part * left_rad, part * up_rad};
}

}  // namespace coopdyn
