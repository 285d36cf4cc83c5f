// SPDX-License-Identifier: MIT
// A world and everything that determines its next steps: bodies, pending broadcasts, loaded controllers. The
// live run (stepper.h) and its repetition (server/replay) step the same class, so they cannot differ. Owned
// by the holder of the baton; no locks inside.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/worker_pool.h"
#include "server/physics/rest.h"
#include "server/state/command_board.h"
#include "server/state/controller_driver.h"
#include "server/state/edits.h"
#include "server/state/frame.h"
#include "server/state/frame_pool.h"
#include "server/state/run_control.h"
#include "server/state/sample_keeper.h"
#include "server/state/score_keeper.h"
#include "server/state/world_change.h"

namespace coopdyn {

class PhysicsWorld;

/// Other participants of a step. Must outlive the simulation.
struct StepHelpers {
  WorkerPool* pool = nullptr;               // null: everything on the stepping thread
  ControllerDriver* controllers = nullptr;  // null: a robot with a controller is an error
  /// Advances the channels' filters by the values of `frame`, the successor of `before`. Required if a
  /// channel has a filter.
  void (*advance_filters)(const Frame& before, Frame& frame) = nullptr;
};

/// The clients' inputs to one step.
struct StepInputs {
  std::span<Setpoint> setpoints;          // by channel of the scene; loaded controllers overwrite theirs
  std::span<const SentMessage> messages;  // broadcasts, by increasing robot
  std::span<const std::uint8_t> commanded =
      {};  // by actuator of the scene: 1 if a client's command takes effect; may be empty
};

class Simulation {
 public:
  /// Builds the world of `scene` and makes frame 0 (of epoch `epoch`). Returns null, with errors at the
  /// files' lines, if the world or its controllers cannot be built. The controllers start later, in
  /// StartControllers().
  static std::unique_ptr<Simulation> Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                           std::uint64_t epoch, const StepHelpers& helpers,
                                           const Clock& clock, Diagnostics& diagnostics);
  ~Simulation();

  /// The newest frame.
  const FramePtr& frame() const { return frame_; }
  const Scene& scene() const { return *scene_; }
  bool has_controllers() const { return has_controllers_; }

  /// Sets the length of the next steps, which frame 0 shows too. Call before StartControllers() or Restart().
  void SetStepLength(Nanoseconds length);
  /// Recreates all controllers for frame(), which is the start.
  void StartControllers();
  /// Returns to the start, with a new seed for noise and solver: the same bits as a fresh Build(). Restarts
  /// the controllers.
  void Restart(std::uint64_t seed, std::uint64_t epoch);
  /// Continues bit for bit from `state`, whose frame has a scene of this scenario, including scores and
  /// controllers. Returns empty, or why scores or controllers cannot continue. After such a failure, call
  /// Restore() or Restart() before the next step, unless the caller handles the controllers that no longer
  /// drive: `stopped` receives their ControllerDriver::TakeStopped().
  [[nodiscard]] std::string Restore(const SavedState& state, std::uint64_t epoch,
                                    std::vector<StoppedController>* stopped = nullptr);
  /// Returns the state for Restore(). The caller fills in `mode` and `paused`.
  SavedState Save() const;

  /// Applies `change` to the world and assigns ids to its new things; frame() shows the result. `inverse`
  /// undoes it. Returns empty, or why it is impossible; then nothing has changed. The caller then collects
  /// the controllers that stopped (ControllerDriver::TakeStopped()).
  [[nodiscard]] std::string Change(WorldChange& change, WorldChange& inverse);
  /// Tunes the joints of a control board; frame() shows the result. Returns empty, or why it is impossible.
  std::string Tune(const edit::TuneJoints& tuning);
  /// Runs a step of `length` and returns its frame.
  const FramePtr& Step(Nanoseconds length, const StepInputs& inputs);
  /// PhysicsWorld::TakeFrozen().
  std::vector<FrozenBody> TakeFrozen();
  /// PhysicsWorld::TakeUnsolved().
  std::vector<std::string> TakeUnsolved();
  /// Only `physics` and `publish` are set.
  const PhaseTimes& times() const { return times_; }

 private:
  Simulation(std::shared_ptr<const Scene> scene, std::unique_ptr<PhysicsWorld> world, std::uint64_t seed,
             std::uint64_t epoch, const StepHelpers& helpers, const Clock& clock);
  std::shared_ptr<Frame> MakeFrame();
  /// Sets the scene and the members derived from it.
  void Use(std::shared_ptr<const Scene> scene);
  /// Sets the world to the state of `frame`, which has a scene of this scenario.
  void Take(const Frame& frame);
  /// Why controllers of robots in `change` cannot be loaded. Empty if they can.
  std::string ControllerFaults(const WorldChange& change) const;
  /// Places the things of `change` in `next`, a frame of the world's scene. `before`: the previous frame.
  std::string PlaceAll(const WorldChange& change, const Frame& before, Frame& next) const;
  std::string RestoreControllers(std::span<const std::byte> saved, std::vector<StoppedController>* told);
  /// Drops broadcasts that can no longer be heard, and adds those of the coming step.
  void TakeMessages(std::span<const SentMessage> sent);

  const StepHelpers helpers_;
  const Clock& clock_;
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<PhysicsWorld> world_;
  FramePtr start_;  // frame 0 of the first seed
  FramePtr frame_;
  std::uint64_t seed_ = 1, epoch_ = 0, step_ = 0;
  Nanoseconds time_ = 0, step_length_ = kDefaultStep;
  bool has_controllers_ = false;
  bool has_filters_ = false;           // a channel has a filter
  UsedIds used_;                       // ids assigned by edits
  std::vector<SentMessage> messages_;  // broadcasts that can still be heard
  std::uint64_t message_steps_ = 0;    // for how many steps they can
  SampleKeeper samples_;
  ScoreKeeper scores_;
  FramePool frames_;
  PhaseTimes times_;
};

}  // namespace coopdyn
