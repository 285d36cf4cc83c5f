// SPDX-License-Identifier: MIT
// Distance sensors: sectors around a robot.
#include "server/model/sensor_models.h"

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

}  // namespace

void DistanceModel::Read(const SensorSource& source) {
  const SectorDefaults common = ReadSectorAttributes(source.attributes, {});
  source.ForEachChild({"coopdyn:sector"}, [&](XmlAttributes& child, std::string_view) {
    sectors.push_back(ReadSector(child, common));
  });
  if (sectors.empty()) source.attributes.Error("write at least one <coopdyn:sector bearing_deg=\"…\"/>");
  std::stable_sort(sectors.begin(), sectors.end(),
                   [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
}

std::string DistanceModel::Text(const RobotModel& /*robot*/) const {
  double most_m = 0;
  for (const SectorModel& sector : sectors) most_m = std::max(most_m, sector.max_range_m);
  return CountOf(sectors.size(), "sector") + ", to " + Rounded4(most_m) + " m";
}

}  // namespace coopdyn
