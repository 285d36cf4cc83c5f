// SPDX-License-Identifier: MIT
#include "server/physics/surface.h"

#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

// Nearer to the ground than this a wheel counts as touching it.
constexpr double kTouching_m = 1e-4;

void Copy(dVector3& to, const Vector3& from) {
  std::copy_n(from.data(), 3, to);
}

Vector3 PointVelocity(const Toucher& of, const Part* part, const Vector3& p) {
  if (!of.moves) return Vector3::Zero();
  const BodyState& body = of.actor->bodies[static_cast<std::size_t>(part->body)];
  return body.v_WB + body.w_WB.cross(p - body.p_WB);
}

double FrictionOf(const Part* part, const WorldSettings& settings) {
  return part == nullptr ? settings.floor_friction : part->friction;
}

bool IsOne(const Toucher& of) {
  return of.actor != nullptr && of.actor->thing.mechanism->one_body();
}

/// Robots side by side, or along a wall, do not lift each other: friction acts in the plane only. Else a
/// crowd would climb up on itself, by what is an artefact of stepping.
bool IsFlat(const Toucher& a, const Toucher& b) {
  return b.actor != nullptr && a.actor->thing.robot >= 0 &&
         (b.actor->thing.robot >= 0 || b.actor->thing.body_count() == 0);
}

void Place(const ContactPoint& point, double dt_s, dContact& contact) {
  Copy(contact.geom.pos, point.p_W);
  Copy(contact.geom.normal, point.n_W);
  contact.geom.depth = std::max(0.0, point.depth_m);
  if (point.depth_m < 0) {
    // They may come as near as they are, and no nearer.
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = point.depth_m / dt_s;
  }
}

Surface Rolling(const FoundContact& found, const Toucher& robot, int sign, const WorldSettings& settings,
                double dt_s) {
  const Part& wheel = *(found.wheel == 0 ? found.a : found.b);
  const Part* ground = found.wheel == 0 ? found.b : found.a;
  const OneBodyDrive& drive = *robot.actor->thing.mechanism->drive;
  const std::size_t side = static_cast<std::size_t>(wheel.wheel);
  ContactPoint point = found.point;
  point.n_W *= sign;  // towards the robot
  // The rolling direction at mid-step: the robot turns on while it rolls.
  const BodyState& state = robot.actor->bodies[0];
  const double half_turn = state.w_WB.z() * dt_s / 2;
  const auto [s, c] = portable::SinCos(half_turn);
  const std::array<double, 9>& R = state.R_WB;
  const Vector3 axle(c * R[1] - s * R[4], s * R[1] + c * R[4], R[7]);
  Surface surface;
  surface.swapped = sign < 0;
  dContact& contact = surface.contact;
  contact.surface.mode = dContactFDir1 | dContactMotion1 | dContactMu2;
  Copy(contact.fdir1, axle.cross(point.n_W).normalized());
  contact.surface.motion1 = drive.SpeedsOf(robot.channels)[side] * drive.wheels.radius_m;
  if (robot.actor->thing.mechanism->planar()) {
    // It always stands as at rest. One wheel's row holds it sideways for both.
    contact.surface.mu = drive.drive_n[side];
    contact.surface.mu2 = side == 0 ? drive.sideways_n : 0;
  } else {
    const double friction = std::min(wheel.friction, FrictionOf(ground, settings));
    contact.surface.mode |= dContactApprox1_2;
    contact.surface.mu2 = friction;
    if (drive.stalls && point.depth_m > -kTouching_m) {
      contact.surface.mu = drive.drive_n[side];  // the motor's, whatever the load
    } else {
      contact.surface.mode |= dContactApprox1_1;
      contact.surface.mu = friction;
    }
  }
  Place(point, dt_s, contact);
  return surface;
}

}  // namespace

std::optional<Surface> SurfaceOf(const FoundContact& found, const Toucher& a, const Toucher& b,
                                 const WorldSettings& settings, double dt_s) {
  const bool a_rolls = found.wheel == 0 && a.moves && IsOne(a);
  const bool b_rolls = found.wheel == 1 && b.moves && IsOne(b);
  if (a_rolls && a.actor->thing.mechanism->drive) return Rolling(found, a, 1, settings, dt_s);
  if (b_rolls && b.actor->thing.mechanism->drive) return Rolling(found, b, -1, settings, dt_s);
  const ContactPoint& point = found.point;
  const double restitution = std::max(found.a->restitution, found.b == nullptr ? 0 : found.b->restitution);
  if (restitution > 0 && point.depth_m < 0) return std::nullopt;  // it turns round where it touches
  Surface surface;
  dContact& contact = surface.contact;
  contact.surface.mu = std::min(found.a->friction, FrictionOf(found.b, settings));
  if (contact.surface.mu > 0) {
    contact.surface.mode = dContactApprox1;
    // The friction pyramid lies along the slip, so that sliding bodies brake alike in every direction.
    const Vector3 slip = PointVelocity(a, found.a, point.p_W) - PointVelocity(b, found.b, point.p_W);
    const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
    constexpr double kSliding_m_s = 0.01;
    constexpr double kHorizontal = 0.1;
    if (IsFlat(a, b) && std::abs(point.n_W.z()) < kHorizontal) {
      contact.surface.mode |= dContactFDir1 | dContactMu2;
      contact.surface.mu2 = 0;
      Copy(contact.fdir1, Vector3::UnitZ().cross(point.n_W).normalized());
    } else if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
      contact.surface.mode |= dContactFDir1;
      Copy(contact.fdir1, along.normalized());
    }
  }
  if (restitution > 0) {
    // Slower than gravity makes it in two steps, it stays.
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = restitution;
    contact.surface.bounce_vel = 2 * settings.gravity_m_s2 * dt_s;
  }
  Place(point, dt_s, contact);
  return surface;
}

}  // namespace coopdyn
