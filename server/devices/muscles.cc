// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include "server/devices/devices.h"
#include "server/state/joint_tuning.h"

namespace coopdyn {

std::optional<Message> MusclesDevice::Refuse(const Message& request) const {
  const CommandSpec& spec = *table().Find(request.command);
  if (request.command != command::kSetActivations && request.command != command::kGetMuscles) return {};
  std::string why;
  const std::vector<std::size_t> muscles = JointsOf(request.params, actuator_.joints.size(), why, "muscle");
  if (!why.empty()) return ErrorReply(request.command, Error::kWrongParams, spec.name + ": " + why);
  const std::size_t wanted = request.command == command::kSetActivations ? muscles.size() : 0;
  if (request.data.size() == wanted) return std::nullopt;
  return ErrorReply(request.command, Error::kWrongData,
                    fmt::format("{} takes {} value{}, not {}: {}", spec.name, wanted, wanted == 1 ? "" : "s",
                                request.data.size(), spec.example));
}

std::optional<Actuation> MusclesDevice::Actuate(const Message& request, const Frame& /*frame*/,
                                                int /*robot*/) const {
  if (request.command != command::kSetActivations) return std::nullopt;
  std::string why;
  Actuation actuation;
  actuation.setpoints.assign(actuator_.joints.size(), {0, ControlMode::kKeep});
  const std::vector<std::size_t> muscles = JointsOf(request.params, actuator_.joints.size(), why, "muscle");
  bool limited = false;
  for (std::size_t i = 0; i < muscles.size(); ++i) {
    Setpoint& setpoint = actuation.setpoints[muscles[i]];
    setpoint = Limit(JointOf(muscles[i]), {request.data[i], ControlMode::kPwm});
    limited |= setpoint.reference != request.data[i];
  }
  if (limited) {
    actuation.limited = "limited to";
    for (const std::size_t muscle : muscles)
      actuation.limited += fmt::format(" {:.6g}", actuation.setpoints[muscle].reference);
  }
  return actuation;
}

void MusclesDevice::Append(const Frame& frame, int robot, std::size_t muscle,
                           std::vector<double>& data) const {
  const ChannelState& channel = ChannelsOf(frame, robot)[first_channel_ + muscle];
  const MuscleModel& model = *JointOf(muscle).muscle;
  const double activation = channel.setpoint.mode == ControlMode::kPwm ? channel.setpoint.reference : 0;
  data.insert(data.end(),
              {activation, channel.effort, channel.position, channel.velocity,
               LengthFactor(model, channel.position), VelocityFactorOf(model, -channel.velocity).value});
}

void MusclesDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  for (std::size_t i = 0; i < actuator_.joints.size(); ++i) Append(frame, robot, i, data);
}

Message MusclesDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetMuscleLimits) {
    for (std::size_t i = 0; i < actuator_.joints.size(); ++i) {
      const MuscleModel& model = *JointOf(i).muscle;
      reply.data.insert(reply.data.end(),
                        {model.max_force_n, model.optimal_length_m, model.max_velocity_m_s});
      reply.text += (reply.text.empty() ? "" : " ") + JointOf(i).name;
    }
    return reply;
  }
  std::string why;
  for (const std::size_t i : JointsOf(request.params, actuator_.joints.size(), why, "muscle"))
    Append(frame, robot, i, reply.data);
  return reply;
}

}  // namespace coopdyn
