// SPDX-License-Identifier: MIT
#include "server/physics/wheel_drive.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/base/portable_math.h"
#include "server/physics/rest.h"
#include "server/physics/things.h"

namespace coopdyn {

namespace {

// Share of the acceleration at which a wheel or caster lifts.
constexpr double kTipShare = 0.8;

/// A point on which the robot stands, relative to its centre of mass.
struct Support {
  double x = 0, y = 0;
  int wheel = -1;
};

/// How far the hull of `supports` reaches from the centre of mass along (dx, dy); 0 if the centre is outside.
double Reach(const std::vector<Support>& supports, double dx, double dy) {
  double reach = 0;
  for (const Support& a : supports) {
    for (const Support& b : supports) {
      // Where the ray meets the segment from a to b.
      const double across_a = dx * a.y - dy * a.x, across_b = dx * b.y - dy * b.x;
      if (across_a > 0 || across_b < 0) continue;
      const double span = across_b - across_a;
      const double share = span > 0 ? -across_a / span : 0;
      const double along = dx * (a.x + share * (b.x - a.x)) + dy * (a.y + share * (b.y - a.y));
      reach = std::max(reach, along);
    }
  }
  return reach;
}

/// The loads of equally springy supports under a weight.
std::vector<double> Loads(const std::vector<Support>& supports, double weight_n) {
  Matrix3 sums = Matrix3::Identity() * 1e-12;
  for (const Support& s : supports) {
    const Vector3 row(1, s.x, s.y);
    sums += row * row.transpose();
  }
  const Vector3 k = sums.ldlt().solve(Vector3(weight_n, 0, 0));
  std::vector<double> loads;
  for (const Support& s : supports) loads.push_back(std::max(0.0, k.x() + k.y() * s.x + k.z() * s.y));
  return loads;
}

/// Cosine and sine of an upright body's heading.
struct Heading2 {
  double c = 1, s = 0;
};

Heading2 HeadingOf(const std::array<double, 4>& q) {
  const double ww = q[0] * q[0], zz = q[3] * q[3];
  const double norm = 1 / (ww + zz);
  return {(ww - zz) * norm, 2 * q[0] * q[3] * norm};
}

/// Changes of the treads' speeds in `dt_s` if no wheel pushes more than its limit: a wheel that cannot follow
/// pushes with its greatest force, and the other follows as far as it can.
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

int WheelOf(const RobotModel& model, int link, const LinkShape& collision) {
  const ActuatorModel* drive = model.drive_actuator();
  if (drive == nullptr || !std::holds_alternative<Cylinder>(collision.shape)) return -1;
  for (std::size_t wheel = 0; wheel < drive->joints.size(); ++wheel) {
    const JointModel& joint = model.joints[static_cast<std::size_t>(drive->joints[wheel])];
    if (joint.child != link) continue;
    const Quaternion q_RG = model.links[static_cast<std::size_t>(link)].X_RL.q * collision.X_LG.q;
    if (std::abs((q_RG * Vector3::UnitZ()).dot(joint.axis_R.normalized())) > 0.999)
      return static_cast<int>(wheel);
  }
  return -1;
}

std::optional<WheelPair> FindWheels(const RobotModel& model, std::string& why) {
  constexpr double kTolerance_m = 1e-4;
  WheelPair pair;
  std::array<double, 2> y_m{}, radius_m{};
  std::array<int, 2> found{};
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    for (const LinkShape& collision : model.links[k].collisions) {
      const int side = WheelOf(model, static_cast<int>(k), collision);
      if (side < 0) continue;
      const std::size_t s = static_cast<std::size_t>(side);
      const JointModel& joint = model.joints[static_cast<std::size_t>(model.drive_actuator()->joints[s])];
      const Pose X_RG = model.links[k].X_RL * collision.X_LG;
      y_m[s] = X_RG.p.y();
      radius_m[s] = std::get<Cylinder>(collision.shape).radius_m;
      pair.friction[s] = collision.friction;
      ++found[s];
      if (joint.axis_R.normalized().y() < 0.9999 || std::abs(X_RG.p.x()) > kTolerance_m ||
          std::abs(X_RG.p.z() - radius_m[s]) > kTolerance_m) {
        why = "its wheels must stand on the y axis and turn about it";
        return std::nullopt;
      }
    }
  }
  if (found[0] != 1 || found[1] != 1) {
    why = "each of its two wheels must be one cylinder about its axle";
    return std::nullopt;
  }
  if (std::abs(radius_m[0] - radius_m[1]) > kTolerance_m || std::abs(y_m[0] + y_m[1]) > kTolerance_m ||
      y_m[0] <= 0) {
    why = "its wheels must be equal and equally far from the middle";
    return std::nullopt;
  }
  pair.radius_m = (radius_m[0] + radius_m[1]) / 2;
  pair.half_track_m = (y_m[0] - y_m[1]) / 2;
  return pair;
}

OneBodyDrive MakeDrive(const Mechanism& robot, const WheelPair& wheels, double floor_friction,
                       const Vector3& g_W) {
  const RigidBody& body = robot.bodies.front();
  const Vector3& p_RB = body.X_RB.p;
  OneBodyDrive drive;
  drive.wheels = wheels;
  drive.first_channel = robot.model->FirstChannel(*robot.model->drive_actuator());
  drive.mass_kg = body.mass_kg;
  drive.p_RB = p_RB;
  std::vector<Support> supports;
  for (const Part& part : robot.parts) {
    const double lowest_m = p_RB.z() + part.p_BG.z() - HalfExtents(part.shape, part.R_BG).z();
    if (std::abs(lowest_m) <= kSupportGap_m) supports.push_back({part.p_BG.x(), part.p_BG.y(), part.wheel});
  }
  const double weight_n = std::max(0.0, -body.mass_kg * g_W.z());
  const bool is_level = g_W.x() == 0 && g_W.y() == 0;  // else it is like a slope
  constexpr std::array<std::array<double, 2>, 4> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  drive.stands = is_level && weight_n > 0 && std::all_of(kWays.begin(), kWays.end(), [&](const auto& way) {
                   return Reach(supports, way[0], way[1]) > 1e-3;
                 });
  std::array<double, 2> load_n = {weight_n / 2, weight_n / 2};  // of each wheel at rest
  if (drive.stands) {
    const std::vector<double> loads = Loads(supports, weight_n);
    for (std::size_t i = 0; i < supports.size(); ++i) {
      if (supports[i].wheel >= 0) load_n[static_cast<std::size_t>(supports[i].wheel)] = loads[i];
    }
  }
  drive.stalls = true;
  for (std::size_t side = 0; side < 2; ++side) {
    const double grip_n = std::min(wheels.friction[side], floor_friction) * load_n[side];
    const double motor_n = robot.model->drive()->max_torque_nm / wheels.radius_m;
    drive.drive_n[side] = std::min(grip_n, motor_n);
    drive.stalls = drive.stalls && motor_n < grip_n;
    drive.sideways_n += grip_n;
  }
  drive.yaw_inertia_kg_m2 = body.inertia_kg_m2(2, 2) + body.mass_kg * p_RB.head<2>().squaredNorm();
  drive.max_across_m_s2 = drive.sideways_n / body.mass_kg;
  drive.max_along_m_s2 = 1e9;
  if (robot.planar()) {
    drive.stands = is_level;  // cannot tip
    return drive;
  }
  const double tip = kTipShare * -g_W.z() / std::max(1e-6, p_RB.z());
  drive.max_along_m_s2 = tip * std::min(Reach(supports, 1, 0), Reach(supports, -1, 0));
  drive.max_across_m_s2 =
      std::min(drive.max_across_m_s2, tip * std::min(Reach(supports, 0, 1), Reach(supports, 0, -1)));
  return drive;
}

DrivePlan PlanDrive(const OneBodyDrive& drive, const BodyState& body, double rest_z_m,
                    const WheelSpeeds& setpoint_rad_s, double dt_s) {
  DrivePlan plan;
  const double r = drive.wheels.radius_m, b = drive.wheels.half_track_m;
  plan.wheels_rad_s = setpoint_rad_s;
  plan.forward_m_s = r * (setpoint_rad_s[0] + setpoint_rad_s[1]) / 2;
  plan.turn_rad_s = r * (setpoint_rad_s[1] - setpoint_rad_s[0]) / (2 * b);
  if (!drive.stands || !StandsUpright(body, rest_z_m)) return plan;

  const Heading2 heading = HeadingOf(body.q_WB);
  const double turn = body.w_WB.z();
  // Velocity of R's origin, along and across the heading.
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

WheelSpeeds WheelRates(const OneBodyDrive& drive, const BodyState& body, const WheelSpeeds& setpoint_rad_s) {
  if (!drive.stalls) return setpoint_rad_s;
  // The wheels grip: they turn as the floor passes under them.
  WheelSpeeds turned_rad_s{};
  const Vector3 ahead(body.R_WB[0], body.R_WB[3], body.R_WB[6]);
  for (std::size_t side = 0; side < 2; ++side) {
    const double b = side == 0 ? drive.wheels.half_track_m : -drive.wheels.half_track_m;
    const Vector3 arm = body.orientation() * (Vector3(0, b, 0) - drive.p_RB);
    turned_rad_s[side] = (body.v_WB + body.w_WB.cross(arm)).dot(ahead) / drive.wheels.radius_m;
  }
  return turned_rad_s;
}

void Advance(const OneBodyDrive& drive, const DrivePlan& plan, double rest_z_m, double dt_s,
             BodyState& body) {
  const double half_turn = plan.turn_rad_s * dt_s / 2;
  const auto [s, c] = portable::SinCos(half_turn);
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
