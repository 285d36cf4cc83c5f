// SPDX-License-Identifier: MIT
// Planar robots that push each other or walls: three rates per robot, and no rows for the floor. Only
// server/physics includes this file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contacts.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Solves one island at a time, from its state alone. Each wheel follows its set-point with a force within
/// the limit of OneBodyDrive, both wheels together hold sideways likewise, and contacts push and rub in the
/// plane. Rows are solved in turn until nothing changes (projected Gauss-Seidel: J. J. Moreau (1999),
/// Numerical aspects of the sweeping process, and E. Catto (2005), Iterative dynamics with temporal
/// coherence, here without memory of earlier steps). One thread at a time.
class PlaneSolver {
 public:
  static constexpr std::uint32_t kStatic = ~std::uint32_t{0};  // number of anything static

  /// Whether the solver accepts the contacts `found`: horizontal pushing and rubbing, without bounces, grain
  /// and torques.
  static bool Takes(std::span<const FoundContact> found);

  /// Removes all robots and contacts.
  void Begin();
  /// Adds a robot and returns its number. @pre its drive stands, and its body stands upright.
  std::uint32_t Add(const Actor& robot, std::span<const ChannelState> channels, double dt_s);
  /// Adds contacts of A with B, by their numbers. @pre Takes(found), and one of them moves.
  void Join(std::span<const FoundContact> found, std::uint32_t a, std::uint32_t b, double dt_s);
  /// kNear: rates still changed by more than 1 cm/s in the last round. kInsane: the result must not be read.
  enum class Outcome { kSolved, kNear, kInsane };
  /// Finds the rates at the end of the substep.
  Outcome Step();
  /// Moves the robot's body by the substep.
  void Move(std::uint32_t number, double dt_s, BodyState& body) const;

 private:
  struct Robot {
    double x = 0, y = 0, turn = 0;  // rates: of the centre of mass, m/s; rad/s
    double per_mass = 0, per_yaw = 0;
    double p_x_m = 0, p_y_m = 0;  // centre of mass
    double rest_z_m = 0;
    double c = 1, s = 0;  // heading at mid-step
    // Of left wheel, right wheel, and both sideways.
    double arm_m[3]{}, wanted_m_s[3]{}, most_ns[3]{}, push_ns[3]{}, mass_kg[3]{};
  };
  struct Contact {
    std::uint32_t a = 0, b = kStatic;
    double n_x = 0, n_y = 0;  // the normal, towards A; the tangent is (-n_y, n_x)
    double arm_an = 0, arm_at = 0, arm_bn = 0, arm_bt = 0;
    double mass_n_kg = 0, mass_t_kg = 0;
    double least_m_s = 0, friction = 0;
    double push_ns = 0, rub_ns = 0;
  };

  double SolveWheels(Robot& robot);
  double SolveContact(Contact& contact);

  std::vector<Robot> robots_;
  std::vector<Contact> contacts_;
  Robot still_;
};

}  // namespace coopdyn
