// SPDX-License-Identifier: MIT
// Loaded controllers as the stepping thread sees them; server/controllers has the one implementation. All
// calls by the holder of the step baton.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/state/command_board.h"
#include "server/state/frame.h"
#include "server/state/run_control.h"
#include "server/state/world_change.h"

namespace coopdyn {

/// The supervisor's place among the robots.
inline constexpr int kSupervisor = -1;
/// What it is called in events and in the status; no robot has such a name.
inline std::string SupervisorName(const ControllerChoice& supervisor) {
  return kSupervisorLabel + supervisor.name;
}

/// A controller that does not drive its robot any more: the robot stands.
struct StoppedController {
  std::string robot;         // or SupervisorName()
  std::string why;           // e.g. "controller diffuse crashed (segmentation fault)"
  bool with_daemon = false;  // it ended because the daemon ends: no fault
};

/// What a controller takes.
struct ControllerCost {
  std::string controller;    // empty: there is none
  Nanoseconds per_step = 0;  // of a recent step, all its robots together
};

/// What controllers want beside driving robots.
struct Supervision {
  struct Log {
    std::string name;  // ROBOT.name; of the supervisor the name alone
    double value = 0;
  };
  struct Move {
    std::int32_t id = 0;  // WorldId
    Pose X_W;
  };
  std::vector<Log> logs = {};
  std::vector<Move> moves = {};
  std::optional<std::string> end = {};  // the run ends; why, may be empty

  bool empty() const { return logs.empty() && moves.empty() && !end; }
};

/// What is not overridden does nothing: set-points and broadcasts stay as they are given.
class ControllerDriver {
 public:
  virtual ~ControllerDriver() = default;

  /// Looks whether the controllers of `scenario` take the options that it gives them; says at their lines
  /// what they do not. What is wrong with a controller itself (its version, a crash) is no error: it stops
  /// its robots.
  virtual void Check(const Scenario& /*scenario*/, Diagnostics& /*diagnostics*/) {}
  /// Frame 0 of a scene that has just been put in force: makes afresh (`seed` of the frame) the controllers
  /// of all robots that have one, and forgets the others.
  virtual void Configure(const FramePtr& /*frame*/) {}
  /// What the controllers make of `frame`, for the next step: overwrites the set-points of the robots they
  /// drive (a stopped one: zeros) and appends their broadcasts by increasing robot. `setpoints` are by the
  /// scene's channels.
  virtual void Step(const FramePtr& /*frame*/, std::span<Setpoint> /*setpoints*/,
                    std::vector<SentMessage>& /*messages*/) {}
  /// What they wanted in that step; the caller does it, or has it from a recording.
  virtual Supervision TakeSupervision() { return {}; }
  /// The caller takes no further step at once: what is held for that, such as its core, is let go.
  virtual void Rest() {}
  /// All that decides what the controllers do from here on, as bytes.
  virtual std::vector<std::byte> Save() const { return {}; }
  /// Instead of Configure(): the controllers of the scene of `frame` as they were when Save() gave `saved`
  /// after the step that made `frame`; those that were stopped are among the next TakeStopped(). False, with
  /// all controllers at their start, if `saved` does not belong to this scene.
  virtual bool Restore(const FramePtr& /*frame*/, std::span<const std::byte> /*saved*/) { return true; }
  /// `frame` is of an edited scene: controllers of robots that stay go on as they are, those of new robots
  /// begin (the stopped are among the next TakeStopped()), the others end.
  virtual void Revise(const FramePtr& /*frame*/) {}
  /// Robots (indices into the scene) whose controller has been taken away.
  virtual std::vector<int> Unloaded() const { return {}; }
  /// The robot, or the supervisor, stands from now on, for the reason `why`, as in the run that is repeated.
  virtual void Stop(int /*robot*/, const std::string& /*why*/) {}
  /// The robot's controller is taken away (`release_robot`): from now on it is driven by clients.
  virtual void Unload(int /*robot*/) {}
  /// Controllers stopped since the last call.
  virtual std::vector<StoppedController> TakeStopped() { return {}; }
  /// Time spent on sensing and control since the start.
  virtual PhaseTimes times() const { return {}; }
  /// The controller that takes most of a step.
  virtual ControllerCost slowest() const { return {}; }
  /// CPU time that the controllers have used outside this process, s.
  virtual double child_cpu_s() const { return 0; }
};

}  // namespace coopdyn
