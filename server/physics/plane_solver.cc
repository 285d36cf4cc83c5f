// SPDX-License-Identifier: MIT
#include "server/physics/plane_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/portable_math.h"
#include "server/physics/rest.h"
#include "server/physics/surface.h"

namespace coopdyn {

namespace {

// Rates have converged when they change by less than this in a round.
constexpr double kFound_m_s = 1e-6;
constexpr double kNear_m_s = 0.01;
constexpr int kMostRounds = 100;

bool IsPlain(const Part& part) {
  return part.restitution <= 0 && part.friction_along_G.isZero() && part.rolling_friction_m <= 0 &&
         part.spinning_friction_m <= 0;
}

}  // namespace

bool PlaneSolver::Takes(std::span<const FoundContact> found) {
  constexpr double kLevel = 1e-3;
  return std::ranges::all_of(found, [](const FoundContact& contact) {
    return std::abs(contact.point.n_W.z()) < kLevel && contact.wheel < 0 && IsPlain(*contact.a) &&
           IsPlain(*contact.b);
  });
}

void PlaneSolver::Begin() {
  robots_.clear();
  contacts_.clear();
}

std::uint32_t PlaneSolver::Add(const Actor& actor, std::span<const ChannelState> channels, double dt_s) {
  const BodyState& body = actor.bodies[0];
  const Mechanism& mechanism = *actor.thing.mechanism;
  const OneBodyDrive& drive = *mechanism.drive;
  Robot robot;
  robot.x = body.v_WB.x();
  robot.y = body.v_WB.y();
  robot.turn = body.w_WB.z();
  robot.per_mass = 1 / drive.mass_kg;
  robot.per_yaw = 1 / mechanism.bodies.front().inertia_kg_m2(2, 2);
  robot.p_x_m = body.p_WB.x();
  robot.p_y_m = body.p_WB.y();
  robot.rest_z_m = actor.thing.rest_z_m;
  // The heading at mid-step: the robot turns while it rolls.
  const auto [s, c] = portable::SinCos(robot.turn * dt_s / 2);
  robot.c = body.R_WB[0] * c - body.R_WB[3] * s;
  robot.s = body.R_WB[3] * c + body.R_WB[0] * s;
  const WheelSpeeds speeds_rad_s = drive.SpeedsOf(channels);
  const double b = drive.wheels.half_track_m;
  const double arms_m[] = {drive.p_RB.y() - b, drive.p_RB.y() + b, -drive.p_RB.x()};
  for (std::size_t row = 0; row < 3; ++row) {
    robot.arm_m[row] = arms_m[row];
    robot.mass_kg[row] = 1 / (robot.per_mass + robot.per_yaw * arms_m[row] * arms_m[row]);
    robot.wanted_m_s[row] = row < 2 ? speeds_rad_s[row] * drive.wheels.radius_m : 0;
    robot.most_ns[row] = (row < 2 ? drive.drive_n[row] : drive.sideways_n) * dt_s;
  }
  robots_.push_back(robot);
  return static_cast<std::uint32_t>(robots_.size() - 1);
}

void PlaneSolver::Join(std::span<const FoundContact> found, std::uint32_t a, std::uint32_t b, double dt_s) {
  const bool is_swapped = a == kStatic;
  if (is_swapped) std::swap(a, b);
  const Robot& robot_a = robots_[a];
  const Robot& robot_b = b == kStatic ? still_ : robots_[b];
  for (const FoundContact& one : found) {
    const ContactPoint& point = one.point;
    const double length =
        (is_swapped ? -1 : 1) * std::sqrt(point.n_W.x() * point.n_W.x() + point.n_W.y() * point.n_W.y());
    Contact contact;
    contact.a = a;
    contact.b = b;
    contact.n_x = point.n_W.x() / length;
    contact.n_y = point.n_W.y() / length;
    const double ax = point.p_W.x() - robot_a.p_x_m, ay = point.p_W.y() - robot_a.p_y_m;
    const double bx = point.p_W.x() - robot_b.p_x_m, by = point.p_W.y() - robot_b.p_y_m;
    contact.arm_an = ax * contact.n_y - ay * contact.n_x;
    contact.arm_at = ax * contact.n_x + ay * contact.n_y;
    contact.arm_bn = bx * contact.n_y - by * contact.n_x;
    contact.arm_bt = bx * contact.n_x + by * contact.n_y;
    const double per_mass = robot_a.per_mass + robot_b.per_mass;
    contact.mass_n_kg = 1 / (per_mass + robot_a.per_yaw * contact.arm_an * contact.arm_an +
                             robot_b.per_yaw * contact.arm_bn * contact.arm_bn);
    contact.mass_t_kg = 1 / (per_mass + robot_a.per_yaw * contact.arm_at * contact.arm_at +
                             robot_b.per_yaw * contact.arm_bt * contact.arm_bt);
    // The two may close their gap in the substep.
    contact.least_m_s =
        point.depth_m < 0 ? point.depth_m / dt_s : std::min(kErp * point.depth_m / dt_s, kMaxPushOut_m_s);
    contact.friction = std::min(one.a->friction, one.b->friction);
    contacts_.push_back(contact);
  }
}

double PlaneSolver::SolveWheels(Robot& robot) {
  double along = robot.x * robot.c + robot.y * robot.s;
  double across = robot.y * robot.c - robot.x * robot.s;
  double most = 0;
  for (int row = 0; row < 3; ++row) {
    double& way = row < 2 ? along : across;
    const double missing_m_s = robot.wanted_m_s[row] - way - robot.arm_m[row] * robot.turn;
    const double push_ns = std::clamp(robot.push_ns[row] + robot.mass_kg[row] * missing_m_s,
                                      -robot.most_ns[row], robot.most_ns[row]);
    const double more_ns = push_ns - robot.push_ns[row];
    robot.push_ns[row] = push_ns;
    way += more_ns * robot.per_mass;
    robot.turn += more_ns * robot.arm_m[row] * robot.per_yaw;
    most = std::max(most, std::abs(more_ns) * robot.per_mass);
  }
  robot.x = along * robot.c - across * robot.s;
  robot.y = along * robot.s + across * robot.c;
  return most;
}

double PlaneSolver::SolveContact(Contact& contact) {
  Robot& a = robots_[contact.a];
  Robot& b = contact.b == kStatic ? still_ : robots_[contact.b];
  const double n_x = contact.n_x, n_y = contact.n_y;
  const double near_m_s =
      n_x * (a.x - b.x) + n_y * (a.y - b.y) + contact.arm_an * a.turn - contact.arm_bn * b.turn;
  const double push_ns = std::max(0.0, contact.push_ns + contact.mass_n_kg * (contact.least_m_s - near_m_s));
  const double more_ns = push_ns - contact.push_ns;
  contact.push_ns = push_ns;
  a.x += more_ns * n_x * a.per_mass;
  a.y += more_ns * n_y * a.per_mass;
  a.turn += more_ns * contact.arm_an * a.per_yaw;
  b.x -= more_ns * n_x * b.per_mass;
  b.y -= more_ns * n_y * b.per_mass;
  b.turn -= more_ns * contact.arm_bn * b.per_yaw;
  const double slip_m_s =
      -n_y * (a.x - b.x) + n_x * (a.y - b.y) + contact.arm_at * a.turn - contact.arm_bt * b.turn;
  const double most_ns = contact.friction * push_ns;
  const double rub_ns = std::clamp(contact.rub_ns - contact.mass_t_kg * slip_m_s, -most_ns, most_ns);
  const double rubs_more_ns = rub_ns - contact.rub_ns;
  contact.rub_ns = rub_ns;
  a.x -= rubs_more_ns * n_y * a.per_mass;
  a.y += rubs_more_ns * n_x * a.per_mass;
  a.turn += rubs_more_ns * contact.arm_at * a.per_yaw;
  b.x += rubs_more_ns * n_y * b.per_mass;
  b.y -= rubs_more_ns * n_x * b.per_mass;
  b.turn -= rubs_more_ns * contact.arm_bt * b.per_yaw;
  return (std::abs(more_ns) + std::abs(rubs_more_ns)) * a.per_mass;
}

PlaneSolver::Outcome PlaneSolver::Step() {
  double most = 1;
  for (int round = 0; round < kMostRounds && most > kFound_m_s; ++round) {
    most = 0;
    for (Robot& robot : robots_) most = std::max(most, SolveWheels(robot));
    for (Contact& contact : contacts_) most = std::max(most, SolveContact(contact));
  }
  // Written so that nan is not sane.
  const bool is_sane = std::ranges::all_of(robots_, [](const Robot& robot) {
    return robot.x * robot.x + robot.y * robot.y < kMaxSpeed_m_s * kMaxSpeed_m_s &&
           std::abs(robot.turn) < kMaxTurnRate_rad_s;
  });
  if (!is_sane) return Outcome::kInsane;
  return most < kNear_m_s ? Outcome::kSolved : Outcome::kNear;
}

void PlaneSolver::Move(std::uint32_t number, double dt_s, BodyState& body) const {
  const Robot& robot = robots_[number];
  const auto [s, c] = portable::SinCos(robot.turn * dt_s / 2);
  double w = body.q_WB[0] * c - body.q_WB[3] * s, z = body.q_WB[3] * c + body.q_WB[0] * s;
  const double norm = 1 / std::sqrt(w * w + z * z);
  w *= norm;
  z *= norm;
  const double cosine = w * w - z * z, sine = 2 * w * z;
  body.q_WB = {w, 0, 0, z};
  body.R_WB = {cosine, -sine, 0, sine, cosine, 0, 0, 0, 1};
  body.p_WB = {robot.p_x_m + robot.x * dt_s, robot.p_y_m + robot.y * dt_s, robot.rest_z_m};
  body.v_WB = {robot.x, robot.y, 0};
  body.w_WB = {0, 0, robot.turn};
}

}  // namespace coopdyn
