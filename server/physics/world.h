// SPDX-License-Identifier: MIT
// The physics world of one scene: in each substep, who moves by the closed form, who is handed to ODE, who
// sleeps. Whoever holds the step baton (server/physics/stepper.h) owns it; no locks inside.
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
  /// another. `pool` (null: none) outlives it and makes steps faster, never different.
  static std::unique_ptr<PhysicsWorld> Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                             Diagnostics& diagnostics, WorkerPool* pool = nullptr);

  /// Advances by `step` in `substeps` equal parts. `setpoints`: of the scene's channels. Frozen bodies are
  /// held. Deterministic: depends on the state and the arguments alone. `noise`: seed of the run, and number
  /// of the step.
  struct NoiseOf {
    std::uint64_t seed = 0, step = 0;
  };
  void Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints, const NoiseOf& noise);
  /// Measures::Keep().
  void KeepMeasured(std::span<const double> values) { measures_.Keep(values); }
  void Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints) {
    Step(step, substeps, setpoints, NoiseOf());
  }

  /// Writes bodies, channels (set-points before the first step: zeros) and solver_seed into `frame`; no
  /// actuator is commanded.
  void Fill(Frame& frame) const;
  /// The world of `scene` from now on, in the exact state of `frame`, which has this scene: the next steps
  /// give the same bits as a fresh Build() with Restore(). What both scenes have is kept, so one thing more
  /// or less among thousands costs a small part of Build(). Floor and gravity are those of before. @pre the
  /// robots have passed Build() in some scene.
  void Rebuild(std::shared_ptr<const Scene> scene, const Frame& frame);
  /// Changes how a joint of a control board is driven, and wakes its robot.
  void Tune(std::size_t control, const JointControl& tuned);
  const std::vector<JointControl>& controls() const { return controls_; }
  const std::vector<DriveTrainState>& drive_trains() const { return drive_trains_; }
  /// Takes the exact state of `frame` (of the same scene), so that the next steps give the same bits. Whoever
  /// changes poses in it sets the sleep counters of what may be affected to 0: sleepers look at nothing.
  void Restore(const Frame& frame);
  /// The exact state of `start`, frame 0 of this world, with the solver's seed of `seed`: as a fresh Build().
  void Restart(const Frame& start, std::uint64_t seed);
  /// Bodies frozen since the last call.
  std::vector<FrozenBody> TakeFrozen() { return std::exchange(frozen_, {}); }
  /// Since the last call: for each substep of an island with limbs that was not solved exactly, who is in it.
  std::vector<std::string> TakeUnsolved() { return std::exchange(unsolved_, {}); }

  const Scene& scene() const { return *scene_; }
  const Things& things() const { return things_; }

 private:
  PhysicsWorld(std::shared_ptr<const Scene> scene, std::uint64_t seed, WorkerPool* pool);

  /// What one thread solves islands with.
  struct Solvers {
    Solvers(const Things& things, const WorldSettings& settings)
        : lane(things, settings), limbs(things, settings), pile(things, settings) {}
    Lane lane;
    LimbSolver limbs;
    PileSolver pile;
    PlaneSolver plane;
  };
  enum class Method { kDirect, kIterative, kLimbs, kPile, kPlane };
  /// Islands that are solved together; by kLimbs one, of bodies with limbs or an object in flight; by kPile
  /// one, of objects; by kPlane one, of robots of fidelity planar.
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

  /// Makes what depends on the number of things. @pre things_
  void Fit();
  /// `left`: substeps of the step that are to come, this one included.
  void Substep(Nanoseconds dt, int left);
  /// Where every robot wants to go, and the space it needs for that.
  void PlanAll(double dt_s);
  void PlanRobot(std::size_t robot, double dt_s);
  /// Decides who is handed to ODE.
  void Sort();

  /// Finds all contacts between things in this substep, and wakes who sleeps and is touched.
  void Touch(double dt_s);
  /// Contacts of the pairs of Sort(); true if none of them touches a sleeper.
  bool FindPairContacts(double dt_s);
  void Wake(std::uint32_t thing, double dt_s);
  std::span<const FoundContact> ContactsOf(std::size_t pair) const;
  /// Groups who is handed to ODE into islands, and islands into batches.
  void MakeIslands();
  void MakeBatches();
  Batch& NextBatch(Method method);
  bool HasLimbs(std::uint32_t root) const;
  /// It is of objects alone, few or calm ones.
  bool IsPile(std::uint32_t root);
  /// It is an object that touches nothing.
  bool Flies(std::uint32_t root) { return root < things_.first_robot && islands_.RowsOf(root) == 0; }
  /// It is of planar robots of which no forces are wanted.
  bool IsPlane(std::uint32_t root) const;
  /// PlaneSolver takes these contacts, and both things.
  bool FitsPlane(std::size_t pair) const;
  /// Solves what stays in the plane; the others become batches of ODE.
  void SolvePlanes(double dt_s);
  void SolvePlane(Batch& batch, PlaneSolver& solver, double dt_s);
  void SolveAll(double dt_s);
  /// Calls work(index, solvers) for the batches after the first, on all threads if that pays.
  template <typename Work>
  void ForBatches(const Work& work);
  /// Solves a batch; if that fails, again without the body that was fastest.
  void SolveBatch(Batch& batch, Solvers& solvers, double dt_s);
  /// Why it failed.
  std::optional<std::string> TryBatch(Batch& batch, Solvers& solvers, double dt_s);
  /// False: nothing moves.
  bool FreezeFastest(std::string why, Batch& batch);
  // `solver`: a Lane or a LimbSolver.
  template <typename Solver>
  void LoadBatch(const Batch& batch, Lane& lane, Solver& solver, double dt_s);
  template <typename Solver>
  void ReadBatch(Batch& batch, const Solver& solver, double dt_s);
  template <typename Solver>
  void ReadChannels(std::uint32_t thing, const Solver& solver, double dt_s);
  /// Wheels of a robot of one body that a solver has moved.
  void TurnWheels(std::uint32_t thing, double dt_s);
  /// Lists the joints of control boards.
  void FitBoards();
  /// Takes the set-points of a step; who gets other ones wakes.
  void TakeSetpoints(std::span<const Setpoint> setpoints);
  /// How fast each joint turns or slides, by the bodies, if its motor's work is wanted; else empty.
  std::vector<double> RatesOf(std::uint32_t thing) const;
  /// Where a joint of a control board is, by its bodies.
  JointPlace PlaceOf(std::size_t control) const;
  /// Where the motor of such a joint is: with a drive train its rotor.
  JointPlace MotorPlaceOf(std::size_t control) const;
  /// What the joint of an elastic drive train moves, kg m², as if all that carries it stood still.
  double InertiaBeyond(std::size_t control) const;
  const JointModel& MotorOf(std::size_t control) const;
  /// Moves the drive train of a control on by a substep in which it gave its joint this effort.
  void FinishTrain(std::size_t control, double effort, double dt_s);
  /// No rotor turns.
  bool RotorsRest(const Thing& thing) const;
  /// What the motors of the control boards do in this substep, of which `left` are to come.
  void AdvanceBoards(double dt_s, int left);
  /// A motor is to move the thing.
  bool IsDriven(const Thing& thing) const {
    return coopdyn::IsDriven(ChannelsOf(thing)) || (thing.control_count > 0 && IsUnderWay(thing));
  }
  /// One of its joints is on its way to a position.
  bool IsUnderWay(const Thing& thing) const;
  /// A channel has turned at this rate in a substep.
  void Turn(ChannelState& channel, double rate, double dt_s) const {
    channel.position += rate * dt_s;
    channel.velocity += rate * share_;
  }

  void AdvanceClosed(double dt_s);
  /// Counts how long everybody has been at rest, and lets whole islands sleep.
  void CountRest(Nanoseconds dt);
  bool AtRest(std::uint32_t thing) const;
  void Freeze(std::uint32_t thing, std::string why, Batch& batch);
  /// Puts its bodies to rest where they are.
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
  std::optional<BroadPhase> broad_phase_;  // always there
  Islands islands_;
  Sweep sweep_;
  std::vector<std::unique_ptr<Solvers>> solvers_;  // one a thread; the first also has the large islands
  // All that the next step depends on, besides the scene and the set-points.
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
  /// A drive train in the present substep, and the motor that its servo takes it for: one that turns the
  /// rotor, without the stops and springs of the joint.
  struct BoardTrain {
    JointModel motor;
    TrainStep step;
  };
  std::vector<BoardJoint> board_joints_;  // as controls_
  std::vector<JointRow> rows_;            // likewise; of the present substep
  std::vector<BoardTrain> board_trains_;  // as drive_trains_

  double share_ = 1;  // of a substep in the present step
  // Of the present substep.
  std::vector<std::size_t> first_bodies_;  // by dynamic thing
  std::vector<std::uint8_t> moves_;        // by dynamic thing: neither frozen nor asleep
  std::vector<std::uint8_t> near_;         // by dynamic thing: in a pair
  std::vector<std::uint8_t> in_ode_;       // by dynamic thing
  std::vector<std::uint8_t> rested_;       // by dynamic thing: of an island's root: all its members
  std::vector<double> travel_m_;           // by dynamic thing: how far it may come
  std::vector<DrivePlan> plans_;           // by robot
  std::vector<std::uint32_t> active_;      // things handed to ODE, increasing
  std::span<const BroadPhase::Pair> pairs_;
  std::vector<FoundContact> found_;
  std::vector<std::size_t> found_ends_;  // by pair: where its contacts end in found_
  std::vector<std::uint32_t> batch_of_;  // by root of an island
  std::vector<Batch> batches_;           // reused; batch 0: the large islands
  std::size_t batch_count_ = 0;
};

/// The number of substeps of a step when not given: each at most 10 ms.
int DefaultSubsteps(Nanoseconds step);

}  // namespace coopdyn
