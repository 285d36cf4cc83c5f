// SPDX-License-Identifier: MIT
#include "server/physics/broad_phase.h"

#include <algorithm>
#include <cmath>

#include "server/physics/drive_motion.h"

namespace coopdyn {

namespace {

constexpr double kCell_m = 0.5;
/// How much wider a robot may be than its disc when it leans, as long as its axis stays within 2°.
constexpr double kLean_m = 0.01;

PlacedRotation PlaceOfObject(const Part& part) {
  return {dGeomGetPosition(part.geom), dGeomGetRotation(part.geom)};
}

/// Whether `part`, somewhere in its box, comes within `circle`.
bool Reaches(const Circle& circle, const Part& part, const PlacedRotation& place, const Aabb2& bounds) {
  const double r = circle.radius_m;
  double dx = circle.x - place.p[0], dy = circle.y - place.p[1];
  if (std::holds_alternative<Sphere>(part.shape) ||
      (std::holds_alternative<Cylinder>(part.shape) && std::abs(place.R[10]) > 1 - 1e-12)) {
    const double reach = r + (bounds.max_x - bounds.min_x) / 2;
    return dx * dx + dy * dy <= reach * reach;
  }
  double half_x = (bounds.max_x - bounds.min_x) / 2, half_y = (bounds.max_y - bounds.min_y) / 2;
  if (const Box* box = std::get_if<Box>(&part.shape); box != nullptr && std::abs(place.R[10]) > 1 - 1e-12) {
    const double along = dx * place.R[0] + dy * place.R[4];
    dy = dx * place.R[1] + dy * place.R[5];
    dx = along;
    half_x = box->size_m.x() / 2;
    half_y = box->size_m.y() / 2;
  }
  const double out_x = std::max(0.0, std::abs(dx) - half_x), out_y = std::max(0.0, std::abs(dy) - half_y);
  return out_x * out_x + out_y * out_y <= r * r;
}

Aabb2 Around(const Circle& c) {
  return {c.x - c.radius_m, c.y - c.radius_m, c.x + c.radius_m, c.y + c.radius_m};
}

}  // namespace

RobotSpace SpaceOf(const Owner& owner, const BodyState& body, double margin_m) {
  const std::array<double, 9>& R = body.R_WB;
  const Vector3& p = owner.p_BR;
  const Vector3 p_WR = body.p_WB + Vector3(R[0] * p.x() + R[1] * p.y() + R[2] * p.z(),
                                           R[3] * p.x() + R[4] * p.y() + R[5] * p.z(),
                                           R[6] * p.x() + R[7] * p.y() + R[8] * p.z());
  const double rise = R[6] * owner.up_B.x() + R[7] * owner.up_B.y() + R[8] * owner.up_B.z();
  if (rise > 0.9995) {
    const double lean_m = rise > 1 - kRestTilt_rad * kRestTilt_rad ? 1e-4 : kLean_m;
    return {{p_WR.x(), p_WR.y(), owner.radius_m + margin_m + lean_m},
            p_WR.z() - margin_m - lean_m,
            p_WR.z() + owner.height_m + margin_m + lean_m};
  }
  const double reach_m = owner.reach_m + margin_m;
  return {{p_WR.x(), p_WR.y(), reach_m}, p_WR.z() - reach_m, p_WR.z() + reach_m};
}

BroadPhase::BroadPhase(const OdeWorld& ode) {
  const auto fill = [&](std::size_t first, std::size_t end, Things& things) {
    things.boxes.resize(end - first);
    things.min_z.resize(end - first);
    things.max_z.resize(end - first);
    for (std::size_t i = first; i < end; ++i) Place(ode, i, things, i - first);
    things.grid.Build(things.boxes, kCell_m);
  };
  fill(0, static_cast<std::size_t>(ode.first_robot), objects_);
  fill(static_cast<std::size_t>(ode.first_static), ode.owners.size(), statics_);
  spaces_.resize(static_cast<std::size_t>(ode.first_static - ode.first_robot));
}

void BroadPhase::Place(const OdeWorld& ode, std::size_t owner, Things& things, std::size_t at) {
  const Part& part = ode.parts[static_cast<std::size_t>(ode.owners[owner].first_part)];
  const double* p = dGeomGetPosition(part.geom);
  const Vector3& half = part.half_m;
  things.boxes[at] = {p[0] - half.x(), p[1] - half.y(), p[0] + half.x(), p[1] + half.y()};
  things.min_z[at] = p[2] - half.z();
  things.max_z[at] = p[2] + half.z();
}

void BroadPhase::MoveObject(const OdeWorld& ode, std::size_t owner) {
  Place(ode, owner, objects_, owner);
  objects_moved_ = true;
}

void BroadPhase::FindThings(const OdeWorld& ode, std::size_t owner, const Things& things, std::size_t first,
                            std::vector<Pair>& pairs) const {
  const RobotSpace& space = spaces_[owner - static_cast<std::size_t>(ode.first_robot)];
  things.grid.VisitOverlaps(things.boxes, Around(space.circle), [&](std::uint32_t item) {
    if (things.min_z[item] > space.max_z || things.max_z[item] < space.min_z) return true;
    const Part& part = ode.parts[static_cast<std::size_t>(ode.owners[first + item].first_part)];
    if (!Reaches(space.circle, part, PlaceOfObject(part), things.boxes[item])) return true;
    const std::uint32_t a = static_cast<std::uint32_t>(owner), b = static_cast<std::uint32_t>(first + item);
    pairs.emplace_back(std::min(a, b), std::max(a, b));
    return true;
  });
}

void BroadPhase::FindObjects(const OdeWorld& ode, std::span<const std::uint8_t> moves) {
  if (objects_.boxes.empty()) return;
  if (objects_moved_) objects_.grid.Build(objects_.boxes, kCell_m);
  objects_moved_ = false;
  const std::size_t count = objects_.boxes.size(), end = moves.size();
  if (std::find(moves.begin(), moves.begin() + static_cast<std::ptrdiff_t>(count), 1) !=
      moves.begin() + static_cast<std::ptrdiff_t>(count)) {
    const std::size_t first = pairs_.size();
    objects_.grid.FindPairs(objects_.boxes, pairs_);
    std::erase_if(pairs_, [&](const Pair& pair) {
      const auto [a, b] = pair;
      if (b >= count || &pair < pairs_.data() + first) return false;
      return (!moves[a] && !moves[b]) || objects_.min_z[a] > objects_.max_z[b] ||
             objects_.min_z[b] > objects_.max_z[a];
    });
  }
  for (std::size_t owner = count; owner < end; ++owner) {
    const std::size_t first = pairs_.size();
    FindThings(ode, owner, objects_, 0, pairs_);
    if (moves[owner] || pairs_.size() == first) continue;
    pairs_.erase(std::remove_if(pairs_.begin() + static_cast<std::ptrdiff_t>(first), pairs_.end(),
                                [&](const Pair& pair) { return !moves[pair.first]; }),
                 pairs_.end());
  }
}

void BroadPhase::FindStatics(const OdeWorld& ode, std::span<const std::uint8_t> moves) {
  if (statics_.boxes.empty()) return;
  const std::size_t objects = objects_.boxes.size(), base = static_cast<std::size_t>(ode.first_static);
  for (std::size_t owner = 0; owner < moves.size(); ++owner) {
    if (!moves[owner]) continue;
    const std::size_t first = pairs_.size();
    if (owner >= objects) {
      FindThings(ode, owner, statics_, base, pairs_);
    } else {
      statics_.grid.VisitOverlaps(statics_.boxes, objects_.boxes[owner], [&](std::uint32_t item) {
        if (statics_.min_z[item] <= objects_.max_z[owner] && statics_.max_z[item] >= objects_.min_z[owner]) {
          pairs_.emplace_back(static_cast<std::uint32_t>(owner), static_cast<std::uint32_t>(base + item));
        }
        return true;
      });
    }
    std::sort(pairs_.begin() + static_cast<std::ptrdiff_t>(first), pairs_.end());
  }
}

const std::vector<BroadPhase::Pair>& BroadPhase::FindPairs(const OdeWorld& ode,
                                                           std::span<const std::uint8_t> moves) {
  pairs_.clear();
  FindObjects(ode, moves);
  circles_.resize(spaces_.size());
  for (std::size_t i = 0; i < spaces_.size(); ++i) circles_[i] = spaces_[i].circle;
  robots_.FindPairs(circles_, robot_pairs_);
  const std::uint32_t base = static_cast<std::uint32_t>(ode.first_robot);
  for (const auto& [a, b] : robot_pairs_) {
    if (!moves[base + a] && !moves[base + b]) continue;
    const RobotSpace &space_a = spaces_[a], &space_b = spaces_[b];
    if (space_a.min_z > space_b.max_z || space_b.min_z > space_a.max_z) continue;
    pairs_.emplace_back(base + a, base + b);
  }
  std::sort(pairs_.begin(), pairs_.end());
  FindStatics(ode, moves);
  return pairs_;
}

}  // namespace coopdyn
