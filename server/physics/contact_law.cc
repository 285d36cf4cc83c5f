// SPDX-License-Identifier: MIT
#include "server/physics/contact_law.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

void ContactLaw::Push() {
  const Vector3 free = hardness * (target - rate);
  if (!is_cone) {
    impulse = free.cwiseMax(-bound).cwiseMin(bound);
    return;
  }
  // The nearest point of the friction cone.
  const double mu = friction, along2 = free[1] * free[1] + free[2] * free[2];
  const double normal = free[0] - hardness * mu * slip;
  if (normal >= 0 && along2 <= mu * mu * normal * normal) {
    state = State::kSticks;
    impulse = {normal, free[1], free[2]};
  } else if (normal <= 0 && mu * mu * along2 <= normal * normal) {
    state = State::kOpen;
    impulse.setZero();
  } else {
    state = State::kSlides;
    const double along = std::sqrt(along2), load = (normal + mu * along) / (1 + mu * mu);
    const double scale = mu * load / along;
    impulse = {load, scale * free[1], scale * free[2]};
  }
}

double ContactLaw::Slip() const {
  if (state == State::kSticks) return 0;
  const double x = target[1] - rate[1], y = target[2] - rate[2];
  // Without the rate that the softness yields.
  return std::sqrt(x * x + y * y) - std::sqrt(impulse[1] * impulse[1] + impulse[2] * impulse[2]) / hardness;
}

Vector3 ContactLaw::Stiffness(bool is_secant) const {
  Vector3 stiffness = Vector3::Zero();
  for (int i = 0; i < 3; ++i) {
    const double free = std::abs(hardness * (target[i] - rate[i]));
    if (free < bound[i]) {
      stiffness[i] = hardness;
    } else if (is_secant && bound[i] > 0) {
      stiffness[i] = hardness * bound[i] / free;
    }
  }
  return stiffness;
}

std::array<ContactSpring, 3> ContactLaw::Springs() const {
  if (state == State::kSticks) {
    return {{{Vector3::UnitX(), hardness}, {Vector3::UnitY(), hardness}, {Vector3::UnitZ(), hardness}}};
  }
  // The impulse turns with the slip: stiffness across it.
  const Vector3 free = hardness * (target - rate);
  const double mu = friction, along = std::sqrt(free[1] * free[1] + free[2] * free[2]);
  const double normal = free[0] - hardness * mu * slip, load = (normal + mu * along) / (1 + mu * mu);
  const double x = free[1] / along, y = free[2] / along;
  return {{{{1, mu * x, mu * y}, hardness / (1 + mu * mu)}, {{0, -y, x}, hardness * mu * load / along}, {}}};
}

LawAlongStep::LawAlongStep(const ContactLaw& law)
    : is_cone_(law.is_cone),
      friction_(law.friction),
      hardness_(law.hardness),
      bound_(law.bound),
      free_(law.hardness * (law.target - law.rate)),
      change_(law.change) {
  free_[0] -= law.hardness * law.friction * law.slip;
}

void LawAlongStep::AddTo(StepSlope& slope, double share) const {
  const Vector3 now = free_ - share * hardness_ * change_;
  if (!is_cone_) {
    for (int i = 0; i < 3; ++i) {
      slope.value -= std::clamp(now[i], -bound_[i], bound_[i]) * change_[i];
      if (std::abs(now[i]) < bound_[i]) slope.rise += hardness_ * change_[i] * change_[i];
    }
    return;
  }
  const double mu = friction_, along2 = now[1] * now[1] + now[2] * now[2], normal2 = now[0] * now[0];
  if (now[0] >= 0 && along2 <= mu * mu * normal2) {
    slope.value -= now.dot(change_);
    slope.rise += hardness_ * change_.squaredNorm();
    return;
  }
  if (now[0] <= 0 && mu * mu * along2 <= normal2) return;
  const double along = std::sqrt(along2), load = (now[0] + mu * along) / (1 + mu * mu);
  const double x = now[1] / along, y = now[2] / along;
  const double edge = change_[0] + mu * (x * change_[1] + y * change_[2]),
               across = x * change_[2] - y * change_[1];
  slope.value -= load * edge;
  slope.rise += hardness_ * (edge * edge / (1 + mu * mu) + mu * load / along * across * across);
}

}  // namespace coopdyn
