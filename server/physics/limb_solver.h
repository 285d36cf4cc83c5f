// SPDX-License-Identifier: MIT
// Solves an island with limbs: robots of more than wheels, and whatever touches them. The joints are exact
// (server/physics/forest.h); motors that do not give in are springs on the mass matrix's diagonal; what is
// left for the complementarity problem are contacts, stops, loops and couplings. Remembers nothing from one
// substep to the next. One thread at a time. Only server/physics includes this file.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/physics/box_lcp.h"
#include "server/physics/forest.h"
#include "server/physics/joint_motor.h"
#include "server/physics/measures.h"
#include "server/physics/surface.h"

namespace coopdyn {

class LimbSolver {
 public:
  /// @pre `things` outlives it.
  LimbSolver(const Things& things, const WorldSettings& settings);

  /// Adds `thing` in the state of `actor` for a step of `dt_s`; `channels`: of it, with what its motors are
  /// to do, and `rows`: of the joints of its control boards. They outlive the step.
  void Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels,
            std::span<const JointRow> rows, double dt_s);
  /// Adds contacts between A and B (null: the floor), after all are loaded. A thing that is not loaded counts
  /// as static.
  /// `measured`: their forces are wanted.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The contacts that were to be measured, after Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  enum class Outcome { kSolved, kNear, kInsane };
  /// Advances what is loaded; not if there is no sane solution. kNear: some bound or motor is not met
  /// exactly.
  Outcome Step(double dt_s);
  /// What is loaded touches nothing, and no motor holds it; after Step().
  bool flies() const { return flies_; }
  /// The state of body `body` of a loaded thing; its sleep counter is 0.
  BodyState Read(std::uint32_t thing, std::size_t body) const;
  /// Rate of a driven joint of a loaded thing, rad/s or m/s; its position, rad or m, beyond ±π too: the one
  /// nearest to `last`; and its motor's effort in the step, with that of its stop, N m or N.
  double JointRate(std::uint32_t thing, std::size_t joint) const;
  double JointPosition(std::uint32_t thing, std::size_t joint, double last) const;
  double JointEffort(std::uint32_t thing, std::size_t joint) const;
  /// Forgets what is loaded.
  void Unload();
  /// The things have changed. @pre nothing is loaded
  void Fit() { member_of_.assign(things_.first_static, kNone); }

 private:
  static constexpr int kNone = Forest::kNone;
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  static constexpr double kRigid = 1e-7;  // m/s per N·s, rad/s per N·m·s: what counts as rigid
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Member {
    const Mechanism* mechanism = nullptr;
    int first_node = 0;
    std::size_t first_effort = 0;  // of efforts_, by joint
    std::span<const ChannelState> channels;
    std::span<const JointRow> rows;
    std::span<const BodyState> bodies;  // at the step's beginning
  };
  /// A spring and a damper whose forces are, so far, those of the step's end.
  struct Resistance {
    double stiffness = 0, damping = 0;
  };
  /// v + softness · impulse = target on one degree of freedom, with a bounded impulse.
  struct Motor {
    int dof = 0;
    std::size_t effort = 0;  // of efforts_; kNowhere: nobody asks for it
    double target = 0, softness = 0, lower = -kInfinity, upper = kInfinity;
    Resistance resistance;
    int gives_in = 0;    // −1 or 1: to this side
    double applied = 0;  // impulse of the last solution
    double bound() const { return gives_in > 0 ? upper : lower; }
  };
  /// J v + softness · impulse = target, with lower ≤ impulse ≤ upper.
  struct Row {
    struct Part {
      int end = kNone;       // of a chain of the forest
      std::size_t from = 0;  // of jacobian_ and transformed_
    };
    std::array<Part, 4> parts;
    std::size_t part_count = 0;
    double target = 0, softness = 0, lower = -kInfinity, upper = kInfinity;
    Resistance resistance;
    int normal = kNone;  // row whose impulse, times this friction, bounds it
    double friction = 0;
    double slip_m_s = 0;  // it is friction across this slip
    int effort = kNone;   // of efforts_
    std::span<const Part> all() const { return std::span(parts).first(part_count); }
  };
  /// A joint of a member: where it is in the forest, or between which nodes it closes a loop.
  struct Hinge {
    int node = kNone;  // in the tree
    int child = kNone, parent = kNone;
  };

  // What works on joints: limb_joints.cc.
  Hinge HingeOf(const Member& member, int joint) const;
  void DriveJoints(const Member& member, std::span<const JointRow> rows, double dt_s);
  /// `counts`: its effort is that of the joint's motor.
  void AddMotor(const Member& member, int joint, double target, double softness, double lower, double upper,
                bool counts = true, const Resistance& resistance = {0, 0});
  void AddMotor(const Member& member, int joint, double target, double softness, double most) {
    AddMotor(member, joint, target, softness, -most, most);
  }
  /// The drive train, friction, damper, spring and stops of a joint.
  void DriveByTrain(const Member& member, int joint, std::span<const CouplingShare> shares, double dt_s);
  /// The spring, damper and stops of a joint, and its friction; they count as the effort of its motor only if
  /// it has none.
  void Resist(const Member& member, int joint, double friction, bool counts, double dt_s);
  void Steer(const Member& member, int joint, double dt_s);
  /// Those that the joint at `position` may reach.
  void AddStops(const Member& member, int joint, double position, double dt_s);
  void AddStop(const Member& member, int joint, int side, double gap, double dt_s);
  void Push(const Member& member, int joint, double impulse);
  void CloseLoop(const Member& member, int joint, double dt_s);
  void Couple(const Member& member, double dt_s);
  double PositionOf(const Member& member, int joint) const;
  /// As JointPosition().
  double PositionNear(const Member& member, int joint, double last) const;
  /// A muscle: where it pulls, between which nodes.
  struct Pull {
    int from = kNone, to = kNone;
    Vector3 p_from_W, p_to_W, direction_W;  // from `from` to `to`
    double length_m = 0;
  };
  Pull PullOf(const Member& member, int joint) const;
  void AddMuscle(const Member& member, int joint, double dt_s);
  void Thrust(const Member& member, int joint, double dt_s);
  /// Adds scale times a joint's rate to a row.
  void AddRate(const Member& member, int joint, double scale, Row& row);

  int NodeOf(std::uint32_t thing, const Part& part) const;
  /// Adds the velocity that `torque` and `force` at p_W, on the node's body, work against.
  void AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force, Row& row);
  /// The directions of its rows, the last ones of rows_: where the first is pushed.
  std::span<const Vector3> AddContact(const Surface& touch, int node_a, int node_b, double dt_s);
  double RateOf(const Row& row, std::span<const double> rates) const;
  /// Springs and dampers among motors and rows work in the middle of the step. After Forest::Begin().
  void FitSprings(double dt_s);
  /// rates_ at the step's end; whether all is exact, as far as the method goes. `is_again`: with other forces
  /// of the forest than before.
  bool Settle(bool is_again);
  /// A step of what touches, or is held: forces where it begins, then the whole way at the new rates.
  bool Advance(double dt_s);
  /// Takes away what an error of the step has added to the energy `before` it.
  void LimitGain(const Forest::Energy& before);
  /// Loops, couplings, and what moves forest_ where it is.
  void BeginStep(double dt_s);
  /// The rates at the step's end, rates_; whether they are exact. After BeginStep().
  bool FindRates();
  /// Moves on what touches nothing and is held by no motor; rates_ are then those of the end. Whether all is
  /// exact. In limb_flight.cc, as what follows.
  bool Fly(double dt_s);
  struct Flight {
    bool is_solved = true;
    double work_j = 0;     // of motors and rows
    double swing_rad = 0;  // in a part, of the fastest swing
  };
  /// A step in `parts` of `dt_s`; it ends before one that swings by more than `most_swing_rad`.
  Flight FlyParts(int parts, double dt_s, double most_swing_rad);
  /// Adds what motors and rows applied to efforts_, as a share of the whole step.
  void AddEfforts();
  struct Work {
    double motors_j = 0, rows_j = 0;
  };
  /// Work of motors (and springs) and of rows in the change from the rates `before` to rates_.
  Work WorkSince(std::span<const double> before) const;
  /// Coriolis, centrifugal and gyroscopic forces at the mean of the rates before the step and rates_; whether
  /// that changes anything.
  bool TakeMeanForces();
  /// Impulses of all rows, with the motors as they are; `state_` becomes the transformed rates. `is_again`:
  /// begins with the impulses of before. `same_motors`: none has given in or held again since the last call.
  /// Whether they are exact, as far as the method goes.
  bool Solve(bool is_again, bool same_motors);
  bool SolveDirectly(bool is_again, bool same_motors);
  /// Turns friction rows along the slip that the solution without friction has: where nothing slips yet, a
  /// pyramid of friction holds up to √2 of what it should, but along its axes.
  void TurnFriction();
  /// The mass matrix with what the motors add, and the rows by it.
  void Factor();
  void SolveByIteration();
  /// Of friction across a slip that is `most` (N s) along it; `mobility`: what an impulse of 1 moves there.
  double SoftnessAcross(double slip_m_s, double most, double mobility) const;
  /// What a row's impulse of 1 adds to the transformed rates. Until the next call.
  const std::vector<double>& Column(const Row& row);
  double Dot(const Row& row, std::span<const double> transformed) const;
  void Apply(const Row& row, double impulse);
  /// Notes what motors applied, and lets them give in or hold again; whether one did.
  bool SwitchMotors(bool may_hold_again);

  const Things& things_;
  const WorldSettings settings_;
  Forest forest_;
  BoxLcp lcp_;
  std::vector<Member> members_;
  std::vector<int> member_of_;  // by dynamic thing
  std::vector<std::uint32_t> loaded_;
  std::vector<Motor> motors_;
  std::vector<Row> rows_;
  std::vector<MeasuredContact> measured_;
  /// Of measured_: its rows, and where these push A.
  struct Rubbing {
    std::size_t first_row = 0, count = 0;
    std::array<Vector3, 3> directions;
  };
  std::vector<Rubbing> rubbing_;
  /// Two friction rows, this one and the next, that may turn; and the place in rubbing_, if measured.
  struct Turning {
    std::size_t row = 0;
    int rubbing = kNone;
  };
  std::vector<Turning> turning_;
  std::array<Vector3, 3> directions_;                     // of the contact added last
  std::vector<double> jacobian_, transformed_, divided_;  // of the rows' parts; the last: by the pivots
  std::vector<double> pushes_;                            // impulses by degree of freedom
  std::vector<double> added_, state_, rates_, mean_, momentum_, efforts_, column_;
  bool touches_ = false;  // a contact is among the rows
  bool holds_ = false;    // a motor holds a rate or a place
  bool flies_ = false;    // the step is a flight
  double step_s_ = 0;     // length of the whole step
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_, lower_, upper_, impulses_;
};

}  // namespace coopdyn
