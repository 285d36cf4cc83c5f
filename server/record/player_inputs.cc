// SPDX-License-Identifier: MIT
#include "server/record/player_inputs.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

/// From this many steps on it is cheaper to begin at a newer keyframe than to read on.
constexpr std::uint64_t kMostReadOn = 1000;

}  // namespace

bool PlayInputs::GoTo(std::uint64_t step) {
  const bool near = keyframe_ != nullptr && step >= keyframe_->frame->step && step <= newest_ + kMostReadOn &&
                    step - keyframe_->frame->step <= limit_;
  bool gap = false;
  const bool read = near && (step <= newest_ || ReadOn(step, gap)) && !gap;
  // After steps that were left out comes a keyframe.
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
  channel_count_ = keyframe_->frame->channels.size();
  message_steps_ = 0;
  for (const SceneRobot& robot : keyframe_->frame->scene->robots) {
    message_steps_ = std::max<std::uint64_t>(message_steps_,
                                             static_cast<unsigned>(robot.entry.model->message_delay_steps()));
  }
  limit_ = step - newest_ + 2 * kMostReadOn;
  bool gap = false;
  return step == newest_ || ReadOn(step, gap);
}

bool PlayInputs::ReadOn(std::uint64_t step, bool& gap) {
  return reader_.ForEach(newest_ + 1, step, true, [&](const RecordedStep& read) {
    gap |= read.step != newest_ + 1;
    newest_ = read.step;
    const std::shared_ptr<const Scene> scene = reader_.SceneOf(read.scene);
    const bool new_scene = scene->channels.size() != channel_count_;
    channel_count_ = scene->channels.size();
    if (new_scene || !read.commands.empty() || !read.messages.empty()) {
      inputs_.push_back({read.step, channel_count_, read.commands, read.messages});
    }
    return true;
  });
}

void PlayInputs::Replay(std::uint64_t step) {
  if (channels_.empty() || step < step_) {
    const Frame& start = *keyframe_->frame;
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
    channels_.resize(inputs_[next_].channels);
    for (const CommandRecord& command : inputs_[next_].commands) {
      if (command.channel >= channels_.size()) continue;
      channels_[command.channel] = {command.setpoint, command.by_client && inputs_[next_].step == step};
    }
  }
  step_ = step;
}

std::vector<SentMessage> PlayInputs::Messages() const {
  const std::uint64_t oldest = step_ - std::min(step_, message_steps_);
  std::vector<SentMessage> messages;
  for (const SentMessage& sent : keyframe_->frame->messages) {
    if (sent.step >= oldest) messages.push_back(sent);
  }
  for (std::size_t i = 0; i < next_; ++i) {
    if (inputs_[i].step < oldest) continue;
    messages.insert(messages.end(), inputs_[i].messages.begin(), inputs_[i].messages.end());
  }
  return messages;
}

}  // namespace coopdyn
