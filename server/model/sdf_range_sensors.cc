// SPDX-License-Identifier: MIT
// Reads coopdyn's elements of range sensors: distance, target, neighbours, lidar and sonar.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/base/portable_math.h"
#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Values of `<coopdyn:distance_sensors>` for all sectors, or of a single sector.
struct SectorDefaults {
  std::optional<double> radius_m, height_m;
  double opening_rad = 0;
  int rays = 1;
  double max_range_m = 0;
  double noise_stddev_m = 0;
};

SectorDefaults ReadSectorAttributes(XmlAttributes& attributes, SectorDefaults values) {
  if (auto v = attributes.Number("radius", 0, kMaxSensorLength_m)) values.radius_m = v;
  if (auto v = attributes.Number("height", 0, kMaxSensorLength_m)) values.height_m = v;
  if (auto v = attributes.Number("opening_deg", 0, 360)) values.opening_rad = *v * kRadPerDeg;
  if (auto v = attributes.Integer("rays", 1, 1000)) values.rays = *v;
  if (auto v = attributes.Number("max_range", 1e-3, kMaxSensorLength_m)) values.max_range_m = *v;
  if (auto v = attributes.Number("noise_stddev", 0, kMaxSensorLength_m)) values.noise_stddev_m = *v;
  return values;
}

SectorModel ReadSector(XmlAttributes& attributes, const SectorDefaults& common) {
  const SectorDefaults values = ReadSectorAttributes(attributes, common);
  const std::optional<double> bearing_deg = attributes.Number("bearing_deg", -180, 180);
  const auto pose = attributes.Numbers("pose", 6);
  SectorModel sector;
  if (pose) {
    const std::vector<double>& v = *pose;
    for (const double x : v) {
      if (std::abs(x) > kMaxSensorLength_m) attributes.Error("the pose is too far away");
    }
    sector.X_RS = {Vector3(v[0], v[1], v[2]), FromRollPitchYaw(v[3], v[4], v[5])};
    sector.bearing_rad = Heading(sector.X_RS.q);
    if (bearing_deg) attributes.Error("give either 'pose' or 'bearing_deg', not both");
  } else if (bearing_deg && values.radius_m && values.height_m) {
    sector.bearing_rad = WrapAngle(*bearing_deg * kRadPerDeg);
    const double b = sector.bearing_rad;
    sector.X_RS = {
        Vector3(*values.radius_m * portable::Cos(b), *values.radius_m * portable::Sin(b), *values.height_m),
        FromRollPitchYaw(0, 0, b)};
  } else {
    attributes.Error(
        "needs 'bearing_deg' with 'radius' and 'height' (here or in <coopdyn:distance_sensors>), or 'pose'");
  }
  if (values.max_range_m <= 0)
    attributes.Error("needs 'max_range' in m, here or in <coopdyn:distance_sensors>");
  if (values.rays == 1 && values.opening_rad > 0) {
    attributes.Error("one ray cannot sample an opening: write rays=\"5\" or opening_deg=\"0\"");
  }
  sector.opening_rad = values.opening_rad;
  sector.rays = values.rays;
  sector.max_range_m = values.max_range_m;
  sector.noise_stddev_m = values.noise_stddev_m;
  return sector;
}

/// Reads the noise of distance and bearing, for targets and neighbours.
template <typename Kind>
void ReadSightNoise(Kind& sensor, XmlAttributes& attributes) {
  if (auto v = attributes.Number("distance_noise_stddev", 0, kMaxSensorLength_m))
    sensor.distance_noise_stddev_m = *v;
  if (auto v = attributes.Number("bearing_noise_stddev_deg", 0, 180))
    sensor.bearing_noise_stddev_rad = *v * kRadPerDeg;
}

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

void ReadInto(DistanceModel& sensor, const SensorSource& source) {
  const SectorDefaults common = ReadSectorAttributes(source.attributes, {});
  source.ForEachChild({"coopdyn:sector"}, [&](XmlAttributes& child, std::string_view) {
    sensor.sectors.push_back(ReadSector(child, common));
  });
  if (sensor.sectors.empty())
    source.attributes.Error("write at least one <coopdyn:sector bearing_deg=\"…\"/>");
  std::stable_sort(sensor.sectors.begin(), sensor.sectors.end(),
                   [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
}

void ReadInto(TargetModel& sensor, const SensorSource& source) {
  if (auto v = source.attributes.Number("max_range", 1e-3, kMaxSensorLength_m)) sensor.max_range_m = *v;
  if (auto v = source.attributes.Flag("see_through")) sensor.see_through = *v;
  ReadSightNoise(sensor, source.attributes);
}

void ReadInto(NeighboursModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("range");
  if (auto v = attributes.Number("range", 1e-3, kMaxSensorLength_m)) sensor.range_m = *v;
  sensor.message_range_m = attributes.Number("message_range", 0, kMaxSensorLength_m).value_or(sensor.range_m);
  if (auto v = attributes.Number("loss", 0, 1)) sensor.loss = *v;
  if (auto v = attributes.Integer("delay_steps", 0, NeighboursModel::kMaxDelaySteps)) sensor.delay_steps = *v;
  ReadSightNoise(sensor, attributes);
}

void ReadInto(LidarModel& sensor, const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  sensor.mount = source.ReadMount(attributes);
  attributes.Require("max_range");
  constexpr int kUsualColumns = 360;
  sensor.columns = attributes.Integer("columns", 1, kMaxLidarRays).value_or(kUsualColumns);
  sensor.rows = attributes.Integer("rows", 1, kMaxLidarRays).value_or(1);
  const auto first = attributes.Number("first_deg", -360, 360),
             last = attributes.Number("last_deg", -360, 360);
  if (first.has_value() != last.has_value())
    attributes.Error("needs both 'first_deg' and 'last_deg', or neither: then it looks all round");
  // Default all round: the last column is next to the first. A single column looks ahead.
  const bool is_one = sensor.columns == 1;
  sensor.first_azimuth_rad = first.value_or(is_one ? 0 : -180) * kRadPerDeg;
  sensor.last_azimuth_rad = last.value_or(is_one ? 0 : 180 - 360.0 / sensor.columns) * kRadPerDeg;
  sensor.first_elevation_rad = attributes.Number("first_elevation_deg", -90, 90).value_or(0) * kRadPerDeg;
  sensor.last_elevation_rad = attributes.Number("last_elevation_deg", -90, 90).value_or(0) * kRadPerDeg;
  sensor.min_range_m = attributes.Number("min_range", 0, kMaxSensorLength_m).value_or(0);
  sensor.max_range_m = attributes.Number("max_range", 1e-3, kMaxSensorLength_m).value_or(1);
  ReadNoise(attributes, "", sensor.noise);
  if (is_one && sensor.first_azimuth_rad != sensor.last_azimuth_rad)
    attributes.Error(
        "one column looks one way: write the same angle as first_deg and last_deg, or more columns");
  if (sensor.rows == 1 && sensor.first_elevation_rad != sensor.last_elevation_rad)
    attributes.Error(
        "one row looks one way: write the same angle as first_elevation_deg and last_elevation_deg, or more "
        "rows");
  if (const std::string wrong = WrongIn(sensor); !wrong.empty()) attributes.Error(wrong);
}

std::string WrongIn(const LidarModel& sensor) {
  if (sensor.columns < 1 || sensor.rows < 1 || sensor.rays() > kMaxLidarRays)
    return "a lidar has 1 to " + std::to_string(kMaxLidarRays) + " rays, columns times rows: take fewer";
  if (sensor.first_azimuth_rad > sensor.last_azimuth_rad ||
      sensor.first_elevation_rad > sensor.last_elevation_rad)
    return "the first angle must not lie above the last: columns go from right to left, rows upwards";
  if (sensor.columns > 1 && sensor.first_azimuth_rad == sensor.last_azimuth_rad)
    return "all columns look the same way: write the angles of the first and the last, or one column";
  if (sensor.rows > 1 && sensor.first_elevation_rad == sensor.last_elevation_rad)
    return "all rows look the same way: write the elevations of the first and the last, or one row";
  if (sensor.min_range_m >= sensor.max_range_m) return "the least range must lie below the largest";
  return {};
}

void ReadInto(SonarModel& sensor, const SensorSource& source) {
  SonarModel::Beam common;
  constexpr double kUsualOpening_deg = 30;
  constexpr double kWidestCone_rad = 170 * kRadPerDeg;
  common.opening_rad = kUsualOpening_deg * kRadPerDeg;
  common.opening_up_rad = -1;  // default: equal to opening_rad
  ReadBeamAttributes(source.attributes, common);
  source.ForEachChild({"coopdyn:beam"}, [&](XmlAttributes& child, std::string_view) {
    SonarModel::Beam beam = common;
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
    sensor.beams.push_back(beam);
  });
  if (sensor.beams.empty())
    source.attributes.Error("write at least one <coopdyn:beam pose=\"x y z roll pitch yaw\"/>");
}

}  // namespace coopdyn
