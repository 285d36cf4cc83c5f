// SPDX-License-Identifier: MIT
// Controllers loaded at run time: the only implementation of ControllerDriver. They run in a child process,
// so that a crash, a hang, a non-finite number or an exception stops only one robot; or, for debugging, in
// the daemon itself with the same results. Only the holder of the baton calls it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/controllers/controller_set.h"
#include "server/controllers/readings_writer.h"
#include "server/state/controller_driver.h"

namespace coopdyn {

class ControllerHost final : public ControllerDriver {
 public:
  /// `clock` and `pool` must outlive the host. Starts no process before there is a controller to run. `draw`:
  /// for controllers that want pictures.
  ControllerHost(ControllerOptions options, const Clock& clock, Logger logger, WorkerPool& pool,
                 DrawPictures draw = nullptr);
  ~ControllerHost() override;

  void Check(const Scenario& scenario, Diagnostics& diagnostics) override;
  void Configure(const FramePtr& frame) override;
  void Step(const FramePtr& frame, std::span<Setpoint> setpoints,
            std::vector<SentMessage>& messages) override;
  void Rest() override;
  void Unload(int robot) override;
  Supervision TakeSupervision() override { return std::exchange(supervision_, {}); }
  std::vector<StoppedController> TakeStopped() override;
  PhaseTimes times() const override { return times_; }
  ControllerCost slowest() const override;
  double child_cpu_s() const override;

  /// Saves which controllers drive, which are stopped and why, and the saved state of each.
  std::vector<std::byte> Save() const override;
  /// Stops controllers whose state size has changed. TakeStopped() returns these first, then those that were
  /// stopped when the state was saved.
  bool Restore(const FramePtr& frame, std::span<const std::byte> saved) override;
  void Revise(const FramePtr& frame) override;
  std::vector<int> Unloaded() const override;
  void Stop(int robot, const std::string& why) override;

  /// The daemon shuts down: from now on do not wait long for a hanging controller. Any thread.
  void Interrupt() { interrupted_ = true; }
  /// The process in which the controllers run; -1 if none.
  int child_pid() const { return set_ ? set_->child_pid() : -1; }

 private:
  enum class Status : std::uint8_t { kDrives, kStopped, kUnloaded };
  /// A robot with a controller, or the supervisor.
  struct Driven {
    RobotId id;     // 0: the supervisor
    int robot = 0;  // index into the scene; -1: removed; kSupervisor: the supervisor
    std::string name, controller;
    std::vector<std::pair<std::string, double>> options;  // of the controller
    std::size_t first_channel = 0, channel_count = 0;     // in the scene
    DriveModel drive;                                     // for forward and turn, if the robot has a drive
    std::size_t wheels = 0;  // first channel of the drive, among the robot's channels
    Status status = Status::kDrives;
    std::string why;                                 // reason of kStopped
    std::uint32_t slot = 0;                          // number in the set
    std::uint32_t readings = 0;                      // of enum coopdyn_reading
    std::vector<std::size_t> sensors;                // COOPDYN_SENSORS: indices into the model's sensors
    std::optional<std::vector<std::byte>> restored;  // initial state, until Create()
    std::vector<Setpoint> held;  // COOPDYN_MAPPED: set-points held until the next exchange

    bool supervises() const { return id.value == 0; }
    /// Its robot was removed: do not step it.
    bool gone() const { return robot < 0 && !supervises(); }
  };

  /// The set that Check() prepared, if it has these files in their current version, else a new one.
  std::unique_ptr<ControllerSet> SetOf(std::vector<std::string> files);
  /// Drops all controllers and pending reports of stopped ones, and lists the robots that have a controller.
  void List(const Scene& scene);
  /// Makes the instances of all controllers that drive.
  void Create(const FramePtr& frame);
  /// Finds the robots again after the scene has changed.
  void Rebind(const std::shared_ptr<const Scene>& scene);
  static ControllerOptions WithFlag(ControllerOptions options, const std::atomic<bool>& interrupted);
  /// Writes the controller's set-points into `channels`, which are at rest. False if one is invalid; then the
  /// content of `channels` is unspecified.
  bool TakeSetpoints(const Driven& driven, std::span<Setpoint> channels) const;
  /// Like TakeSetpoints(), for the motors of the robot's channel: takes new values in an exchange and holds
  /// them until the next one.
  bool TakeMotors(const Frame& frame, Driven& driven, std::span<Setpoint> channels) const;
  const SceneRobot& RobotOf(const Driven& driven) const {
    return driven.supervises() ? world_ : scene_->robots[static_cast<std::size_t>(driven.robot)];
  }
  /// Take the controller's logged numbers and the supervisor's actions. False if one is invalid.
  bool TakeLogs(const Driven& driven, const coopdyn_command& command);
  bool TakeDoings();
  /// Lists the robots to step.
  void ListItems();
  /// `why` follows "controller NAME ".
  void Stop(Driven& driven, const std::string& why);
  void StopCasualties(std::span<const Casualty> casualties);

  std::atomic<bool> interrupted_{false};
  const ControllerOptions options_;
  const Clock& clock_;
  const Logger logger_;
  WorkerPool& pool_;
  bool stale_ = false;                      // the files of the running set have changed
  std::unique_ptr<ControllerSet> checked_;  // by Check(), for a Configure() that may follow
  std::unique_ptr<ControllerSet> set_;
  std::vector<Driven> driven_;  // by increasing id: the supervisor first
  std::vector<std::uint32_t> driven_of_slot_;
  std::vector<std::uint32_t> items_;    // slots to step
  std::vector<ReadingsWanted> wanted_;  // parallel to items_
  std::shared_ptr<const Scene> scene_;  // that driven_ is bound to
  SceneRobot world_;                    // the supervisor's robot: without parts
  Supervision supervision_;             // not taken yet
  ReadingsWriter readings_;
  std::string missing_pictures_;            // the reason logged last
  std::vector<StoppedController> stopped_;  // not taken yet
  PhaseTimes times_;
  double ended_cpu_s_ = 0;  // of destroyed sets
};

}  // namespace coopdyn
