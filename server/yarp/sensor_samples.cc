// SPDX-License-Identifier: MIT
#include "server/yarp/sensor_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "server/base/portable_math.h"
#include "server/yarp/board.h"
#include "server/yarp/struct_writer.h"

namespace coopdyn {
namespace {

constexpr double kDegreesInRadian = 180 / std::numbers::pi;
constexpr std::size_t kTimeAndStep = 2;

// The kinds of multipleAnalogSensors, in the order of its lists.
enum Measure : std::size_t {
  kGyroscope,
  kAccelerometer,
  kMagnetometer,
  kOrientation,
  kTemperature,
  kForceTorque,
  kContactLoad,
  kEncoders,
  kSkin,
  kPlace,
  kLinearVelocity,
  kAngularAcceleration,
  kMeasureKinds,
};
using Measures = std::array<std::vector<double>, kMeasureKinds>;

/// Roll, pitch and yaw in degrees: turned about x, then y, then z of the world (as YARP's dcm2rpy).
std::vector<double> RollPitchYaw(std::span<const double> q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double roll = portable::Atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const double pitch = portable::Asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0));
  const double yaw = portable::Atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  return {roll * kDegreesInRadian, pitch * kDegreesInRadian, yaw * kDegreesInRadian};
}

std::vector<double> InDegrees(std::span<const double> radians) {
  std::vector<double> degrees;
  for (const double value : radians) degrees.push_back(value * kDegreesInRadian);
  return degrees;
}

std::vector<double> Copy(std::span<const double> values) {
  return {values.begin(), values.end()};
}

command::Id ReadingIn(const Message& message) {
  return message.command < 0 ? -message.command : message.command;
}

/// Converts a reading; nullopt if its length is wrong.
std::optional<Measures> MeasuresOf(const Message& reading) {
  const std::span<const double> data = std::span(reading.data).first(reading.data.size() - kTimeAndStep);
  Measures measures;
  switch (ReadingIn(reading)) {
    case command::kGetImu:
      if (data.size() != 10) return {};
      measures[kOrientation] = RollPitchYaw(data.first(4));
      measures[kGyroscope] = InDegrees(data.subspan(4, 3));
      measures[kAccelerometer] = Copy(data.subspan(7, 3));
      return measures;
    case command::kGetWrench:
      if (data.size() != 6) return {};
      measures[kForceTorque] = Copy(data);
      return measures;
    case command::kGetContacts: {
      if (data.size() % 7 != 0) return {};
      double load = 0;
      for (std::size_t i = 0; i + 6 < data.size(); i += 7) load += data[i];
      measures[kContactLoad] = {load};
      return measures;
    }
    case command::kGetBoard: {
      const std::optional<BoardState> board = ReadBoard(reading);
      if (!board) return {};
      for (const BoardJoint& joint : board->joints) measures[kEncoders].push_back(joint.position);
      return measures;
    }
    case command::kGetPose3d:
      if (data.size() != 13) return {};
      measures[kPlace] = Copy(data.first(3));
      measures[kOrientation] = RollPitchYaw(data.subspan(3, 4));
      measures[kLinearVelocity] = Copy(data.subspan(7, 3));
      return measures;
    default:
      return {};
  }
}

/// The kinds that a module measures.
std::vector<Measure> KindsOf(std::string_view module) {
  if (module == "imu") return {kGyroscope, kAccelerometer, kOrientation};
  if (module == "wrench") return {kForceTorque};
  if (module == "contact") return {kContactLoad};
  if (module == "joints") return {kEncoders};
  if (module == "pose") return {kOrientation, kPlace, kLinearVelocity};
  return {};
}

bool AppendMeasures(const Message& reading, YarpStructWriter write) {
  const std::optional<Measures> measures = MeasuresOf(reading);
  if (!measures) return false;
  const double time_s = reading.data[reading.data.size() - kTimeAndStep];
  write.Struct(kMeasureKinds);
  for (const std::vector<double>& values : *measures) {
    write.Struct(values.empty() ? 0 : 1);
    if (values.empty()) continue;
    write.Struct(2);
    write.Doubles(values);
    write.Double(time_s);
  }
  return true;
}

bool AppendInertial(const Message& reading, YarpStructWriter write) {
  const std::optional<Measures> measures = MeasuresOf(reading);
  if (!measures || (*measures)[kOrientation].empty()) return false;
  std::vector<double> values;
  for (const Measure kind : {kOrientation, kAccelerometer, kGyroscope})
    values.insert(values.end(), (*measures)[kind].begin(), (*measures)[kind].end());
  values.resize(12);  // no magnetometer
  write.Doubles(values);
  return true;
}

bool AppendScan(const Message& reading, const Message& geometry, YarpStructWriter write) {
  constexpr std::int32_t kInUse = 1;
  const std::optional<ScanLimits> limits = ReadScanGeometry(geometry);
  if (!limits || reading.data.size() < (limits->row + 1) * limits->columns + kTimeAndStep) return false;
  const std::span<const double> row =
      std::span(reading.data).subspan(limits->row * limits->columns, limits->columns);
  write.Struct(6);
  write.Double(limits->first_deg);
  write.Double(limits->end_deg);
  write.Double(limits->min_range_m);
  write.Double(limits->max_range_m);
  write.Doubles(row);
  write.Int(kInUse);
  return true;
}

bool AppendOdometry(const Message& reading, YarpStructWriter write) {
  if (reading.data.size() != 5 + kTimeAndStep) return false;
  const double heading = reading.data[2], forward = reading.data[3];
  const double turn_deg = reading.data[4] * kDegreesInRadian;
  write.Struct(9);
  for (const double value :
       {reading.data[0], reading.data[1], heading * kDegreesInRadian, forward, 0.0, turn_deg,
        forward * portable::Cos(heading), forward * portable::Sin(heading), turn_deg})
    write.Double(value);
  return true;
}

/// Only energy and power are known: no voltage, current or temperature.
bool AppendBattery(const Message& reading, YarpStructWriter write) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr std::int32_t kStandby = 0, kInUse = 2, kLow = 5, kCritical = 6;
  constexpr double kLow_percent = 15, kCritical_percent = 5;  // as in YARP's own batteries
  if (ReadingIn(reading) != command::kGetBattery || reading.data.size() != 3 + kTimeAndStep) return false;
  const double charge_percent = 100 * reading.data[1], power_w = reading.data[2];
  write.Struct(5);
  for (const double value : {charge_percent, kUnknown, kUnknown, kUnknown}) write.Double(value);
  write.Int(!(power_w > 0)                        ? kStandby
            : charge_percent <= kCritical_percent ? kCritical
            : charge_percent <= kLow_percent      ? kLow
                                                  : kInUse);
  return true;
}

/// Params: width, height, byte count, then four bytes of the image each.
bool AppendImage(const Message& reading, YarpSample sample, std::string& out) {
  constexpr std::int32_t kRowMultiple = 8, kBlobTag = 12, kIntsTag = 257;
  const bool depth = sample == YarpSample::kDepth;
  const std::int32_t pixel = depth ? 4 : 3;
  if (reading.params.size() < 3) return false;
  const std::int32_t width = reading.params[0], height = reading.params[1];
  const std::span<const std::int32_t> words = std::span(reading.params).subspan(3);
  constexpr std::int32_t kMaxSide = 1 << 16;
  if (width <= 0 || height <= 0 || width > kMaxSide || height > kMaxSide ||
      std::int64_t{width} * height * pixel != reading.params[2] ||
      words.size_bytes() < static_cast<std::size_t>(reading.params[2]))
    return false;
  const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(pixel);
  const std::size_t padded = (row + kRowMultiple - 1) / kRowMultiple * kRowMultiple;
  const auto size = static_cast<std::int32_t>(padded * static_cast<std::size_t>(height));
  for (const std::int32_t number : {256, 4, 9, VocabCode("mat"), 9, VocabCode(depth ? "dec" : "rgb"),
                                    kIntsTag, 5, pixel, size, kRowMultiple, width, height, kBlobTag, size})
    AppendBytes(number, out);
  const char* const bytes = reinterpret_cast<const char*>(words.data());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    out.append(bytes + y * row, row);
    out.append(padded - row, '\0');
  }
  return true;
}

}  // namespace

bool AppendSensorSample(YarpSample sample, const Message& reading, const Message& geometry,
                        YarpDialect dialect, std::string& out) {
  if (reading.error != 0 || reading.data.size() < kTimeAndStep) return false;
  const YarpStructWriter write(dialect, out);
  switch (sample) {
    case YarpSample::kMeasures:
      return AppendMeasures(reading, write);
    case YarpSample::kInertial:
      return AppendInertial(reading, write);
    case YarpSample::kLaserScan:
      return AppendScan(reading, geometry, write);
    case YarpSample::kOdometry:
      return AppendOdometry(reading, write);
    case YarpSample::kBattery:
      return AppendBattery(reading, write);
    case YarpSample::kImage:
    case YarpSample::kDepth:
      return AppendImage(reading, sample, out);
    default:
      return false;
  }
}

std::string MeasuresMetadata(std::string_view kind, std::string_view name) {
  std::string bytes;
  YarpStructWriter write(YarpDialect::k3, bytes);
  const std::vector<Measure> kinds = KindsOf(kind);
  write.Struct(kMeasureKinds);
  for (std::size_t each = 0; each < kMeasureKinds; ++each) {
    const bool has = std::ranges::find(kinds, static_cast<Measure>(each)) != kinds.end();
    write.Struct(has ? 1 : 0);
    if (!has) continue;
    write.Struct(3);
    write.String(name);
    write.String(name);  // its frame's name
    write.String("");
  }
  return bytes;
}

std::optional<ScanLimits> ReadScanGeometry(const Message& geometry) {
  if (geometry.error != 0 || geometry.data.size() != 8 + kTimeAndStep) return {};
  const double* const data = geometry.data.data();
  const double rows = data[4], columns = data[5], low = data[6], step = data[7];
  const bool finite =
      std::isfinite(data[0]) && std::isfinite(data[1]) && std::isfinite(low) && std::isfinite(step);
  if (!finite || !(rows >= 1) || !(columns >= 1) || rows > 1e6 || columns > 1e6) return {};
  ScanLimits limits;
  limits.columns = static_cast<std::size_t>(columns);
  limits.first_deg = data[0] * kDegreesInRadian;
  limits.increment_deg = data[1] * kDegreesInRadian;
  limits.end_deg = limits.first_deg + static_cast<double>(limits.columns) * limits.increment_deg;
  limits.min_range_m = data[2];
  limits.max_range_m = data[3];
  const double level = step == 0 ? 0 : std::round(-low / step);
  limits.row = static_cast<std::size_t>(std::clamp(level, 0.0, rows - 1));
  return limits;
}

}  // namespace coopdyn
