// SPDX-License-Identifier: MIT
// When a body counts as resting, when it sleeps, and when it has exploded. ODE's own sleeping keeps counters
// that nobody can read, so a saved state would not continue alike; these are in the frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

/// BodyState::sleep_counter counts the nanoseconds that a body has been slow and its set-points zero, up to
/// this. Down again while it is nearly slow: in a pile things settle by small jolts. When all bodies of an
/// island have got there, the island sleeps.
inline constexpr std::uint64_t kSleepAfter = 500'000'000;
/// The counter of a body that sleeps: exactly at rest, until something awake touches it or its set-points
/// change. Below it bodies are awake.
inline constexpr std::uint64_t kAsleep = BodyState::kFrozen - 1;

inline constexpr double kRestSpeed_m_s = 2e-3;
inline constexpr double kRestTurnRate_rad_s = 1e-2;

/// Nearly slow: not beyond this many times these rates.
inline constexpr double kNearly = 10;

/// Not beyond `times` these rates.
inline bool IsSlow(const BodyState& body, double times = 1) {
  const double speed_m_s = times * kRestSpeed_m_s, turn_rad_s = times * kRestTurnRate_rad_s;
  return body.v_WB.squaredNorm() <= speed_m_s * speed_m_s &&
         body.w_WB.squaredNorm() <= turn_rad_s * turn_rad_s;
}

/// Whether a motor is to move one of these channels.
inline bool IsDriven(std::span<const ChannelState> channels) {
  for (const ChannelState& channel : channels) {
    if (channel.setpoint.drives()) return true;
  }
  return false;
}

/// A body that exploded (not finite, or beyond a stated speed) and is held where it was last sane, so that
/// the rest of the world goes on.
struct FrozenBody {
  std::string name;  // of the robot or object
  std::string why;   // e.g. "speed 312 m/s"
};

inline constexpr double kMaxSpeed_m_s = 100;
inline constexpr double kMaxTurnRate_rad_s = 1000;

/// Why `state` is not sane, e.g. "speed 312 m/s"; nothing if it is.
std::optional<std::string> WhyInsane(const BodyState& state);

/// The largest share of these limits that a body uses; infinite if it is not finite.
double Violence(const BodyState& state);

}  // namespace coopdyn
