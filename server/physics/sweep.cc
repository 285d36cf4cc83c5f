// SPDX-License-Identifier: MIT
#include "server/physics/sweep.h"

#include <algorithm>
#include <cmath>

#include "server/geometry/mesh.h"

namespace coopdyn {

namespace {

// Shares of the half size: an object that moves by more than kFast is fast; a contact deeper than kDeep is
// more than a touch; what is deeper still may go kDeeper in a substep, less than contacts push it out.
constexpr double kFast = 0.5, kDeep = 0.1, kDeeper = 0.01;
// What yields is pressed in deeper than a touch. Here it has no room left.
constexpr double kDeepest = 0.9;
// Share of its rates that what turns on into something keeps in a substep, at least.
constexpr double kKeeps = 0.5;
// Deep enough for Collide() to find contacts.
constexpr double kTouch_m = 1e-5;
constexpr int kMostLooks = 2000, kBisections = 30;

/// Radius of a sphere that fits into the shape.
double HalfSizeOf(const Shape& shape) {
  struct Visitor {
    double operator()(const Box& box) const { return box.size_m.minCoeff() / 2; }
    double operator()(const Cylinder& cylinder) const {
      return std::min(cylinder.radius_m, cylinder.length_m / 2);
    }
    double operator()(const Sphere& sphere) const { return sphere.radius_m; }
    double operator()(const Capsule& capsule) const { return capsule.radius_m; }
    double operator()(const Mesh& mesh) const { return mesh.data->radius_m / 8; }
  };
  return std::visit(Visitor(), shape);
}

/// Whether it is one shape without a drive: an object, or a robot of one link.
bool IsLoose(const Thing& thing) {
  return thing.body_count() == 1 && !thing.mechanism->drive && thing.mechanism->parts.size() == 1;
}

const Part& PartOf(const Thing& thing) {
  return thing.mechanism->parts.front();
}

/// Half the size of a box around the body's place that contains it.
Vector3 ReachOf(const Thing& thing, const BodyState& body) {
  const PlacedPart placed(PartOf(thing), body);
  return (Vector3(placed.p) - body.p_WB).cwiseAbs() + placed.half_m;
}

/// Interpolates from `before` to `after`.
BodyState Between(const BodyState& before, const BodyState& after, double share) {
  BodyState body = after;
  body.p_WB = before.p_WB + share * (after.p_WB - before.p_WB);
  body.v_WB = before.v_WB + share * (after.v_WB - before.v_WB);
  body.w_WB = before.w_WB + share * (after.w_WB - before.w_WB);
  const Quaternion from = before.orientation();
  Quaternion to = after.orientation();
  if (from.dot(to) < 0) to.coeffs() *= -1;
  Orient(body,
         Quaternion(Eigen::Vector4d(from.coeffs() + share * (to.coeffs() - from.coeffs()))).normalized());
  return body;
}

}  // namespace

void Sweep::Begin(const Things& things, std::span<const std::uint32_t> active,
                  std::span<const BodyState> bodies, double dt_s) {
  fast_.clear();
  for (const std::uint32_t thing : active) {
    const Thing& info = things.all[thing];
    if (!IsLoose(info)) continue;
    const BodyState& body = bodies[static_cast<std::size_t>(info.first_body)];
    const double half_size_m = HalfSizeOf(PartOf(info).shape);
    const double way_m = dt_s * body.v_WB.norm();
    if (way_m > kFast * half_size_m) fast_.push_back({thing, half_size_m, body, body});
  }
}

void Sweep::End(const Things& things, BroadPhase& broad_phase, Collider& collider,
                std::span<BodyState> bodies) {
  if (fast_.empty()) return;
  const auto body_of = [&](std::uint32_t thing) -> BodyState& {
    return bodies[static_cast<std::size_t>(things.all[thing].first_body)];
  };
  for (Fast& one : fast_) one.after = body_of(one.thing);
  for (Fast& one : fast_) {
    if (one.after.frozen()) continue;
    const Vector3 reach = ReachOf(things.all[one.thing], one.after) + Vector3::Constant(one.half_size_m);
    near_.clear();
    broad_phase.FindIn(one.before.p_WB.cwiseMin(one.after.p_WB) - reach,
                       one.before.p_WB.cwiseMax(one.after.p_WB) + reach, near_);
    EndAt(things, one, nullptr, nullptr, collider);
    for (const std::uint32_t thing : near_) {
      if (std::ranges::binary_search(fast_, thing, {}, &Fast::thing)) continue;
      const Actor other = things.ActorOf(thing, bodies);
      EndAt(things, one, &other, nullptr, collider);
    }
  }
  for (std::size_t i = 0; i < fast_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Fast &a = fast_[i], &b = fast_[j];
      const Vector3 apart_m = a.before.p_WB - b.before.p_WB;
      const double ways_m = (a.after.p_WB - a.before.p_WB).norm() + (b.after.p_WB - b.before.p_WB).norm();
      const auto radius_m = [&](const Fast& of) { return ReachOf(things.all[of.thing], of.before).norm(); };
      if (apart_m.norm() > ways_m + radius_m(a) + radius_m(b)) continue;
      const Actor other = things.ActorOf(b.thing, bodies);
      EndAt(things, a, &other, &b, collider);
    }
  }
  for (const Fast& one : fast_) {
    if (one.end >= 1) continue;
    BodyState& body = body_of(one.thing);
    body = Between(one.before, one.after, one.end);
    if (one.touched) {
      // Its contacts did not stop it: it turns on into what it touches, where it hits again, or a weak spring
      // holds it. Unless it lost speed, it could gain some forever without moving.
      const double keeps = one.yields ? one.end : std::max(one.end, kKeeps);
      body.v_WB = keeps * one.after.v_WB;
      body.w_WB = keeps * one.after.w_WB;
    }
    if (one.thing < things.first_robot) broad_phase.MoveObject(one.thing, body);
  }
}

void Sweep::EndAt(const Things& things, Fast& a, const Actor* other, Fast* moving, Collider& collider) {
  BodyState place, other_place;
  const Actor actor{things.all[a.thing], &place};
  /// Depth of the deepest contact at `share` of the way, m; -1 without contacts.
  const auto depth_m = [&](double share) {
    place = Between(a.before, a.after, share);
    found_.clear();
    if (other == nullptr) {
      FindFloorContacts(collider, actor, 0, found_);
    } else if (moving != nullptr) {
      other_place = Between(moving->before, moving->after, share);
      FindContacts(collider, actor, {other->thing, &other_place}, 0, found_);
    } else {
      FindContacts(collider, actor, *other, 0, found_);
    }
    double deepest_m = -1;
    for (const FoundContact& contact : found_) deepest_m = std::max(deepest_m, contact.point.depth_m);
    return deepest_m;
  };
  Vector3 way_m = a.after.p_WB - a.before.p_WB;
  if (moving != nullptr) way_m -= moving->after.p_WB - moving->before.p_WB;
  const double step_m =
      kFast * std::min(a.half_size_m, moving != nullptr ? moving->half_size_m : a.half_size_m);
  const int looks = static_cast<int>(std::clamp(std::ceil(way_m.norm() / step_m), 1.0, 1.0 * kMostLooks));
  const double start_m = depth_m(0);
  const bool touches = start_m > kTouch_m;
  const bool yields =
      things.all[a.thing].mechanism->is_soft() || (other != nullptr && other->thing.mechanism->is_soft());
  const double deep_m =
      std::max((yields ? kDeepest : kDeep) * a.half_size_m, start_m + kDeeper * a.half_size_m);
  // What touches goes on until it is deeper than it may be: if it stopped at once, it would hang in the air.
  const double end_m = touches ? deep_m : kTouch_m;
  for (int i = 1; i <= looks; ++i) {
    if (!(depth_m(1.0 * i / looks) > deep_m)) continue;
    double free = 0, touching = 1.0 * i / looks;
    if (depth_m(1.0 * (i - 1) / looks) <= end_m) free = 1.0 * (i - 1) / looks;
    for (int k = 0; k < kBisections; ++k) {
      const double middle = (free + touching) / 2;
      (depth_m(middle) > end_m ? touching : free) = middle;
    }
    for (Fast* one : {&a, moving}) {
      if (one == nullptr || touching >= one->end) continue;
      one->end = touching;
      one->touched = touches;
      one->yields = yields;
    }
    return;
  }
}

}  // namespace coopdyn
