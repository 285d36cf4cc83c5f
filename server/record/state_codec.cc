// SPDX-License-Identifier: MIT
#include "server/record/state_codec.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace coopdyn {

namespace {

constexpr std::uint8_t kStateVersion = 4, kWithoutAcceleration = 3, kWithoutControls = 2;
constexpr std::size_t kBodyBytes = (3 + 4 + 9 + 3 + 3) * 8 + 8;
constexpr std::size_t kSetpointBytes = 1 + 8, kChannelStateBytes = 2 * 8 + kSetpointBytes;
constexpr std::size_t kMessageBytes = 4 + 8 + 4;  // and its values

void CodeBody(auto& codec, auto& body) {
  codec.Finite(body.p_WB);
  codec.Finite(body.q_WB);
  codec.Finite(body.R_WB);
  codec.Finite(body.v_WB);
  codec.Finite(body.w_WB);
  codec.Number(body.sleep_counter);
}

void CodeChannel(auto& codec, auto& channel) {
  codec.Finite(channel.position);
  codec.Finite(channel.velocity);
  CodeSetpoint(codec, channel.setpoint);
}

void CodeControl(auto& codec, auto& control, std::uint64_t version) {
  codec.Number(control.stiffness);  // may be infinite
  codec.Finite(control.damping);
  codec.Finite(control.offset);
  codec.Finite(control.speed);
  codec.Finite(control.acceleration);
  codec.Finite(control.p);
  codec.Finite(control.i);
  codec.Finite(control.d);
  codec.Finite(control.start);
  codec.Finite(control.start_velocity);
  if (version != kWithoutAcceleration) codec.Finite(control.start_acceleration);
  codec.Finite(control.target);
  codec.Finite(control.duration_s);
  codec.Finite(control.elapsed_s);
  codec.Finite(control.integral);
  codec.Finite(control.reference);
}

void CodeSent(auto& codec, auto& sent) {
  codec.Number(sent.robot);
  codec.Number(sent.step);
  CodeMessage(codec, sent.message);
}

bool IsStepLength(Nanoseconds length) {
  return length >= kMinStep && length <= kMaxStep;
}

/// All of `state` and its frame, as `version` has them; when it is read, without what the scene must say of
/// it.
template <typename Codec>
void CodeState(Codec& codec, auto& state, auto& frame, std::uint64_t version) {
  codec.Word(state.mode, Mode::kFree);
  codec.Bool(state.paused);
  codec.Number(frame.epoch);
  codec.Number(frame.step);
  codec.Number(frame.revision);
  codec.Number(frame.time);
  codec.Number(frame.step_length);
  codec.Number(frame.seed);
  codec.Number(frame.solver_seed);
  codec.List(frame.bodies, kBodyBytes, [&codec](auto& body) { CodeBody(codec, body); });
  codec.List(frame.channels, kChannelStateBytes, [&codec](auto& channel) { CodeChannel(codec, channel); });
  if (version != kWithoutControls) {
    const std::size_t doubles = JointControl::kDoubles - (version == kWithoutAcceleration ? 1 : 0);
    codec.List(frame.controls, 8 * doubles,
               [&codec, version](auto& one) { CodeControl(codec, one, version); });
  }
  codec.List(frame.commanded, 1, [&codec](auto& commanded) { codec.Number(commanded); });
  codec.List(frame.messages, kMessageBytes, [&codec](auto& sent) { CodeSent(codec, sent); });
  codec.Bytes(state.controllers);
  Nanoseconds step_length = state.step_length.value_or(0);
  codec.Number(step_length);
  codec.List(state.setpoints, kSetpointBytes, [&codec](auto& setpoint) { CodeSetpoint(codec, setpoint); });
  if constexpr (Codec::kReads) {
    if (step_length != 0) state.step_length = step_length;
  }
}

/// What was read is a state of `scene`.
bool Fits(const SavedState& state, const Frame& frame, const Scene& scene) {
  const auto is_of_frame = [&](const SentMessage& sent) {
    return sent.robot < scene.robots.size() && sent.step <= frame.step;
  };
  const auto is_fine = [](const JointControl& control) {
    return control.stiffness >= 0 && control.damping >= 0 && control.speed > 0 && control.acceleration > 0 &&
           control.p >= 0 && control.i >= 0 && control.d >= 0 && control.duration_s >= 0;
  };
  return frame.time >= 0 && IsStepLength(frame.step_length) &&
         IsStepLength(state.step_length.value_or(kDefaultStep)) &&
         frame.bodies.size() == scene.body_ids.size() && frame.channels.size() == scene.channels.size() &&
         frame.controls.size() == static_cast<std::size_t>(scene.control_count) &&
         frame.commanded.size() == scene.actuators.size() &&
         (state.setpoints.empty() || state.setpoints.size() == scene.channels.size()) &&
         std::ranges::all_of(frame.controls, is_fine) &&
         std::all_of(frame.messages.begin(), frame.messages.end(), is_of_frame);
}

}  // namespace

std::vector<std::byte> EncodeState(const SavedState& state) {
  const Frame& frame = *state.frame;
  std::vector<std::byte> bytes;
  bytes.reserve(128 + frame.bodies.size() * kBodyBytes + frame.channels.size() * kChannelStateBytes +
                frame.messages.size() * sizeof(SentMessage) + state.controllers.size());
  ByteWriter writer(bytes);
  writer.Number(kStateVersion);
  CodeState(writer, state, frame, kStateVersion);
  return bytes;
}

SavedStatePtr DecodeState(std::span<const std::byte> bytes, std::shared_ptr<const Scene> scene) {
  auto state = std::make_shared<SavedState>();
  auto frame = std::make_shared<Frame>();
  ByteReader reader(bytes);
  const std::uint64_t version = reader.Low(1);
  if (version > kStateVersion || version < kWithoutControls) return nullptr;
  CodeState(reader, *state, *frame, version);
  if (!reader.finished() || !Fits(*state, *frame, *scene)) return nullptr;
  frame->scene = std::move(scene);
  state->frame = std::move(frame);
  return state;
}

}  // namespace coopdyn
