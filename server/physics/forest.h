// SPDX-License-Identifier: MIT
// Trees of bodies connected by joints, in joint coordinates: their dynamics, and the response to impulses on
// bodies. Joints cannot drift, and the work is proportional to the number of bodies. One thread at a time.
//
// R. Featherstone (2008), Rigid Body Dynamics Algorithms: the recursive Newton-Euler and articulated-body
// algorithms (tables 5.1 and 7.1) with spatial vectors in world axes about one point of each tree, which
// needs no transformations. The second is a factorisation of the mass matrix, H = Lᵀ D L (A. Jain (2011),
// Robot and Multibody Dynamics, chapter 7): L and its inverse are applied without forming the matrix. Only
// server/physics includes this file.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "server/physics/things.h"

namespace coopdyn {

/// Angular part (rad/s or N m) first, then linear (m/s or N).
using Spatial = Eigen::Matrix<double, 6, 1>;

inline Spatial Join(const Vector3& angular, const Vector3& linear) {
  Spatial joined;
  joined << angular, linear;
  return joined;
}

/// Angle of a rotation about `axis`, in [-π, π].
double AngleAbout(const Quaternion& q, const Vector3& axis);

class Forest {
  template <typename T>
  static decltype(auto) at(T& of, int index) {
    return of[static_cast<std::size_t>(index)];
  }

 public:
  static constexpr int kNone = -1;

  void Clear();
  /// Adds a mechanism in the state of its bodies; returns its first node.
  int Add(const Mechanism& mechanism, std::span<const BodyState> bodies);

  int node_count() const { return static_cast<int>(nodes_.size()); }
  int dof_count() const { return static_cast<int>(rates_.size()); }
  /// The first degree of freedom of a node that has any; and the last one that moves the node, kNone if it is
  /// fixed.
  int FirstDof(int node) const { return at(nodes_, node).first_dof; }
  int EndOf(int node) const { return at(nodes_, node).end; }
  /// Number of degrees of freedom in the chain from the root to `dof`, including `dof`.
  int ChainLength(int dof) const { return at(depths_, dof) + 1; }
  /// The chain's degrees of freedom, from the root on.
  std::span<const int> Chain(int dof) const {
    return std::span(paths_).subspan(at(offsets_, dof), static_cast<std::size_t>(ChainLength(dof)));
  }
  /// Position of a joint in the tree, in the joint's direction: m, or rad, wrapped except for screws. Move()
  /// updates it.
  double Position(int node) const { return at(nodes_, node).position; }
  /// Rates of the degrees of freedom at the beginning of the step.
  const std::vector<double>& rates() const { return rates_; }

  /// Computes inertias, and momentum(): that of the step's end if there were no rows, with the Coriolis,
  /// centrifugal and gyroscopic forces at the rates of the step's beginning.
  void Begin(const Vector3& g_W, double dt_s);
  /// Computes MassOf(). After Begin().
  void ComputeMasses();
  /// Recomputes momentum() with those forces at `rates`, such as the mean of the step's beginning and end.
  void EvaluateForcesAt(std::span<const double> rates);
  /// Mass or inertia that a degree of freedom moves, kg or kg m², as if its parent stood still. After
  /// ComputeMasses().
  double MassOf(int dof) const { return at(masses_, dof); }
  /// Factors the mass matrix with `added` (by degree of freedom) on its diagonal.
  void Factor(std::span<const double> added);
  double pivot(int dof) const { return at(pivots_, dof); }
  /// The nutation rate of the fastest rotor's axle, rad/s: its spin momentum times the axle's yielding in
  /// both directions across. 0 if each axle keeps its direction or can turn in one way only, and if no rotor
  /// spins faster than `least_spin_rad_s` relative to its carrier. After Factor().
  double NutationRate_rad_s(double least_spin_rad_s);

  /// Adds to `row`, which has the length of EndOf(node)'s chain, the Jacobian of the velocity on which a
  /// wrench on the node's body does work. `torque` and `force` are in world axes, at `p_W`.
  void AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force,
                 std::span<double> row) const;
  /// Replaces a chain's row J by L⁻ᵀ J. After Factor().
  void Transform(int end, std::span<double> row) const;
  /// Transform() replaces `momentum` (by degree of freedom, size dof_count()) by D⁻¹ L⁻ᵀ momentum. Finish()
  /// turns that into rates.
  void Transform(std::span<double> momentum);
  void Finish(std::span<double> transformed);
  const std::vector<double>& momentum() const { return momentum_; }

  /// Moves all bodies for `dt_s` at `rates`. SetRates() sets the bodies' twists.
  void Move(std::span<const double> rates, double dt_s);
  void SetRates(std::span<const double> rates);
  bool IsViolent() const;
  /// After Begin(): approximate frequency, rad/s, of the fastest joint that swings under the load of its
  /// subtree.
  double SwingRate_rad_s();
  /// Largest turn rate of floating bodies and ball joints.
  double FreeTurnRate_rad_s() const;
  /// Largest turn rate of all bodies.
  double TurnRate_rad_s() const;
  /// Scales the joints' `rates` by `share`, and updates the bodies' twists.
  void SlowJoints(double share, std::span<double> rates);
  /// Return() moves all bodies back to where they were at Save(), with the rates of that moment.
  void Save();
  void Return();
  /// Begins the next step where Move() has ended, with `rates`.
  void Continue(std::span<const double> rates);
  struct Energy {
    double kinetic_j = 0, potential_j = 0;
    double total_j() const { return kinetic_j + potential_j; }
  };
  /// After Add() or SetRates().
  Energy EnergyAt(const Vector3& g_W) const;
  /// Removes `energy_j` from the relative motion of bodies. Does not change the momentum and angular momentum
  /// of floating trees. `rates`: those of the last SetRates(), slowed down (or sped up if `energy_j` is
  /// negative); `kinetic_j`: the kinetic energy at `rates`.
  void Slow(double energy_j, double kinetic_j, std::span<double> rates);
  /// A node's body, after Move() that of the step's end; its sleep counter is 0.
  const BodyState& body(int node) const { return at(nodes_, node).state; }
  /// A direction and a point of the model, carried by a node's body; and the rotation of the child's model
  /// relative to the parent's.
  Vector3 Axis(int node, const Vector3& axis_R) const { return at(nodes_, node).R_WR * axis_R; }
  Vector3 Point(int node, const Vector3& p_R) const;
  Quaternion Between(int parent, int child) const {
    return at(nodes_, parent).R_WR.conjugate() * at(nodes_, child).R_WR;
  }

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Inertia {
    double mass = 0;
    Vector3 moment = Vector3::Zero();  // mass times the centre of mass relative to the point
    Matrix3 I = Matrix3::Zero();       // about the point
    void operator+=(const Inertia& other);
    Vector3 Angular(const Vector3& w, const Vector3& v) const { return I * w + moment.cross(v); }
    Vector3 Linear(const Vector3& w, const Vector3& v) const { return mass * v - moment.cross(w); }
    Matrix6 matrix() const;
  };
  struct Twist {
    Vector3 angular = Vector3::Zero(), linear = Vector3::Zero();
  };
  /// Where a node's body is.
  struct Posture {
    BodyState state;
    Quaternion R_WR;                  // of the model's axes, carried by this body
    Quaternion q_rel;                 // of a ball joint: relative to the parent, in the parent's axes
    double position = 0;              // of its joint
    double position2 = 0;             // of a universal joint's second axis
    Vector3 arm_W = Vector3::Zero();  // from its joint, carried by it, to its centre of mass
    Vector3 axis_W;                   // of a joint with one axis, in the direction of its rate
  };
  struct Node : Posture {
    const RigidBody* rigid = nullptr;
    const JointModel* model = nullptr;  // null: a root
    int parent = kNone;                 // node
    int sign = 1;
    int dofs = 0, first_dof = 0, end = kNone;
    double rate = 0;       // of its joint's first axis, for the armature
    Vector3 arm_R;         // arm_W in the model's axes
    Vector3 origin;        // the tree's reference point
    Inertia inertia;       // of this body
    Inertia subtree;       // of this body and its descendants, rigidly connected
    Matrix6 articulated;   // articulated-body inertia of the same
    Spatial passed;        // in Transform(): impulse that its joints pass on; in Finish(): its velocity
    Twist velocity, bias;  // bias: acceleration without that of the degrees of freedom, with gravity
    Twist momentum;        // at the beginning of the step
    Spatial force;         // momentum of the step's end, then with its descendants
    Vector3 load;          // force that its bias acceleration needs
    double square_m2 = 0;  // of the longest way from its joint to its centre or its children's joints
    int turns = 0;         // about how many independent axes it turns: 0, 1 or, for more, 2
    Vector3 turn_W;        // if 1, that axis
    Vector3 spin_W;        // as a carrier: spin momentum of its rotors relative to it
  };

  /// A point of the model, carried by a node's body.
  static Vector3 Carried(const Node& node, const Vector3& p_R) {
    return node.state.p_WB + node.R_WR * (p_R - node.rigid->X_RB.p);
  }
  static auto RotationOf(const BodyState& body) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(body.R_WB.data());
  }
  /// The inertia of a node's body about p_W.
  static Inertia InertiaOf(const Node& node, const Vector3& p_W);
  void AddUp(std::span<const double> rates, bool at_start);
  static double ArmatureOf(const Node& node) { return node.model == nullptr ? 0 : node.model->armature; }
  void AddDofs(Node& node, int index);
  /// Counts the axes about which a node turns, and notes rotors.
  void CountTurns(int index);
  /// The nutation rate of a carrier squared.
  double NutationOf(const Node& carrier);
  /// Computes a joint's position and rates from its two bodies.
  void Measure(Node& node);
  void AddAxes(const Node& node);
  /// Makes the joint's arm and axis of the body's orientation.
  static void Carry(Node& node);
  void Place(Node& node, const double* rates, double dt_s);

  std::vector<Node> nodes_;
  std::vector<Posture> saved_postures_;
  Vector3 g_W_ = Vector3::Zero();  // of this step
  double dt_s_ = 0;                // likewise
  // By degree of freedom.
  std::vector<int> depths_;
  std::vector<std::size_t> offsets_;  // into paths_
  std::vector<Spatial> axes_;
  std::vector<Spatial> gains_;  // articulated inertia times axis, divided by the pivot
  std::vector<double> rates_, saved_rates_, momentum_, masses_, pivots_;
  std::vector<int> paths_;  // the chains
  /// Nodes that turn without end on a carrier that turns about several axes, and on which no other such node
  /// turns: wheels and flywheels, but not the links of a limp chain.
  std::vector<int> rotors_;
  std::vector<double> across_, third_;
};

}  // namespace coopdyn
