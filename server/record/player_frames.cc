// SPDX-License-Identifier: MIT
#include "server/record/player_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/base/portable_math.h"
#include "server/state/sample_keeper.h"
#include "server/state/world_change.h"

namespace coopdyn {

namespace {

/// Beyond this many steps, starting at a newer keyframe is cheaper than reading on.
constexpr std::uint64_t kMostReadOn = 1000;

/// The place in `before` of the body at `place` in `scene`; nullopt if its thing or robot is not there or has
/// another number of bodies.
std::optional<std::size_t> PlaceIn(const Scene& before, const Scene& scene, std::size_t place) {
  if (&before == &scene) return place;
  const int body = static_cast<int>(place);
  for (const SceneObject& thing : scene.objects) {
    if (thing.body != body) continue;
    const auto found = std::ranges::find(before.objects, thing.id, &SceneObject::id);
    if (found == before.objects.end() || found->body < 0) return std::nullopt;
    return static_cast<std::size_t>(found->body);
  }
  for (const SceneRobot& robot : scene.robots) {
    if (body < robot.first_body || body >= robot.first_body + robot.body_count) continue;
    const auto found = std::ranges::find(before.robots, robot.id, &SceneRobot::id);
    if (found == before.robots.end() || found->body_count != robot.body_count) return std::nullopt;
    return static_cast<std::size_t>(found->first_body + body - robot.first_body);
  }
  return std::nullopt;
}

}  // namespace

bool PlayInputs::GoTo(std::uint64_t step) {
  const bool near = keyframe_ != nullptr && step >= keyframe_->frame->step && step <= newest_ + kMostReadOn &&
                    step - keyframe_->frame->step <= limit_;
  bool gap = false;
  const bool read = near && (step <= newest_ || ReadOn(step, gap)) && !gap;
  // After a gap, reload: a keyframe follows steps that were left out.
  if (!read && !Load(step)) return false;
  Replay(step);
  return true;
}

bool PlayInputs::Load(std::uint64_t step) {
  keyframe_ = reader_.Keyframe(step);
  if (keyframe_ == nullptr) return false;
  inputs_.clear();
  newest_ = step_ = keyframe_->frame->step;
  next_ = 0;
  channels_.clear();
  newest_scene_ = keyframe_->frame->scene;
  limit_ = step - newest_ + 2 * kMostReadOn;
  bool gap = false;
  return step == newest_ || ReadOn(step, gap);
}

bool PlayInputs::ReadOn(std::uint64_t step, bool& gap) {
  return reader_.ForEach(newest_ + 1, step, true, [&](const RecordedStep& read) {
    gap |= read.step != newest_ + 1;
    newest_ = read.step;
    const std::shared_ptr<const Scene> scene = reader_.SceneOf(read.scene);
    const bool new_scene = scene != newest_scene_;
    newest_scene_ = scene;
    if (new_scene || !read.commands.empty() || !read.messages.empty()) {
      inputs_.push_back({read.step, scene, read.commands, read.messages});
    }
    return true;
  });
}

void PlayInputs::Replay(std::uint64_t step) {
  if (channels_.empty() || step < step_) {
    const Frame& start = *keyframe_->frame;
    scene_ = start.scene;
    channels_.clear();
    for (const ChannelState& channel : start.channels) channels_.push_back({channel.setpoint, false});
    for (std::size_t i = 0; i < start.commanded.size(); ++i) {
      const SceneActuator& actuator = start.scene->actuators[i];
      const int first = actuator.first_channel, end = first + actuator.channel_count;
      for (int channel = first; channel < end; ++channel) {
        channels_[static_cast<std::size_t>(channel)].commanded = start.commanded[i] != 0;
      }
    }
    step_ = start.step;
    next_ = 0;
  }
  if (step > step_) {
    for (Driven& channel : channels_) channel.commanded = false;
  }
  for (; next_ < inputs_.size() && inputs_[next_].step <= step; ++next_) {
    Enter(inputs_[next_].scene);
    for (const CommandRecord& command : inputs_[next_].commands) {
      if (command.channel >= channels_.size()) continue;
      channels_[command.channel] = {command.setpoint, command.by_client && inputs_[next_].step == step};
    }
  }
  step_ = step;
}

void PlayInputs::Enter(const std::shared_ptr<const Scene>& scene) {
  if (scene == scene_) return;
  channels_ = InChannelsOf(*scene, *scene_, channels_, Driven());
  scene_ = scene;
}

std::vector<SentMessage> PlayInputs::Messages() const {
  int longest_steps = 0;
  for (const SceneRobot& robot : scene_->robots)
    longest_steps = std::max(longest_steps, robot.entry.model->message_delay_steps());
  const std::uint64_t oldest = step_ - std::min(step_, static_cast<std::uint64_t>(longest_steps));
  std::vector<SentMessage> messages;
  // The messages of a removed robot are dropped.
  const auto add = [&](const std::vector<SentMessage>& sent, const Scene& scene) {
    for (SentMessage message : sent) {
      if (message.step < oldest) continue;
      if (&scene != scene_.get()) {
        const auto now = std::ranges::find(scene_->robots, scene.robots[message.robot].id, &SceneRobot::id);
        if (now == scene_->robots.end()) continue;
        message.robot = static_cast<std::uint32_t>(now - scene_->robots.begin());
      }
      messages.push_back(message);
    }
  };
  add(keyframe_->frame->messages, *keyframe_->frame->scene);
  for (std::size_t i = 0; i < next_; ++i) {
    if (inputs_[i].step >= oldest) add(inputs_[i].messages, *inputs_[i].scene);
  }
  return messages;
}

Vector3 AngularVelocity(const Quaternion& from, const Quaternion& to, double seconds) {
  Quaternion turn = to * from.conjugate();
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  if (sine == 0) return Vector3::Zero();
  return turn.vec() * (2 * portable::Atan2(sine, turn.w()) / (sine * seconds));
}

std::optional<RecordedStep> PlayFrames::Read(std::uint64_t step) {
  if (newest_ && newest_->step == step) return std::move(newest_);
  return reader_.Read(step);
}

std::shared_ptr<Frame> PlayFrames::Make(std::uint64_t step) {
  std::shared_ptr<Frame> frame = MakeMoment(step);
  if (frame == nullptr || frame->scene->clocks.empty()) return frame;
  AddSamples(*frame);
  if (!inputs_.GoTo(step)) return nullptr;
  return frame;
}

void PlayFrames::AddSamples(Frame& frame) {
  const std::vector<SensorTiming>& clocks = frame.scene->clocks;
  std::size_t in_use = 0;
  for (const SensorTiming& clock : clocks) {
    const std::uint64_t back = SampleKeeper::StepsBack(clock, frame.time, frame.step_length);
    FramePtr moment = back == 0 ? nullptr : MomentAt(frame.step - std::min(frame.step, back));
    if (moment == nullptr || moment->scene != frame.scene) {
      moment = SampleKeeper::Copy(frame);
      moments_.push_back(moment);
    }
    frame.samples.push_back({std::move(moment)});
    ++in_use;
  }
  // A moment is used for many consecutive steps, then never again.
  const std::size_t most = 2 * in_use + 8;
  if (moments_.size() > most)
    moments_.erase(moments_.begin(), moments_.end() - static_cast<std::ptrdiff_t>(most));
}

FramePtr PlayFrames::MomentAt(std::uint64_t step) {
  const std::optional<std::uint64_t> shown = reader_.NextShown(step + 1, true);
  if (!shown) return nullptr;
  const auto found = std::ranges::find(moments_, *shown, [](const FramePtr& one) { return one->step; });
  if (found != moments_.end()) {
    std::rotate(found, found + 1, moments_.end());
    return moments_.back();
  }
  const std::shared_ptr<Frame> made = MakeMoment(*shown);
  if (made == nullptr) return nullptr;
  moments_.push_back(SampleKeeper::Copy(*made));
  return moments_.back();
}

std::shared_ptr<Frame> PlayFrames::MakeMoment(std::uint64_t step) {
  std::optional<RecordedStep> now = reader_.Read(step);
  if (!now || !inputs_.GoTo(step)) return nullptr;
  const std::shared_ptr<const Scene> scene = reader_.SceneOf(now->scene);
  if (scene == nullptr) return nullptr;
  const std::shared_ptr<Frame> frame = pool_.Take();
  const Frame& keyframe = inputs_.keyframe();
  frame->step = now->step;
  frame->time = now->time;
  frame->step_length = keyframe.step_length;
  frame->seed = keyframe.seed;
  frame->solver_seed = keyframe.solver_seed;
  frame->recorded_hash = now->hash;
  frame->scene = scene;
  frame->bodies.assign(now->bodies.begin(), now->bodies.end());
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // for values that were not recorded
  frame->channels.assign(scene->channels.size(), {kUnknown, kUnknown, kUnknown, {}});
  frame->measured = now->sensed.measured;
  frame->contacts = now->sensed.contacts;
  frame->scores = now->scores;
  frame->controls = keyframe.controls;
  if (frame->controls.size() != static_cast<std::size_t>(scene->control_count)) {
    frame->controls = StartControls(*scene);
  }
  frame->drive_trains = keyframe.drive_trains;
  if (frame->drive_trains.size() != static_cast<std::size_t>(scene->drive_train_count)) {
    frame->drive_trains = StartDriveTrains(*scene);
  }
  frame->commanded.assign(scene->actuators.size(), 0);
  const std::span<const PlayInputs::Driven> driven = inputs_.channels();
  for (std::size_t i = 0; i < scene->channels.size(); ++i) {
    ChannelState& channel = frame->channels[i];
    if (i < now->channels.size()) {
      channel.position = now->channels[i].position;
      channel.velocity = now->channels[i].velocity;
    }
    if (i < driven.size()) channel.setpoint = driven[i].setpoint;
    if (scene->channels[i].control >= 0) {
      ShowAim(channel, frame->controls[static_cast<std::size_t>(scene->channels[i].control)]);
    }
  }
  for (std::size_t i = 0; i < scene->actuators.size(); ++i) {
    const auto first = static_cast<std::size_t>(scene->actuators[i].first_channel);
    const bool is_driven = scene->actuators[i].channel_count > 0 && first < driven.size();
    frame->commanded[i] = is_driven && driven[first].commanded ? 1 : 0;
  }
  for (const SentMessage& sent : inputs_.Messages()) {
    if (sent.robot < scene->robots.size()) frame->messages.push_back(sent);
  }
  if (!AddVelocities(*now, *frame)) return nullptr;
  newest_ = std::move(now);
  return frame;
}

void PlayFrames::ShowAim(const ChannelState& channel, JointControl& control) {
  const Setpoint& setpoint = channel.setpoint;
  constexpr double kArrived = 1e-3;  // rad or m
  const bool on_way = setpoint.mode == ControlMode::kPosition &&
                      !(std::abs(channel.position - setpoint.reference) < kArrived);
  control.target = setpoint.reference;
  control.reference = on_way ? std::numeric_limits<double>::quiet_NaN() : setpoint.reference;
}

bool PlayFrames::AddVelocities(const RecordedStep& now, Frame& frame) {
  const std::optional<std::uint64_t> before_step = reader_.NextShown(now.step, true);
  if (!before_step) {
    if (!reader_.error().empty()) return false;
    const Frame& keyframe = inputs_.keyframe();
    if (keyframe.step != now.step || keyframe.bodies.size() != frame.bodies.size()) return true;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      frame.bodies[i].v_WB = keyframe.bodies[i].v_WB;
      frame.bodies[i].w_WB = keyframe.bodies[i].w_WB;
    }
    return true;
  }
  const std::optional<RecordedStep> before = Read(*before_step);
  // A damaged previous step costs only the velocities.
  if (!before || before->time >= now.time) return true;
  const double seconds = ToSeconds(now.time - before->time);
  if (now.step - before->step == 1) frame.step_length = now.time - before->time;
  const std::shared_ptr<const Scene> scene = reader_.SceneOf(before->scene);
  if (scene == nullptr) return true;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const std::optional<std::size_t> place = PlaceIn(*scene, *frame.scene, i);
    if (!place || *place >= before->bodies.size()) continue;
    const BodyState& was = before->bodies[*place];
    BodyState& body = frame.bodies[i];
    body.v_WB = (body.p_WB - was.p_WB) / seconds;
    body.w_WB = AngularVelocity(was.orientation(), body.orientation(), seconds);
  }
  return true;
}

}  // namespace coopdyn
