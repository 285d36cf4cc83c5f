// SPDX-License-Identifier: MIT
#include "server/physics/broad_phase.h"

#include <cmath>

namespace coopdyn {

namespace {

constexpr double kCell_m = 0.5;  // a little more than a robot

Aabb2 Around(const double* p, double half_x, double half_y) {
  return {p[0] - half_x, p[1] - half_y, p[0] + half_x, p[1] + half_y};
}

Quaternion OrientationOf(dBodyID body) {
  const double* q = dBodyGetQuaternion(body);
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

BroadPhase::BroadPhase(const OdeWorld& ode) {
  for (std::size_t i = static_cast<std::size_t>(ode.first_static); i < ode.owners.size(); ++i) {
    const Part& part = ode.parts[static_cast<std::size_t>(ode.owners[i].first_part)];
    static_boxes_.push_back(Around(dGeomGetPosition(part.geom), part.half_m.x(), part.half_m.y()));
  }
  static_grid_.Build(static_boxes_, kCell_m);
  moving_boxes_.resize(static_cast<std::size_t>(ode.first_static));
}

const std::vector<std::pair<std::uint32_t, std::uint32_t>>& BroadPhase::FindPairs(OdeWorld& ode) {
  for (std::size_t i = 0; i < moving_boxes_.size(); ++i) {
    const Owner& owner = ode.owners[i];
    dBodyID body = ode.bodies[static_cast<std::size_t>(owner.first_body)];
    double half_x = owner.radius_m, half_y = owner.radius_m;
    if (owner.robot < 0) {
      Part& part = ode.parts[static_cast<std::size_t>(owner.first_part)];
      part.half_m = HalfExtents(part.shape, OrientationOf(body));
      half_x = part.half_m.x();
      half_y = part.half_m.y();
    }
    moving_boxes_[i] = Around(dBodyGetPosition(body), half_x, half_y);
  }
  pairs_.clear();
  if (moving_boxes_.size() > 1) {
    moving_grid_.Build(moving_boxes_, kCell_m);
    moving_grid_.FindPairs(moving_boxes_, pairs_);
  }
  if (static_boxes_.empty()) return pairs_;
  for (std::uint32_t i = 0; i < moving_boxes_.size(); ++i) {
    statics_.clear();
    static_grid_.FindOverlaps(static_boxes_, moving_boxes_[i], statics_);
    for (const std::uint32_t s : statics_) {
      pairs_.emplace_back(i, static_cast<std::uint32_t>(ode.first_static) + s);
    }
  }
  return pairs_;
}

}  // namespace coopdyn
