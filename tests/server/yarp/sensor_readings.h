// SPDX-License-Identifier: MIT
// Readings of sensors, and their samples on ports of YARP's devices.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "server/yarp/sensor_samples.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn::yarp_sensors {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kNothingInRange = std::numeric_limits<double>::infinity();
inline constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

inline auto AllAbout(const std::vector<double>& values) {
  return ::testing::Pointwise(::testing::DoubleNear(1e-9), values);
}

/// A push of `reading` at 12.5 s.
inline Message PushOf(command::Id reading, std::vector<double> data, std::vector<std::int32_t> params = {}) {
  Message push;
  push.command = -reading;
  push.params = std::move(params);
  push.data = std::move(data);
  push.data.insert(push.data.end(), {12.5, 1250});
  return push;
}

/// Turned by 30 degrees about x, then 40 about y, then 50 about z of the world.
inline const std::vector<double> kTurned = {0.860042173697679, 0.08080468869083995, 0.40219849353410964,
                                            0.30337177447125957};

inline Message ImuReading() {
  std::vector<double> data = kTurned;
  data.insert(data.end(), {kPi, -kPi / 2, kPi / 180, 1, -2, 9.81});
  return PushOf(command::kGetImu, data);
}
inline Message WrenchReading() {
  return PushOf(command::kGetWrench, {1, 2, 3, 4, 5, 6});
}
inline Message PoseReading() {
  std::vector<double> data = {1, 2, 3};
  data.insert(data.end(), kTurned.begin(), kTurned.end());
  data.insert(data.end(), {0.1, 0.2, 0.3, 7, 8, 9});
  return PushOf(command::kGetPose3d, data);
}
/// Readings of a revolute joint at 45 degrees, and a sliding one at 0.25 m.
inline Message BoardReading() {
  std::vector<double> data(36);
  data[0] = kPi / 4;
  data[18] = 0.25;
  Message board = PushOf(command::kGetBoard, data, {0, 1, 1, 1, 1, 1});
  board.text = "elbow lift";
  return board;
}
inline Message OdometryReading() {
  return PushOf(command::kGetOdometry, {1, -2, kPi / 2, 3, kPi / 4});
}
inline Message BatteryReading(double fraction = 0.75, double power_w = 12) {
  return PushOf(command::kGetBattery, {fraction * 1e5, fraction, power_w});
}
/// Four columns from -90 degrees on, 45 apart; three rows, of which the middle one is level.
inline Message Geometry() {
  return PushOf(command::kGetScanGeometry, {-kPi / 2, kPi / 4, 0.1, 5, 3, 4, -0.2, 0.2});
}
inline Message GeometryWith(std::size_t at, double value) {
  Message geometry = Geometry();
  geometry.data[at] = value;
  return geometry;
}
inline Message ScanReading() {
  return PushOf(command::kGetScan, {1, 1, 1, 1, 2, kNothingInRange, 0, 2.5, 3, 3, 3, 3});
}
inline Message ImageReading(std::int32_t width, std::int32_t height, std::string pixels) {
  std::vector<std::int32_t> params = {width, height, static_cast<std::int32_t>(pixels.size())};
  pixels.resize((pixels.size() + 3) / 4 * 4, '\x55');
  params.resize(3 + pixels.size() / 4);
  std::memcpy(&params[3], pixels.data(), pixels.size());
  return PushOf(command::kGetImage, {}, params);
}

inline std::string SampleBytes(YarpSample sample, const Message& reading,
                               YarpDialect dialect = YarpDialect::k3, const Message& geometry = Geometry()) {
  std::string bytes;
  EXPECT_TRUE(AppendSensorSample(sample, reading, geometry, dialect, bytes));
  return bytes;
}
/// True if a reading makes no sample, and writes nothing.
inline bool IsLeftOut(YarpSample sample, const Message& reading, const Message& geometry = Geometry()) {
  std::string bytes = "before";
  const bool appended = AppendSensorSample(sample, reading, geometry, YarpDialect::k3, bytes);
  return !appended && bytes == "before";
}

inline Bottle ItemsOf(const std::string& bytes) {
  YarpDialect dialect = YarpDialect::k3;
  const std::optional<Bottle> items = DecodeBottle(bytes, dialect);
  EXPECT_TRUE(items.has_value());
  return items.value_or(Bottle());
}
inline std::vector<double> NumbersIn(const Bottle& bottle) {
  std::vector<double> numbers;
  for (const BottleValue& item : bottle) numbers.push_back(NumberOf(item).value_or(kNotANumber));
  return numbers;
}

}  // namespace coopdyn::yarp_sensors
