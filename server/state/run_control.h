// SPDX-License-Identifier: MIT
// How the run stands, for get_status, the page and the command line. The stepping thread writes, any thread
// reads.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/model/scenario.h"

namespace coopdyn {

enum class RunState { kRunning, kPaused, kWaiting, kPlaying, kEnded };
const char* ToString(RunState state);

/// Why a run has ended.
enum class RunEnd {
  kDuration,
  kController,
  kRecording,
  kQuit,
  kSignal,
  kScore,
  kLimit,
  kClient,
  kSupervisor
};
const char* ToString(RunEnd end);
/// "the run has ended: it has reached its duration", from "the run has reached its duration".
std::string RunEndedText(const std::string& why);
/// "by a signal", "because the recording failed": why a run ended before its duration.
const char* WhyEarly(RunEnd end);

/// How long the parts of stepping have taken in all, by the wall clock; for `coopdyn bench`.
struct PhaseTimes {
  Nanoseconds sense = 0;    // readings for loaded controllers
  Nanoseconds control = 0;  // loaded controllers, the wait for their process included
  Nanoseconds physics = 0;
  Nanoseconds publish = 0;  // making frames
};

/// What steps cost, in all since the start.
struct StepLoad {
  PhaseTimes times;
  std::string controller;           // the loaded controller that takes most; empty: none
  Nanoseconds controller_step = 0;  // that it took in a recent step, all its robots together
  bool priority_refused = false;    // the system does not let the stepping thread go first
};

/// What steps have cost since the last reset, load or restore, by the wall clock.
struct StepCosts {
  std::uint64_t runs = 0;  // grows with each of these: the rest begins anew
  std::uint64_t steps = 0;
  Nanoseconds busy = 0;     // in steps
  Nanoseconds idle = 0;     // between steps, but for pauses: the world waits for clients or for its pace
  Nanoseconds journal = 0;  // of busy: handing steps to the recorder, the wait for it included
  Nanoseconds answer = 0;   // of busy: telling those who wait for a step
  PhaseTimes times = {};    // of busy
};

struct RunStatus {
  Mode mode = Mode::kRealtime;
  RunState state = RunState::kRunning;
  std::string ended;  // why, in kEnded
  Nanoseconds step_length = kDefaultStep;
  double speed = 1;                // ≤ 0: no limit
  double real_time_factor = 0;     // over the last second of wall time
  std::uint64_t late_periods = 0;  // skipped in real time
  double duration_s = 0;           // the simulated time at which the run ends; 0: never
  Nanoseconds simulated = 0;       // by all steps since the daemon started, whatever was reset
  StepLoad load;                   // in real time
  StepCosts costs = {};
  std::size_t undo = 0, redo = 0;  // edits of the world that can be taken back, or made again
  std::uint64_t unsolved = 0;      // substeps in which joints and contacts were not solved exactly
  std::vector<std::string> frozen;
  std::set<std::string> frozen_before;  // before the last reset, restore or load, since the daemon started
};

/// Something that happened: at most 100 are kept.
struct Event {
  std::uint64_t step = 0;
  double time_s = 0;
  std::string level;  // info, warning, error
  std::string text;
};
/// The level of an event that is a logged number: "NAME VALUE".
inline constexpr const char* kLogLevel = "log";

/// A letter, then letters, digits and _, at most 63.
bool IsLogName(std::string_view name);

/// A number that a client or a controller has logged.
struct Logged {
  std::uint64_t step = 0;
  double time_s = 0;
  double value = 0;
};

/// A robot that does not do what it was to do.
struct StoppedRobot {
  std::string by;  // controller: it failed; deadline: its client was late; client: it was lost;
                   // watchdog: its client was silent
  std::uint64_t step = 0;
  double time_s = 0;
  std::string why;
};
using StoppedRobots = std::map<std::string, StoppedRobot>;  // by the robot's name

/// How a recording is being played.
struct PlaybackStatus {
  std::string file;
  Nanoseconds begin = 0, end = 0;  // simulated times of the first and last recorded step
  std::uint64_t begin_step = 0, end_step = 0;
  Nanoseconds time = 0;  // of the frame shown
  std::uint64_t step = 0;
  double speed = 1;      // −4…64; below 0: backwards
  bool playing = false;  // else it stands
  bool loop = false;
  bool growing = false;  // it is still being recorded
};

class RunControl {
 public:
  static constexpr std::size_t kMaxEvents = 100, kMaxLogged = 100;

  void SetStatus(RunStatus status) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    status_ = std::move(status);
  }
  RunStatus status() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return status_;
  }
  /// Of the recording that is played; empty: a live run.
  void SetPlayback(std::optional<PlaybackStatus> status) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    playback_ = std::move(status);
  }
  std::optional<PlaybackStatus> playback() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return playback_;
  }
  /// The newest number of a name; false if there are kMaxLogged other names.
  bool SetLogged(const std::string& name, Logged logged) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (!logged_.contains(name) && logged_.size() >= kMaxLogged) return false;
    logged_[name] = logged;
    return true;
  }
  /// In a playback: what had been logged by the moment that is shown.
  void ReplaceLogged(std::map<std::string, Logged> logged) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    logged_ = std::move(logged);
  }
  void ClearLogged() { ReplaceLogged({}); }
  std::map<std::string, Logged> logged() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return logged_;
  }
  void AddEvent(Event event) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    events_.push_back(std::move(event));
    if (events_.size() > kMaxEvents) events_.pop_front();
  }
  std::vector<Event> events() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return {events_.begin(), events_.end()};
  }
  /// Each robot's last stop since ClearStopped().
  void AddStopped(const std::string& robot, StoppedRobot stopped) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (stopped.by == "controller") failed_[robot] = stopped;
    stopped_[robot] = std::move(stopped);
  }
  void ClearStopped() EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    stopped_.clear();
  }
  StoppedRobots stopped() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return stopped_;
  }
  /// For the report: stopped() and, whatever was reset or loaded since, each robot's last failed controller.
  StoppedRobots stopped_or_failed() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    StoppedRobots robots = failed_;
    robots.insert(stopped_.begin(), stopped_.end());
    return robots;
  }
  /// The run ends. The first reason counts; `text` says it in words.
  void End(RunEnd why, std::string text = {}) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (end_) return;
    end_ = why;
    end_text_ = std::move(text);
  }
  /// Why nobody is served any more.
  std::string stopping_text() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return end_text_.empty() ? "the daemon is stopping" : RunEndedText(end_text_);
  }
  std::optional<RunEnd> end() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return end_;
  }

 private:
  mutable Mutex mutex_;
  RunStatus status_ GUARDED_BY(mutex_);
  std::optional<PlaybackStatus> playback_ GUARDED_BY(mutex_);
  std::deque<Event> events_ GUARDED_BY(mutex_);
  std::map<std::string, Logged> logged_ GUARDED_BY(mutex_);
  StoppedRobots stopped_ GUARDED_BY(mutex_);
  StoppedRobots failed_ GUARDED_BY(mutex_);  // by their controllers, since the daemon started
  std::optional<RunEnd> end_ GUARDED_BY(mutex_);
  std::string end_text_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
