// SPDX-License-Identifier: MIT
#include "server/physics/islands.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

void Enable(const OdeWorld& ode, const Owner& owner, bool on) {
  const auto set = [on](dBodyID body) { on ? dBodyEnable(body) : dBodyDisable(body); };
  if (owner.one_body != nullptr) {
    set(ode.slots[static_cast<std::size_t>(owner.slot)].body);
    return;
  }
  for (int i = 0; i < owner.body_count; ++i) set(ode.bodies[static_cast<std::size_t>(owner.first_body + i)]);
}

}  // namespace

void Islands::Reset(const OdeWorld& ode, std::span<const std::uint32_t> active) {
  parents_.resize(static_cast<std::size_t>(ode.first_static));
  for (const std::uint32_t i : active) {
    const Owner& owner = ode.owners[i];
    parents_[i] = -1 - owner.rows - (owner.robot >= 0 ? kRobotSurcharge : 0);
  }
}

std::size_t Islands::RootOf(std::size_t owner) {
  while (parents_[owner] >= 0) {
    const std::size_t parent = static_cast<std::size_t>(parents_[owner]);
    if (parents_[parent] >= 0) parents_[owner] = parents_[parent];
    owner = parent;
  }
  return owner;
}

void Islands::Join(std::size_t a, std::size_t b) {
  a = RootOf(a);
  b = RootOf(b);
  if (a == b) return;
  if (a > b) std::swap(a, b);
  parents_[a] += parents_[b] + 1;
  parents_[b] = static_cast<int>(a);
}

void Solve(OdeWorld& ode, Islands& islands, std::span<const std::uint32_t> active, double dt_s) {
  dWorldID world = ode.world.get();
  const auto is_large = [&](std::uint32_t i) { return islands.RowsOf(i) > kMaxDirectRows; };
  if (std::none_of(active.begin(), active.end(), is_large)) {
    dWorldStep(world, dt_s);
    return;
  }
  // ODE steps what is enabled: first the small groups, then the large ones.
  bool any_small = false;
  for (const std::uint32_t i : active) {
    if (is_large(i)) {
      Enable(ode, ode.owners[i], false);
    } else {
      any_small = true;
    }
  }
  if (any_small) dWorldStep(world, dt_s);
  for (const std::uint32_t i : active) Enable(ode, ode.owners[i], is_large(i));
  dWorldQuickStep(world, dt_s);
  for (const std::uint32_t i : active) Enable(ode, ode.owners[i], true);
}

}  // namespace coopdyn
