// SPDX-License-Identifier: MIT
#include "clients/cpp/run_database.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string_view>

namespace coopdyn::client {
std::uint64_t Little(Bytes bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

std::int64_t Signed(std::uint64_t bits, int width) {
  const std::uint64_t sign = std::uint64_t{1} << (width - 1);
  return static_cast<std::int64_t>(((bits & (2 * sign - 1)) ^ sign) - sign);
}

double Single(Bytes bytes) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(Little(bytes.first(4))));
}

double Double(Bytes bytes) {
  return std::bit_cast<double>(Little(bytes.first(8)));
}

Pose7 BodyPose(Bytes raw, int exponent) {
  static const double kTurnScale = std::numbers::sqrt2 * ((1 << 19) - 1);
  const double unit = std::ldexp(1.0, exponent);
  const std::uint64_t low = Little(raw.first(8)), middle = Little(raw.subspan(8, 8));
  const std::uint64_t high = Little(raw.subspan(16, 2));
  Pose7 pose{};
  pose[0] = static_cast<double>(Signed(low, 27)) * unit / 1e6;
  pose[1] = static_cast<double>(Signed(low >> 27, 27)) * unit / 1e6;
  pose[2] = static_cast<double>(Signed(low >> 54 | middle << 10, 27)) * unit / 1e6;
  const std::array<std::uint64_t, 3> parts{middle >> 17, middle >> 37, middle >> 57 | high << 7};
  const std::size_t left_out = high >> 13 & 3;
  double square = 0;
  for (std::size_t i = 0, part = 0; i < 4; ++i) {
    if (i == left_out) continue;
    pose[3 + i] = static_cast<double>(Signed(parts[part++], 20)) / kTurnScale;
    square += pose[3 + i] * pose[3 + i];
  }
  const double largest = std::sqrt(std::max(0.0, 1 - square));
  pose[3 + left_out] = largest;
  const double norm = std::sqrt(square + largest * largest);
  for (std::size_t i = 3; i < 7; ++i) pose[i] /= norm;
  return pose;
}

Pose7 RobotPose(const Pose7& X_WB, const Pose7& X_BR) {
  const Eigen::Quaterniond q_WB(X_WB[3], X_WB[4], X_WB[5], X_WB[6]);
  const Eigen::Quaterniond q = q_WB * Eigen::Quaterniond(X_BR[3], X_BR[4], X_BR[5], X_BR[6]);
  const Eigen::Vector3d p =
      Eigen::Map<const Eigen::Vector3d>(X_WB.data()) + q_WB * Eigen::Map<const Eigen::Vector3d>(X_BR.data());
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

std::string ControllerIn(Bytes scene, std::int64_t id, const std::string& name, const std::string& type) {
  std::string key;
  const auto add = [&](std::size_t number, const std::string& text = "") {
    for (int bit = 0; bit < 32; bit += 8) key += static_cast<char>(number >> bit & 255);
    key += text;
  };
  add(static_cast<std::size_t>(id));
  add(static_cast<std::size_t>(id));
  add(name.size(), name);
  add(type.size(), type);
  const std::string_view all(reinterpret_cast<const char*>(scene.data()), scene.size());
  std::size_t at = all.find(key);
  if (at == std::string_view::npos) return "";
  const auto take = [&](std::size_t bytes) { at += std::min(bytes, scene.size() - at); };
  const auto count = [&] {
    const std::uint64_t n = Little(scene.subspan(at, std::min<std::size_t>(4, scene.size() - at)));
    take(4);
    return static_cast<std::size_t>(n);
  };
  take(key.size() + 56 + 24 + 1);  // pose, colour, sync
  for (std::size_t modules = count(); modules > 0 && at < scene.size(); --modules) take(count());
  take(9 + 3);  // deadline, three words
  const std::size_t size = count();
  return std::string(all.substr(at, size));
}

}  // namespace coopdyn::client
