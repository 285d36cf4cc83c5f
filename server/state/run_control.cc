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

const char* ToString(RunEnd end) {
  switch (end) {
    case RunEnd::kDuration:
      return "duration";
    case RunEnd::kController:
      return "controller";
    case RunEnd::kRecording:
      return "recording";
    case RunEnd::kQuit:
      return "quit";
    case RunEnd::kSignal:
      return "signal";
  }
  return "unknown";
}

const char* WhyEarly(RunEnd end) {
  switch (end) {
    case RunEnd::kDuration:
      break;
    case RunEnd::kController:
      return "because a controller failed";
    case RunEnd::kRecording:
      return "because the recording failed";
    case RunEnd::kQuit:
      return "by quit";
    case RunEnd::kSignal:
      return "by a signal";
  }
  return "for an unknown reason";
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

void RunControl::AddStopped(const std::string& robot, StoppedRobot stopped) {
  const MutexLock lock(mutex_);
  if (stopped.by == "controller") failed_[robot] = stopped;
  stopped_[robot] = std::move(stopped);
}

void RunControl::ClearStopped() {
  const MutexLock lock(mutex_);
  stopped_.clear();
}

StoppedRobots RunControl::stopped() const {
  const MutexLock lock(mutex_);
  return stopped_;
}

StoppedRobots RunControl::stopped_or_failed() const {
  const MutexLock lock(mutex_);
  StoppedRobots robots = failed_;
  robots.insert(stopped_.begin(), stopped_.end());
  return robots;
}

void RunControl::End(RunEnd why) {
  const MutexLock lock(mutex_);
  if (!end_) end_ = why;
}

std::optional<RunEnd> RunControl::end() const {
  const MutexLock lock(mutex_);
  return end_;
}

}  // namespace coopdyn
