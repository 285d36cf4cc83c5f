// SPDX-License-Identifier: MIT
#include "server/physics/surface.h"

#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

// A wheel nearer to the ground than this counts as touching it.
constexpr double kTouching_m = 1e-4;

void Copy(dVector3& to, const Vector3& from) {
  std::copy_n(from.data(), 3, to);
}

Vector3 PointVelocity(const ContactSide& of, const Part* part, const Vector3& p) {
  if (!of.moves) return Vector3::Zero();
  const BodyState& body = of.actor->bodies[static_cast<std::size_t>(part->body)];
  return body.v_WB + body.w_WB.cross(p - body.p_WB);
}

Vector3 TurnRate(const ContactSide& of, const Part* part) {
  if (!of.moves) return Vector3::Zero();
  return of.actor->bodies[static_cast<std::size_t>(part->body)].w_WB;
}

bool HasGrain(const Part* part) {
  return part != nullptr && !part->friction_along_G.isZero();
}

double FrictionOf(const Part* part, const WorldSettings& settings) {
  if (part == nullptr) return settings.floor_friction;
  return HasGrain(part) ? std::min(part->friction, part->friction_across) : part->friction;
}

double RestitutionOf(const Part* part) {
  return part == nullptr ? 0 : part->restitution;
}

/// A direction of a part's shape in the world.
Vector3 InWorld(const ContactSide& of, const Part& part, const Vector3& direction_G) {
  return of.actor->bodies[static_cast<std::size_t>(part.body)].orientation() * (part.R_BG * direction_G);
}

/// The direction of a part's grain in the world.
Vector3 GrainInWorld(const ContactSide& of, const Part& part) {
  if (part.friction_body < 0) return InWorld(of, part, part.friction_along_G);
  return of.actor->bodies[static_cast<std::size_t>(part.friction_body)].orientation() * part.friction_along_G;
}

bool IsOne(const ContactSide& of) {
  return of.actor != nullptr && of.actor->thing.mechanism->one_body();
}

/// Robots side by side, or along a wall, do not lift each other: friction acts in the horizontal plane only.
/// Otherwise a crowd would climb up on itself, an artefact of stepping.
bool IsFlat(const ContactSide& a, const ContactSide& b) {
  return b.actor != nullptr && a.actor->thing.robot >= 0 && !a.actor->thing.mechanism->is_loose() &&
         (b.actor->thing.robot >= 0 || b.actor->thing.body_count() == 0);
}

/// The slip of A on B that gravity adds in the step by pulling the one that moves, or the upper one if both
/// move.
Vector3 Pull(const ContactSide& a, const ContactSide& b, const Vector3& n_W, const WorldSettings& settings,
             double dt_s) {
  const double along_n = settings.g_W.dot(n_W);
  const Vector3 pull = dt_s * (settings.g_W - along_n * n_W);
  return a.moves && (!b.moves || along_n <= 0) ? pull : Vector3(-pull);
}

// A contact with less slip does not slip yet.
constexpr double kSliding_m_s = 0.01;
// A part that turns more slowly does not roll yet.
constexpr double kRolling_rad_s = 0.01;

/// Friction along the grain of a part, and across it. `along`: the slip, in the plane of contact.
void RubGrain(const Vector3& grain_W, double friction, double across, const Vector3& n_W,
              const Vector3& along, Surface& surface) {
  dContact& contact = surface.contact;
  const Vector3 in_plane = grain_W - grain_W.dot(n_W) * n_W;
  constexpr double kStraightUp = 1e-3;
  if (in_plane.norm() < kStraightUp) {
    contact.surface.mu = std::min(friction, across);
    return;
  }
  const Vector3 first = in_plane.normalized();
  contact.surface.mode |= dContactFDir1 | dContactMu2;
  Copy(contact.fdir1, first);
  contact.surface.mu = friction;
  contact.surface.mu2 = across;
  surface.grain = {friction, across};
  if (along.squaredNorm() <= kSliding_m_s * kSliding_m_s) return;
  const double u = friction * along.dot(first), w = across * along.dot(n_W.cross(first));
  const double length = std::sqrt(u * u + w * w);
  if (length == 0) return;
  contact.surface.mu *= std::abs(u) / length;
  contact.surface.mu2 *= std::abs(w) / length;
}

/// Friction against sliding.
void Rub(const FoundContact& found, const ContactSide& a, const ContactSide& b, const WorldSettings& settings,
         double dt_s, Surface& surface) {
  const ContactPoint& point = found.point;
  dContact& contact = surface.contact;
  contact.surface.mu = std::min(FrictionOf(found.a, settings), FrictionOf(found.b, settings));
  const Part* grained = HasGrain(found.a) ? found.a : HasGrain(found.b) ? found.b : nullptr;
  if (contact.surface.mu <= 0 && grained == nullptr) return;
  contact.surface.mode |= dContactApprox1;
  const Vector3 slip = PointVelocity(a, found.a, point.p_W) - PointVelocity(b, found.b, point.p_W);
  const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
  constexpr double kHorizontal = 0.1;
  if (IsFlat(a, b) && std::abs(point.n_W.z()) < kHorizontal) {
    contact.surface.mode |= dContactFDir1 | dContactMu2;
    contact.surface.mu2 = 0;
    Copy(contact.fdir1, Vector3::UnitZ().cross(point.n_W).normalized());
  } else if (grained != nullptr) {
    const bool is_a = grained == found.a;
    const double other = FrictionOf(is_a ? found.b : found.a, settings);
    RubGrain(GrainInWorld(is_a ? a : b, *grained), std::min(grained->friction, other),
             std::min(grained->friction_across, other), point.n_W, along, surface);
  } else if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
    surface.slip_m_s = along.norm();
    contact.surface.mode |= dContactFDir1;
    Copy(contact.fdir1, along.normalized());
  } else {
    surface.slip_m_s = along.norm();
    surface.may_turn = true;
    const Vector3 pull = Pull(a, b, point.n_W, settings, dt_s);
    constexpr double kFlat = 1e-3;  // of gravity
    if (pull.norm() <= kFlat * settings.g_W.norm() * dt_s) return;
    const Vector3 to_come = along + pull;
    if (to_come.squaredNorm() == 0) return;
    contact.surface.mode |= dContactFDir1;
    Copy(contact.fdir1, to_come.normalized());
  }
}

/// Whether a part can roll on this contact: not on the end of a cylinder, nor on a face.
bool IsRound(const ContactSide& of, const Part& part, const Vector3& n_W) {
  constexpr double kOnEnd = 0.99;
  if (std::holds_alternative<Cylinder>(part.shape))
    return std::abs(InWorld(of, part, Vector3::UnitZ()).dot(n_W)) < kOnEnd;
  return std::holds_alternative<Sphere>(part.shape) || std::holds_alternative<Capsule>(part.shape);
}

double RollingOf(const ContactSide& of, const Part* part, const Vector3& n_W) {
  const bool rolls = part != nullptr && part->rolling_friction_m > 0 && IsRound(of, *part, n_W);
  return rolls ? part->rolling_friction_m : 0;
}

double SpinningOf(const Part* part) {
  return part == nullptr ? 0 : part->spinning_friction_m;
}

/// Torques against rolling and spinning.
void HoldTurns(const FoundContact& found, const ContactSide& a, const ContactSide& b, Surface& surface) {
  const Vector3& n_W = found.point.n_W;
  dContact& contact = surface.contact;
  const double rolling = std::max(RollingOf(a, found.a, n_W), RollingOf(b, found.b, n_W));
  const double spinning = std::max(SpinningOf(found.a), SpinningOf(found.b));
  if (rolling <= 0 && spinning <= 0) return;
  if ((contact.surface.mode & dContactMu2) == 0) contact.surface.mu2 = contact.surface.mu;
  contact.surface.mode |= dContactRolling | dContactMu2 | dContactApprox1;
  contact.surface.rho = contact.surface.rho2 = rolling;
  contact.surface.rhoN = spinning;
  if (!surface.may_turn) return;
  // The first axis lies along the rolling direction, as it otherwise does along a slip.
  const Vector3 turns = TurnRate(a, found.a) - TurnRate(b, found.b);
  const Vector3 way = turns.cross(n_W);
  if (way.squaredNorm() <= kRolling_rad_s * kRolling_rad_s) return;
  contact.surface.mode |= dContactFDir1;
  Copy(contact.fdir1, way.normalized());
}

void Place(const ContactPoint& point, double dt_s, dContact& contact) {
  Copy(contact.geom.pos, point.p_W);
  Copy(contact.geom.normal, point.n_W);
  contact.geom.depth = std::max(0.0, point.depth_m);
  if (point.depth_m < 0) {
    // The two may close the gap in this substep, but not overlap.
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = point.depth_m / dt_s;
  }
}

Surface Rolling(const FoundContact& found, const ContactSide& robot, int sign, const WorldSettings& settings,
                double dt_s) {
  const Part& wheel = *(found.wheel == 0 ? found.a : found.b);
  const Part* ground = found.wheel == 0 ? found.b : found.a;
  const OneBodyDrive& drive = *robot.actor->thing.mechanism->drive;
  const std::size_t side = static_cast<std::size_t>(wheel.wheel);
  ContactPoint point = found.point;
  point.n_W *= sign;  // towards the robot
  // The rolling direction at mid-step: the robot turns while it rolls.
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
    // A planar robot always stands as at rest. One wheel's row holds it sideways for both wheels.
    contact.surface.mu = drive.drive_n[side];
    contact.surface.mu2 = side == 0 ? drive.sideways_n : 0;
  } else {
    const double friction = std::min(wheel.friction, FrictionOf(ground, settings));
    contact.surface.mode |= dContactApprox1_2;
    contact.surface.mu2 = friction;
    if (drive.stalls && point.depth_m > -kTouching_m) {
      contact.surface.mu = drive.drive_n[side];  // the motor's limit, at any load
    } else {
      contact.surface.mode |= dContactApprox1_1;
      contact.surface.mu = friction;
    }
  }
  Place(point, dt_s, contact);
  return surface;
}

/// The restitution for the solver that gives a bounce the height that belongs to `restitution`. The contact
/// is found at some depth, so the thing is already faster than when it touched, and gravity acts in the rest
/// of the step.
double BounceOf(double restitution, const FoundContact& found, const ContactSide& a, const ContactSide& b,
                const WorldSettings& settings, double dt_s) {
  const ContactPoint& point = found.point;
  const Vector3 slip = PointVelocity(a, found.a, point.p_W) - PointVelocity(b, found.b, point.p_W);
  const double speed_m_s = -slip.dot(point.n_W);
  // Robots that ODE moves fall with errors that make up for this.
  const auto falls_exactly = [](const ContactSide& of) {
    const Mechanism& mechanism = *of.actor->thing.mechanism;
    return mechanism.is_loose() || mechanism.has_limbs();
  };
  if (speed_m_s <= 0 || !falls_exactly(a.moves ? a : b)) return restitution;
  const double pull_m_s2 = -settings.g_W.dot(point.n_W) * ((a.moves ? 1 : 0) - (b.moves ? 1 : 0));
  const double fallen_m2_s2 = 2 * pull_m_s2 * point.depth_m;
  const double touched_m2_s2 = std::max(0.0, speed_m_s * speed_m_s - fallen_m2_s2);
  const double leaves_m_s =
      std::sqrt(std::max(0.0, restitution * restitution * touched_m2_s2 + fallen_m2_s2)) - pull_m_s2 * dt_s;
  return std::max(0.0, leaves_m_s) / speed_m_s;
}

/// 1 / stiffness of a part, m/N; 0: it is hard.
double ComplianceOf(const ContactSide& of, const Part* part) {
  const bool yields = part != nullptr && of.actor->thing.mechanism->is_soft();
  return yields ? 1 / part->contact_stiffness_n_m : 0;
}

double DampingOf(const ContactSide& of, const Part* part) {
  return ComplianceOf(of, part) > 0 ? part->contact_damping_n_s_m : 0;
}

/// The springs of both are in series; their dampers add up, as in Gazebo. ODE's manual has the ERP and CFM of
/// a spring with a damper, which make the step implicit.
void Yield(const FoundContact& found, const ContactSide& a, const ContactSide& b, double dt_s,
           dContact& contact) {
  const double compliance_m_n = ComplianceOf(a, found.a) + ComplianceOf(b, found.b);
  if (compliance_m_n <= 0) return;
  const double spring = dt_s / compliance_m_n;
  const double resistance = spring + DampingOf(a, found.a) + DampingOf(b, found.b);
  if (resistance * kCfm >= 1) return;  // as hard as any other contact
  contact.surface.mode |= dContactSoftERP | dContactSoftCFM;
  contact.surface.soft_erp = spring / resistance;
  contact.surface.soft_cfm = 1 / resistance;
}

}  // namespace

int RowsOf(const FoundContact& found) {
  const auto slips = [](const Part* part) {
    return part != nullptr && part->friction <= 0 && !(HasGrain(part) && part->friction_across > 0);
  };
  const auto rolls = [](const Part* part) { return part != nullptr && part->rolling_friction_m > 0; };
  int rows = slips(found.a) || slips(found.b) ? 1 : 3;
  if (rolls(found.a) || rolls(found.b)) rows += 2;
  if (SpinningOf(found.a) > 0 || SpinningOf(found.b) > 0) rows += 1;
  return rows;
}

std::optional<Surface> SurfaceOf(const FoundContact& found, const ContactSide& a, const ContactSide& b,
                                 const WorldSettings& settings, double dt_s) {
  const bool a_rolls = found.wheel == 0 && a.moves && IsOne(a);
  const bool b_rolls = found.wheel == 1 && b.moves && IsOne(b);
  if (a_rolls && a.actor->thing.mechanism->drive) return Rolling(found, a, 1, settings, dt_s);
  if (b_rolls && b.actor->thing.mechanism->drive) return Rolling(found, b, -1, settings, dt_s);
  const ContactPoint& point = found.point;
  const double restitution = std::max(RestitutionOf(found.a), RestitutionOf(found.b));
  if (restitution > 0 && point.depth_m < 0) return std::nullopt;  // it bounces only when it touches
  Surface surface;
  dContact& contact = surface.contact;
  Rub(found, a, b, settings, dt_s, surface);
  HoldTurns(found, a, b, surface);
  Yield(found, a, b, dt_s, contact);
  if (restitution > 0) {
    // No bounce below the speed that gravity adds in two steps.
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = BounceOf(restitution, found, a, b, settings, dt_s);
    contact.surface.bounce_vel = 2 * settings.g_W.norm() * dt_s;
  }
  Place(point, dt_s, contact);
  return surface;
}

}  // namespace coopdyn
