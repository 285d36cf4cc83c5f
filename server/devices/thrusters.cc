// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include "server/devices/devices.h"
#include "server/state/joint_tuning.h"

namespace coopdyn {

std::optional<Message> ThrustersDevice::Refuse(const Message& request) const {
  const CommandSpec& spec = *table().Find(request.command);
  if (request.command != command::kSetThrusts && request.command != command::kGetThrusts) return {};
  std::string why;
  const std::vector<std::size_t> thrusters =
      JointsOf(request.params, actuator_.joints.size(), why, "thruster");
  if (!why.empty()) return ErrorReply(request.command, Error::kWrongParams, spec.name + ": " + why);
  const std::size_t wanted = request.command == command::kSetThrusts ? thrusters.size() : 0;
  if (request.data.size() == wanted) return std::nullopt;
  return ErrorReply(request.command, Error::kWrongData,
                    fmt::format("{} takes {} value{}, not {}: {}", spec.name, wanted, wanted == 1 ? "" : "s",
                                request.data.size(), spec.example));
}

std::optional<Actuation> ThrustersDevice::Actuate(const Message& request, const Frame& /*frame*/,
                                                  int /*robot*/) const {
  if (request.command != command::kSetThrusts) return std::nullopt;
  std::string why;
  Actuation actuation;
  actuation.setpoints.assign(actuator_.joints.size(), {0, ControlMode::kKeep});
  const std::vector<std::size_t> thrusters =
      JointsOf(request.params, actuator_.joints.size(), why, "thruster");
  bool limited = false;
  for (std::size_t i = 0; i < thrusters.size(); ++i) {
    Setpoint& setpoint = actuation.setpoints[thrusters[i]];
    setpoint = Limit(JointOf(thrusters[i]), {request.data[i], ControlMode::kEffort});
    limited |= setpoint.reference != request.data[i];
  }
  if (!limited) return actuation;
  actuation.limited = "limited to";
  for (const std::size_t thruster : thrusters)
    actuation.limited += fmt::format(" {:.6g}", actuation.setpoints[thruster].reference);
  return actuation;
}

void ThrustersDevice::Append(const Frame& frame, int robot, std::size_t thruster,
                             std::vector<double>& data) const {
  const ChannelState& channel = ChannelsOf(frame, robot)[first_channel_ + thruster];
  data.insert(data.end(), {channel.effort, channel.velocity});
}

void ThrustersDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  for (std::size_t i = 0; i < actuator_.joints.size(); ++i) Append(frame, robot, i, data);
}

Message ThrustersDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetThrusterLimits) {
    for (std::size_t i = 0; i < actuator_.joints.size(); ++i) {
      reply.data.push_back(JointOf(i).max_effort);
      reply.text += (reply.text.empty() ? "" : " ") + JointOf(i).name;
    }
    return reply;
  }
  std::string why;
  for (const std::size_t i : JointsOf(request.params, actuator_.joints.size(), why, "thruster"))
    Append(frame, robot, i, reply.data);
  return reply;
}

}  // namespace coopdyn
