// SPDX-License-Identifier: MIT
#include "server/physics/freeze.h"

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

/// The largest share of the stated limits that a body uses.
double Violence(const BodyState& state) {
  if (!IsFinite(state)) return std::numeric_limits<double>::infinity();
  return std::max(state.v_WB.norm() / kMaxSpeed_m_s, state.w_WB.norm() / kMaxTurnRate_rad_s);
}

bool IsSane(dBodyID body) {
  const auto squared = [](const double* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
  const double* q = dBodyGetQuaternion(body);
  const double* p = dBodyGetPosition(body);
  // Comparisons with nan are false.
  return squared(dBodyGetLinearVel(body)) <= kMaxSpeed_m_s * kMaxSpeed_m_s &&
         squared(dBodyGetAngularVel(body)) <= kMaxTurnRate_rad_s * kMaxTurnRate_rad_s &&
         std::isfinite(p[0] + p[1] + p[2] + q[0] + q[1] + q[2] + q[3]);
}

}  // namespace

std::optional<std::string> WhyInsane(const BodyState& state) {
  if (!IsFinite(state)) return "position or speed not finite";
  if (!(state.v_WB.norm() <= kMaxSpeed_m_s)) return Number("speed", state.v_WB.norm(), "m/s");
  if (!(state.w_WB.norm() <= kMaxTurnRate_rad_s)) return Number("turn rate", state.w_WB.norm(), "rad/s");
  return std::nullopt;
}

void Hold(OdeWorld& ode, Owner& owner) {
  owner.frozen = true;
  for (int i = owner.first_body; i < owner.first_body + owner.body_count; ++i) {
    dBodyID body = ode.bodies[static_cast<std::size_t>(i)];
    dBodySetLinearVel(body, 0, 0, 0);
    dBodySetAngularVel(body, 0, 0, 0);
    dBodySetForce(body, 0, 0, 0);
    dBodySetTorque(body, 0, 0, 0);
    dBodyDisable(body);
  }
}

void LastSane::Remember(const OdeWorld& ode) {
  bodies_.resize(ode.bodies.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) bodies_[i] = ReadBody(ode.bodies[i]);
}

void LastSane::FreezeInsane(OdeWorld& ode, std::vector<FrozenBody>& frozen) const {
  for (std::size_t k = 0; k < static_cast<std::size_t>(ode.first_static); ++k) {
    Owner& owner = ode.owners[k];
    if (owner.frozen) continue;
    const std::size_t first = static_cast<std::size_t>(owner.first_body);
    const std::size_t end = first + static_cast<std::size_t>(owner.body_count);
    for (std::size_t i = first; i < end; ++i) {
      if (IsSane(ode.bodies[i])) continue;
      const auto why = WhyInsane(ReadBody(ode.bodies[i]));
      frozen.push_back({owner.name, why.value_or("exploded")});
      for (std::size_t j = first; j < end; ++j) WriteBody(ode.bodies[j], bodies_[j]);
      Hold(ode, owner);
      break;
    }
  }
}

bool LastSane::FreezeFastest(OdeWorld& ode, const std::string& why, std::vector<FrozenBody>& frozen) const {
  Owner* fastest = nullptr;
  double most = -1;
  for (std::size_t k = 0; k < static_cast<std::size_t>(ode.first_static); ++k) {
    Owner& owner = ode.owners[k];
    for (int i = owner.first_body; i < owner.first_body + owner.body_count; ++i) {
      const std::size_t body = static_cast<std::size_t>(i);
      WriteBody(ode.bodies[body], bodies_[body]);
      if (owner.frozen || Violence(bodies_[body]) <= most) continue;
      most = Violence(bodies_[body]);
      fastest = &owner;
    }
  }
  if (fastest == nullptr) return false;
  frozen.push_back({fastest->name, why});
  Hold(ode, *fastest);
  return true;
}

}  // namespace coopdyn
