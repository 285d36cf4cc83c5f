// SPDX-License-Identifier: MIT
// Bodies that hang on each other by joints, as trees in joint coordinates: what moves them, and what an
// impulse on a body does. Joints cannot drift, and the work grows with the number of bodies. One thread at a
// time.
//
// R. Featherstone (2008), Rigid Body Dynamics Algorithms: the recursive Newton-Euler and articulated-body
// algorithms (tables 5.1 and 7.1) with spatial vectors in world axes about one point of each tree, so that
// nothing is transformed on the way. The second is a factorisation of the mass matrix, H = Lᵀ D L (A. Jain
// (2011), Robot and Multibody Dynamics, chapter 7): L and its inverse are applied without the matrix. Only
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
  /// The first degree of freedom of a node that has some; and the last one that moves it, kNone: it is fixed.
  int FirstDof(int node) const { return at(nodes_, node).first_dof; }
  int EndOf(int node) const { return at(nodes_, node).end; }
  /// Degrees of freedom of the chain from the root to `dof`, this one included.
  int ChainLength(int dof) const { return at(depths_, dof) + 1; }
  /// The chain's degrees of freedom, from the root on.
  std::span<const int> Chain(int dof) const {
    return std::span(paths_).subspan(at(offsets_, dof), static_cast<std::size_t>(ChainLength(dof)));
  }
  /// Position of a joint in the tree, in its own direction: m, or rad, wrapped unless it is a screw's; after
  /// Move() where it has come to.
  double Position(int node) const { return at(nodes_, node).position; }
  /// Rates of the degrees of freedom at the beginning of the step.
  const std::vector<double>& rates() const { return rates_; }

  /// Computes inertias, and the momentum that the rates of the step's end would give without rows:
  /// with the Coriolis, centrifugal and gyroscopic forces of the rates at the step's beginning.
  void Begin(const Vector3& g_W, double dt_s);
  /// Computes MassOf(). After Begin().
  void Weigh();
  /// momentum() again, with those forces at `rates`, such as the mean of the step's beginning and end.
  void TakeForcesAt(std::span<const double> rates);
  /// What a degree of freedom moves: kg or kg m², as if all that carries it stood still. After Weigh().
  double MassOf(int dof) const { return at(masses_, dof); }
  /// Factors the mass matrix with `added` (by degree of freedom) on its diagonal.
  void Factor(std::span<const double> added);
  double pivot(int dof) const { return at(pivots_, dof); }

  /// Row of the velocity that a force (per N, or N m) on a node's body works against: `wrench` is in world
  /// axes, about `p_W`. Adds scale times its row to `row`, of the length of EndOf(node)'s chain.
  void AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force,
                 std::span<double> row) const;
  /// Turns a chain's row J into L⁻ᵀ J. After Factor().
  void Transform(int end, std::span<double> row) const;
  /// `momentum` (by degree of freedom, size dof_count()) becomes D⁻¹ L⁻ᵀ of it, then, by Finish(), rates.
  void Transform(std::span<double> momentum);
  void Finish(std::span<double> transformed);
  const std::vector<double>& momentum() const { return momentum_; }

  /// Moves everything on by `dt_s` at `rates`; the bodies' twists are those of SetRates().
  void Move(std::span<const double> rates, double dt_s);
  void SetRates(std::span<const double> rates);
  bool IsViolent() const;
  /// After Begin(): roughly the frequency, rad/s, at which the fastest of the joints swings that carry what
  /// hangs on them.
  double SwingRate_rad_s();
  /// How fast the fastest of what turns about any axis turns: what floats, and ball joints.
  double FreeTurnRate_rad_s() const;
  /// And of all bodies.
  double TurnRate_rad_s() const;
  /// Leaves joints this share of their `rates`, and bodies what follows.
  void SlowJoints(double share, std::span<double> rates);
  /// The next step begins where Move() at `rates` has come to.
  void Continue(std::span<const double> rates);
  struct Energy {
    double kinetic_j = 0, potential_j = 0;
    double total_j() const { return kinetic_j + potential_j; }
  };
  /// After Add() or SetRates().
  Energy EnergyAt(const Vector3& g_W) const;
  /// Takes `energy_j` out of the motion of bodies against each other: neither momentum nor angular momentum
  /// of what floats changes. `rates`: of the last SetRates(), made slower (or faster); `kinetic_j`: at them.
  void Slow(double energy_j, double kinetic_j, std::span<double> rates);
  /// A node's body, after Move() at its end; its sleep counter is 0.
  const BodyState& body(int node) const { return at(nodes_, node).state; }
  /// A direction, and a point, of the model as a node's body carries it; and how the child's model is turned
  /// against the parent's.
  Vector3 Axis(int node, const Vector3& axis_R) const { return at(nodes_, node).R_WR * axis_R; }
  Vector3 Point(int node, const Vector3& p_R) const;
  Quaternion Between(int parent, int child) const {
    return at(nodes_, parent).R_WR.conjugate() * at(nodes_, child).R_WR;
  }

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Inertia {
    double mass = 0;
    Vector3 moment = Vector3::Zero();  // mass times the centre of mass about the point
    Matrix3 I = Matrix3::Zero();       // about the point
    void operator+=(const Inertia& other);
    Vector3 Angular(const Vector3& w, const Vector3& v) const { return I * w + moment.cross(v); }
    Vector3 Linear(const Vector3& w, const Vector3& v) const { return mass * v - moment.cross(w); }
    Matrix6 matrix() const;
  };
  struct Twist {
    Vector3 angular = Vector3::Zero(), linear = Vector3::Zero();
  };
  struct Node {
    const RigidBody* rigid = nullptr;
    const JointModel* model = nullptr;  // null: a root
    int parent = kNone;                 // node
    int sign = 1;
    int dofs = 0, first_dof = 0, end = kNone;
    BodyState state;
    Quaternion R_WR;                  // of the model's axes as this body sees them
    Quaternion q_rel;                 // of a ball joint: against the parent, in the parent's axes
    double position = 0;              // of its joint
    double position2 = 0;             // of a universal joint's second axis
    double rate = 0;                  // of its joint's motor, while it has an armature
    Vector3 arm_W = Vector3::Zero();  // from its joint, as it carries it, to its centre of mass
    Vector3 origin;                   // the tree's point
    Inertia inertia;                  // of this body
    Inertia subtree;                  // and of all that hangs on it, rigidly
    Matrix6 articulated;              // and as its joints let it hang there
    Spatial passed;                   // while rates are found: what the joints beyond pass on; its velocity
    Twist velocity, bias;             // acceleration without that of the degrees of freedom, gravity included
    Twist momentum;                   // at the beginning of the step
    Spatial force;                    // then of all that hangs on it: momentum to come
    Vector3 load;                     // the force that its acceleration without degrees of freedom takes
    double square_m2 = 0;             // of the longest way from its joint to those that hang on it
  };

  /// A point of the model as a node's body carries it.
  static Vector3 Carried(const Node& node, const Vector3& p_R) {
    return node.state.p_WB + node.R_WR * (p_R - node.rigid->X_RB.p);
  }
  static auto RotationOf(const BodyState& body) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(body.R_WB.data());
  }
  /// About p_W.
  static Inertia InertiaOf(const Node& node, const Vector3& p_W);
  void AddUp(std::span<const double> rates, bool at_start);
  static double ArmatureOf(const Node& node) { return node.model == nullptr ? 0 : node.model->armature; }
  void AddDofs(Node& node, int index);
  /// Where a joint stands, from its two bodies.
  void Measure(Node& node);
  void AddAxes(const Node& node);
  void Place(Node& node, const double* rates, double dt_s);

  std::vector<Node> nodes_;
  Vector3 g_W_ = Vector3::Zero();  // of this step
  double dt_s_ = 0;                // likewise
  // By degree of freedom.
  std::vector<int> depths_;
  std::vector<std::size_t> offsets_;  // into paths_
  std::vector<Spatial> axes_;
  std::vector<Spatial> gains_;  // the momentum that it takes along for each momentum of its own
  std::vector<double> rates_, momentum_, masses_, pivots_;
  std::vector<int> paths_;  // the chains
};

}  // namespace coopdyn
