// SPDX-License-Identifier: MIT
// Bodies that explode are held where they were last sane, so that the rest of the world goes on.
// Only server/physics includes this file.
#pragma once

#include <optional>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

inline constexpr double kMaxSpeed_m_s = 100;
inline constexpr double kMaxTurnRate_rad_s = 1000;

/// Why `state` is not sane, e.g. "speed 312 m/s"; nothing if it is.
std::optional<std::string> WhyInsane(const BodyState& state);

/// The largest share of these limits that a body uses; infinite if it is not finite.
double Violence(const BodyState& state);

}  // namespace coopdyn
