// SPDX-License-Identifier: MIT
#include "server/state/run_control.h"

#include <utility>

namespace coopdyn {

const char* ToString(RunState state) {
  switch (state) {
    case RunState::kRunning:
      return "running";
    case RunState::kPaused:
      return "paused";
    case RunState::kWaiting:
      return "waiting";
    case RunState::kPlaying:
      return "playing";
    case RunState::kEnded:
      return "ended";
  }
  return "unknown";
}

void RunControl::SetStatus(RunStatus status) {
  const MutexLock lock(mutex_);
  status_ = std::move(status);
}

RunStatus RunControl::status() const {
  const MutexLock lock(mutex_);
  return status_;
}

void RunControl::SetPlayback(std::optional<PlaybackStatus> status) {
  const MutexLock lock(mutex_);
  playback_ = std::move(status);
}

std::optional<PlaybackStatus> RunControl::playback() const {
  const MutexLock lock(mutex_);
  return playback_;
}

void RunControl::AddEvent(Event event) {
  const MutexLock lock(mutex_);
  events_.push_back(std::move(event));
  if (events_.size() > kMaxEvents) events_.pop_front();
}

std::vector<Event> RunControl::events() const {
  const MutexLock lock(mutex_);
  return {events_.begin(), events_.end()};
}

}  // namespace coopdyn
