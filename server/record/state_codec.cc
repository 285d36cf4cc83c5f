// SPDX-License-Identifier: MIT
#include "server/record/state_codec.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "server/record/recorded_step.h"

namespace coopdyn {

namespace {

constexpr std::uint8_t kStateVersion = 8, kWithoutEfforts = 7, kWithoutTrains = 6, kWithoutScores = 5,
                       kWithoutSensed = 4, kWithoutAcceleration = 3, kWithoutControls = 2;
constexpr std::size_t kStoredContactBytes = 2 * 4 * 4 + 9 * 8;
constexpr std::size_t kMessageBytes = 4 + 8 + 4;  // without its values

void CodeContact(auto& codec, auto& contact) {
  for (auto* end : {&contact.a, &contact.b}) {
    codec.Number(end->object);
    codec.Number(end->robot);
    codec.Number(end->link);
    codec.Number(end->collision);
  }
  codec.Finite(contact.p_W);
  codec.Finite(contact.normal_W);
  codec.Finite(contact.force_W);
}

/// The quantities of a frame that sensors measure, besides bodies and channels.
void CodeSensed(auto& codec, auto& frame) {
  codec.List(frame.measured, 8, [&codec](auto& value) { codec.Finite(value); });
  codec.List(frame.contacts, kStoredContactBytes, [&codec](auto& contact) { CodeContact(codec, contact); });
}

/// A sample: the moment that a sensor shows.
void CodeSample(auto& codec, auto& frame, bool has_efforts) {
  codec.Number(frame.step);
  codec.Number(frame.revision);
  codec.Number(frame.time);
  codec.Number(frame.step_length);
  codec.List(frame.bodies, kBodyBytes, [&codec](auto& body) { CodeBody(codec, body); });
  codec.List(frame.channels, kChannelStateBytes,
             [&](auto& channel) { CodeChannel(codec, channel, has_efforts); });
  CodeSensed(codec, frame);
}

void WriteSamples(ByteWriter& writer, const Frame& frame) {
  std::vector<FramePtr> samples;  // each once
  for (const FrameSamples& clock : frame.samples) {
    for (const FramePtr& sample : clock) {
      if (std::ranges::find(samples, sample) == samples.end()) samples.push_back(sample);
    }
  }
  writer.List(samples, 1, [&writer](const FramePtr& sample) { CodeSample(writer, *sample, true); });
  writer.List(frame.samples, 4, [&](const FrameSamples& clock) {
    writer.List(clock, 4, [&](const FramePtr& sample) {
      writer.Number(static_cast<std::uint32_t>(std::ranges::find(samples, sample) - samples.begin()));
    });
  });
}

void ReadSamples(ByteReader& reader, const std::shared_ptr<const Scene>& scene, bool have_efforts,
                 Frame& frame) {
  std::vector<std::shared_ptr<Frame>> samples;
  reader.List(samples, 32, [&](std::shared_ptr<Frame>& sample) {
    sample = std::make_shared<Frame>();
    sample->epoch = frame.epoch;
    sample->seed = frame.seed;
    sample->scene = scene;
    CodeSample(reader, *sample, have_efforts);
  });
  reader.List(frame.samples, 4, [&](FrameSamples& clock) {
    reader.List(clock, 4, [&](FramePtr& sample) {
      const std::uint64_t index = reader.Low(4);
      reader.Require(index < samples.size());
      if (reader.ok()) sample = samples[index];
    });
    reader.Require(!clock.empty());
  });
}

void CodeSent(auto& codec, auto& sent) {
  codec.Number(sent.robot);
  codec.Number(sent.step);
  CodeMessage(codec, sent.message);
}

bool IsStepLength(Nanoseconds length) {
  return length >= kMinStep && length <= kMaxStep;
}

/// All of `state` and its frame, which belongs to `scene`, in format `version`.
template <typename Codec>
void CodeState(Codec& codec, const std::shared_ptr<const Scene>& scene, auto& state, auto& frame,
               std::uint64_t version) {
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
  codec.List(frame.channels, kChannelStateBytes,
             [&](auto& channel) { CodeChannel(codec, channel, version > kWithoutEfforts); });
  if (version != kWithoutControls) {
    const std::size_t doubles = JointControl::kDoubles - (version > kWithoutAcceleration ? 0 : 1);
    codec.List(frame.controls, 8 * doubles,
               [&codec, version](auto& one) { CodeControl(codec, one, version > kWithoutAcceleration); });
  }
  if (version > kWithoutTrains) {
    codec.List(frame.drive_trains, 8 * DriveTrainState::kDoubles,
               [&codec](auto& train) { CodeDriveTrain(codec, train); });
  }
  if (version > kWithoutSensed) {
    CodeSensed(codec, frame);
    if constexpr (Codec::kReads) {
      ReadSamples(codec, scene, version > kWithoutEfforts, frame);
    } else {
      WriteSamples(codec, frame);
    }
  }
  codec.List(frame.commanded, 1, [&codec](auto& commanded) { codec.Number(commanded); });
  codec.List(frame.messages, kMessageBytes, [&codec](auto& sent) { CodeSent(codec, sent); });
  codec.Bytes(state.controllers);
  Nanoseconds step_length = state.step_length.value_or(0);
  codec.Number(step_length);
  codec.List(state.setpoints, kSetpointBytes, [&codec](auto& setpoint) { CodeSetpoint(codec, setpoint); });
  if (version > kWithoutScores) codec.List(state.scores, 8, [&codec](auto& value) { codec.Number(value); });
  if constexpr (Codec::kReads) {
    if (step_length != 0) state.step_length = step_length;
  }
}

/// Whether a decoded moment fits `scene`. Empty measured values were not recorded.
bool FitsScene(const Frame& frame, const Scene& scene) {
  return frame.time >= 0 && IsStepLength(frame.step_length) && frame.bodies.size() == scene.body_ids.size() &&
         frame.channels.size() == scene.channels.size() &&
         (frame.measured.empty() ||
          frame.measured.size() == static_cast<std::size_t>(scene.measured_count)) &&
         std::ranges::all_of(frame.contacts, [&scene](const Contact& one) { return Fits(one, scene); });
}

bool SamplesFit(const Frame& frame, const Scene& scene) {
  if (!frame.samples.empty() && frame.samples.size() != scene.clocks.size()) return false;
  return std::ranges::all_of(frame.samples, [&](const FrameSamples& clock) {
    return std::ranges::all_of(clock, [&](const FramePtr& sample) {
      return sample->time <= frame.time && FitsScene(*sample, scene);
    });
  });
}

/// Whether a decoded state fits `scene`.
bool Fits(const SavedState& state, const Frame& frame, const Scene& scene) {
  const auto is_of_frame = [&](const SentMessage& sent) {
    return sent.robot < scene.robots.size() && sent.step <= frame.step;
  };
  const auto is_fine = [](const JointControl& control) {
    return control.stiffness >= 0 && control.damping >= 0 && control.speed > 0 && control.acceleration > 0 &&
           control.p >= 0 && control.i >= 0 && control.d >= 0 && control.duration_s >= 0;
  };
  return FitsScene(frame, scene) && SamplesFit(frame, scene) &&
         IsStepLength(state.step_length.value_or(kDefaultStep)) &&
         frame.controls.size() == static_cast<std::size_t>(scene.control_count) &&
         frame.drive_trains.size() == static_cast<std::size_t>(scene.drive_train_count) &&
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
  CodeState(writer, frame.scene, state, frame, kStateVersion);
  return bytes;
}

SavedStatePtr DecodeState(std::span<const std::byte> bytes, std::shared_ptr<const Scene> scene) {
  auto state = std::make_shared<SavedState>();
  auto frame = std::make_shared<Frame>();
  ByteReader reader(bytes);
  const std::uint64_t version = reader.Low(1);
  if (version > kStateVersion || version < kWithoutControls) return nullptr;
  CodeState(reader, scene, *state, *frame, version);
  if (!reader.finished() || !Fits(*state, *frame, *scene)) return nullptr;
  frame->scene = std::move(scene);
  state->frame = std::move(frame);
  return state;
}

}  // namespace coopdyn
