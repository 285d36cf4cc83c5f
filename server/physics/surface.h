// SPDX-License-Identifier: MIT
// What happens where two things touch: friction, rolling, bouncing, in ODE's terms, for whichever solver.
// Pure; any thread. Only server/physics includes this file.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "server/physics/contacts.h"

namespace coopdyn {

// A contact that sinks in is pushed out by this share of its depth in a substep, but never faster than
// kMaxPushOut: 0.4 keeps wheels at their radius and hinges together at every step size; the cap is what makes
// impacts not bounce.
inline constexpr double kErp = 0.4;
inline constexpr double kMaxPushOut_m_s = 0.1;
// Softness (m/s per N·s): shares a load among redundant contacts; small enough that nothing creeps on a
// slope.
inline constexpr double kCfm = 1e-6;

struct WorldSettings {
  Vector3 g_W{0, 0, -9.81};  // gravity, m/s²
  double floor_friction = 1;
};

/// One of the two that touch.
struct Toucher {
  const Actor* actor = nullptr;  // null: the floor
  bool moves = false;            // the body that touches is free to move in this step
  std::span<const ChannelState> channels;
};

/// The contact of A and B; the normal is towards the first. Friction: the slippier of the two decides (the
/// smaller coefficient); of bouncing, rolling and spinning friction the larger value.
///
/// ODE's friction is a pyramid, μ N along its two axes and √2 times that between them. So its first axis lies
/// along the slip, where there is none yet along what gravity will make it, and the bounds of a surface with
/// a grain are those of the ellipse at this slip (S. Goyal, A. Ruina, J. Papadopoulos (1991), Planar sliding
/// with dry friction, Wear 143).
struct Surface {
  dContact contact{};
  bool swapped = false;  // the first is B
  /// Of one with a grain: friction along fdir1 and across it, whatever slips. The contact has what a pyramid
  /// needs.
  std::optional<std::array<double, 2>> grain{};
  bool may_turn = false;  // nothing slips yet: a solver that knows whither it will may turn the axes
  double slip_m_s = 0;    // of one without a grain
};
/// Rows of a contact in a solver, at most.
int RowsOf(const FoundContact& found);
/// Nothing: they do not act on each other.
std::optional<Surface> SurfaceOf(const FoundContact& found, const Toucher& a, const Toucher& b,
                                 const WorldSettings& settings, double dt_s);

}  // namespace coopdyn
