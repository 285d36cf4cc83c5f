// SPDX-License-Identifier: MIT
#include "server/physics/drive_motion.h"

#include <algorithm>
#include <cmath>

#include "server/physics/freeze.h"

namespace coopdyn {

namespace {

/// Cosine and sine of an upright body's heading.
struct Heading2 {
  double c = 1, s = 0;
};

Heading2 HeadingOf(const std::array<double, 4>& q) {
  const double ww = q[0] * q[0], zz = q[3] * q[3];
  const double norm = 1 / (ww + zz);
  return {(ww - zz) * norm, 2 * q[0] * q[3] * norm};
}

/// Changes of the treads' speeds in `dt_s` if no wheel pushes more than its limit: the wheel that cannot
/// follow pushes with all it has, the other follows as it can.
std::array<double, 2> LimitedChange(const OneBodyDrive& drive, const std::array<double, 2>& wanted_m_s,
                                    double dt_s) {
  const double b = drive.wheels.half_track_m;
  const double straight = dt_s / drive.mass_kg, turning = dt_s * b * b / drive.yaw_inertia_kg_m2;
  const double own = straight + turning, other = straight - turning;
  std::array<double, 2> push_n{};
  constexpr int kRounds = 8;  // the error shrinks at least by the square of other / own in each
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t side = 0; side < 2; ++side) {
      const double needed_n = (wanted_m_s[side] - other * push_n[1 - side]) / own;
      push_n[side] = std::clamp(needed_n, -drive.drive_n[side], drive.drive_n[side]);
    }
  }
  return {own * push_n[0] + other * push_n[1], own * push_n[1] + other * push_n[0]};
}

}  // namespace

bool StandsUpright(const BodyState& body, double rest_z_m) {
  // Written so that nan is not upright.
  return std::abs(body.q_WB[1]) <= kRestTilt_rad / 2 && std::abs(body.q_WB[2]) <= kRestTilt_rad / 2 &&
         std::abs(body.p_WB.z() - rest_z_m) <= kRestHeight_m && std::abs(body.v_WB.z()) <= kRestSink_m_s &&
         std::abs(body.w_WB.x()) <= kRestTurn_rad_s && std::abs(body.w_WB.y()) <= kRestTurn_rad_s;
}

DrivePlan PlanDrive(const OneBodyDrive& drive, const BodyState& body, double rest_z_m,
                    const std::array<double, 2>& setpoint_rad_s, double dt_s) {
  DrivePlan plan;
  const double r = drive.wheels.radius_m, b = drive.wheels.half_track_m;
  plan.wheels_rad_s = setpoint_rad_s;
  plan.forward_m_s = r * (setpoint_rad_s[0] + setpoint_rad_s[1]) / 2;
  plan.turn_rad_s = r * (setpoint_rad_s[1] - setpoint_rad_s[0]) / (2 * b);
  if (!drive.stands || !StandsUpright(body, rest_z_m)) return plan;

  const Heading2 heading = HeadingOf(body.q_WB);
  const double turn = body.w_WB.z();
  // Of R's origin, along and across the heading.
  const double along = body.v_WB.x() * heading.c + body.v_WB.y() * heading.s + turn * drive.p_RB.y();
  const double across = body.v_WB.y() * heading.c - body.v_WB.x() * heading.s - turn * drive.p_RB.x();
  if (!(std::abs(across) <= drive.max_across_m_s2 * dt_s)) return plan;
  if (!(along * along + turn * turn * b * b < kMaxSpeed_m_s * kMaxSpeed_m_s)) return plan;

  const double faster = plan.forward_m_s - along, turns_more = plan.turn_rad_s - turn;
  if (faster != 0 || turns_more != 0) {
    const double straight_n = drive.mass_kg * faster / (2 * dt_s);
    const double turning_n = drive.yaw_inertia_kg_m2 * turns_more / (2 * b * dt_s);
    if (std::abs(straight_n - turning_n) > drive.drive_n[0] ||
        std::abs(straight_n + turning_n) > drive.drive_n[1]) {
      const auto change = LimitedChange(drive, {faster - b * turns_more, faster + b * turns_more}, dt_s);
      plan.forward_m_s = along + (change[0] + change[1]) / 2;
      plan.turn_rad_s = turn + (change[1] - change[0]) / (2 * b);
      if (drive.stalls) {
        plan.wheels_rad_s = {(plan.forward_m_s - b * plan.turn_rad_s) / r,
                             (plan.forward_m_s + b * plan.turn_rad_s) / r};
      }
    }
    if (std::abs(plan.forward_m_s - along) > drive.max_along_m_s2 * dt_s) return plan;
  }
  plan.closed = std::abs(plan.forward_m_s * plan.turn_rad_s) <= drive.max_across_m_s2;
  return plan;
}

void Advance(const OneBodyDrive& drive, const DrivePlan& plan, double rest_z_m, double dt_s,
             BodyState& body) {
  const double half_turn = plan.turn_rad_s * dt_s / 2;
  const double s = std::sin(half_turn), c = std::cos(half_turn);
  const double chord_m = plan.forward_m_s * dt_s * (half_turn != 0 ? s / half_turn : 1);
  const Heading2 before = HeadingOf(body.q_WB);
  const Vector3& p_RB = drive.p_RB;
  double x = body.p_WB.x() - (before.c * p_RB.x() - before.s * p_RB.y());
  double y = body.p_WB.y() - (before.s * p_RB.x() + before.c * p_RB.y());
  x += chord_m * (before.c * c - before.s * s);
  y += chord_m * (before.s * c + before.c * s);
  const double w = body.q_WB[0] * c - body.q_WB[3] * s, z = body.q_WB[3] * c + body.q_WB[0] * s;
  const double norm = 1 / std::sqrt(w * w + z * z);
  body.q_WB = {w * norm, 0, 0, z * norm};
  const Heading2 after = HeadingOf(body.q_WB);
  const double arm_x = after.c * p_RB.x() - after.s * p_RB.y();
  const double arm_y = after.s * p_RB.x() + after.c * p_RB.y();
  body.p_WB = {x + arm_x, y + arm_y, rest_z_m};
  body.R_WB = {after.c, -after.s, 0, after.s, after.c, 0, 0, 0, 1};
  body.v_WB = {plan.forward_m_s * after.c - plan.turn_rad_s * arm_y,
               plan.forward_m_s * after.s + plan.turn_rad_s * arm_x, 0};
  body.w_WB = {0, 0, plan.turn_rad_s};
}

}  // namespace coopdyn
