// SPDX-License-Identifier: MIT
// What a contact point does in a pile: its impulse as a function of the rates at the point. Of the convex
// problem that PileSolver solves (server/physics/pile_solver.h), each law is one term: the impulse is its
// slope. Pure functions. Only server/physics includes this file.
#pragma once

#include <array>
#include <cstdint>

#include "server/geometry/shape.h"

namespace coopdyn {

/// Resistance of a contact to rates along `axis`.
struct ContactSpring {
  Vector3 axis = Vector3::Zero();
  double stiffness = 0;  // impulse per rate
};

/// Resistance to motion along or about three axes. Impulses in N s or N m s, rates in m/s or rad/s.
struct ContactLaw {
  enum class State : std::uint8_t { kOther, kOpen, kSticks, kSlides };

  // If true, the law is one-sided along the first axis, the impulse along the other axes is at most
  // `friction` times that along the first, and `slip` is the last known rate along them. Otherwise each
  // axis has its own bound.
  bool is_cone = false;
  double friction = 0, slip = 0;
  Vector3 bound = Vector3::Zero();
  Vector3 target = Vector3::Zero();
  double hardness = 0;                                       // impulse per rate
  Vector3 rate = Vector3::Zero(), change = Vector3::Zero();  // now, and change by the Newton step
  Vector3 impulse = Vector3::Zero();
  State state = State::kOther;  // of a cone

  /// Sets the impulse to that at the current rates.
  void Push();
  /// Slip of a cone at the current rates.
  double Slip() const;
  /// −∂impulse/∂rate of a cone that is not open, as springs along axes.
  std::array<ContactSpring, 3> Springs() const;
  /// The same of another law, by axis; `is_secant`: where an impulse has reached its bound, −impulse / rate.
  Vector3 Stiffness(bool is_secant) const;
};

/// Slope of the convex function along the Newton step, and the slope's derivative.
struct StepSlope {
  double value = 0, rise = 0;
};

/// What a search along the Newton step needs of a law.
class LawAlongStep {
 public:
  explicit LawAlongStep(const ContactLaw& law);
  /// Adds the law's part after this share of the step.
  void AddTo(StepSlope& slope, double share) const;

 private:
  bool is_cone_;
  double friction_, hardness_;
  Vector3 bound_, free_, change_;  // impulses: the bounds, and without them; of the rates by the whole step
};

}  // namespace coopdyn
