// SPDX-License-Identifier: MIT
#include "server/physics/islands.h"

#include <algorithm>
#include <span>

namespace coopdyn {

namespace {

std::span<const dBodyID> BodiesOf(const OdeWorld& ode, const Owner& owner) {
  return std::span(ode.bodies)
      .subspan(static_cast<std::size_t>(owner.first_body), static_cast<std::size_t>(owner.body_count));
}

}  // namespace

void Islands::Reset(const OdeWorld& ode) {
  parents_.resize(static_cast<std::size_t>(ode.first_static));
  for (std::size_t i = 0; i < parents_.size(); ++i) {
    const Owner& owner = ode.owners[i];
    parents_[i] = -1 - owner.rows - (owner.robot >= 0 ? kRobotSurcharge : 0);
  }
}

std::size_t Islands::Root(std::size_t owner) {
  while (parents_[owner] >= 0) {
    const std::size_t parent = static_cast<std::size_t>(parents_[owner]);
    if (parents_[parent] >= 0) parents_[owner] = parents_[parent];
    owner = parent;
  }
  return owner;
}

void Islands::Join(std::size_t a, std::size_t b) {
  a = Root(a);
  b = Root(b);
  if (a == b) return;
  if (a > b) std::swap(a, b);
  parents_[a] += parents_[b] + 1;
  parents_[b] = static_cast<int>(a);
}

void Solve(OdeWorld& ode, Islands& islands, double dt_s) {
  dWorldID world = ode.world.get();
  const std::size_t count = static_cast<std::size_t>(ode.first_static);
  const auto is_large = [&](std::size_t i) { return islands.RowsOf(i) > kMaxDirectRows; };
  bool any_large = false;
  for (std::size_t i = 0; i < count && !any_large; ++i) any_large = !ode.owners[i].frozen && is_large(i);
  if (!any_large) {
    dWorldStep(world, dt_s);
    return;
  }
  // ODE steps what is enabled: first the small groups, then the large ones.
  const auto enable = [&](bool small, bool large) {
    for (std::size_t i = 0; i < count; ++i) {
      if (ode.owners[i].frozen) continue;
      const bool on = is_large(i) ? large : small;
      for (dBodyID body : BodiesOf(ode, ode.owners[i])) on ? dBodyEnable(body) : dBodyDisable(body);
    }
  };
  enable(true, false);
  dWorldStep(world, dt_s);
  enable(false, true);
  dWorldQuickStep(world, dt_s);
  enable(true, true);
}

}  // namespace coopdyn
