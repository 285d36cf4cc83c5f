// SPDX-License-Identifier: MIT
// The controllers of one scene: loads their shared objects, makes one instance per robot and steps them
// together. Used only by the stepping thread (the holder of the baton).
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
  bool in_process = false;                                 // for debugging: a crash ends the daemon
  int threads = 1;                                         // of the child
  Nanoseconds deadline = 2 * kNanosecondsPerSecond;        // wall clock, for one robot's step; 0: none
  std::uint64_t memory_bytes = DefaultControllerMemory();  // limit for all in the child; 0: none
  Nanoseconds silence = 30 * kNanosecondsPerSecond;        // limit for the process to start on a busy machine
  Nanoseconds share_from = 200'000;                        // a longer step is distributed over the threads
  const std::atomic<bool>* interrupted = nullptr;          // true: give up a hanging step at once
  std::string program = "/proc/self/exe";                  // started as `controller-child 3`
  std::shared_ptr<ChildLauncher> launcher = nullptr;       // starts the children; null: a host makes its own
};

/// An option of a controller.
struct ControllerOption {
  std::string name, help;
  double value = 0, min = 0, max = 0;
};

/// The result of a controller's describe().
struct ControllerDescription {
  std::string help;
  std::uint32_t readings = 0;  // of enum coopdyn_reading
  std::uint32_t state_size = 0;
  std::string sensors;  // COOPDYN_SENSORS: names or types of modules; empty: all but cameras
  std::vector<ControllerOption> options;
  bool takes_any_options = false;  // COOPDYN_ANY_OPTIONS; then `options` is empty

  /// The sensors of `model` that the controller wants by COOPDYN_SENSORS: indices into the model's sensors.
  std::vector<std::size_t> SensorsOf(const RobotModel& model) const;
  /// Commands channels by set-points, not a two-wheel drive by forward and turn.
  bool gives_setpoints() const { return (readings & COOPDYN_SETPOINTS) != 0; }
  bool supervises() const { return (readings & COOPDYN_WORLD) != 0; }
  /// Exchanges the values of the robot's channel.
  bool maps() const { return (readings & COOPDYN_MAPPED) != 0; }
  /// Why the controller cannot drive `robot`, or be the supervisor, with the scenario's options, and what to
  /// do instead; one text per fault.
  std::vector<std::string> Faults(const RobotEntry& robot) const;
  std::vector<std::string> SupervisorFaults(const ControllerChoice& choice) const;
  /// One value per option: as given, else the described default. With takes_any_options, the given values.
  std::vector<double> Values(const ControllerChoice& choice) const;

 private:
  void AddOptionFaults(const ControllerChoice& choice, std::vector<std::string>& faults) const;
};

/// A loaded shared object, or why it could not be loaded.
struct LoadedController {
  std::string file;
  std::optional<ControllerDescription> description;
  std::string why;  // follows "controller NAME "
};

/// A robot and its controller. The supervisor has a robot without parts.
struct ControlledRobot {
  std::uint32_t file = 0;  // index
  const SceneRobot* robot = nullptr;
  std::vector<double> options;       // ControllerDescription::Values()
  std::span<const std::byte> state;  // to restore; empty: initial state
};

class ControllerSet {
 public:
  /// Loads `files`. `clock` and `pool` must outlive the set. Throws std::system_error if shared memory cannot
  /// be made.
  ControllerSet(std::vector<std::string> files, const ControllerOptions& options, const Clock& clock,
                const Logger& logger, WorkerPool& pool);
  ~ControllerSet();

  /// In the order of the files given.
  const std::vector<LoadedController>& loaded() const { return loaded_; }
  /// The index of `file` in loaded(); -1 if it is missing.
  int IndexOf(const std::string& file) const;
  /// Whether no file has been written since it was loaded.
  bool is_fresh() const;

  /// Makes the instances; call once. Returns those that could not be made, and why. Robots are numbered in
  /// the given order. Uses seed and step length of `frame`.
  std::vector<Casualty> Create(std::span<const ControlledRobot> robots, const Frame& frame);
  /// The areas, for writing readings before Step(). Add places only after `readings_end()`.
  Areas& areas() { return areas_; }
  Place readings_end() const { return readings_end_; }

  /// The controller that took the most time in the last timed step.
  ControllerCost slowest() const;
  /// Steps `items` (robots as numbered in Create()) and leaves their commands in the areas' results. Returns
  /// the robots that failed: they have no command and must not be stepped again. Valid until the next call.
  std::span<const Casualty> Step(const Frame& frame, std::span<const std::uint32_t> items);
  /// The state that the robot's controller saved after the last step.
  std::span<const std::byte> StateOf(std::uint32_t robot) const;
  /// No step follows immediately.
  void Rest() { backend_->Rest(); }
  /// The robot will not be stepped again.
  void Drop(std::uint32_t robot) { backend_->Drop(robot); }
  double child_cpu_s() const { return backend_->child_cpu_s(); }
  /// The process in which the controllers run; -1: this process, or none.
  int child_pid() const { return backend_->child_pid(); }

 private:
  void Run(Operation operation, std::span<const std::uint32_t> items);
  /// Runs `operation` on robots. Adds to casualties_ the robots that failed without ending their process.
  void RunRobots(Operation operation, std::span<const std::uint32_t> items);

  std::vector<LoadedController> loaded_;
  std::vector<std::int64_t> written_;  // modification time of each file
  Areas areas_;                        // declared before the backend, which uses them
  std::unique_ptr<Backend> backend_;
  std::vector<Casualty> casualties_;
  Place readings_end_ = 0;
};

}  // namespace coopdyn
