// SPDX-License-Identifier: MIT
// The physics world of one scene. In each substep, decides which things move by the closed form, which go to
// a solver, and which sleep. Owned by the holder of the baton (server/physics/stepper.h); no locks inside.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/base/worker_pool.h"
#include "server/physics/broad_phase.h"
#include "server/physics/drive_train.h"
#include "server/physics/islands.h"
#include "server/physics/lane.h"
#include "server/physics/limb_solver.h"
#include "server/physics/measures.h"
#include "server/physics/pile_solver.h"
#include "server/physics/plane_solver.h"
#include "server/physics/rest.h"
#include "server/physics/sweep.h"
#include "server/physics/wheel_drive.h"
#include "server/state/frame.h"

namespace coopdyn {

class PhysicsWorld {
 public:
  /// Builds the bodies of `scene`. Null, with errors at the model's lines, if a dynamic body starts inside
  /// another. `pool` (may be null) must outlive the world. A pool makes steps faster and does not change
  /// results.
  static std::unique_ptr<PhysicsWorld> Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                             Diagnostics& diagnostics, WorkerPool* pool = nullptr);

  /// Advances by `step` in `substeps` equal parts. `setpoints`: by channel of the scene. Frozen bodies are
  /// held in place. Deterministic: depends only on the state and the arguments. `noise`: the run's seed and
  /// the step's number.
  struct NoiseOf {
    std::uint64_t seed = 0, step = 0;
  };
  void Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints, const NoiseOf& noise);
  /// Measures::Keep().
  void KeepMeasured(std::span<const double> values) { measures_.Keep(values); }
  void Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints) {
    Step(step, substeps, setpoints, NoiseOf());
  }

  /// Writes the world's state into `frame`: bodies, channels (set-points are zero before the first step),
  /// controls, drive trains, solver_seed and measured values. Marks no actuator as commanded.
  void Fill(Frame& frame) const;
  /// Switches to `scene`, in the exact state of `frame`, which belongs to `scene`. The next steps give the
  /// same bits as after a fresh Build() and Restore(). Keeps the mechanisms that both scenes share, so adding
  /// or removing one thing among thousands costs a small part of Build().
  /// @pre floor and gravity are unchanged
  /// @pre the robots have passed Build() in some scene
  void Rebuild(std::shared_ptr<const Scene> scene, const Frame& frame);
  /// Changes how a control board's joint is driven, and wakes the robot.
  void Tune(std::size_t control, const JointControl& tuned);
  const std::vector<JointControl>& controls() const { return controls_; }
  const std::vector<DriveTrainState>& drive_trains() const { return drive_trains_; }
  /// Restores the exact state of `frame` (of the same scene): the next steps give the same bits. If the
  /// caller has changed poses in `frame`, it must also set the sleep counters of all affected bodies to 0,
  /// because sleeping bodies check nothing.
  void Restore(const Frame& frame);
  /// Restores the exact state of `start`, frame 0 of this world, and derives the solver's seed from `seed`:
  /// equivalent to a fresh Build().
  void Restart(const Frame& start, std::uint64_t seed);
  /// Returns the bodies frozen since the last call.
  std::vector<FrozenBody> TakeFrozen() { return std::exchange(frozen_, {}); }
  /// Returns, for each island and substep that were not solved exactly since the last call, the name of the
  /// island's first thing.
  std::vector<std::string> TakeUnsolved() { return std::exchange(unsolved_, {}); }

  const Scene& scene() const { return *scene_; }
  const Things& things() const { return things_; }

 private:
  PhysicsWorld(std::shared_ptr<const Scene> scene, std::uint64_t seed, WorkerPool* pool);

  /// One thread's solvers.
  struct Solvers {
    Solvers(const Things& things, const WorldSettings& settings)
        : lane(things, settings), limbs(things, settings), pile(things, settings) {}
    Lane lane;
    LimbSolver limbs;
    PileSolver pile;
    PlaneSolver plane;
  };
  enum class Method { kDirect, kIterative, kLimbs, kPile, kPlane };
  /// Islands that are solved together. A kLimbs batch is one island that has limbs, or one loose thing in
  /// flight, or an island that ODE gave up on; a kPile batch is one island of loose things; a kPlane batch is
  /// one island of planar robots.
  struct Batch {
    Method method = Method::kDirect;
    std::vector<std::uint32_t> members;                         // things, island by island
    std::vector<std::uint32_t> pairs;                           // index into pairs_, in order
    std::vector<std::pair<std::uint32_t, std::string>> frozen;  // in this substep: thing and why
    std::vector<MeasuredContact> measured;
    bool unsolved = false;
    bool is_solved = false;
    bool is_for_ode() const { return method == Method::kDirect || method == Method::kIterative; }
  };

  /// Sizes and builds all members that depend on the things.
  /// @pre things_ is set
  void Fit();
  /// `left`: the step's remaining substeps, including this one.
  void Substep(Nanoseconds dt, int left);
  /// Plans each robot's motion and the space that it needs.
  void PlanAll(double dt_s);
  void PlanRobot(std::size_t robot, double dt_s);
  /// Finds the pairs that may touch, and decides which things go to a solver.
  void Sort();

  /// Finds all contacts between things in this substep, and wakes sleepers that are touched.
  void Touch(double dt_s);
  /// Finds the contacts of Sort()'s pairs. Returns whether no sleeper was touched.
  bool FindPairContacts(double dt_s);
  void Wake(std::uint32_t thing, double dt_s);
  std::span<const FoundContact> ContactsOf(std::size_t pair) const;
  /// Groups the active things into islands, and the islands into batches.
  void MakeIslands();
  void MakeBatches();
  Batch& NextBatch(Method method);
  /// The root of the island that holds a pair that touches.
  std::uint32_t RootOfPair(std::size_t pair);
  bool HasLimbs(std::uint32_t root) const;
  /// Something in the island yields where it touches.
  bool IsSoft(std::uint32_t root) const;
  /// Whether the pile solver takes an island in which something yields.
  bool IsSoftPile(std::uint32_t root) const;
  /// The island contains only loose things, and they are few or slow.
  bool IsPile(std::uint32_t root);
  /// The island is one loose thing that touches nothing.
  bool Flies(std::uint32_t root) {
    return things_.all[root].mechanism->is_loose() && islands_.RowsOf(root) == 0;
  }
  /// The island contains only upright planar robots whose forces are not measured.
  bool IsPlane(std::uint32_t root) const;
  /// PlaneSolver accepts the pair's contacts and both things.
  bool FitsPlane(std::size_t pair) const;
  /// Solves the kPlane batches that PlaneSolver accepts; the other ones become ODE batches.
  void SolvePlanes(double dt_s);
  void SolvePlane(Batch& batch, PlaneSolver& solver, double dt_s);
  void SolveAll(double dt_s);
  /// Calls work(index, solvers) for the batches after the first, on all threads if that pays.
  template <typename Work>
  void ForBatches(const Work& work);
  /// Solves a batch. If that fails, freezes the fastest thing and tries again.
  void SolveBatch(Batch& batch, Solvers& solvers, double dt_s);
  /// Returns why it failed, or nullopt if it succeeded.
  std::optional<std::string> TryBatch(Batch& batch, Solvers& solvers, double dt_s);
  /// Solves each island of a kDirect batch alone, after ODE gave up on one of them.
  void SolveIslands(Batch& batch, Solvers& solvers, double dt_s);
  /// Returns false if nothing in the batch moves.
  bool FreezeFastest(std::string why, Batch& batch);
  // `solver`: a Lane, a LimbSolver or a PileSolver.
  template <typename Solver>
  void LoadBatch(const Batch& batch, Lane& lane, Solver& solver, double dt_s);
  template <typename Solver>
  void ReadBatch(Batch& batch, const Solver& solver, double dt_s);
  template <typename Solver>
  void ReadChannels(std::uint32_t thing, const Solver& solver, double dt_s);
  /// Turns the wheels of a one-body robot that a solver has moved.
  void TurnWheels(std::uint32_t thing, double dt_s);
  /// Lists the control boards' joints.
  void FitBoards();
  /// Applies the set-points of a step, and wakes robots whose control boards get new ones.
  void TakeSetpoints(std::span<const Setpoint> setpoints);
  /// Rate of each joint, from its bodies' twists. Empty if the work of the thing's motors is not measured.
  std::vector<double> RatesOf(std::uint32_t thing) const;
  /// Position, velocity and load of a control board's joint, from its bodies.
  JointPlace PlaceOf(std::size_t control) const;
  /// The same of the joint's motor: of the rotor if the joint has a drive train.
  JointPlace MotorPlaceOf(std::size_t control) const;
  /// Inertia beyond the joint about its axis, kg m², as if the parent stood still.
  double InertiaBeyond(std::size_t control) const;
  const JointModel& MotorOf(std::size_t control) const;
  /// Advances a control's drive train by a substep in which it applied `effort` to the joint.
  void FinishTrain(std::size_t control, double effort, double dt_s);
  /// No rotor turns.
  bool RotorsRest(const Thing& thing) const;
  /// Computes what the control boards' motors do in this substep. `left`: as in Substep().
  void AdvanceBoards(double dt_s, int left);
  /// A set-point or an unfinished motion drives the thing.
  bool IsDriven(const Thing& thing) const {
    return coopdyn::IsDriven(ChannelsOf(thing)) || (thing.control_count > 0 && IsUnderWay(thing));
  }
  /// One of the joints is still moving to a commanded position.
  bool IsUnderWay(const Thing& thing) const;
  /// Advances a channel that turned at `rate` in a substep.
  void Turn(ChannelState& channel, double rate, double dt_s) const {
    channel.position += rate * dt_s;
    channel.velocity += rate * share_;
  }

  void AdvanceClosed(double dt_s);
  /// Counts how long each thing has been at rest, and puts resting islands to sleep.
  void CountRest(Nanoseconds dt);
  bool AtRest(std::uint32_t thing) const;
  /// Whether a large pile rests on average, and each of its objects nearly: a few that still turn in their
  /// places do not keep it awake. `root`: of its island.
  bool IsCalm(std::uint32_t root) const;
  void Freeze(std::uint32_t thing, std::string why, Batch& batch);
  /// Stops the thing's bodies in place and sets their sleep counters.
  void Hold(std::uint32_t thing, std::uint64_t counter);

  /// Calls work(first, end) for parts of [0, count), on all threads if that pays.
  template <typename Work>
  void ForAll(std::size_t count, const Work& work);

  std::span<ChannelState> ChannelsOf(const Thing& thing) {
    return std::span(channels_).subspan(thing.first_channel, thing.channel_count);
  }
  std::span<const ChannelState> ChannelsOf(const Thing& thing) const {
    return std::span(channels_).subspan(thing.first_channel, thing.channel_count);
  }
  std::span<const JointRow> JointRowsOf(const Thing& thing) const {
    return std::span(rows_).subspan(thing.first_control, thing.control_count);
  }
  Actor ActorOf(std::uint32_t thing) const { return things_.ActorOf(thing, bodies_); }
  const BodyState& FirstBody(std::size_t thing) const { return bodies_[first_bodies_[thing]]; }
  std::span<BodyState> BodiesOf(std::uint32_t thing) {
    return std::span(bodies_).subspan(first_bodies_[thing], things_.all[thing].body_count());
  }
  std::size_t dynamic_count() const { return things_.first_static; }

  std::shared_ptr<const Scene> scene_;
  WorkerPool* const pool_;
  Things things_;
  std::optional<BroadPhase> broad_phase_;  // always set after construction
  Islands islands_;
  Sweep sweep_;
  std::vector<std::unique_ptr<Solvers>> solvers_;  // one per thread; the first also solves the large islands
  // Everything that the next step depends on, besides the scene and the set-points.
  std::vector<BodyState> bodies_;              // as Frame::bodies
  std::vector<ChannelState> channels_;         // as Frame::channels
  std::vector<JointControl> controls_;         // as Frame::controls
  std::vector<DriveTrainState> drive_trains_;  // as Frame::drive_trains
  std::uint64_t solver_seed_ = 0;
  std::vector<FrozenBody> frozen_;
  std::vector<std::string> unsolved_;
  Measures measures_;

  /// A joint of a control board.
  struct BoardJoint {
    std::uint32_t thing = 0;
    std::size_t channel = 0;  // of Frame::channels
    const Joint* joint = nullptr;
    int drive_train = -1;  // of Frame::drive_trains
  };
  /// A drive train in the current substep. `motor`: the joint's model as its servo sees it, for turning the
  /// rotor: without stops, damping, friction and spring.
  struct BoardTrain {
    JointModel motor;
    TrainStep step;
  };
  std::vector<BoardJoint> board_joints_;  // by control
  std::vector<JointRow> rows_;            // by control, for this substep
  std::vector<BoardTrain> board_trains_;  // by drive train

  double share_ = 1;  // one substep's share of the step
  // For the current substep.
  std::vector<std::size_t> first_bodies_;  // by dynamic thing
  std::vector<std::uint8_t> moves_;        // by dynamic thing: neither frozen nor asleep
  std::vector<std::uint8_t> near_;         // by dynamic thing: in a pair
  std::vector<std::uint8_t> soft_;       // by dynamic thing: it yields where it touches, or touches what does
  std::vector<std::uint8_t> in_solver_;  // by dynamic thing
  std::vector<std::uint8_t> rested_;     // by dynamic thing; at an island's root: all members rested
  std::vector<std::uint8_t> calm_;       // by dynamic thing; at an island's root: IsCalm()
  std::vector<double> travel_m_;         // by dynamic thing: how far it may move
  std::vector<DrivePlan> plans_;         // by robot
  std::vector<std::uint32_t> active_;    // things that go to a solver, increasing
  std::span<const BroadPhase::Pair> pairs_;
  std::vector<FoundContact> found_;
  std::vector<std::size_t> found_ends_;  // by pair: where its contacts end in found_
  std::vector<std::uint32_t> batch_of_;  // by root of an island
  std::vector<Batch> batches_;           // reused; batch 0: the large islands
  std::size_t batch_count_ = 0;
};

/// Default number of substeps: each lasts at most 10 ms.
int DefaultSubsteps(Nanoseconds step);

}  // namespace coopdyn
