// SPDX-License-Identifier: MIT
#include "server/devices/devices.h"

#include <spdlog/fmt/fmt.h>

#include <span>
#include <utility>

#include "server/model/drive.h"

namespace coopdyn {

std::optional<Actuation> MotorsDevice::Actuate(const Message& request, const Frame& /*frame*/,
                                               int /*robot*/) const {
  WheelSpeeds wheels_rad_s{};
  double factor = 1;
  std::string limited;
  switch (request.command) {
    case command::kSetWheelSpeeds:
      wheels_rad_s = LimitWheels(drive_, {request.data[0], request.data[1]}, factor);
      if (factor != 1 || (drive_.steering && wheels_rad_s != WheelSpeeds{request.data[0], request.data[1]})) {
        limited = fmt::format("limited to {:.6g} {:.6g} rad/s", wheels_rad_s[0], wheels_rad_s[1]);
      }
      break;
    case command::kSetVelocity: {
      const double turn_rad_s = LimitTurn(drive_, request.data[0], request.data[1]);
      wheels_rad_s = WheelsFor(drive_, request.data[0], turn_rad_s, factor);
      if (factor != 1 || turn_rad_s != request.data[1]) {
        limited =
            fmt::format("limited to {:.6g} m/s {:.6g} rad/s", request.data[0] * factor, turn_rad_s * factor);
      }
      break;
    }
    case command::kStop:
      break;
    default:
      return std::nullopt;
  }
  const auto setpoints = SetpointsFor(wheels_rad_s);
  Actuation actuation{{setpoints.begin(), setpoints.end()}, std::nullopt, std::move(limited)};
  if (!request.params.empty()) actuation.steps = request.params.front();
  return actuation;
}

void MotorsDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  const std::span<const ChannelState> wheels = ChannelsOf(frame, robot).subspan(first_channel_, 2);
  for (const ChannelState& wheel : wheels) data.push_back(wheel.position);
  for (const ChannelState& wheel : wheels) data.push_back(wheel.velocity);
}

Message MotorsDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetLimits) {
    reply.data = {drive_.max_wheel_speed_rad_s, drive_.wheel_radius_m, drive_.track_m};
  } else {
    reply.data.reserve(6);
    AppendFirstReading(frame, robot, reply.data);
  }
  return reply;
}

}  // namespace coopdyn
