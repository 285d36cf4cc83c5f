// SPDX-License-Identifier: MIT
#include "clients/cpp/run_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string_view>

namespace coopdyn::client {
namespace {

std::array<double, 3> Cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

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

Pose7 RobotPose(Pose7 pose, const std::array<double, 3>& u, const std::array<double, 4>& r) {
  if (u[0] != 0 || u[1] != 0 || u[2] != 0) {
    std::array<double, 3> t = Cross(&pose[4], u.data());
    for (double& c : t) c += c;
    const std::array<double, 3> s = Cross(&pose[4], t.data());
    for (std::size_t i = 0; i < 3; ++i) pose[i] += u[i] + pose[3] * t[i] + s[i];
  }
  if (r[1] != 0 || r[2] != 0 || r[3] != 0) {
    const double w = pose[3], x = pose[4], y = pose[5], z = pose[6];
    pose[3] = w * r[0] - x * r[1] - y * r[2] - z * r[3];
    pose[4] = w * r[1] + x * r[0] + y * r[3] - z * r[2];
    pose[5] = w * r[2] - x * r[3] + y * r[0] + z * r[1];
    pose[6] = w * r[3] + x * r[2] - y * r[1] + z * r[0];
  }
  return pose;
}

std::string ControllerIn(Bytes scene, std::int64_t id, const std::string& name, const std::string& type) {
  const auto number = [](std::size_t n) {
    std::string bytes;
    for (int k = 0; k < 32; k += 8) bytes += static_cast<char>(n >> k & 255);
    return bytes;
  };
  const std::string key = number(static_cast<std::size_t>(id)) + number(static_cast<std::size_t>(id)) +
                          number(name.size()) + name + number(type.size()) + type;
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
