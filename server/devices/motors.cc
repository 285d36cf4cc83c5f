// SPDX-License-Identifier: MIT
#include "server/devices/motors.h"

#include <spdlog/fmt/fmt.h>

#include "server/model/drive.h"

namespace coopdyn {

std::optional<Actuation> MotorsDevice::Actuate(const Message& request) const {
  Actuation actuation;
  if (!request.params.empty()) actuation.steps = request.params.front();
  double factor = 1;
  switch (request.command) {
    case command::kSetWheelSpeeds:
      actuation.wheel_speed_rad_s = LimitWheels(drive_, {request.data[0], request.data[1]}, factor);
      if (factor != 1) {
        actuation.limited = fmt::format("limited to {:.6g} {:.6g} rad/s", actuation.wheel_speed_rad_s[0],
                                        actuation.wheel_speed_rad_s[1]);
      }
      return actuation;
    case command::kSetVelocity:
      actuation.wheel_speed_rad_s = WheelsFor(drive_, request.data[0], request.data[1], factor);
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
