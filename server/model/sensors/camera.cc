// SPDX-License-Identifier: MIT
// Cameras.
#include "server/model/sensor_models.h"

#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"
#include "server/model/sdf_sensors.h"
#include "server/model/sensor_text.h"
#include "server/model/values.h"

namespace coopdyn {

void CameraModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  mount = source.ReadMount(attributes);
  if (auto v = attributes.Integer("width", 1, kMaxWidth)) width = *v;
  if (auto v = attributes.Integer("height", 1, kMaxHeight)) height = *v;
  if (auto v = attributes.Number("fov_deg", 1, 175)) horizontal_fov_rad = *v * kRadPerDeg;
  if (auto v = attributes.Number("near", 1e-4, kMaxSensorLength_m)) near_m = *v;
  if (auto v = attributes.Number("far", 1e-3, kMaxSensorLength_m)) far_m = *v;
  ReadNoise(attributes, "", noise);
  ReadNoise(attributes, "depth_", depth_noise);
  if (const std::string wrong = Wrong(); !wrong.empty()) attributes.Error(wrong);
}

std::string CameraModel::Wrong() const {
  constexpr double kLeast_deg = 1, kMost_deg = 175;
  if (width < 1 || height < 1 || width > kMaxWidth || height > kMaxHeight) {
    return "a picture has 1 x 1 to " + std::to_string(kMaxWidth) + " x " + std::to_string(kMaxHeight) +
           " points";
  }
  if (!(horizontal_fov_rad >= kLeast_deg * kRadPerDeg * (1 - 1e-9) &&
        horizontal_fov_rad <= kMost_deg * kRadPerDeg * (1 + 1e-9)))
    return "the camera's horizontal field of view lies between 1 and 175 degrees (0.0175 to 3.05 rad)";
  if (!(near_m > 0 && near_m < far_m && std::isfinite(far_m))) return "the camera needs 0 < near < far, in m";
  return {};
}

std::string CameraModel::Text(const RobotModel& robot) const {
  return std::to_string(width) + " x " + std::to_string(height) + ", " +
         Rounded4(horizontal_fov_rad * 180 / std::numbers::pi) + " degrees wide, " + Span(near_m, far_m) +
         ", " + On(mount, robot);
}

double CameraModel::focal_px() const {
  return width / (2 * portable::Tan(horizontal_fov_rad / 2));
}

}  // namespace coopdyn
