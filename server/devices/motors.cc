// SPDX-License-Identifier: MIT
#include "server/devices/motors.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

/// Beyond any limit, and still far from overflow when divided by a wheel radius.
constexpr double kHuge = 1e100;

}  // namespace

Setpoint MotorsDevice::Limit(Setpoint wheels, double& factor) const {
  const double fastest = std::max(std::abs(wheels[0]), std::abs(wheels[1]));
  if (fastest <= drive_.max_wheel_speed_rad_s) return wheels;
  const double scale = drive_.max_wheel_speed_rad_s / fastest;
  factor *= scale;
  for (double& wheel : wheels) {
    // Rounding must not bring it beyond the limit again.
    wheel = std::clamp(wheel * scale, -drive_.max_wheel_speed_rad_s, drive_.max_wheel_speed_rad_s);
  }
  return wheels;
}

Setpoint MotorsDevice::WheelSpeeds(double linear_m_s, double angular_rad_s, double& factor) const {
  const double largest = std::max(std::abs(linear_m_s), std::abs(angular_rad_s));
  if (largest > kHuge) {
    factor = kHuge / largest;
    linear_m_s *= factor;
    angular_rad_s *= factor;
  }
  const double half_turn_m_s = angular_rad_s * drive_.track_m / 2;
  return Limit({(linear_m_s - half_turn_m_s) / drive_.wheel_radius_m,
                (linear_m_s + half_turn_m_s) / drive_.wheel_radius_m},
               factor);
}

std::optional<Actuation> MotorsDevice::Actuate(const Message& request) const {
  Actuation actuation;
  if (!request.params.empty()) actuation.steps = request.params.front();
  double factor = 1;
  switch (request.command) {
    case command::kSetWheelSpeeds:
      actuation.wheel_speed_rad_s = Limit({request.data[0], request.data[1]}, factor);
      if (factor != 1) {
        actuation.limited = fmt::format("limited to {:.6g} {:.6g} rad/s", actuation.wheel_speed_rad_s[0],
                                        actuation.wheel_speed_rad_s[1]);
      }
      return actuation;
    case command::kSetVelocity:
      actuation.wheel_speed_rad_s = WheelSpeeds(request.data[0], request.data[1], factor);
      if (factor != 1) {
        actuation.limited = fmt::format("limited to {:.6g} m/s {:.6g} rad/s", request.data[0] * factor,
                                        request.data[1] * factor);
      }
      return actuation;
    case command::kStop:
      return actuation;
    default:
      return std::nullopt;
  }
}

void MotorsDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  const SceneRobot& place = frame.scene->robots[static_cast<std::size_t>(robot)];
  const RobotState& state = frame.robots[static_cast<std::size_t>(place.slot)];
  data.insert(data.end(), {state.wheel_angle_rad[0], state.wheel_angle_rad[1], state.wheel_speed_rad_s[0],
                           state.wheel_speed_rad_s[1]});
}

Message MotorsDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request);
  if (request.command == command::kGetLimits) {
    reply.data = {drive_.max_wheel_speed_rad_s, drive_.wheel_radius_m, drive_.track_m};
  } else {
    reply.data.reserve(6);
    AppendFirstReading(frame, robot, reply.data);
  }
  return reply;
}

}  // namespace coopdyn
