// SPDX-License-Identifier: MIT
// The controllers of one scene: their shared objects loaded, one instance for each robot, stepped together.
// The stepping thread (holder of the baton) only.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/controllers/backend.h"
#include "server/controllers/child_process.h"
#include "server/controllers/shared_area.h"
#include "server/state/controller_driver.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Half of this machine's memory.
std::uint64_t DefaultControllerMemory();

struct ControllerOptions {
  bool in_process = false;                                 // for debugging: a crash is the daemon's
  int threads = 1;                                         // of the child
  Nanoseconds deadline = 2 * kNanosecondsPerSecond;        // wall clock, for one robot's step; 0: none
  std::uint64_t memory_bytes = DefaultControllerMemory();  // that all may use in the child; 0: no limit
  Nanoseconds silence = 30 * kNanosecondsPerSecond;        // for the process to start on a busy machine
  Nanoseconds share_from = 200'000;                   // a step that takes longer is shared out to the threads
  const std::atomic<bool>* interrupted = nullptr;     // true: a step that hangs is given up at once
  std::string program = "/proc/self/exe";             // which becomes the child with `controller-child 3`
  std::shared_ptr<ChildLauncher> launcher = nullptr;  // of the children; null: a host makes its own
};

/// An option that a controller takes.
struct ControllerOption {
  std::string name, help;
  double value = 0, min = 0, max = 0;
};

/// What a controller says about itself.
struct ControllerDescription {
  std::string help;
  std::uint32_t readings = 0;  // of enum coopdyn_reading
  std::uint32_t state_size = 0;
  std::string sensors;  // COOPDYN_SENSORS: names or types of modules; empty: all but cameras
  std::vector<ControllerOption> options;
  bool takes_any_options = false;  // COOPDYN_ANY_OPTIONS: `options` is empty

  /// The sensors of `model` that it wants by COOPDYN_SENSORS: index into its sensors.
  std::vector<std::size_t> SensorsOf(const RobotModel& model) const;
  /// It commands channels by set-points, not a two-wheel drive by forward and turn.
  bool gives_setpoints() const { return (readings & COOPDYN_SETPOINTS) != 0; }
  bool supervises() const { return (readings & COOPDYN_WORLD) != 0; }
  /// It exchanges the values of the robot's channel.
  bool maps() const { return (readings & COOPDYN_MAPPED) != 0; }
  /// Why it cannot drive this robot, or be the supervisor, with the options that its scenario gives, with
  /// what to do instead; one text each.
  std::vector<std::string> Faults(const RobotEntry& robot) const;
  std::vector<std::string> SupervisorFaults(const ControllerChoice& choice) const;
  /// One value for each option: as given, else as described. If it takes any, those given.
  std::vector<double> Values(const ControllerChoice& choice) const;

 private:
  void AddOptionFaults(const ControllerChoice& choice, std::vector<std::string>& faults) const;
};

/// A loaded shared object, or why it is none.
struct LoadedController {
  std::string file;
  std::optional<ControllerDescription> description;
  std::string why;  // follows "controller NAME "
};

/// A robot and what drives it; of the supervisor a robot without parts.
struct ControlledRobot {
  std::uint32_t file = 0;  // index
  const SceneRobot* robot = nullptr;
  std::vector<double> options;       // one for each described, or given
  std::span<const std::byte> state;  // to restore; empty: from the start
};

class ControllerSet {
 public:
  /// Loads `files`. Clock and pool outlive it. Throws std::system_error if there is no memory to share.
  ControllerSet(std::vector<std::string> files, const ControllerOptions& options, const Clock& clock,
                const Logger& logger, WorkerPool& pool);
  ~ControllerSet();

  /// In the order of the files given.
  const std::vector<LoadedController>& loaded() const { return loaded_; }
  /// The index of a file among them; -1: it is not.
  int IndexOf(const std::string& file) const;
  /// No file has been written to since it was loaded.
  bool is_fresh() const;

  /// Makes the instances; call once. Returns which could not be made, and why. Robots are numbered as given.
  /// Of `frame` seed and step length.
  std::vector<Casualty> Create(std::span<const ControlledRobot> robots, const Frame& frame);
  /// The areas, to write readings into before Step(). Places may only be added behind `readings_end()`.
  Areas& areas() { return areas_; }
  Place readings_end() const { return readings_end_; }

  /// The controller that took most of the last step that was timed.
  ControllerCost slowest() const;
  /// Steps `items` (robots as numbered in Create()); their commands are then in the areas' results.
  /// Returns which failed: those have no command and are not to be stepped again. Valid until the next call.
  std::span<const Casualty> Step(const Frame& frame, std::span<const std::uint32_t> items);
  /// The state after the last step, as saved by the robot's controller.
  std::span<const std::byte> StateOf(std::uint32_t robot) const;
  /// No step follows at once.
  void Rest() { backend_->Rest(); }
  /// The robot is not to be stepped again.
  void Drop(std::uint32_t robot) { backend_->Drop(robot); }
  double child_cpu_s() const { return backend_->child_cpu_s(); }
  /// Process in which they run; -1: this one, or none now.
  int child_pid() const { return backend_->child_pid(); }

 private:
  void Run(Operation operation, std::span<const std::uint32_t> items);
  /// Runs it on robots; adds those that failed without taking their process with them.
  void RunRobots(Operation operation, std::span<const std::uint32_t> items);

  std::vector<LoadedController> loaded_;
  std::vector<std::int64_t> written_;  // when each file was
  Areas areas_;                        // before the backend, which refers to them
  std::unique_ptr<Backend> backend_;
  std::vector<Casualty> casualties_;
  Place readings_end_ = 0;
};

}  // namespace coopdyn
