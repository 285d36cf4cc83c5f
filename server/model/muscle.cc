// SPDX-License-Identifier: MIT
#include "server/model/muscle.h"

#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn {

double LengthFactor(const MuscleModel& muscle, double length_m) {
  if (!muscle.use_length) return 1;
  const double off =
      std::abs((length_m - muscle.optimal_length_m) / (muscle.width * muscle.optimal_length_m));
  return portable::Exp(-muscle.c * off * off * off);
}

VelocityFactor VelocityFactorOf(const MuscleModel& muscle, double shortening_m_s) {
  if (!muscle.use_velocity) return {};
  // Geyer and Herr (2010); 7.56 gives the slopes at rest the right ratio (van Soest and Bobbert 1993).
  constexpr double kSlopes = 7.56;
  const double most = muscle.max_velocity_m_s, u = std::clamp(shortening_m_s, -most, most);
  if (u >= 0) {
    const double below = most + muscle.curvature * u;
    return {(most - u) / below, -most * (1 + muscle.curvature) / (below * below)};
  }
  const double steep = kSlopes * muscle.curvature, below = steep * u - most, more = muscle.eccentric - 1;
  return {muscle.eccentric + more * (most + u) / below, -more * most * (1 + steep) / (below * below)};
}

}  // namespace coopdyn
