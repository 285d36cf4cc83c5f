// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include "server/devices/devices.h"
#include "server/state/joint_tuning.h"

namespace coopdyn {

namespace {

struct ActuatorWords {
  const char* one;
  std::int32_t set, get, get_limits;
  ControlMode mode;
};

ActuatorWords WordsOf(const ActuatorModel& actuator) {
  if (actuator.is_muscles())
    return {"muscle", command::kSetActivations, command::kGetMuscles, command::kGetMuscleLimits,
            ControlMode::kPwm};
  return {"thruster", command::kSetThrusts, command::kGetThrusts, command::kGetThrusterLimits,
          ControlMode::kEffort};
}

void AppendMuscle(const MuscleModel& model, const ChannelState& channel, std::vector<double>& data) {
  const double activation = channel.setpoint.mode == ControlMode::kPwm ? channel.setpoint.reference : 0;
  data.insert(data.end(),
              {activation, channel.effort, channel.position, channel.velocity,
               LengthFactor(model, channel.position), VelocityFactorOf(model, -channel.velocity).value});
}

}  // namespace

std::vector<std::size_t> ActuatorsDevice::Chosen(const Message& request, std::string& why) const {
  return JointsOf(request.params, actuator_.joints.size(), why, WordsOf(actuator_).one);
}

std::optional<Message> ActuatorsDevice::Refuse(const Message& request) const {
  const CommandSpec& spec = *table().Find(request.command);
  const ActuatorWords words = WordsOf(actuator_);
  if (request.command != words.set && request.command != words.get) return {};
  std::string why;
  const std::vector<std::size_t> chosen = Chosen(request, why);
  if (!why.empty()) return ErrorReply(request.command, Error::kWrongParams, spec.name + ": " + why);
  const std::size_t wanted = request.command == words.set ? chosen.size() : 0;
  if (request.data.size() == wanted) return std::nullopt;
  return ErrorReply(request.command, Error::kWrongData,
                    fmt::format("{} takes {} value{}, not {}: {}", spec.name, wanted, wanted == 1 ? "" : "s",
                                request.data.size(), spec.example));
}

std::optional<Actuation> ActuatorsDevice::Actuate(const Message& request, const Frame& /*frame*/,
                                                  int /*robot*/) const {
  const ActuatorWords words = WordsOf(actuator_);
  if (request.command != words.set) return std::nullopt;
  std::string why;
  Actuation actuation;
  actuation.setpoints.assign(actuator_.joints.size(), {0, ControlMode::kKeep});
  const std::vector<std::size_t> chosen = Chosen(request, why);
  bool limited = false;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Setpoint& setpoint = actuation.setpoints[chosen[i]];
    setpoint = Limit(JointOf(chosen[i]), {request.data[i], words.mode});
    limited |= setpoint.reference != request.data[i];
  }
  if (!limited) return actuation;
  actuation.limited = "limited to";
  for (const std::size_t i : chosen)
    actuation.limited += fmt::format(" {:.6g}", actuation.setpoints[i].reference);
  return actuation;
}

void ActuatorsDevice::Append(const Frame& frame, int robot, std::size_t index,
                             std::vector<double>& data) const {
  const ChannelState& channel = ChannelsOf(frame, robot)[first_channel_ + index];
  if (const auto& muscle = JointOf(index).muscle) return AppendMuscle(*muscle, channel, data);
  data.insert(data.end(), {channel.effort, channel.velocity});
}

void ActuatorsDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  for (std::size_t i = 0; i < actuator_.joints.size(); ++i) Append(frame, robot, i, data);
}

Message ActuatorsDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == WordsOf(actuator_).get_limits) {
    for (std::size_t i = 0; i < actuator_.joints.size(); ++i) {
      const JointModel& joint = JointOf(i);
      reply.text += (reply.text.empty() ? "" : " ") + joint.name;
      if (joint.muscle) {
        reply.data.insert(reply.data.end(), {joint.muscle->max_force_n, joint.muscle->optimal_length_m,
                                             joint.muscle->max_velocity_m_s});
      } else {
        reply.data.push_back(joint.max_effort);
      }
    }
    return reply;
  }
  std::string why;
  for (const std::size_t i : Chosen(request, why)) Append(frame, robot, i, reply.data);
  return reply;
}

}  // namespace coopdyn
