// SPDX-License-Identifier: MIT
// A world and all that decides how it goes on: bodies, broadcasts on their way, loaded controllers. The live
// run (stepper.h) and its repetition (server/replay) step the same class, so they cannot differ. Whoever
// holds the step baton owns it; no locks inside.
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

/// What else takes part in a step; outlives the simulation.
struct StepHelpers {
  WorkerPool* pool = nullptr;               // null: everything on the stepping thread
  ControllerDriver* controllers = nullptr;  // null: robots that ask for a controller are errors
  /// Gives the filters of channels the values of `frame`, the one after `before`; needed if a channel has
  /// one.
  void (*advance_filters)(const Frame& before, Frame& frame) = nullptr;
};

/// What clients want of one step.
struct StepInputs {
  std::span<Setpoint> setpoints;          // by the scene's channels; loaded controllers overwrite theirs
  std::span<const SentMessage> messages;  // broadcasts, by increasing robot
  std::span<const std::uint8_t> commanded =
      {};  // by the scene's actuators: a client's command comes in force; or empty
};

class Simulation {
 public:
  /// Builds the world of `scene` and makes frame 0 (of epoch `epoch`). Null, with errors at the lines of the
  /// files, if it or its controllers do not fit. The controllers do not run yet: StartControllers().
  static std::unique_ptr<Simulation> Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                           std::uint64_t epoch, const StepHelpers& helpers,
                                           const Clock& clock, Diagnostics& diagnostics);
  ~Simulation();

  /// The newest frame.
  const FramePtr& frame() const { return frame_; }
  const Scene& scene() const { return *scene_; }
  bool has_controllers() const { return has_controllers_; }

  /// How long steps will be, which frame 0 says before there was one. Before StartControllers() or Restart().
  void SetStepLength(Nanoseconds length);
  /// Makes all controllers afresh for frame(), which is the start.
  void StartControllers();
  /// Back to the start, with this seed of noise and solver: the same bits as a fresh Build(). Controllers as
  /// after StartControllers().
  void Restart(std::uint64_t seed, std::uint64_t epoch);
  /// Goes on from `state`, whose frame has a scene of this scenario, bit for bit; scores and controllers
  /// included. Else why those cannot: nothing is to be stepped then before another Restore() or Restart(),
  /// unless those that do not drive any more are noted: `stopped` is ControllerDriver::TakeStopped() of then.
  /// Empty: all went well.
  [[nodiscard]] std::string Restore(const SavedState& state, std::uint64_t epoch,
                                    std::vector<StoppedController>* stopped = nullptr);
  /// What Restore() takes; `mode` and `paused` are the caller's to fill in.
  SavedState Save() const;

  /// Changes what stands in the world, and gives what is new in `change` its ids; frame() shows it. `inverse`
  /// undoes it. Why it cannot be, and nothing has changed; empty: it is done. Stopped controllers: as with
  /// Restore().
  [[nodiscard]] std::string Change(WorldChange& change, WorldChange& inverse);
  /// Tunes the joints of a control board; frame() says so. Why it cannot; empty: it is done.
  std::string Tune(const edit::TuneJoints& tuning);
  /// Runs a step of `length` and returns its frame.
  const FramePtr& Step(Nanoseconds length, const StepInputs& inputs);
  /// PhysicsWorld::TakeFrozen().
  std::vector<FrozenBody> TakeFrozen();
  /// PhysicsWorld::TakeUnsolved().
  std::vector<std::string> TakeUnsolved();
  /// Physics and publish only.
  const PhaseTimes& times() const { return times_; }

 private:
  Simulation(std::shared_ptr<const Scene> scene, std::unique_ptr<PhysicsWorld> world, std::uint64_t seed,
             std::uint64_t epoch, const StepHelpers& helpers, const Clock& clock);
  std::shared_ptr<Frame> MakeFrame();
  /// What is derived from the scene.
  void Use(std::shared_ptr<const Scene> scene);
  /// `frame`, of a scene of this scenario, tells what stands where from now on.
  void Take(const Frame& frame);
  /// Why controllers of robots in `change` cannot be; empty: they can.
  std::string ControllerFaults(const WorldChange& change) const;
  /// Puts things as `change` says into `next`, a frame of the world's scene; `before`: the frame before.
  std::string PlaceAll(const WorldChange& change, const Frame& before, Frame& next) const;
  std::string RestoreControllers(std::span<const std::byte> saved, std::vector<StoppedController>* told);
  /// Broadcasts that nobody can hear any more are dropped, those of the coming step added.
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
  bool has_filters_ = false;           // of values of channels
  UsedIds used_;                       // by edits
  std::vector<SentMessage> messages_;  // that may still be heard
  std::uint64_t message_steps_ = 0;    // for so long
  SampleKeeper samples_;
  ScoreKeeper scores_;
  FramePool frames_;
  PhaseTimes times_;
};

}  // namespace coopdyn
