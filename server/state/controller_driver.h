// SPDX-License-Identifier: MIT
// The stepping thread's interface to loaded controllers, implemented in server/controllers. All calls by the
// holder of the step baton.
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

/// The supervisor's index, among those of robots.
inline constexpr int kSupervisor = -1;
/// The supervisor's name in events and in the status; no robot has such a name.
inline std::string SupervisorName(const ControllerChoice& supervisor) {
  return kSupervisorLabel + supervisor.name;
}

/// A controller that no longer drives its robot; the robot stands.
struct StoppedController {
  std::string robot;         // or SupervisorName()
  std::string why;           // e.g. "controller diffuse crashed (segmentation fault)"
  bool with_daemon = false;  // it ended because the daemon shuts down: no fault
};

/// The time that a controller uses.
struct ControllerCost {
  std::string controller;    // empty: none is loaded
  Nanoseconds per_step = 0;  // in a recent step, for all its robots together
};

/// Requests of controllers other than driving robots.
struct Supervision {
  struct Log {
    std::string name;  // ROBOT.name; for the supervisor, only the name
    double value = 0;
  };
  struct Move {
    std::int32_t id = 0;  // WorldId
    Pose X_W;
  };
  std::vector<Log> logs = {};
  std::vector<Move> moves = {};
  std::optional<std::string> end = {};  // end the run; the reason, may be empty

  bool empty() const { return logs.empty() && moves.empty() && !end; }
};

/// The default implementations do nothing: set-points and broadcasts stay unchanged.
class ControllerDriver {
 public:
  virtual ~ControllerDriver() = default;

  /// Checks whether the controllers of `scenario` accept their options; reports those they reject at their
  /// lines. A fault of a controller itself (its version, a crash) is no error: it stops the controller's
  /// robots.
  virtual void Check(const Scenario& /*scenario*/, Diagnostics& /*diagnostics*/) {}
  /// For frame 0 of a scene just put in force: creates the controllers of all its robots afresh, with the
  /// frame's seed, and forgets the old ones.
  virtual void Configure(const FramePtr& /*frame*/) {}
  /// Runs the controllers on `frame` for the next step: overwrites the set-points of the robots they drive
  /// (zeros for a stopped one) and appends their broadcasts by increasing robot. `setpoints` are by the
  /// scene's channels.
  virtual void Step(const FramePtr& /*frame*/, std::span<Setpoint> /*setpoints*/,
                    std::vector<SentMessage>& /*messages*/) {}
  /// Their requests in that step. The caller executes them, or uses those of a recording instead.
  virtual Supervision TakeSupervision() { return {}; }
  /// No step follows at once: releases resources held for that, such as a core.
  virtual void Rest() {}
  /// All state that determines the controllers' future behaviour, as bytes.
  virtual std::vector<std::byte> Save() const { return {}; }
  /// Instead of Configure(): restores the controllers of `frame`'s scene to their state at the Save() after
  /// the step that made `frame`. The next TakeStopped() includes controllers that were stopped. Returns
  /// false, with all controllers at their start, if `saved` does not belong to this scene.
  virtual bool Restore(const FramePtr& /*frame*/, std::span<const std::byte> /*saved*/) { return true; }
  /// `frame` has an edited scene: controllers of remaining robots continue, those of new robots start (the
  /// next TakeStopped() includes stopped ones), the others end.
  virtual void Revise(const FramePtr& /*frame*/) {}
  /// Robots (indices into the scene) whose controller has been unloaded.
  virtual std::vector<int> Unloaded() const { return {}; }
  /// Stops the robot, or the supervisor, for the reason `why`, as in the run being repeated.
  virtual void Stop(int /*robot*/, const std::string& /*why*/) {}
  /// Unloads the robot's controller (`release_robot`): from now on clients drive the robot.
  virtual void Unload(int /*robot*/) {}
  /// Controllers stopped since the last call.
  virtual std::vector<StoppedController> TakeStopped() { return {}; }
  /// Time spent on sensing and control since the start.
  virtual PhaseTimes times() const { return {}; }
  /// The controller that uses most of a step.
  virtual ControllerCost slowest() const { return {}; }
  /// CPU time used by the controllers outside this process, s.
  virtual double child_cpu_s() const { return 0; }
};

}  // namespace coopdyn
