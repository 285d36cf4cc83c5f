// SPDX-License-Identifier: MIT
// The contact joints of a lane.
#include <algorithm>
#include <cmath>

#include "server/physics/lane.h"

namespace coopdyn {

namespace {

// Nearer to the ground than this a wheel counts as touching it.
constexpr double kTouching_m = 1e-4;

void Copy(dVector3& to, const Vector3& from) {
  std::copy_n(from.data(), 3, to);
}

/// Velocity of the point `p` of a body.
Vector3 PointVelocity(const BodyState& body, const Vector3& p) {
  return body.v_WB + body.w_WB.cross(p - body.p_WB);
}

Vector3 PointVelocity(const Actor* actor, const Part* part, const Vector3& p) {
  if (actor == nullptr) return Vector3::Zero();
  return PointVelocity(actor->bodies[static_cast<std::size_t>(part->body)], p);
}

}  // namespace

dBodyID Lane::BodyOf(std::uint32_t thing, const Part& part) const {
  if (thing >= slot_of_.size() || slot_of_[thing] == nullptr) return nullptr;
  return slot_of_[thing]->bodies[static_cast<std::size_t>(part.body)];
}

void Lane::Attach(dContact& contact, const ContactPoint& point, dBodyID a, dBodyID b, double dt_s) {
  Copy(contact.geom.pos, point.p_W);
  Copy(contact.geom.normal, point.n_W);
  contact.geom.depth = std::max(0.0, point.depth_m);
  if (point.depth_m < 0) {
    // They may come as near as they are, and no nearer.
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = point.depth_m / dt_s;
  }
  dJointAttach(dJointCreateContact(world_.get(), contacts_.get(), &contact), a, b);
}

void Lane::JoinParts(const FoundContact& found, const Actor& actor_a, const Actor* actor_b, dBodyID a,
                     dBodyID b, bool flat, double dt_s) {
  const ContactPoint& point = found.point;
  dContact contact{};
  contact.surface.mu =
      std::min(found.a->friction, found.b == nullptr ? settings_.floor_friction : found.b->friction);
  if (contact.surface.mu > 0) {
    contact.surface.mode = dContactApprox1;
    // The friction pyramid lies along the slip, so that sliding bodies brake alike in every direction.
    const Vector3 slip = PointVelocity(a == nullptr ? nullptr : &actor_a, found.a, point.p_W) -
                         PointVelocity(b == nullptr ? nullptr : actor_b, found.b, point.p_W);
    const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
    constexpr double kSliding_m_s = 0.01;
    constexpr double kHorizontal = 0.1;
    if (flat && std::abs(point.n_W.z()) < kHorizontal) {
      contact.surface.mode |= dContactFDir1 | dContactMu2;
      contact.surface.mu2 = 0;
      Copy(contact.fdir1, Vector3::UnitZ().cross(point.n_W).normalized());
    } else if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
      contact.surface.mode |= dContactFDir1;
      Copy(contact.fdir1, along.normalized());
    }
  }
  Attach(contact, point, a, b, dt_s);
}

void Lane::JoinWheel(const FoundContact& found, const Actor& robot, std::uint32_t index, dBodyID body,
                     dBodyID other, int sign, double dt_s) {
  const Part& wheel = *(found.wheel == 0 ? found.a : found.b);
  const Part* ground = found.wheel == 0 ? found.b : found.a;
  const OneBodyDrive& drive = *robot.thing.mechanism->drive;
  const std::size_t side = static_cast<std::size_t>(wheel.wheel);
  ContactPoint point = found.point;
  point.n_W *= sign;  // towards the robot
  // The rolling direction at mid-step: the robot turns on while it rolls.
  const BodyState& state = robot.bodies[0];
  const double half_turn = state.w_WB.z() * dt_s / 2;
  const double c = std::cos(half_turn), s = std::sin(half_turn);
  const std::array<double, 9>& R = state.R_WB;
  const Vector3 axle(c * R[1] - s * R[4], s * R[1] + c * R[4], R[7]);
  dContact contact{};
  contact.surface.mode = dContactFDir1 | dContactMotion1 | dContactMu2;
  Copy(contact.fdir1, axle.cross(point.n_W).normalized());
  contact.surface.motion1 = drive.SpeedsOf(slot_of_[index]->channels)[side] * drive.wheels.radius_m;
  if (robot.thing.mechanism->planar()) {
    // It always stands as at rest. One wheel's row holds it sideways for both.
    contact.surface.mu = drive.drive_n[side];
    contact.surface.mu2 = side == 0 ? drive.sideways_n : 0;
  } else {
    const double friction =
        std::min(wheel.friction, ground == nullptr ? settings_.floor_friction : ground->friction);
    contact.surface.mode |= dContactApprox1_2;
    contact.surface.mu2 = friction;
    if (drive.stalls && point.depth_m > -kTouching_m) {
      contact.surface.mu = drive.drive_n[side];  // the motor's, whatever the load
    } else {
      contact.surface.mode |= dContactApprox1_1;
      contact.surface.mu = friction;
    }
  }
  Attach(contact, point, body, other, dt_s);
}

void Lane::Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
                std::uint32_t index_b, double dt_s) {
  const auto is_one = [](const Actor& actor) { return actor.thing.mechanism->one_body(); };
  // Robots side by side, or along a wall, do not lift each other: friction acts in the plane only. Else a
  // crowd would climb up on itself, by what is an artefact of stepping.
  const bool flat = b != nullptr && a.thing.robot >= 0 && (b->thing.robot >= 0 || b->thing.body_count() == 0);
  for (const FoundContact& contact : found) {
    dBodyID body_a = BodyOf(index_a, *contact.a);
    dBodyID body_b = b == nullptr ? nullptr : BodyOf(index_b, *contact.b);
    if (body_a == nullptr && body_b == nullptr) continue;
    const bool a_rolls = contact.wheel == 0 && is_one(a) && body_a != nullptr;
    const bool b_rolls = contact.wheel == 1 && is_one(*b) && body_b != nullptr;
    if (a_rolls && a.thing.mechanism->drive) {
      JoinWheel(contact, a, index_a, body_a, body_b, 1, dt_s);
    } else if (b_rolls && b->thing.mechanism->drive) {
      JoinWheel(contact, *b, index_b, body_b, body_a, -1, dt_s);
    } else {
      JoinParts(contact, a, b, body_a, body_b, flat, dt_s);
    }
  }
}

}  // namespace coopdyn
