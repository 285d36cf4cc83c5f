// SPDX-License-Identifier: MIT
// Readings of fixed length: the names of their values.
#include <algorithm>
#include <initializer_list>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

using Names = std::vector<std::string>;

Names Numbered(std::size_t count, const std::string& before, const std::string& after) {
  Names names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back(before + std::to_string(i) + after);
  return names;
}

Names Named(const DistanceModel& model) {
  return Numbered(model.sectors.size(), "range", "_m");
}
Names Named(const PoseModel& /*model*/) {
  return {"x_m", "y_m", "heading_rad", "forward_m_s", "turn_rad_s"};
}
Names Named(const CompassModel& /*model*/) {
  return {"heading_rad"};
}
Names Named(const SupportModel& /*model*/) {
  return {"x_m", "y_m", "angle_rad"};
}
Names Named(const ImuModel& /*model*/) {
  return {"qw", "qx", "qy", "qz", "wx_rad_s", "wy_rad_s", "wz_rad_s", "ax_m_s2", "ay_m_s2", "az_m_s2"};
}
Names Named(const WrenchModel& /*model*/) {
  return {"fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"};
}
Names Named(const LidarModel& model) {
  return Numbered(model.rays(), "range", "_m");
}
Names Named(const ContactModel& model) {
  return Numbered(std::max<std::size_t>(model.zones.size(), 1), "pressed", "");
}
Names Named(const SonarModel& model) {
  return Numbered(model.beams.size(), "range", "_m");
}
Names Named(const InfraredModel& model) {
  return Numbered(model.eyes.size(), "value", "");
}
Names Named(const LightModel& model) {
  return Numbered(model.eyes.size(), "light", "");
}
Names Named(const BatteryModel& /*model*/) {
  return {"energy_j", "fraction", "power_w"};
}
Names Named(const OdometryModel& /*model*/) {
  return {"x_m", "y_m", "heading_rad", "forward_m_s", "turn_rad_s"};
}
// Numbers adjacent values of the same name.
Names Named(const ChannelModel& model) {
  Names names;
  for (std::size_t i = 0, number = 0; i < model.values.size(); ++i) {
    const std::string& name = model.values[i].name;
    number = i > 0 && model.values[i - 1].name == name ? number + 1 : 1;
    const bool has_more = i + 1 < model.values.size() && model.values[i + 1].name == name;
    names.push_back(number > 1 || has_more ? name + "_" + std::to_string(number) : name);
  }
  return names;
}
template <typename Kind>
Names Named(const Kind& /*model*/) {
  return {};
}

}  // namespace

std::vector<std::string> FixedNames(const SensorKind& kind) {
  return std::visit([](const auto& one) { return Named(one); }, kind);
}

}  // namespace coopdyn
