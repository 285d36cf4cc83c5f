// SPDX-License-Identifier: MIT
// When a body counts as resting, when it sleeps, and when it has exploded. ODE's own sleeping has counters
// that cannot be read, so a restored state would continue differently; our counters are in the frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

/// BodyState::sleep_counter counts, up to kSleepAfter, the nanoseconds for which a body has been slow and its
/// set-points zero. While an object is nearly slow, the counter decreases instead of restarting, because
/// things in a pile settle in small jolts. When all bodies of an island have reached kSleepAfter, the island
/// sleeps.
inline constexpr std::uint64_t kSleepAfter = 500'000'000;
/// The counter of a sleeping body, which is exactly at rest until something awake touches it or its
/// set-points change. Bodies with smaller counters are awake.
inline constexpr std::uint64_t kAsleep = BodyState::kFrozen - 1;

inline constexpr double kRestSpeed_m_s = 2e-3;
inline constexpr double kRestTurnRate_rad_s = 1e-2;

/// A body is nearly slow up to kNearly times the rates above.
inline constexpr double kNearly = 10;

/// Whether both rates are at most `times` the rates above.
inline bool IsSlow(const BodyState& body, double times = 1) {
  const double speed_m_s = times * kRestSpeed_m_s, turn_rad_s = times * kRestTurnRate_rad_s;
  return body.v_WB.squaredNorm() <= speed_m_s * speed_m_s &&
         body.w_WB.squaredNorm() <= turn_rad_s * turn_rad_s;
}

/// Whether a set-point drives one of these channels.
inline bool IsDriven(std::span<const ChannelState> channels) {
  for (const ChannelState& channel : channels) {
    if (channel.setpoint.drives()) return true;
  }
  return false;
}

/// A body that exploded (not finite, or beyond the limits below). It is held at its last sane pose, so that
/// the rest of the world continues.
struct FrozenBody {
  std::string name;  // of the robot or object
  std::string why;   // e.g. "speed 312 m/s"
};

inline constexpr double kMaxSpeed_m_s = 100;
inline constexpr double kMaxTurnRate_rad_s = 10'000;  // a ball of 1 cm that rolls at 100 m/s

/// Why `state` is not sane, e.g. "speed 312 m/s"; nullopt if it is sane.
std::optional<std::string> FindFault(const BodyState& state);

/// The body's speed or turn rate as a share of its limit, whichever is larger; infinite if the state is not
/// finite.
double LimitRatio(const BodyState& state);

}  // namespace coopdyn
