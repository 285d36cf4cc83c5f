// SPDX-License-Identifier: MIT
#include "server/yarp/board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kUnlimited = 1e9;  // programs calculate with limits
constexpr std::size_t kParams = 3, kData = 18;
// Default compliance of a servo that becomes compliant: it yields by about this much (rad, m) at full effort,
// and is well damped.
constexpr double kGivesWay = 0.2, kDampingTime_s = 0.1, kDefaultStiffness = 100;

constexpr std::array<std::string_view, 6> kModeWords = {"idl", "pos", "posd", "vel", "torq", "pwm"};

double Limited(double value) {
  return std::clamp(value, -kUnlimited, kUnlimited);
}

/// YARP's units per rad or m of the joint.
double UnitOf(const BoardJoint& joint) {
  return joint.slides ? 1 : kDegrees;
}

bool Places(BoardMode mode) {
  return mode == BoardMode::kPosition || mode == BoardMode::kDirect;
}

std::vector<double> ValuesOf(BoardItem item, const BoardJoint& joint) {
  const auto one_if = [](bool condition) { return std::vector<double>{condition ? 1.0 : 0.0}; };
  const double reference = Places(joint.mode) ? joint.reference : joint.position;
  switch (item) {
    case BoardItem::kType:
      return one_if(joint.slides);
    case BoardItem::kPosition:
      return {joint.position};
    case BoardItem::kVelocity:
      return {joint.velocity};
    case BoardItem::kEffort:
      return {joint.effort};
    case BoardItem::kTarget:
      return {joint.target};
    case BoardItem::kDirect:
    case BoardItem::kPidReference:
      return {reference};
    case BoardItem::kVelocityReference:
      return {joint.mode == BoardMode::kVelocity ? joint.reference : 0};
    case BoardItem::kTorque:
      return {joint.mode == BoardMode::kTorque ? joint.reference : 0};
    case BoardItem::kSpeed:
      return {joint.speed};
    case BoardItem::kAcceleration:
      return {joint.acceleration};
    case BoardItem::kPositionLimits:
      return {joint.lower, joint.upper};
    case BoardItem::kVelocityLimits:
      return {0, joint.max_velocity};
    case BoardItem::kTorqueRange:
      return {-joint.max_effort, joint.max_effort};
    case BoardItem::kMode:
      return {static_cast<double>(joint.mode)};
    case BoardItem::kCompliant:
      return one_if(!joint.stiff);
    case BoardItem::kImpedance:
      return {joint.stiffness, joint.damping};
    case BoardItem::kImpedanceOffset:
      return {joint.offset};
    case BoardItem::kImpedanceLimits:
      return {0, kUnlimited, 0, kUnlimited};
    case BoardItem::kPid:
      return {joint.p, joint.d, joint.i, 0, 0, 0, 0, 0, 0, 0};
    case BoardItem::kPidError:
      return {reference - joint.position};
    case BoardItem::kPidOutput:
      return {joint.p * (reference - joint.position)};
    case BoardItem::kPidEnabled:
      return one_if(Places(joint.mode) || joint.mode == BoardMode::kVelocity);
    case BoardItem::kAmplifier:
      return one_if(joint.mode != BoardMode::kIdle);
    case BoardItem::kGearRatio:
      return {1};
    case BoardItem::kCounts:
      return {joint.counts};
    default:
      return {};
  }
}

BoardAnswer Failed(BoardAnswer::Kind kind, std::string why) {
  return {.kind = kind, .why = std::move(why)};
}

/// A command for `joints`, with their values in `data`.
Message CommandFor(command::Id id, const std::vector<std::size_t>& joints, std::vector<double> data) {
  Message command;
  command.command = id;
  for (const std::size_t joint : joints) command.params.push_back(static_cast<std::int32_t>(joint) + 1);
  command.data = std::move(data);
  return command;
}

/// The command that sets one reference per joint; 0 if `item` is not a reference.
command::Id ReferenceCommand(BoardItem item) {
  switch (item) {
    case BoardItem::kTarget:
    case BoardItem::kRelative:
      return command::kSetPositions;
    case BoardItem::kDirect:
      return command::kSetPositionsDirect;
    case BoardItem::kVelocityReference:
      return command::kSetVelocities;
    case BoardItem::kTorque:
      return command::kSetEfforts;
    default:
      return 0;
  }
}

/// Stops moving joints where they are; joints in torque, PWM or idle mode are unchanged.
std::vector<Message> Stop(const BoardState& state, const std::vector<std::size_t>& joints) {
  std::vector<Message> commands;
  for (const auto& [mode, id] : {std::pair{BoardMode::kPosition, command::kHold},
                                 std::pair{BoardMode::kDirect, command::kSetPositionsDirect},
                                 std::pair{BoardMode::kVelocity, command::kSetVelocities}}) {
    Message command;
    command.command = id;
    for (const std::size_t i : joints) {
      const BoardJoint& joint = state.joints[i];
      if (joint.mode != mode) continue;
      command.params.push_back(static_cast<std::int32_t>(i) + 1);
      if (mode == BoardMode::kDirect) command.data.push_back(joint.position / UnitOf(joint));
      if (mode == BoardMode::kVelocity) command.data.push_back(0);
    }
    if (!command.params.empty()) commands.push_back(std::move(command));
  }
  return commands;
}

}  // namespace

std::string_view BoardModeWord(BoardMode mode) {
  return kModeWords[static_cast<std::size_t>(mode)];
}

std::optional<BoardMode> BoardModeNamed(std::string_view word) {
  if (word == "veld") word = "vel";
  if (word == "fidl") word = "idl";
  // PWM mode can be shown but not set: YARP has no other word for a braking joint.
  const auto* const end = kModeWords.end() - 1;
  const auto* const found = std::find(kModeWords.begin(), end, word);
  if (found == end) return {};
  return static_cast<BoardMode>(found - kModeWords.begin());
}

std::optional<BoardState> ReadBoard(const Message& reply) {
  const std::size_t count = reply.params.size() / kParams;
  if (reply.error != 0 || count == 0 || reply.params.size() != kParams * count ||
      reply.data.size() != kData * count + 2)
    return {};
  BoardState state{reply.data[kData * count], static_cast<std::int64_t>(reply.data.back()), {}};
  std::istringstream names(reply.text);
  const std::int32_t* param = reply.params.data();
  const double* value = reply.data.data();
  for (std::size_t i = 0; i < count; ++i, param += kParams, value += kData) {
    BoardJoint joint;
    if (!(names >> joint.name)) joint.name = "joint" + std::to_string(i);
    joint.slides = param[0] == 1;
    joint.mode = static_cast<BoardMode>(std::clamp(param[1], 0, static_cast<int>(kModeWords.size()) - 1));
    joint.arrived = param[2] == 1;
    const double unit = UnitOf(joint);
    joint.position = value[0] * unit;
    joint.velocity = value[1] * unit;
    joint.effort = std::isnan(value[2]) ? 0 : value[2];  // before the first step
    joint.target = value[3] * unit;
    joint.reference = value[4] * (joint.mode == BoardMode::kTorque ? 1 : unit);
    joint.lower = Limited(value[5] * unit);
    joint.upper = Limited(value[6] * unit);
    joint.max_velocity = Limited(value[7] * unit);
    joint.max_effort = Limited(value[8]);
    joint.stiff = std::isinf(value[9]);
    joint.stiffness = value[9] / unit;
    joint.damping = value[10] / unit;
    if (joint.stiff) {
      const double stiffness = std::isfinite(value[8]) ? value[8] / kGivesWay : kDefaultStiffness;
      joint.stiffness = stiffness / unit;
      joint.damping = kDampingTime_s * joint.stiffness;
    }
    joint.offset = value[11];
    joint.speed = Limited(value[12] * unit);
    joint.acceleration = Limited(value[13] * unit);
    joint.p = value[14];
    joint.i = value[15];
    joint.d = value[16];
    if (!joint.slides && value[17] > 0) joint.counts = 2 * std::numbers::pi / value[17];
    state.joints.push_back(std::move(joint));
  }
  return state;
}

std::size_t BoardWidth(BoardItem item) {
  switch (item) {
    case BoardItem::kNothing:
    case BoardItem::kAxes:
    case BoardItem::kDone:
    case BoardItem::kStop:
    case BoardItem::kName:
    case BoardItem::kPidReset:
      return 0;
    case BoardItem::kPositionLimits:
    case BoardItem::kVelocityLimits:
    case BoardItem::kTorqueRange:
    case BoardItem::kImpedance:
      return 2;
    case BoardItem::kImpedanceLimits:
      return 4;
    case BoardItem::kPid:
      return 10;
    default:
      return 1;
  }
}

BoardAnswer BoardClient::Answer(const BoardCall& call, BoardState state) {
  using Kind = BoardAnswer::Kind;
  if (call.item == BoardItem::kNothing) return Failed(Kind::kNotThere, call.refusal);
  Overlay(state);
  std::vector<std::size_t> joints;
  const auto count = static_cast<int>(state.joints.size());
  for (int i = 0; i < count && !call.joints; ++i) joints.push_back(static_cast<std::size_t>(i));
  if (call.joints) {
    for (const int joint : *call.joints) {
      if (joint < 0 || joint >= count) {
        return Failed(Kind::kOutOfBounds, "there is no joint " + std::to_string(joint) +
                                              ": they are counted from 0 to " + std::to_string(count - 1));
      }
      joints.push_back(static_cast<std::size_t>(joint));
    }
    std::vector<std::size_t> sorted = joints;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end())
      return Failed(Kind::kFailed, "a joint is named twice");
  }
  if (call.tells) {
    const std::size_t expected = BoardWidth(call.item) * joints.size();
    if (call.values.size() != expected) {
      return Failed(Kind::kFailed, std::to_string(expected) + (expected == 1 ? " value is" : " values are") +
                                       " needed for " + std::to_string(joints.size()) +
                                       (joints.size() == 1 ? " joint" : " joints") + ", not " +
                                       std::to_string(call.values.size()));
    }
    if (!std::ranges::all_of(call.values, [](double value) { return std::isfinite(value); }))
      return Failed(Kind::kFailed, "values are finite numbers");
    return Tell(call, state, joints);
  }
  BoardAnswer answer;
  if (call.item == BoardItem::kAxes) {
    answer.values = {static_cast<double>(count)};
  } else if (call.item == BoardItem::kDone) {
    answer.values = {
        std::ranges::all_of(joints, [&](std::size_t i) { return state.joints[i].arrived; }) ? 1.0 : 0.0};
  }
  for (const std::size_t i : joints) {
    const BoardJoint& joint = state.joints[i];
    if (call.item == BoardItem::kCounts && joint.counts <= 0) {
      return Failed(Kind::kNotThere,
                    joint.slides ? "joint " + std::to_string(i) + " slides: it has no revolutions"
                                 : "the encoder of joint " + std::to_string(i) +
                                       " is exact: it counts when its group has an encoder_resolution");
    }
    if (call.item == BoardItem::kName) answer.names.push_back(joint.name);
    const std::vector<double> values = ValuesOf(call.item, joint);
    answer.values.insert(answer.values.end(), values.begin(), values.end());
  }
  return answer;
}

BoardAnswer BoardClient::Tell(const BoardCall& call, const BoardState& state,
                              const std::vector<std::size_t>& joints) {
  using Kind = BoardAnswer::Kind;
  BoardAnswer answer;
  const auto joint = [&](std::size_t k) -> const BoardJoint& { return state.joints[joints[k]]; };
  if (const command::Id id = ReferenceCommand(call.item); id != 0) {
    std::vector<double> data;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      double value = call.values[k];
      if (call.item == BoardItem::kRelative) value += joint(k).position;
      data.push_back(call.item == BoardItem::kTorque ? value : value / UnitOf(joint(k)));
    }
    answer.commands = {CommandFor(id, joints, std::move(data))};
    return answer;
  }
  std::vector<double> data;
  switch (call.item) {
    case BoardItem::kStop:
      answer.commands = Stop(state, joints);
      break;
    case BoardItem::kMode:
      answer.commands = {CommandFor(command::kSetModes, joints, call.values)};
      break;
    case BoardItem::kSpeed:
    case BoardItem::kAcceleration:
      for (std::size_t k = 0; k < joints.size(); ++k) {
        const bool speed = call.item == BoardItem::kSpeed;
        data.push_back((speed ? call.values[k] : joint(k).speed) / UnitOf(joint(k)));
        data.push_back((speed ? joint(k).acceleration : call.values[k]) / UnitOf(joint(k)));
      }
      answer.commands = {CommandFor(command::kSetProfile, joints, std::move(data))};
      break;
    case BoardItem::kPid:
      for (std::size_t k = 0; k < joints.size(); ++k) {
        const double* const pid = &call.values[10 * k];
        data.insert(data.end(), {pid[0], pid[2], pid[1]});
      }
      answer.commands = {CommandFor(command::kSetGains, joints, std::move(data))};
      break;
    case BoardItem::kPidReset:  // setting gains clears the integral
      for (std::size_t k = 0; k < joints.size(); ++k)
        data.insert(data.end(), {joint(k).p, joint(k).i, joint(k).d});
      answer.commands = {CommandFor(command::kSetGains, joints, std::move(data))};
      break;
    case BoardItem::kAmplifier:
      for (std::size_t k = 0; k < joints.size(); ++k) {
        const BoardMode mode = call.values[k] == 0                 ? BoardMode::kIdle
                               : joint(k).mode == BoardMode::kIdle ? BoardMode::kPosition
                                                                   : joint(k).mode;
        data.push_back(static_cast<double>(mode));
      }
      answer.commands = {CommandFor(command::kSetModes, joints, std::move(data))};
      break;
    case BoardItem::kCompliant:
    case BoardItem::kImpedance:
    case BoardItem::kImpedanceOffset:
      answer.commands = {Compliance(call, state, joints)};
      break;
    case BoardItem::kPositionLimits:
    case BoardItem::kVelocityLimits:
      return Failed(Kind::kNotThere, "the limits are those of the robot's model: change them there");
    default:
      return Failed(Kind::kNotThere, "this can be read only");
  }
  return answer;
}

Message BoardClient::Compliance(const BoardCall& call, const BoardState& state,
                                const std::vector<std::size_t>& joints) {
  impedances_.resize(state.joints.size());
  std::vector<double> data;  // includes unchanged values: the module decides whether the client may set them
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const BoardJoint& joint = state.joints[joints[k]];
    auto& kept = impedances_[joints[k]];
    double stiffness = joint.stiffness, damping = joint.damping, offset = joint.offset;
    bool stiff = joint.stiff;
    if (call.item == BoardItem::kImpedance) {
      stiffness = call.values[2 * k];
      damping = call.values[2 * k + 1];
      kept = {stiffness, damping};  // for a stiff joint: used when it becomes compliant
    } else if (call.item == BoardItem::kImpedanceOffset) {
      offset = call.values[k];
    } else {
      stiff = call.values[k] == 0;
      if (stiff && !joint.stiff) kept = {stiffness, damping};
    }
    const double unit = UnitOf(joint);
    data.insert(data.end(),
                {stiff ? std::numeric_limits<double>::infinity() : stiffness * unit, damping * unit, offset});
  }
  return CommandFor(command::kSetCompliance, joints, std::move(data));
}

void BoardClient::OverlayReference(double reference, BoardJoint& joint) {
  const double value = reference * UnitOf(joint);
  if (Places(joint.mode)) joint.target = std::clamp(value, joint.lower, joint.upper);
  if (joint.mode == BoardMode::kDirect) joint.reference = joint.target;
  if (joint.mode == BoardMode::kVelocity)
    joint.reference = std::clamp(value, -joint.max_velocity, joint.max_velocity);
  if (joint.mode == BoardMode::kTorque)
    joint.reference = std::clamp(reference, -joint.max_effort, joint.max_effort);
}

void BoardClient::Overlay(BoardState& state) const {
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    BoardJoint& joint = state.joints[i];
    if (i < impedances_.size() && joint.stiff && impedances_[i]) {
      joint.stiffness = impedances_[i]->first;
      joint.damping = impedances_[i]->second;
    }
    if (i >= commanded_.size() || state.step > commanded_[i].until_step) continue;
    if (commanded_[i].mode) joint.mode = *commanded_[i].mode;
    if (commanded_[i].moves) joint.arrived = false;
    if (commanded_[i].reference) OverlayReference(*commanded_[i].reference, joint);
  }
}

void BoardClient::Taken(const Message& command, const Message& reply) {
  constexpr std::int32_t kLockstep = 1;
  // In lockstep the step has run already; get_board shows changes of tuning at once.
  if (reply.error != 0 || reply.params.empty() || reply.params[0] == kLockstep || reply.data.empty()) return;
  std::optional<BoardMode> mode;
  switch (command.command) {
    case command::kSetPositions:
    case command::kHold:
      mode = BoardMode::kPosition;
      break;
    case command::kSetPositionsDirect:
      mode = BoardMode::kDirect;
      break;
    case command::kSetVelocities:
      mode = BoardMode::kVelocity;
      break;
    case command::kSetEfforts:
      mode = BoardMode::kTorque;
      break;
    default:
      break;
  }
  const bool refers = mode && command.command != command::kHold;
  for (std::size_t k = 0; k < command.params.size(); ++k) {
    const auto joint = static_cast<std::size_t>(command.params[k]) - 1;
    if (joint >= commanded_.size()) commanded_.resize(joint + 1);
    // The current step may have missed the command.
    commanded_[joint] = {static_cast<std::int64_t>(reply.data.back()) + 1,
                         command.command == command::kSetModes
                             ? std::optional(static_cast<BoardMode>(static_cast<int>(command.data[k])))
                             : mode,
                         command.command == command::kSetPositions,
                         refers ? std::optional(command.data[k]) : std::nullopt};
  }
}

}  // namespace coopdyn
