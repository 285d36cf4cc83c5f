// SPDX-License-Identifier: MIT
// Controllers loaded at run time: the one implementation of ControllerDriver. They run in a child process, so
// that a crash, a hang, a number that is not finite or an exception stops one robot and nothing else; or in
// the daemon itself, for debugging, with the same results. All calls by the holder of the step baton.
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
  /// Clock and pool outlive it. No process is started before there is a controller to run. `draw`: for those
  /// that want pictures.
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

  /// Which drive, which are stopped and why, and what each has saved.
  std::vector<std::byte> Save() const override;
  /// A controller whose state has another size by now is stopped; TakeStopped() has those first, then those
  /// that were stopped when it was saved.
  bool Restore(const FramePtr& frame, std::span<const std::byte> saved) override;
  void Revise(const FramePtr& frame) override;
  std::vector<int> Unloaded() const override;
  void Stop(int robot, const std::string& why) override;

  /// The daemon ends: from now on nobody waits long for a controller that hangs. Any thread.
  void Interrupt() { interrupted_ = true; }
  /// The process in which the controllers run; -1: none now.
  int child_pid() const { return set_ ? set_->child_pid() : -1; }

 private:
  enum class Status : std::uint8_t { kDrives, kStopped, kUnloaded };
  /// A robot that has a controller, or what the supervisor has instead.
  struct Driven {
    RobotId id;     // none: of the supervisor
    int robot = 0;  // index into the scene; -1: it is not there any more, or it is the supervisor's
    std::string name, controller;
    std::vector<std::pair<std::string, double>> options;  // of the controller
    std::size_t first_channel = 0, channel_count = 0;     // in the scene
    DriveModel drive;                                     // for forward and turn, if it has one
    std::size_t wheels = 0;                               // the first channel of its drive, among its own
    Status status = Status::kDrives;
    std::string why;                                 // it is stopped
    std::uint32_t slot = 0;                          // its number in the set
    std::uint32_t readings = 0;                      // of enum coopdyn_reading
    std::vector<std::size_t> sensors;                // COOPDYN_SENSORS: index into the model's
    std::optional<std::vector<std::byte>> restored;  // state to begin with, until it is created
    std::vector<Setpoint> held;                      // COOPDYN_MAPPED: from one exchange to the next

    bool supervises() const { return id.value == 0; }
    /// It is not to be stepped: its robot has gone.
    bool gone() const { return robot < 0 && !supervises(); }
  };

  /// The set that Check() has made ready, if it has these files as they are now, else a new one.
  std::unique_ptr<ControllerSet> SetOf(std::vector<std::string> files);
  /// Forgets all controllers and lists the robots that have one; nobody is told any more what was stopped.
  void List(const Scene& scene);
  /// Makes the instances of all that are to drive.
  void Create(const FramePtr& frame);
  /// The scene has changed: finds the robots again.
  void Rebind(const std::shared_ptr<const Scene>& scene);
  static ControllerOptions WithFlag(ControllerOptions options, const std::atomic<bool>& interrupted);
  /// What the robot's controller wants of each channel, into `channels`, which are at rest. False: it cannot
  /// be carried out; nothing is promised of `channels` then.
  bool TakeSetpoints(const Driven& driven, std::span<Setpoint> channels) const;
  /// The same of the motors of its channel: in an exchange what it gave, then as before.
  bool TakeMotors(const Frame& frame, Driven& driven, std::span<Setpoint> channels) const;
  const SceneRobot& RobotOf(const Driven& driven) const {
    return driven.supervises() ? world_ : scene_->robots[static_cast<std::size_t>(driven.robot)];
  }
  /// What the controller has logged, and what the supervisor does. False: it cannot be.
  bool TakeLogs(const Driven& driven, const coopdyn_command& command);
  bool TakeDoings();
  /// Which robots are stepped from now on.
  void ListItems();
  /// `why` follows "controller NAME ".
  void Stop(Driven& driven, const std::string& why);
  void StopCasualties(std::span<const Casualty> casualties);

  std::atomic<bool> interrupted_{false};
  const ControllerOptions options_;
  const Clock& clock_;
  const Logger logger_;
  WorkerPool& pool_;
  bool stale_ = false;                      // the running set is older than its files
  std::unique_ptr<ControllerSet> checked_;  // by Check(), for the Configure() that may follow
  std::unique_ptr<ControllerSet> set_;
  std::vector<Driven> driven_;  // by increasing id: a supervisor first
  std::vector<std::uint32_t> driven_of_slot_;
  std::vector<std::uint32_t> items_;    // slots to step
  std::vector<ReadingsWanted> wanted_;  // as items_
  std::shared_ptr<const Scene> scene_;  // that driven_ is bound to
  SceneRobot world_;                    // the supervisor's: without parts
  Supervision supervision_;             // not taken yet
  ReadingsWriter readings_;
  std::string missing_pictures_;            // why, as it was logged
  std::vector<StoppedController> stopped_;  // not taken yet
  PhaseTimes times_;
  double ended_cpu_s_ = 0;  // of sets that are gone
};

}  // namespace coopdyn
