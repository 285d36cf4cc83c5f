// SPDX-License-Identifier: MIT
// Solves an island of touching objects. Newton's method finds the rates of all objects at once, in the convex
// problem whose optimality conditions are momentum, contact and friction (E. Todorov (2014), "Convex and
// analytically-invertible dynamics with contacts and constraints", ICRA; A. M. Castro et al. (2023), "An
// unconstrained convex formulation of compliant contact", IEEE T-RO). That problem alone would lift sliding
// objects; a correction by the known slip prevents it (G. De Saxcé, Z.-Q. Feng (1998), "The bipotential
// method", Mathl. Comput. Modelling 28). Keeps no state between substeps: the rates before the substep are
// the first guess, and already solve the problem for resting objects. One thread at a time. Only
// server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/physics/block_cholesky.h"
#include "server/physics/contact_law.h"
#include "server/physics/measures.h"
#include "server/physics/surface.h"

namespace coopdyn {

class PileSolver {
 public:
  /// @pre `things` outlives it.
  PileSolver(const Things& things, const WorldSettings& settings);

  /// Adds the object `thing` in the state of `actor`, for a step of `dt_s`.
  void Load(std::uint32_t thing, const Actor& actor, double dt_s);
  /// Adds contacts between A and B (null: the floor). Call after all things are loaded, once per pair. A
  /// thing that is not loaded counts as static. `measured`: also measures their forces.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The measured contacts. After Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  /// Advances the loaded things. Returns whether the rates are exact within about 1 cm/s.
  bool Step(double dt_s);
  /// The state of a loaded thing; its sleep counter is 0.
  const BodyState& Read(std::uint32_t thing, std::size_t body) const;
  /// Removes all loaded things.
  void Unload();
  /// Adapts to changed things.
  /// @pre nothing is loaded
  void Fit() { body_of_.assign(things_.first_static, kNone); }

 private:
  static constexpr int kNone = -1;
  using Matrix6 = BlockCholesky::Block;
  using Vector6 = BlockCholesky::Vector;

  struct Body {
    BodyState state;
    double mass_kg = 0;
    Matrix3 I_W, inverse_I_W;  // about the centre of mass
    Vector3 free_v, free_w;    // rates in W without contacts
    Vector3 v = Vector3::Zero(), w = Vector3::Zero();
    Vector3 step_v = Vector3::Zero(), step_w = Vector3::Zero();
    Vector3 gradient_v = Vector3::Zero(), gradient_w = Vector3::Zero();
  };
  /// Two touching bodies, or one body and something static.
  struct Joint {
    int a = kNone, b = kNone;          // of bodies_
    std::size_t first = 0, count = 0;  // of points_
    std::size_t edge = 0;              // of the matrix, if both move
  };
  /// A contact point. Axes: the normal, from B to A, and two tangents.
  struct Point {
    Matrix3 axes_W;
    Vector3 r_a = Vector3::Zero(), r_b = Vector3::Zero();  // from the centres of mass, in W
    ContactLaw slide, roll;
    bool is_round = true;                  // all axes have length 1
    bool rolls = false;                    // resists rolling or spinning
    Vector3 resistance = Vector3::Zero();  // m: torque bounds per load
  };

  int BodyOf(std::uint32_t thing) const { return thing < body_of_.size() ? body_of_[thing] : kNone; }
  std::span<Point> PointsOf(const Joint& joint) {
    return std::span(points_).subspan(joint.first, joint.count);
  }
  /// Rate along the normal per impulse along it, 1/kg.
  double MobilityAt(const Point& point, int a, int b);
  void AddPoint(const Surface& surface, int a, int b, double dt_s);
  /// kNone: something static.
  Body& BodyAt(int body) { return body == kNone ? still_ : bodies_[static_cast<std::size_t>(body)]; }
  /// Calls take(law, rates of A relative to B along its axes) for all laws. `linear`, `angular`: return the
  /// rates of a body to use.
  template <typename Linear, typename Angular, typename Take>
  void AtPoints(const Linear& linear, const Angular& angular, const Take& take);
  /// Finds the rates. Returns whether they are within 1 cm/s of the solution.
  bool Solve(double dt_s);
  /// Updates friction to the current loads and slips; `rolls`: also rolling and spinning friction. Returns
  /// the largest change of a slip, times its friction, m/s.
  double UpdateLoads(bool rolls);
  /// Computes the gradients of all bodies. Returns the largest, as the change of velocity that it causes,
  /// m/s.
  double FindGradient();
  /// Computes the Newton step, which would be the last if no contact opened, closed or began to slip.
  void FindStep();
  /// Takes as much of the step as leads downhill. Returns the largest step of a body, m/s.
  double TakeStep();
  void Move(double dt_s);

  const Things& things_;
  const WorldSettings settings_;
  std::vector<int> body_of_;  // by dynamic thing
  std::vector<std::uint32_t> loaded_;
  std::vector<Body> bodies_;
  double heaviest_kg_ = 0;  // of bodies_
  Body still_;
  std::vector<Joint> joints_;
  std::vector<Point> points_;
  std::vector<std::pair<int, int>> edges_;
  BlockCholesky matrix_;
  // The first guess of a load may be far too large, and so is rolling friction, between whose bounds Newton's
  // method may jump forever. A careful attempt begins without it, and approaches it by secants.
  bool is_careful_ = false;
  std::vector<LawAlongStep> laws_;
  std::vector<Vector6> solution_;
  std::vector<MeasuredContact> measured_;
  std::vector<std::size_t> measured_points_;
};

}  // namespace coopdyn
