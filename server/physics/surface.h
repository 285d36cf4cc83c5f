// SPDX-License-Identifier: MIT
// The contact law of two things: friction, rolling and bouncing, in ODE's terms, for all solvers. Pure; any
// thread. Only server/physics includes this file.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "server/physics/contacts.h"

namespace coopdyn {

// A penetrating contact is pushed out by this share of its depth per substep, but never faster than
// kMaxPushOut_m_s. 0.4 keeps wheels at their radius and hinges together at every step size; the cap keeps
// impacts from bouncing.
inline constexpr double kErp = 0.4;
inline constexpr double kMaxPushOut_m_s = 0.1;
// Softness (m/s per N·s): distributes a load over redundant contacts; small enough that nothing creeps on a
// slope.
inline constexpr double kCfm = 1e-6;

struct WorldSettings {
  Vector3 g_W{0, 0, -9.81};  // gravity, m/s²
  double floor_friction = 1;
};

/// One of the two things in a contact.
struct ContactSide {
  const Actor* actor = nullptr;  // null: the floor
  bool moves = false;            // the touching body is free to move in this step
  std::span<const ChannelState> channels;
};

/// The contact of A and B. The normal points towards the first (A, or B if `swapped`). Of two friction
/// coefficients the smaller one counts; of restitution, rolling and spinning friction the larger one.
///
/// ODE's friction is a pyramid, μ N along its two axes and √2 times that between them. So its first axis lies
/// along the slip, or along the slip that gravity will cause if nothing slips yet. The bounds of a surface
/// with a grain are those of the ellipse at this slip (S. Goyal, A. Ruina, J. Papadopoulos (1991), Planar
/// sliding with dry friction, Wear 143).
struct Surface {
  dContact contact{};
  bool swapped = false;  // the first is B
  /// Only with a grain: friction along fdir1 and across it, independent of the slip. `contact` has the values
  /// for a pyramid.
  std::optional<std::array<double, 2>> grain{};
  bool may_turn = false;  // nothing slips yet: a solver that knows the coming slip may turn the axes
  double slip_m_s = 0;    // only without a grain
};
/// Largest number of solver rows of a contact.
int RowsOf(const FoundContact& found);
/// Returns nullopt if the two do not act on each other.
std::optional<Surface> SurfaceOf(const FoundContact& found, const ContactSide& a, const ContactSide& b,
                                 const WorldSettings& settings, double dt_s);

}  // namespace coopdyn
