// SPDX-License-Identifier: MIT
#include "server/rosiml/lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn::rosiml {

std::string Exact(double value) {
  if (value == 0) return "0";
  char buffer[40];
  const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return code == std::errc() ? std::string(buffer, end) : std::string("0");
}

std::string Whole(double value) {
  return std::to_string(std::llround(value));
}

std::string Rounded(double value) {
  constexpr double kParts = 1e12;
  return Exact(std::round(value * kParts) / kParts);
}

std::string Places(const Vector3& v) {
  return Rounded(v.x()) + " " + Rounded(v.y()) + " " + Rounded(v.z());
}

std::string RollPitchYaw(const Quaternion& q) {
  const Matrix3 R = q.normalized().toRotationMatrix();
  const double pitch = portable::Atan2(-R(2, 0), portable::Hypot(R(0, 0), R(1, 0)));
  double roll = 0, yaw = 0;
  if (portable::Hypot(R(2, 1), R(2, 2)) < 1e-9) {  // gimbal lock: roll and yaw share an axis
    yaw = portable::Atan2(-R(0, 1), R(1, 1));
  } else {
    roll = portable::Atan2(R(2, 1), R(2, 2));
    yaw = portable::Atan2(R(1, 0), R(0, 0));
  }
  return Places(Vector3(roll, pitch, yaw));
}

std::string Places(const Pose& pose) {
  return Places(pose.p) + " " + RollPitchYaw(pose.q);
}

std::string Simple(std::string_view name, std::size_t most) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  std::string out;
  for (const char c : name) out += is_letter(c) || (c >= '0' && c <= '9') || c == '-' ? c : '_';
  if (out.empty() || !is_letter(out.front())) out = "m" + out;
  out.resize(std::min(out.size(), most));
  return out;
}

}  // namespace coopdyn::rosiml
