// SPDX-License-Identifier: MIT
#include "server/state/sample_keeper.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "server/state/world_change.h"

namespace coopdyn {

namespace {

// Steps are whole microseconds, rates are not: a sample is due slightly before its time.
constexpr double kRounding = 1e-6;  // of a period

Nanoseconds DelayOf(const SensorTiming& timing) {
  return static_cast<Nanoseconds>(std::llround(timing.delay_s * 1e9));
}

}  // namespace

FramePtr SampleKeeper::Copy(const Frame& frame) {
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

void SampleKeeper::Refit(const Frame& now, const std::vector<SensorTiming>& before) {
  std::map<FramePtr, FramePtr> refitted;  // one per sample, because sensors share samples
  const auto refit = [&](const FramePtr& sample) -> const FramePtr& {
    FramePtr& made = refitted[sample];
    if (made == nullptr) made = Copy(*InScene(*sample, now.scene, &now));
    return made;
  };
  std::vector<FrameSamples> held(now.scene->clocks.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    const auto same = std::ranges::find(before, now.scene->clocks[i]);
    const auto place = static_cast<std::size_t>(same - before.begin());
    if (same != before.end() && place < held_.size()) {
      for (const FramePtr& sample : held_[place]) held[i].push_back(refit(sample));
    }
    if (held[i].empty()) held[i].push_back(Copy(now));
  }
  held_ = std::move(held);
}

std::int64_t SampleKeeper::SampleAt(const SensorTiming& timing, Nanoseconds time) {
  if (timing.rate_hz <= 0) return time;
  return static_cast<std::int64_t>(std::floor(ToSeconds(time) * timing.rate_hz + kRounding));
}

std::uint64_t SampleKeeper::StepsBack(const SensorTiming& timing, Nanoseconds time, Nanoseconds length) {
  const Nanoseconds delay = std::min(DelayOf(timing), time);
  const Nanoseconds steps = (delay + length - 1) / length;
  const Nanoseconds shown = std::max<Nanoseconds>(time - steps * length, 0);
  Nanoseconds back = 0;
  if (timing.rate_hz > 0) {
    const std::int64_t sample = SampleAt(timing, shown);
    const double since_s = ToSeconds(shown) - static_cast<double>(sample) / timing.rate_hz;
    back = std::max<Nanoseconds>(static_cast<Nanoseconds>(since_s * 1e9) / length - 1, 0);
    while (shown >= (back + 1) * length && SampleAt(timing, shown - (back + 1) * length) == sample) ++back;
  }
  return static_cast<std::uint64_t>(steps + back);
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
    const Nanoseconds newest = frame.time - DelayOf(clocks[i]);
    std::size_t old = 0;
    while (old + 1 < held.size() && held[old + 1]->time <= newest) ++old;
    held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(old));
  }
  frame.samples = held_;
}

}  // namespace coopdyn
