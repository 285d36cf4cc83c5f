// SPDX-License-Identifier: MIT
#include "server/record/state_codec.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "server/record/bytes.h"

namespace coopdyn {

namespace {

constexpr std::uint8_t kStateVersion = 2;
constexpr std::size_t kBodyBytes = (3 + 4 + 9 + 3 + 3) * 8 + 8;
constexpr std::size_t kSetpointBytes = 1 + 8, kChannelBytes = 2 * 8 + kSetpointBytes;
constexpr std::size_t kMessageBytes = 4 + 8 + 4;  // and its values

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

void PutSetpoint(const Setpoint& setpoint, ByteWriter& writer) {
  writer.Put(static_cast<std::uint8_t>(setpoint.mode));
  writer.Put(setpoint.reference);
}

Setpoint GetSetpoint(ByteReader& reader) {
  const auto mode = reader.Get<std::uint8_t>();
  const auto reference = reader.Get<double>();
  if (mode > static_cast<std::uint8_t>(ControlMode::kEffort) || !std::isfinite(reference)) reader.Fail();
  return {reference, static_cast<ControlMode>(mode)};
}

void PutChannel(const ChannelState& channel, ByteWriter& writer) {
  writer.Put(channel.position);
  writer.Put(channel.velocity);
  PutSetpoint(channel.setpoint, writer);
}

ChannelState GetChannel(ByteReader& reader) {
  ChannelState channel;
  std::array<double, 2> motion{};
  GetFinite(reader, motion);
  channel.position = motion[0];
  channel.velocity = motion[1];
  channel.setpoint = GetSetpoint(reader);
  return channel;
}

void PutMessage(const SentMessage& sent, ByteWriter& writer) {
  writer.Put(sent.robot);
  writer.Put(sent.step);
  writer.Put(sent.message.count);
  for (std::uint32_t i = 0; i < sent.message.count; ++i) writer.Put(sent.message.values[i]);
}

SentMessage GetMessage(ByteReader& reader, const Frame& frame, const Scene& scene) {
  SentMessage sent;
  sent.robot = reader.Get<std::uint32_t>();
  sent.step = reader.Get<std::uint64_t>();
  sent.message.count = reader.Get<std::uint32_t>();
  const bool is_of_frame = sent.robot < scene.robots.size() && sent.step <= frame.step;
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
  bytes.reserve(128 + frame.bodies.size() * kBodyBytes + frame.channels.size() * kChannelBytes +
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
  writer.Put(static_cast<std::uint32_t>(frame.channels.size()));
  for (const ChannelState& channel : frame.channels) PutChannel(channel, writer);
  writer.Put(static_cast<std::uint32_t>(frame.commanded.size()));
  for (const std::uint8_t commanded : frame.commanded) writer.Put(commanded);
  writer.Put(static_cast<std::uint32_t>(frame.messages.size()));
  for (const SentMessage& sent : frame.messages) PutMessage(sent, writer);
  writer.Put(static_cast<std::uint32_t>(state.controllers.size()));
  writer.PutBytes(state.controllers);
  writer.Put(state.step_length.value_or(0));
  writer.Put(static_cast<std::uint32_t>(state.setpoints.size()));
  for (const Setpoint& setpoint : state.setpoints) PutSetpoint(setpoint, writer);
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
  if (reader.GetCount(kChannelBytes) != scene->channels.size()) return nullptr;
  frame->channels.resize(scene->channels.size());
  for (ChannelState& channel : frame->channels) channel = GetChannel(reader);
  if (reader.GetCount(1) != scene->actuators.size()) return nullptr;
  frame->commanded.resize(scene->actuators.size());
  for (std::uint8_t& commanded : frame->commanded) commanded = reader.Get<std::uint8_t>() != 0 ? 1 : 0;
  const std::size_t messages = reader.GetCount(kMessageBytes);
  for (std::size_t i = 0; reader.ok() && i < messages; ++i) {
    frame->messages.push_back(GetMessage(reader, *frame, *scene));
  }
  const std::span<const std::byte> controllers = reader.GetBytes(reader.GetCount(1));
  const auto step_length = reader.Get<Nanoseconds>();
  if (step_length != 0) state->step_length = step_length;
  if (step_length != 0 && !IsStepLength(step_length)) return nullptr;
  state->setpoints.resize(reader.GetCount(kSetpointBytes));
  for (Setpoint& setpoint : state->setpoints) setpoint = GetSetpoint(reader);
  if (!state->setpoints.empty() && state->setpoints.size() != scene->channels.size()) return nullptr;
  if (!reader.finished()) return nullptr;
  state->controllers.assign(controllers.begin(), controllers.end());
  frame->scene = std::move(scene);
  state->frame = std::move(frame);
  return state;
}

}  // namespace coopdyn
