// SPDX-License-Identifier: MIT
// Lidars.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"
#include "server/model/sensor_text.h"
#include "server/model/values.h"

namespace coopdyn {

void LidarModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  mount = source.ReadMount(attributes);
  attributes.Require("max_range");
  constexpr int kUsualColumns = 360;
  columns = attributes.Integer("columns", 1, kMaxLidarRays).value_or(kUsualColumns);
  rows = attributes.Integer("rows", 1, kMaxLidarRays).value_or(1);
  const auto first = attributes.Number("first_deg", -360, 360),
             last = attributes.Number("last_deg", -360, 360);
  if (first.has_value() != last.has_value())
    attributes.Error("needs both 'first_deg' and 'last_deg', or neither: then it looks all round");
  // Default all round: the last column is next to the first. A single column looks ahead.
  const bool is_one = columns == 1;
  first_azimuth_rad = first.value_or(is_one ? 0 : -180) * kRadPerDeg;
  last_azimuth_rad = last.value_or(is_one ? 0 : 180 - 360.0 / columns) * kRadPerDeg;
  first_elevation_rad = attributes.Number("first_elevation_deg", -90, 90).value_or(0) * kRadPerDeg;
  last_elevation_rad = attributes.Number("last_elevation_deg", -90, 90).value_or(0) * kRadPerDeg;
  min_range_m = attributes.Number("min_range", 0, kMaxSensorLength_m).value_or(0);
  max_range_m = attributes.Number("max_range", 1e-3, kMaxSensorLength_m).value_or(1);
  ReadNoise(attributes, "", noise);
  if (is_one && first_azimuth_rad != last_azimuth_rad)
    attributes.Error(
        "one column looks one way: write the same angle as first_deg and last_deg, or more columns");
  if (rows == 1 && first_elevation_rad != last_elevation_rad)
    attributes.Error(
        "one row looks one way: write the same angle as first_elevation_deg and last_elevation_deg, or more "
        "rows");
  if (const std::string wrong = Wrong(); !wrong.empty()) attributes.Error(wrong);
}

std::string LidarModel::Wrong() const {
  if (columns < 1 || rows < 1 || rays() > kMaxLidarRays)
    return "a lidar has 1 to " + std::to_string(kMaxLidarRays) + " rays, columns times rows: take fewer";
  if (first_azimuth_rad > last_azimuth_rad || first_elevation_rad > last_elevation_rad)
    return "the first angle must not lie above the last: columns go from right to left, rows upwards";
  if (columns > 1 && first_azimuth_rad == last_azimuth_rad)
    return "all columns look the same way: write the angles of the first and the last, or one column";
  if (rows > 1 && first_elevation_rad == last_elevation_rad)
    return "all rows look the same way: write the elevations of the first and the last, or one row";
  if (min_range_m >= max_range_m) return "the least range must lie below the largest";
  return {};
}

std::string LidarModel::Text(const RobotModel& robot) const {
  return CountOf(rays(), "ray") + ", " + Span(min_range_m, max_range_m) + ", " + On(mount, robot);
}

}  // namespace coopdyn
