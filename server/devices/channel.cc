// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include <type_traits>
#include <utility>

#include "server/devices/devices.h"

namespace coopdyn {

namespace {

/// The joint's parent link.
int ParentOf(const RobotModel& model, const std::string& name) {
  for (const JointModel& joint : model.joints) {
    if (joint.name == name) return joint.parent;
  }
  return 0;
}

/// The link that carries the sensor; the first one if it has several mounts; else the base.
int CarrierOf(const SensorKind& kind) {
  const auto first = [](const auto& places) { return places.empty() ? 0 : places.front().mount.link; };
  return std::visit(
      [&]<typename Kind>(const Kind& one) {
        if constexpr (requires { one.mount.link; }) {
          return one.mount.link;
        } else if constexpr (requires { one.beams.front().mount; }) {
          return first(one.beams);
        } else if constexpr (requires { one.eyes.front().mount; }) {
          return first(one.eyes);
        } else if constexpr (std::is_same_v<Kind, ContactModel>) {
          return one.parts.empty() ? 0 : one.parts.front().link;
        } else {
          return 0;
        }
      },
      kind);
}

int LinkOf(const RobotModel& model, const ChannelModel::Value& value) {
  using Quantity = ChannelModel::Quantity;
  if (value.quantity == Quantity::kReading) {
    const SensorKind& kind = model.sensors[value.source].kind;
    if (const auto* sonar = std::get_if<SonarModel>(&kind);
        sonar != nullptr && value.index < sonar->beams.size())
      return sonar->beams[value.index].mount.link;
    return CarrierOf(kind);
  }
  return value.quantity <= Quantity::kEnergy ? ParentOf(model, value.of) : value.mount.link;
}

}  // namespace

Message ChannelDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command != command::kGetChannel) {
    return SensorDevice::Read(request, frame, robot);
  }
  Message reply = ReplyTo(request.command);
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* const model = robot_model.Find<ChannelModel>(number());
  if (model == nullptr) return reply;
  const auto add = [&reply](const std::string& name, const ValueMap& map, bool auxiliary, int link) {
    reply.text += (reply.text.empty() ? "" : " ") + name;
    reply.data.insert(reply.data.end(), {map.internal_min, map.internal_max, map.external_min,
                                         map.external_max, auxiliary ? 1.0 : 0.0, link + 1.0});
  };
  for (const ChannelModel::Motor& motor : model->motors)
    add(motor.name, motor.map, false, ParentOf(robot_model, motor.joint));
  for (const ChannelModel::Value& value : model->values)
    add(value.name, value.map, value.auxiliary, LinkOf(robot_model, value));
  reply.params = {static_cast<std::int32_t>(model->motors.size()),
                  static_cast<std::int32_t>(model->values.size()), model->steps,
                  static_cast<std::int32_t>(robot_model.links.size())};
  return reply;
}

std::optional<Actuation> ChannelDevice::Actuate(const Message& request, const Frame& frame, int robot) const {
  if (request.command != command::kSetMotors) return std::nullopt;
  const auto* const model = ModelOf(frame, robot).Find<ChannelModel>(number());
  if (model == nullptr) return std::nullopt;
  Actuation actuation;
  if (request.data.size() != model->motors.size()) {
    actuation.refusal =
        fmt::format("set_motors takes {} value{}, one for each motor, not {}", model->motors.size(),
                    model->motors.size() == 1 ? "" : "s", request.data.size());
    return actuation;
  }
  actuation.setpoints = ChannelSetpoints(frame, robot, number(), request.data);
  actuation.steps = request.params.empty() ? model->steps : request.params.front();
  return actuation;
}

std::string ChannelDevice::StepNote(const Frame& frame, int robot) const {
  return IsAborted(frame, robot, number()) ? kAborted : "";
}

}  // namespace coopdyn
