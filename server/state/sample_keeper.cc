// SPDX-License-Identifier: MIT
#include "server/state/sample_keeper.h"

#include <cmath>
#include <utility>

namespace coopdyn {

namespace {

// Steps are whole microseconds, rates are not: a sample is due a little before its time.
constexpr double kRounding = 1e-6;  // of a period

/// What sensing needs of `frame`, without samples.
FramePtr Copy(const Frame& frame) {
  auto copy = std::make_shared<Frame>();
  copy->epoch = frame.epoch;
  copy->step = frame.step;
  copy->revision = frame.revision;
  copy->time = frame.time;
  copy->step_length = frame.step_length;
  copy->seed = frame.seed;
  copy->scene = frame.scene;
  copy->bodies = frame.bodies;
  copy->channels = frame.channels;
  copy->measured = frame.measured;
  copy->contacts = frame.contacts;
  return copy;
}

}  // namespace

std::int64_t SampleKeeper::SampleAt(const SensorTiming& timing, Nanoseconds time) {
  if (timing.rate_hz <= 0) return time;
  return static_cast<std::int64_t>(std::floor(ToSeconds(time) * timing.rate_hz + kRounding));
}

void SampleKeeper::AddTo(Frame& frame) {
  const std::vector<SensorTiming>& clocks = frame.scene->clocks;
  if (clocks.empty()) {
    held_.clear();
    return;
  }
  const bool anew = frame.epoch != epoch_ || held_.size() != clocks.size();
  epoch_ = frame.epoch;
  if (anew) held_.assign(clocks.size(), {});
  FramePtr copy;
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    FrameSamples& held = held_[i];
    if (held.empty() || SampleAt(clocks[i], frame.time) > SampleAt(clocks[i], held.back()->time)) {
      if (copy == nullptr) copy = Copy(frame);
      held.push_back(copy);
    }
    const Nanoseconds newest = frame.time - static_cast<Nanoseconds>(std::llround(clocks[i].delay_s * 1e9));
    std::size_t old = 0;
    while (old + 1 < held.size() && held[old + 1]->time <= newest) ++old;
    held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(old));
  }
  frame.samples = held_;
}

}  // namespace coopdyn
