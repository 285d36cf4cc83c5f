// SPDX-License-Identifier: MIT
// The state of the run, for get_status, the page and the command line. The stepping thread writes, any thread
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
/// Turns "the run has reached its duration" into "the run has ended: it has reached its duration".
std::string RunEndedText(const std::string& why);
/// Why a run ended before its duration: "by a signal", "because the recording failed".
const char* WhyEarly(RunEnd end);

/// Total wall-clock time of the parts of stepping, for `coopdyn bench`.
struct PhaseTimes {
  Nanoseconds sense = 0;    // readings for loaded controllers
  Nanoseconds control = 0;  // loaded controllers, including the wait for their process
  Nanoseconds physics = 0;
  Nanoseconds publish = 0;  // making frames
};

/// The total cost of steps since the start.
struct StepLoad {
  PhaseTimes times;
  std::string controller;           // the slowest loaded controller; empty: none
  Nanoseconds controller_step = 0;  // its time in a recent step, for all its robots together
  bool priority_refused = false;    // the system denies the stepping thread its priority
};

/// The wall-clock cost of steps since the last reset, load or restore.
struct StepCosts {
  std::uint64_t runs = 0;  // grows with each of these, which restart the rest
  std::uint64_t steps = 0;
  Nanoseconds busy = 0;     // within steps
  Nanoseconds idle = 0;     // between steps, excluding pauses: waiting for clients or the pace
  Nanoseconds journal = 0;  // part of busy: passing steps to the recorder, including waits for it
  Nanoseconds answer = 0;   // part of busy: answering those who wait for a step
  PhaseTimes times = {};    // part of busy
};

struct RunStatus {
  Mode mode = Mode::kRealtime;
  RunState state = RunState::kRunning;
  std::string ended;  // the reason, in kEnded
  Nanoseconds step_length = kDefaultStep;
  double speed = 1;                // ≤ 0: no limit
  double real_time_factor = 0;     // over the last second of wall time
  std::uint64_t late_periods = 0;  // skipped in real time
  double duration_s = 0;           // simulated time at which the run ends; 0: never
  Nanoseconds simulated = 0;       // by all steps since the daemon started, across resets
  StepLoad load;                   // in real time
  StepCosts costs = {};
  std::size_t undo = 0, redo = 0;  // number of world edits that can be taken back or repeated
  std::uint64_t unsolved = 0;      // substeps whose joints and contacts were not solved exactly
  std::vector<std::string> frozen;
  std::set<std::string> frozen_before;  // before the last reset, restore or load, since the daemon started
};

/// An event of the run; at most 100 are kept.
struct Event {
  std::uint64_t step = 0;
  double time_s = 0;
  std::string level;  // info, warning, error
  std::string text;
};
/// The level of events that log a number: "NAME VALUE".
inline constexpr const char* kLogLevel = "log";

/// True for a letter followed by at most 62 letters, digits and _.
bool IsLogName(std::string_view name);

/// A number logged by a client or a controller.
struct Logged {
  std::uint64_t step = 0;
  double time_s = 0;
  double value = 0;
};

/// A robot that has stopped doing its task.
struct StoppedRobot {
  std::string by;  // controller: it failed; deadline: its client was late; client: it was lost; watchdog: its
                   // client was silent
  std::uint64_t step = 0;
  double time_s = 0;
  std::string why;
};
using StoppedRobots = std::map<std::string, StoppedRobot>;  // by the robot's name

/// The state of a playback.
struct PlaybackStatus {
  std::string file;
  Nanoseconds begin = 0, end = 0;  // simulated times of the first and last recorded step
  std::uint64_t begin_step = 0, end_step = 0;
  Nanoseconds time = 0;  // of the frame shown
  std::uint64_t step = 0;
  double speed = 1;      // −4…64; below 0: backwards
  bool playing = false;  // false: paused
  bool loop = false;
  bool growing = false;  // the recording is still in progress
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
  /// The recording being played; nullopt: a live run.
  void SetPlayback(std::optional<PlaybackStatus> status) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    playback_ = std::move(status);
  }
  std::optional<PlaybackStatus> playback() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return playback_;
  }
  /// Sets a name's newest number; false if there are already kMaxLogged other names.
  bool SetLogged(const std::string& name, Logged logged) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (!logged_.contains(name) && logged_.size() >= kMaxLogged) return false;
    logged_[name] = logged;
    return true;
  }
  /// In a playback: the numbers logged up to the frame shown.
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
  /// Says that `by` did what `deed` says. Completes the stepper's own event of the same text, if it is among
  /// the newest; replaces an earlier one of the same text and person, so that a program that resets a
  /// thousand times leaves one.
  void AddDeed(Event deed, const std::string& by) EXCLUDES(mutex_);
  std::vector<Event> events() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return {events_.begin(), events_.end()};
  }
  /// Keeps each robot's last stop since ClearStopped().
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
  /// For the report: stopped() plus each robot's last failed controller, across resets and loads.
  StoppedRobots stopped_or_failed() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    StoppedRobots robots = failed_;
    robots.insert(stopped_.begin(), stopped_.end());
    return robots;
  }
  /// The run ends. The first reason counts; `text` describes it.
  void End(RunEnd why, std::string text = {}) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (end_) return;
    end_ = why;
    end_text_ = std::move(text);
  }
  /// Why the daemon refuses all requests.
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
  StoppedRobots failed_ GUARDED_BY(mutex_);  // by controller failures since the daemon started
  std::optional<RunEnd> end_ GUARDED_BY(mutex_);
  std::string end_text_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
