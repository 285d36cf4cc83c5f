// SPDX-License-Identifier: MIT
// Infrared range finders.
#include "server/model/sensor_models.h"

#include <algorithm>
#include <utility>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Sharp GP2D12, in volts. From 10 cm on 33.6 / (cm + 4), which meets both typical values of its data sheet,
/// 0.4 V at 80 cm and 2.0 V more at 10 cm. Nearer than 10 cm the output falls again, here by estimated
/// values. A new value is available every 38.3 ms.
void ReadPreset(InfraredModel& sensor, SensorTiming& timing) {
  for (const auto& [distance_m, value_v] :
       {std::pair(0.0, 0.3), {0.02, 1.0}, {0.04, 1.8}, {0.06, 2.35}, {0.08, 2.5}}) {
    sensor.curve.push_back({distance_m, value_v, 0});
  }
  for (const int cm : {10, 11, 12, 13, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 60, 70, 80}) {
    sensor.curve.push_back({cm * 0.01, 33.6 / (cm + 4), 0});
  }
  sensor.max_range_m = 0.8;
  sensor.dark = 0.25;  // minimum at 80 cm in the data sheet
  sensor.noise.resolution = 0.02;
  timing.rate_hz = 1 / 0.0383;
}

/// Sharp DM2Y3A003K0F, approximate because its data are not public. A wide beam of five rays from 40 cm to 3
/// m, with eight bits, 102 / m, falling again nearer than 40 cm. A new value is available after all five rays
/// have been measured.
void ReadWidePreset(InfraredModel& sensor, SensorTiming& timing) {
  for (const auto& [distance_m, value] : {std::pair(0.0, 50.0), {0.1, 100}, {0.2, 170}, {0.3, 235}})
    sensor.curve.push_back({distance_m, value, 0});
  for (const int cm : {40, 44, 48, 53, 58, 64, 70, 80, 90, 100, 115, 130, 150, 170, 200, 230, 260, 300})
    sensor.curve.push_back({cm * 0.01, 10200.0 / cm, 0});
  sensor.opening_rad = 25 * kRadPerDeg;
  sensor.rays = 5;
  sensor.max_range_m = 3;
  sensor.dark = 30;
  sensor.noise.resolution = 1;
  timing.rate_hz = 1 / 0.0825;
}

}  // namespace

void InfraredModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  constexpr double kMost = 1e6;
  const std::optional<std::string> preset = attributes.Text("preset");
  if (preset == "gp2d12") {
    ReadPreset(*this, source.timing);
  } else if (preset == "dm2y3a003k0f") {
    ReadWidePreset(*this, source.timing);
  } else if (preset) {
    attributes.Error(
        "there is no preset '" + *preset +
        "': write gp2d12, dm2y3a003k0f, or a curve of <coopdyn:row distance=\"…\" value=\"…\"/>");
  }
  if (auto v = attributes.Number("opening_deg", 0, 180)) opening_rad = *v * kRadPerDeg;
  if (auto v = attributes.Integer("rays", 1, 1000)) rays = *v;
  const auto given_range_m = attributes.Number("max_range", 1e-3, kMaxSensorLength_m);
  const auto given_dark = attributes.Number("dark", -kMost, kMost);
  ReadNoise(attributes, "", noise);
  std::vector<Row> rows;
  source.ForEachChild({"coopdyn:eye", "coopdyn:row"}, [&](XmlAttributes& child, std::string_view name) {
    if (name == "coopdyn:eye") {
      eyes.push_back(source.ReadMount(child));
      return;
    }
    child.Require("distance");
    child.Require("value");
    Row row;
    row.distance_m = child.Number("distance", 0, kMaxSensorLength_m).value_or(0);
    row.value = child.Number("value", -kMost, kMost).value_or(0);
    row.noise_stddev = child.Number("noise_stddev", 0, kMost).value_or(0);
    if (!rows.empty() && row.distance_m <= rows.back().distance_m)
      child.Error("rows go by increasing 'distance': write this one further up");
    rows.push_back(row);
  });
  if (preset && !rows.empty()) attributes.Error("has a preset and rows of its own: keep one of them");
  if (!preset && rows.size() < 2) {
    attributes.Error(
        "needs a preset=\"gp2d12\", or at least two <coopdyn:row distance=\"…\" value=\"…\"/> by increasing "
        "distance");
  }
  if (!preset && rows.size() >= 2) {
    max_range_m = rows.back().distance_m;
    dark = rows.back().value;
    curve = std::move(rows);
  }
  if (given_range_m) max_range_m = *given_range_m;
  if (given_dark) dark = *given_dark;
  if (rays == 1 && opening_rad > 0)
    attributes.Error("one ray cannot sample an opening: write rays=\"5\" or opening_deg=\"0\"");
  if (eyes.empty()) attributes.Error("write at least one <coopdyn:eye pose=\"x y z roll pitch yaw\"/>");
}

std::string InfraredModel::Text(const RobotModel& /*robot*/) const {
  return CountOf(eyes.size(), "eye") + ", to " + Rounded4(max_range_m) + " m";
}

}  // namespace coopdyn
