// SPDX-License-Identifier: MIT
#include "server/record/state_codec.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "server/record/bytes.h"

namespace coopdyn {

namespace {

constexpr std::uint8_t kStateVersion = 1;
constexpr std::size_t kBodyBytes = (3 + 4 + 9 + 3 + 3) * 8 + 8;
constexpr std::size_t kMotionBytes = 3 * 2 * 8 + 1;
constexpr std::size_t kMessageBytes = 4 + 8 + 4;  // and its values
constexpr std::uint8_t kFrozenBit = 1, kCommandedBit = 2;

void PutBody(const BodyState& body, ByteWriter& writer) {
  writer.PutAll(body.p_WB);
  writer.PutAll(body.q_WB);
  writer.PutAll(body.R_WB);
  writer.PutAll(body.v_WB);
  writer.PutAll(body.w_WB);
  writer.Put(body.sleep_counter);
}

/// Numbers that an exact state may hold; anything else fails the reader.
template <typename Numbers>
void GetFinite(ByteReader& reader, Numbers& numbers) {
  for (double& number : numbers) {
    number = reader.Get<double>();
    if (!std::isfinite(number)) reader.Fail();
  }
}

BodyState GetBody(ByteReader& reader) {
  BodyState body;
  GetFinite(reader, body.p_WB);
  GetFinite(reader, body.q_WB);
  GetFinite(reader, body.R_WB);
  GetFinite(reader, body.v_WB);
  GetFinite(reader, body.w_WB);
  body.sleep_counter = reader.Get<std::uint64_t>();
  return body;
}

void PutRobot(const RobotState& robot, ByteWriter& writer) {
  writer.PutAll(robot.wheel_angle_rad);
  writer.PutAll(robot.wheel_speed_rad_s);
  writer.PutAll(robot.setpoint_rad_s);
  const int flags = (robot.frozen ? kFrozenBit : 0) | (robot.commanded ? kCommandedBit : 0);
  writer.Put(static_cast<std::uint8_t>(flags));
}

RobotState GetRobot(ByteReader& reader) {
  RobotState robot;
  GetFinite(reader, robot.wheel_angle_rad);
  GetFinite(reader, robot.wheel_speed_rad_s);
  GetFinite(reader, robot.setpoint_rad_s);
  const auto flags = reader.Get<std::uint8_t>();
  robot.frozen = (flags & kFrozenBit) != 0;
  robot.commanded = (flags & kCommandedBit) != 0;
  return robot;
}

void PutMessage(const SentMessage& sent, ByteWriter& writer) {
  writer.Put(sent.robot);
  writer.Put(sent.step);
  writer.Put(sent.message.count);
  for (std::uint32_t i = 0; i < sent.message.count; ++i) writer.Put(sent.message.values[i]);
}

SentMessage GetMessage(ByteReader& reader, const Frame& frame) {
  SentMessage sent;
  sent.robot = reader.Get<std::uint32_t>();
  sent.step = reader.Get<std::uint64_t>();
  sent.message.count = reader.Get<std::uint32_t>();
  const bool is_of_frame = sent.robot < frame.robots.size() && sent.step <= frame.step;
  if (!is_of_frame || sent.message.count > RobotMessage::kMaxValues) {
    reader.Fail();
    return {};
  }
  for (std::uint32_t i = 0; i < sent.message.count; ++i) sent.message.values[i] = reader.Get<double>();
  return sent;
}

bool IsStepLength(Nanoseconds length) {
  return length >= kMinStep && length <= kMaxStep;
}

bool GetMode(ByteReader& reader, Mode& mode) {
  const auto number = reader.Get<std::uint8_t>();
  mode = static_cast<Mode>(number);
  return number <= static_cast<int>(Mode::kFree);
}

}  // namespace

std::vector<std::byte> EncodeState(const SavedState& state) {
  const Frame& frame = *state.frame;
  std::vector<std::byte> bytes;
  bytes.reserve(128 + frame.bodies.size() * kBodyBytes + frame.robots.size() * kMotionBytes +
                frame.messages.size() * sizeof(SentMessage) + state.controllers.size());
  ByteWriter writer(bytes);
  writer.Put(kStateVersion);
  writer.Put(static_cast<std::uint8_t>(state.mode));
  writer.Put(static_cast<std::uint8_t>(state.paused ? 1 : 0));
  writer.Put(frame.epoch);
  writer.Put(frame.step);
  writer.Put(frame.revision);
  writer.Put(frame.time);
  writer.Put(frame.step_length);
  writer.Put(frame.seed);
  writer.Put(frame.solver_seed);
  writer.Put(static_cast<std::uint32_t>(frame.bodies.size()));
  for (const BodyState& body : frame.bodies) PutBody(body, writer);
  writer.Put(static_cast<std::uint32_t>(frame.robots.size()));
  for (const RobotState& robot : frame.robots) PutRobot(robot, writer);
  writer.Put(static_cast<std::uint32_t>(frame.messages.size()));
  for (const SentMessage& sent : frame.messages) PutMessage(sent, writer);
  writer.Put(static_cast<std::uint32_t>(state.controllers.size()));
  writer.PutBytes(state.controllers);
  writer.Put(state.step_length.value_or(0));
  writer.Put(static_cast<std::uint32_t>(state.setpoints.size()));
  for (const auto& setpoint : state.setpoints) writer.PutAll(setpoint);
  return bytes;
}

SavedStatePtr DecodeState(std::span<const std::byte> bytes, std::shared_ptr<const Scene> scene) {
  auto state = std::make_shared<SavedState>();
  auto frame = std::make_shared<Frame>();
  ByteReader reader(bytes);
  if (reader.Get<std::uint8_t>() != kStateVersion || !GetMode(reader, state->mode)) return nullptr;
  state->paused = reader.Get<std::uint8_t>() != 0;
  frame->epoch = reader.Get<std::uint64_t>();
  frame->step = reader.Get<std::uint64_t>();
  frame->revision = reader.Get<std::uint64_t>();
  frame->time = reader.Get<Nanoseconds>();
  frame->step_length = reader.Get<Nanoseconds>();
  frame->seed = reader.Get<std::uint64_t>();
  frame->solver_seed = reader.Get<std::uint64_t>();
  if (frame->time < 0 || !IsStepLength(frame->step_length)) return nullptr;
  if (reader.GetCount(kBodyBytes) != scene->body_ids.size()) return nullptr;
  frame->bodies.resize(scene->body_ids.size());
  for (BodyState& body : frame->bodies) body = GetBody(reader);
  if (reader.GetCount(kMotionBytes) != scene->robots.size()) return nullptr;
  frame->robots.resize(scene->robots.size());
  for (RobotState& robot : frame->robots) robot = GetRobot(reader);
  const std::size_t messages = reader.GetCount(kMessageBytes);
  for (std::size_t i = 0; reader.ok() && i < messages; ++i) {
    frame->messages.push_back(GetMessage(reader, *frame));
  }
  const std::span<const std::byte> controllers = reader.GetBytes(reader.GetCount(1));
  const auto step_length = reader.Get<Nanoseconds>();
  if (step_length != 0) state->step_length = step_length;
  if (step_length != 0 && !IsStepLength(step_length)) return nullptr;
  state->setpoints.resize(reader.GetCount(2 * 8));
  for (auto& setpoint : state->setpoints) GetFinite(reader, setpoint);
  if (!state->setpoints.empty() && state->setpoints.size() != scene->robots.size()) return nullptr;
  if (!reader.finished()) return nullptr;
  state->controllers.assign(controllers.begin(), controllers.end());
  frame->scene = std::move(scene);
  state->frame = std::move(frame);
  return state;
}

}  // namespace coopdyn
