// SPDX-License-Identifier: MIT
// Solves an island with limbs: robots with joints other than wheels, and everything that touches them. The
// joints are exact (server/physics/forest.h). Unsaturated motors are springs on the mass matrix's diagonal.
// The complementarity problem contains contacts, stops, loops and couplings. Keeps no state between substeps.
// One thread at a time. Only server/physics includes this file.
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

  /// Adds `thing` in the state of `actor` for a step of `dt_s`. `channels`: the thing's, with its set-points;
  /// `rows`: of its control boards' joints. All must outlive the step.
  void Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels,
            std::span<const JointRow> rows, double dt_s);
  /// Adds contacts between A and B (null: the floor). Call after all things are loaded; a thing that is not
  /// loaded counts as static. `measured`: also measures their forces.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The measured contacts. After Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  enum class Outcome { kSolved, kNear, kInsane };
  /// Advances the loaded things. kNear: some bound or motor is not met exactly. kInsane: there is no sane
  /// solution, so the result must not be read.
  Outcome Step(double dt_s);
  /// The loaded things touch nothing, and no motor holds them. After Step().
  bool flies() const { return flies_; }
  /// The state of body `body` of a loaded thing; its sleep counter is 0.
  BodyState Read(std::uint32_t thing, std::size_t body) const;
  /// A driven joint of a loaded thing: its rate, rad/s or m/s; its position, rad or m, unwrapped to the one
  /// nearest to `last`; and its motor's effort in the step, N m or N.
  double JointRate(std::uint32_t thing, std::size_t joint) const;
  double JointPosition(std::uint32_t thing, std::size_t joint, double last) const;
  double JointEffort(std::uint32_t thing, std::size_t joint) const;
  /// Removes all loaded things.
  void Unload();
  /// Adapts to changed things.
  /// @pre nothing is loaded
  void Fit() { member_of_.assign(things_.first_static, kNone); }

 private:
  static constexpr int kNone = Forest::kNone;
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  static constexpr double kRigid = 1e-7;  // m/s per N·s, rad/s per N·m·s: softness of rigid rows
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Member {
    const Mechanism* mechanism = nullptr;
    int first_node = 0;
    std::size_t first_effort = 0;  // of efforts_, by joint
    std::span<const ChannelState> channels;
    std::span<const JointRow> rows;
  };
  /// A spring and a damper. Until FitSprings(), targets and softnesses have their forces at the step's end.
  struct Resistance {
    double stiffness = 0, damping = 0;
  };
  /// v + softness · impulse = target on one degree of freedom, with a bounded impulse.
  struct Motor {
    int dof = 0;
    std::size_t effort = 0;  // of efforts_; kNowhere: not reported
    double target = 0, softness = 0, lower = -kInfinity, upper = kInfinity;
    Resistance resistance;
    int saturated_side = 0;  // −1 or 1: saturated at the lower or upper bound; 0: holds
    double applied = 0;      // impulse of the last solution
    double bound() const { return saturated_side > 0 ? upper : lower; }
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
    int normal = kNone;  // the row whose impulse times `friction` bounds this one
    double friction = 0;
    double slip_m_s = 0;  // > 0: this is friction across a slip of this speed
    int effort = kNone;   // of efforts_
    std::span<const Part> all() const { return std::span(parts).first(part_count); }
  };
  /// A joint of a member: its node in the tree, or the nodes between which it closes a loop.
  struct Hinge {
    int node = kNone;  // in the tree
    int child = kNone, parent = kNone;
  };

  // Forces on joints: limb_joints.cc.
  Hinge HingeOf(const Member& member, int joint) const;
  void DriveJoints(const Member& member, std::span<const JointRow> rows, double dt_s);
  /// `counts`: its effort counts as that of the joint's motor.
  void AddMotor(const Member& member, int joint, double target, double softness, double lower, double upper,
                bool counts = true, const Resistance& resistance = {0, 0});
  void AddMotor(const Member& member, int joint, double target, double softness, double most) {
    AddMotor(member, joint, target, softness, -most, most);
  }
  /// Adds the drive train, friction, damper, spring and stops of a joint.
  void DriveByTrain(const Member& member, int joint, std::span<const CouplingShare> shares, double dt_s);
  /// Adds the spring, damper, friction and stops of a joint. `counts`: all but the stops count as its motor's
  /// effort.
  void Resist(const Member& member, int joint, double friction, bool counts, double dt_s);
  void Steer(const Member& member, int joint, double dt_s);
  /// Adds the stops that the joint at `position` may reach.
  void AddStops(const Member& member, int joint, double position, double dt_s);
  void AddStop(const Member& member, int joint, int side, double gap, double dt_s);
  void Push(const Member& member, int joint, double impulse);
  void CloseLoop(const Member& member, int joint, double dt_s);
  void Couple(const Member& member, double dt_s);
  double PositionOf(const Member& member, int joint) const;
  /// As JointPosition().
  double PositionNear(const Member& member, int joint, double last) const;
  /// A muscle's line of action between two nodes.
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
  /// Adds to `row` the velocity on which `torque` and `force` at p_W on the node's body do work.
  void AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force, Row& row);
  /// Appends a contact's rows to rows_. Returns the directions in which its normal and friction rows push the
  /// first thing.
  std::span<const Vector3> AddContact(const Surface& touch, int node_a, int node_b, double dt_s);
  double RateOf(const Row& row, std::span<const double> rates) const;
  /// Makes springs and dampers among motors and rows act in the middle of the step. After Forest::Begin().
  void FitSprings(double dt_s);
  /// Computes rates_, those of the step's end. Returns whether they are exact, up to the method's error.
  /// `is_again`: the forest's forces have changed since the last call.
  bool Settle(bool is_again);
  /// A step of things that touch or are held: the forces at its beginning, then the whole motion at the new
  /// rates.
  bool Advance(double dt_s);
  /// Removes the energy that an integration error has added to `before`, the energy before the step.
  void LimitGain(const Forest::Energy& before);
  /// Adds loops and couplings, and computes inertias, forces and springs in forest_'s present state.
  void BeginStep(double dt_s);
  /// Computes rates_, those of the step's end. Returns whether they are exact. After BeginStep().
  bool FindRates(double dt_s);
  /// Repeats UseMeanForces() and Settle() until the mean rates belong to their own forces.
  bool SettleRotors();
  /// Advances things that touch nothing and are held by no motor; rates_ become those of the step's end.
  /// Returns whether all is exact. limb_flight.cc has Fly(), FlyParts() and WorkSince().
  bool Fly(double dt_s);
  /// The only thing is loose and turns at a constant rate: its moments of inertia are all equal.
  bool FliesExactly() const;
  struct Flight {
    bool is_solved = true;
    double work_j = 0;      // of motors and rows
    double coarseness = 0;  // angle of the fastest swing or nutation per part, as a share of the largest
  };
  /// Runs a step in `parts` parts of `dt_s`. Returns early at a part that is coarser than `most`.
  Flight FlyParts(int parts, double dt_s, double most);
  /// Adds the impulses of motors and rows to efforts_, averaged over the whole step.
  void AddEfforts();
  struct Work {
    double motors_j = 0, rows_j = 0;
  };
  /// Work of motors (and springs) and of rows while the rates change from `before` to rates_.
  Work WorkSince(std::span<const double> before) const;
  /// Recomputes Coriolis, centrifugal and gyroscopic forces at the mean of the rates before the step and
  /// rates_. Returns whether the change matters.
  bool UseMeanForces();
  /// Computes the impulses of all rows for the motors' present states, and the transformed rates `state_`.
  /// `is_again`: warm start from the last impulses. `same_motors`: no motor has switched since the last call.
  /// Returns whether the impulses are exact, up to the method's error.
  bool Solve(bool is_again, bool same_motors);
  bool SolveDirectly(bool is_again, bool same_motors);
  /// Turns friction rows along the slip of the solution without friction. Where nothing slips yet, a friction
  /// pyramid holds up to √2 times too much, except along its axes.
  void TurnFriction();
  /// Factors the mass matrix with the motors' springs, and transforms the rows by it.
  void Factor();
  void SolveByIteration();
  /// Softness of friction across a slip. `most`: the friction impulse along the slip, N s; `mobility`: the
  /// row's velocity per impulse.
  double SoftnessAcross(double slip_m_s, double most, double mobility) const;
  /// Change of the transformed rates per unit impulse of a row. Valid until the next call.
  const std::vector<double>& Column(const Row& row);
  double Dot(const Row& row, std::span<const double> transformed) const;
  void Apply(const Row& row, double impulse);
  /// Records the motors' impulses, and switches motors between holding and saturated. Returns whether one
  /// switched.
  bool SwitchMotors(bool may_release);

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
  /// By contact of measured_: its rows, and the directions in which they push A.
  struct Rubbing {
    std::size_t first_row = 0, count = 0;
    std::array<Vector3, 3> directions;
  };
  std::vector<Rubbing> rubbing_;
  /// Two friction rows that may turn: `row` and the next one. `rubbing`: index into rubbing_ if measured.
  struct Turning {
    std::size_t row = 0;
    int rubbing = kNone;
  };
  std::vector<Turning> turning_;
  std::array<Vector3, 3> directions_;                     // of the contact added last
  std::vector<double> jacobian_, transformed_, divided_;  // of the rows' parts; divided_: by the pivots
  std::vector<double> pushes_;                            // impulses by degree of freedom
  std::vector<double> added_, state_, rates_, mean_, earlier_, momentum_, efforts_, column_;
  bool touches_ = false;  // a contact is among the rows
  bool holds_ = false;    // a motor holds a rate or a position
  bool flies_ = false;    // the step is a flight
  double step_s_ = 0;     // length of the whole step, also while FlyParts() runs
  double nutation_rad_ =
      0;  // turn of the fastest rotor's nutation in the step or part; 0: it does not matter
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_, lower_, upper_, impulses_;
};

}  // namespace coopdyn
