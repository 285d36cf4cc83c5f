// SPDX-License-Identifier: MIT
// Solves an island of objects that touch: Newton's method finds the rates of all of them at
// once, in the convex problem whose optimality conditions are momentum, contact and friction (E. Todorov
// (2014), "Convex and analytically-invertible dynamics with contacts and constraints", ICRA; A. M. Castro et
// al. (2023), "An unconstrained convex formulation of compliant contact", IEEE T-RO). By itself that problem
// lifts what slides; what is known of the slip takes that away (G. De Saxcé, Z.-Q. Feng (1998), "The
// bipotential method", Mathl. Comput. Modelling 28). Remembers nothing from one substep to the next: the
// rates before it are the first guess, and what rests needs no more. One thread at a time. Only
// server/physics includes this file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/physics/block_cholesky.h"
#include "server/physics/measures.h"
#include "server/physics/surface.h"

namespace coopdyn {

class PileSolver {
 public:
  /// @pre `things` outlives it.
  PileSolver(const Things& things, const WorldSettings& settings);

  /// Adds the object `thing` in the state of `actor`, for a step of `dt_s`.
  void Load(std::uint32_t thing, const Actor& actor, double dt_s);
  /// Adds contacts between A and B (null: the floor), after all are loaded; once for the two. A thing that is
  /// not loaded counts as static. `measured`: their forces are wanted.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The contacts that were to be measured, after Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  /// Advances what is loaded; whether the rates are exact, within some 1 cm/s.
  bool Step(double dt_s);
  /// The state of a loaded thing; its sleep counter is 0.
  const BodyState& Read(std::uint32_t thing, std::size_t body) const;
  /// Forgets what is loaded.
  void Unload();
  /// The things have changed. @pre nothing is loaded
  void Fit() { body_of_.assign(things_.first_static, kNone); }

 private:
  static constexpr int kNone = -1;
  using Matrix6 = BlockCholesky::Block;

  struct Body {
    BodyState state;
    double mass_kg = 0;
    Matrix3 I_W, inverse_I_W;  // about the centre of mass
    Vector3 free_v, free_w;    // rates in W without contacts
    Vector3 v = Vector3::Zero(), w = Vector3::Zero();
    Vector3 step_v = Vector3::Zero(), step_w = Vector3::Zero();
    Vector3 gradient_v = Vector3::Zero(), gradient_w = Vector3::Zero();
  };
  /// Two bodies that touch, or one and what stands still.
  struct Joint {
    int a = kNone, b = kNone;          // of bodies_
    std::size_t first = 0, count = 0;  // of points_
    std::size_t edge = 0;              // of the matrix, if both move
  };
  enum class State { kOther, kOpen, kSticks, kSlides };
  /// What resists motion along three axes, or about them. Impulses in N s or N m s, rates in m/s or rad/s.
  struct Law {
    // One-sided along the first axis; the impulses along the others are at most `friction` times that, `slip`
    // is their rate as far as it is known. Else each axis has bounds of its own.
    bool is_cone = false;
    double friction = 0, slip = 0;
    Vector3 bound = Vector3::Zero();
    Vector3 target = Vector3::Zero();
    double hardness = 0;                                       // impulse per rate
    Vector3 rate = Vector3::Zero(), change = Vector3::Zero();  // now, and by the step
    Vector3 impulse = Vector3::Zero();
    State state = State::kOther;  // of a cone

    /// The impulse after this share of the step.
    void Push(double share);
    /// Of a cone at the rates of now.
    double Slip() const;
    /// −∂impulse/∂rate.
    Matrix3 Stiffness() const;
  };
  /// Where they touch. Axes: the normal, from B to A, and two tangents.
  struct Point {
    Matrix3 axes_W;
    Vector3 r_a = Vector3::Zero(), r_b = Vector3::Zero();  // from the centres of mass, in W
    Law slide, roll;
    bool is_round = true;                  // friction is the same in all directions: the axes have length 1
    bool rolls = false;                    // it resists rolling or spinning,
    Vector3 resistance = Vector3::Zero();  // m, times the load
  };

  int BodyOf(std::uint32_t thing) const { return thing < body_of_.size() ? body_of_[thing] : kNone; }
  std::span<Point> PointsOf(const Joint& joint) {
    return std::span(points_).subspan(joint.first, joint.count);
  }
  /// Rate along the normal per impulse along it, 1/kg.
  double MobilityAt(const Point& point, int a, int b);
  void AddPoint(const Surface& surface, int a, int b, double dt_s);
  /// kNone: what stands still.
  Body& BodyAt(int body) { return body == kNone ? still_ : bodies_[static_cast<std::size_t>(body)]; }
  /// Calls take(law, rates along its axes of A against B) for all laws; `linear`, `angular`: which rates of a
  /// body.
  template <typename Linear, typename Angular, typename Take>
  void AtPoints(const Linear& linear, const Angular& angular, const Take& take);
  /// Friction as it is with the loads and slips of now; by how much slips have changed, m/s.
  double TakeLoads();
  /// The gradients of all bodies; how far they are from zero: the most that one moves by it, m/s.
  double FindGradient();
  /// The step that would be the last if no contact opened, closed or began to slip.
  void FindStep();
  /// Takes as much of the step as leads downhill; how long the longest was, m/s.
  double TakeStep();
  void Move(double dt_s);

  const Things& things_;
  const WorldSettings settings_;
  std::vector<int> body_of_;  // by dynamic thing
  std::vector<std::uint32_t> loaded_;
  std::vector<Body> bodies_;
  Body still_;
  std::vector<Joint> joints_;
  std::vector<Point> points_;
  std::vector<std::pair<int, int>> edges_;
  BlockCholesky matrix_;
  std::vector<BlockCholesky::Vector> solution_;
  std::vector<MeasuredContact> measured_;
  std::vector<std::size_t> measured_points_;
};

}  // namespace coopdyn
