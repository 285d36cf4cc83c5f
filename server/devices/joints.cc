// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "server/devices/devices.h"
#include "server/state/joint_tuning.h"
#include "server/state/noise.h"

namespace coopdyn {

namespace {

/// The control mode that a command selects.
std::optional<ControlMode> ModeOf(command::Id command) {
  switch (command) {
    case command::kSetPositions:
      return ControlMode::kPosition;
    case command::kSetPositionsDirect:
      return ControlMode::kDirect;
    case command::kSetVelocities:
      return ControlMode::kVelocity;
    case command::kSetEfforts:
      return ControlMode::kEffort;
    case command::kSetPwm:
      return ControlMode::kPwm;
    default:
      return std::nullopt;
  }
}

/// Number of values per joint in a request's data; 0: none.
std::size_t DataPerJoint(command::Id command) {
  if (IsTuning(command)) return ValuesPerJoint(command);
  return ModeOf(command) || command == command::kSetModes ? 1 : 0;
}

}  // namespace

JointsDevice::JointsDevice(const CommandTable& table, const RobotModel& model, std::size_t actuator)
    : Device(table),
      model_(model),
      actuator_(model.actuators[actuator]),
      board_(std::get<BoardModel>(actuator_.kind)) {
  first_channel_ = model.FirstChannel(actuator_);
  for (std::size_t i = 0; i < actuator; ++i) {
    if (model.actuators[i].is_board()) first_control_ += model.actuators[i].joints.size();
  }
}

std::optional<Message> JointsDevice::Refuse(const Message& request) const {
  const CommandSpec& spec = *table().Find(request.command);
  if (request.command < command::kGetJoints || spec.params.empty()) return std::nullopt;
  std::string why;
  const std::vector<std::size_t> joints = JointsOf(request.params, actuator_.joints.size(), why);
  if (!why.empty()) return ErrorReply(request.command, Error::kWrongParams, spec.name + ": " + why);
  const std::size_t each = DataPerJoint(request.command);
  const bool fits = request.data.size() == each * joints.size();
  for (std::size_t i = 0; i < joints.size() && fits; ++i) {
    const bool is_duty =
        request.command == command::kSetPwm ||
        (request.command == command::kSetModes && request.data[i] == static_cast<double>(ControlMode::kPwm));
    const JointModel& joint = model_.joints[static_cast<std::size_t>(actuator_.joints[joints[i]])];
    if (!is_duty || joint.drive_train) continue;
    return ErrorReply(request.command, Error::kNotPossible,
                      spec.name + ": joint " + joint.name +
                          " has no drive train: give its <joint> in the model a <coopdyn:drivetrain>");
  }
  if (fits) return std::nullopt;
  return ErrorReply(request.command, Error::kWrongData,
                    fmt::format("{} takes {} value{} for each of {} joint{}, not {} in all: {}", spec.name,
                                each, each == 1 ? "" : "s", joints.size(), joints.size() == 1 ? "" : "s",
                                request.data.size(), spec.example));
}

std::span<const ChannelState> JointsDevice::Channels(const Frame& frame, int robot) const {
  return ChannelsOf(frame, robot).subspan(first_channel_, actuator_.joints.size());
}

const JointControl& JointsDevice::Control(const Frame& frame, int robot, std::size_t joint) const {
  const int first = frame.scene->robots[static_cast<std::size_t>(robot)].first_control;
  return frame.controls[static_cast<std::size_t>(first) + first_control_ + joint];
}

double JointsDevice::Measured(const Frame& frame, int robot, std::size_t joint) const {
  double position = Channels(frame, robot)[joint].position;
  if (board_.encoder_noise_stddev > 0) {
    position += board_.encoder_noise_stddev *
                GaussianNoise({.seed = frame.seed,
                               .kind = NoiseKind::kEncoder,
                               .robot = frame.scene->robots[static_cast<std::size_t>(robot)].id.value,
                               .sensor = static_cast<std::uint32_t>(first_channel_ + joint),
                               .step = frame.step});
  }
  const double resolution = board_.encoder_resolution;
  return resolution > 0 ? std::round(position / resolution) * resolution : position;
}

std::optional<Actuation> JointsDevice::Actuate(const Message& request, const Frame& frame, int robot) const {
  const std::optional<ControlMode> mode = ModeOf(request.command);
  const bool sets_modes = request.command == command::kSetModes;
  if (!mode && !sets_modes && request.command != command::kHold) return std::nullopt;
  std::string why;
  const std::vector<std::size_t> joints = JointsOf(request.params, actuator_.joints.size(), why);
  const std::span<const ChannelState> channels = Channels(frame, robot);
  Actuation actuation;
  actuation.setpoints.assign(actuator_.joints.size(), {0, ControlMode::kKeep});
  bool limited = false;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Setpoint& setpoint = actuation.setpoints[joints[i]];
    const double here = channels[joints[i]].position;
    if (mode) {
      setpoint = {request.data[i], *mode};
    } else {
      setpoint.mode = sets_modes ? static_cast<ControlMode>(request.data[i]) : ControlMode::kPosition;
      const bool holds = setpoint.mode == ControlMode::kPosition || setpoint.mode == ControlMode::kDirect;
      setpoint.reference = holds ? here : 0;
    }
    const Setpoint asked = setpoint;
    setpoint = Limit(model_.joints[static_cast<std::size_t>(actuator_.joints[joints[i]])], setpoint);
    limited |= mode && setpoint.reference != asked.reference;
  }
  if (limited) {
    actuation.limited = "limited to";
    for (const std::size_t joint : joints) {
      actuation.limited += fmt::format(" {:.6g}", actuation.setpoints[joint].reference);
    }
  }
  return actuation;
}

std::optional<edit::TuneJoints> JointsDevice::Tune(const Message& request) const {
  if (!IsTuning(request.command)) return std::nullopt;
  return edit::TuneJoints{"", actuator_.module, request.command, request.params, request.data};
}

void JointsDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  const std::span<const ChannelState> channels = Channels(frame, robot);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    data.insert(data.end(), {Measured(frame, robot, i), channels[i].velocity, channels[i].effort});
  }
}

Message JointsDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command == command::kGetChain) return ReadChain();
  Message reply = ReplyTo(request.command);
  std::string why;
  const std::span<const ChannelState> channels = Channels(frame, robot);
  for (const std::size_t i : JointsOf(request.params, actuator_.joints.size(), why)) {
    const ChannelState& channel = channels[i];
    const JointControl& control = Control(frame, robot, i);
    const JointModel& joint = model_.joints[static_cast<std::size_t>(actuator_.joints[i])];
    const ControlMode mode = channel.setpoint.mode;
    const bool places = mode == ControlMode::kPosition || mode == ControlMode::kDirect;
    const std::int32_t arrived =
        mode == ControlMode::kPosition && control.reference != control.target ? 0 : 1;
    const double target = places ? control.target : channel.position,
                 reference = places ? control.reference : channel.setpoint.reference;
    const auto add_name = [&reply, &joint] { reply.text += (reply.text.empty() ? "" : " ") + joint.name; };
    const auto add = [&reply](std::initializer_list<double> values) {
      reply.data.insert(reply.data.end(), values);
    };
    switch (request.command) {
      case command::kGetModes:
        reply.params.push_back(static_cast<std::int32_t>(mode));
        break;
      case command::kGetCompliance:
        add({control.stiffness, control.damping, control.offset});
        break;
      case command::kGetProfile:
        add({control.speed, control.acceleration});
        break;
      case command::kGetGains:
        add({control.p, control.i, control.d});
        break;
      case command::kGetJointLimits:
        add({joint.lower, joint.upper, joint.max_velocity, joint.max_effort});
        add_name();
        break;
      case command::kGetMotion:
        reply.params.push_back(arrived);
        add({target});
        break;
      case command::kGetDriveTrains: {
        constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
        const DriveTrainState* train = DriveTrainOf(frame, robot, actuator_.joints[i]);
        if (train == nullptr) {
          add({kNone, kNone, kNone, kNone});
        } else {
          add({train->rotor_rad, train->rotor_rad_s, train->current_a, train->energy_j});
        }
        break;
      }
      case command::kGetReferences:
        add({reference});
        break;
      case command::kGetBoard:
        reply.params.insert(reply.params.end(), {joint.kind == JointModel::Kind::kSlider ? 1 : 0,
                                                 static_cast<std::int32_t>(mode), arrived});
        add({Measured(frame, robot, i), channel.velocity, channel.effort, target, reference, joint.lower,
             joint.upper, joint.max_velocity, joint.max_effort, control.stiffness, control.damping,
             control.offset, control.speed, control.acceleration, control.p, control.i, control.d,
             board_.encoder_resolution});
        add_name();
        break;
      default:
        add({Measured(frame, robot, i), channel.velocity, channel.effort});
    }
  }
  return reply;
}

Message JointsDevice::ReadChain() const {
  const bool starts_at_zero =
      std::ranges::all_of(model_.joints, [](const JointModel& j) { return j.start == 0; });
  const RobotModel zeroed = starts_at_zero ? RobotModel() : AtZero(model_);
  const RobotModel& model = starts_at_zero ? model_ : zeroed;
  std::vector<std::size_t> chain;  // from the tool to the base; indices into the board's joints
  const int link = model.joints[static_cast<std::size_t>(actuator_.joints.back())].child;
  const LinkModel& last = model.links[static_cast<std::size_t>(link)];
  const FrameModel tool = board_.tool ? *std::ranges::find(model.frames, board_.tool->name, &FrameModel::name)
                                      : FrameModel{last.name, link, last.X_RL};
  for (int at = tool.link; at != 0;) {
    const auto joint = std::ranges::find(model.joints, at, &JointModel::child);
    if (joint == model.joints.end()) break;
    const auto found = std::ranges::find(actuator_.joints, static_cast<int>(joint - model.joints.begin()));
    const auto index = static_cast<std::size_t>(found - actuator_.joints.begin());
    if (std::ranges::find(chain, index) != chain.end()) break;  // a loop
    if (found != actuator_.joints.end()) chain.push_back(index);
    at = joint->parent;
  }
  if (chain.empty() || (!board_.tool && chain.size() != actuator_.joints.size())) {
    return ErrorReply(command::kGetChain, Error::kNotPossible,
                      "the joints of " + actuator_.module +
                          " are no single chain: name its tool in the model, <coopdyn:group name=\"" +
                          actuator_.module + "\" tool=\"LINK\" …/>");
  }
  std::ranges::reverse(chain);
  Message reply = ReplyTo(command::kGetChain, tool.name);
  for (const std::size_t i : chain) {
    const JointModel& joint = model.joints[static_cast<std::size_t>(actuator_.joints[i])];
    reply.params.push_back(static_cast<std::int32_t>(i + 1));
    reply.params.push_back(joint.kind == JointModel::Kind::kSlider ? 1 : 0);
    const Vector3 axis = joint.axis_R.normalized();
    reply.data.insert(reply.data.end(),
                      {joint.p_RJ.x(), joint.p_RJ.y(), joint.p_RJ.z(), axis.x(), axis.y(), axis.z()});
  }
  const Pose& X_RT = tool.X_RF;
  reply.data.insert(reply.data.end(),
                    {X_RT.p.x(), X_RT.p.y(), X_RT.p.z(), X_RT.q.w(), X_RT.q.x(), X_RT.q.y(), X_RT.q.z()});
  return reply;
}

}  // namespace coopdyn
