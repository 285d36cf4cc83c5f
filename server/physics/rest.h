// SPDX-License-Identifier: MIT
// When a body counts as resting, and when it sleeps. ODE's own sleeping keeps counters that nobody can read,
// so a saved state would not continue alike; these are in the frame. Only server/physics includes this file.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "server/state/frame.h"

namespace coopdyn {

/// BodyState::sleep_counter counts the nanoseconds that a body has been slow and its set-points zero, up to
/// this. When all bodies of an island have got there, the island sleeps.
inline constexpr std::uint64_t kSleepAfter = 500'000'000;
/// The counter of a body that sleeps: exactly at rest, until something awake touches it or its set-points
/// change. Below it bodies are awake.
inline constexpr std::uint64_t kAsleep = BodyState::kFrozen - 1;

inline constexpr double kRestSpeed_m_s = 2e-3;
inline constexpr double kRestTurnRate_rad_s = 1e-2;

inline bool IsSlow(const BodyState& body) {
  return body.v_WB.squaredNorm() <= kRestSpeed_m_s * kRestSpeed_m_s &&
         body.w_WB.squaredNorm() <= kRestTurnRate_rad_s * kRestTurnRate_rad_s;
}

/// Whether a motor is to move one of these channels.
inline bool IsDriven(std::span<const ChannelState> channels) {
  for (const ChannelState& channel : channels) {
    if (channel.setpoint.drives()) return true;
  }
  return false;
}

}  // namespace coopdyn
