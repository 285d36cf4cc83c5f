// SPDX-License-Identifier: MIT
#include "server/physics/rest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace coopdyn {

namespace {

std::string Number(const char* what, double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof(text), "%s %.0f %s", what, value, unit);
  return text;
}

bool IsFinite(const BodyState& state) {
  double sum = state.p_WB.sum() + state.v_WB.sum() + state.w_WB.sum();
  for (const double x : state.q_WB) sum += x;
  return std::isfinite(sum);  // a sum is finite only if all its terms are
}

}  // namespace

std::optional<std::string> FindFault(const BodyState& state) {
  if (!IsFinite(state)) return "position or speed not finite";
  if (!(state.v_WB.norm() <= kMaxSpeed_m_s)) return Number("speed", state.v_WB.norm(), "m/s");
  if (!(state.w_WB.norm() <= kMaxTurnRate_rad_s)) return Number("turn rate", state.w_WB.norm(), "rad/s");
  return std::nullopt;
}

double LimitRatio(const BodyState& state) {
  if (!IsFinite(state)) return std::numeric_limits<double>::infinity();
  return std::max(state.v_WB.norm() / kMaxSpeed_m_s, state.w_WB.norm() / kMaxTurnRate_rad_s);
}

}  // namespace coopdyn
