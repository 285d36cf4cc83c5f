// SPDX-License-Identifier: MIT
#include "server/physics/one_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {

// What is this near the floor when the robot stands on it carries it.
constexpr double kSupportGap_m = 2e-4;
// Of the acceleration at which a wheel or caster lifts.
constexpr double kTipShare = 0.8;

Pose PlaceInR(const LinkModel& link, const LinkShape& collision) {
  return link.X_RL * collision.X_LG;
}

/// Where the robot stands on the floor, from its centre of mass.
struct Support {
  double x = 0, y = 0;
  int side = -1;  // of a wheel
};

/// How far the hull of `supports` reaches from the centre of mass along (dx, dy); 0 if it is not within.
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

void AddLinks(OneBody& body) {
  const RobotModel& model = *body.model;
  body.p_RB = CenterOfMass(model);
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    const LinkModel& link = model.links[k];
    const Pose X_RI = link.X_RL * link.X_LI;
    const Matrix3 R = X_RI.q.toRotationMatrix();
    const Vector3 d = X_RI.p - body.p_RB;
    body.mass_kg += link.mass_kg;
    body.inertia_kg_m2 += R * link.inertia_kg_m2.asDiagonal() * R.transpose() +
                          link.mass_kg * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
    for (const LinkShape& collision : link.collisions) {
      const Pose X_RG = PlaceInR(link, collision);
      Part part{collision.shape};
      part.friction = collision.friction;
      part.side = WheelSide(model, static_cast<int>(k), collision);
      part.is_wheel = part.side >= 0;
      part.p_BG = X_RG.p - body.p_RB;
      part.R_BG = X_RG.q.toRotationMatrix();
      part.half_m = Vector3::Constant(BoundingRadius(collision.shape));
      body.parts.push_back(part);
    }
  }
  body.inertia_kg_m2 = (body.inertia_kg_m2 + body.inertia_kg_m2.transpose().eval()) / 2;
}

/// Radius about R's z axis of the vertical cylinder that holds a part.
double RadiusOf(const OneBody& body, const Part& part) {
  const double x = body.p_RB.x() + part.p_BG.x(), y = body.p_RB.y() + part.p_BG.y();
  const Vector3 half = HalfExtents(part.shape, part.R_BG);
  if (!std::holds_alternative<Box>(part.shape) && std::abs(part.R_BG(2, 2)) > 1 - 1e-9) {
    return std::hypot(x, y) + half.x();
  }
  if (std::holds_alternative<Sphere>(part.shape)) return std::hypot(x, y) + half.x();
  return std::hypot(std::abs(x) + half.x(), std::abs(y) + half.y());
}

void Measure(OneBody& body) {
  for (const Part& part : body.parts) {
    const Vector3 p_RG = body.p_RB + part.p_BG;
    body.radius_m = std::max(body.radius_m, RadiusOf(body, part));
    body.reach_m = std::max(body.reach_m, p_RG.norm() + BoundingRadius(part.shape));
    body.height_m = std::max(body.height_m, p_RG.z() + HalfExtents(part.shape, part.R_BG).z());
  }
  for (std::size_t i = 0; i < body.parts.size(); ++i) {
    const Part& part = body.parts[i];
    const Vector3 p_RG = body.p_RB + part.p_BG;
    const auto* cylinder = std::get_if<Cylinder>(&part.shape);
    if (cylinder == nullptr || part.R_BG(2, 2) < 1 - 1e-9) continue;
    if (std::hypot(p_RG.x(), p_RG.y()) > 1e-9 || cylinder->radius_m < body.radius_m - 1e-9) continue;
    body.shell = static_cast<int>(i);
  }
}

void SetDrive(OneBody& body, double floor_friction, double gravity_m_s2) {
  std::string why;
  const auto wheels = FindWheels(*body.model, why);
  if (!wheels) return;
  body.has_wheels = true;
  body.wheels = *wheels;
  std::vector<Support> supports;
  for (const Part& part : body.parts) {
    const double lowest_m = body.p_RB.z() + part.p_BG.z() - HalfExtents(part.shape, part.R_BG).z();
    if (std::abs(lowest_m) <= kSupportGap_m) supports.push_back({part.p_BG.x(), part.p_BG.y(), part.side});
  }
  const double weight_n = body.mass_kg * gravity_m_s2;
  constexpr std::array<std::array<double, 2>, 4> kWays{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  body.stands = std::all_of(kWays.begin(), kWays.end(),
                            [&](const auto& way) { return Reach(supports, way[0], way[1]) > 1e-3; });
  body.load_n = {weight_n / 2, weight_n / 2};
  if (body.stands) {
    const std::vector<double> loads = Loads(supports, weight_n);
    for (std::size_t i = 0; i < supports.size(); ++i) {
      if (supports[i].side >= 0) body.load_n[static_cast<std::size_t>(supports[i].side)] = loads[i];
    }
  }
  body.stalls = true;
  for (std::size_t side = 0; side < 2; ++side) {
    const double grip_n = std::min(wheels->friction[side], floor_friction) * body.load_n[side];
    const double motor_n = body.model->drive.max_torque_nm / wheels->radius_m;
    body.drive_n[side] = std::min(grip_n, motor_n);
    body.stalls = body.stalls && motor_n < grip_n;
    body.sideways_n += grip_n;
  }
  body.yaw_inertia_kg_m2 = body.inertia_kg_m2(2, 2) + body.mass_kg * body.p_RB.head<2>().squaredNorm();
  const double rise_m = std::max(1e-6, body.p_RB.z());
  body.max_across_m_s2 = body.sideways_n / body.mass_kg;
  body.max_along_m_s2 = 1e9;
  if (body.planar) return;  // cannot tip
  const double tip = kTipShare * gravity_m_s2 / rise_m;
  body.max_along_m_s2 = tip * std::min(Reach(supports, 1, 0), Reach(supports, -1, 0));
  body.max_across_m_s2 =
      std::min(body.max_across_m_s2, tip * std::min(Reach(supports, 0, 1), Reach(supports, 0, -1)));
}

}  // namespace

int WheelSide(const RobotModel& model, int link, const LinkShape& collision) {
  if (!std::holds_alternative<Cylinder>(collision.shape)) return -1;
  for (int side = 0; side < 2; ++side) {
    const int driven = side == 0 ? model.drive.left_joint : model.drive.right_joint;
    if (driven < 0 || static_cast<std::size_t>(driven) >= model.joints.size()) continue;
    const JointModel& joint = model.joints[static_cast<std::size_t>(driven)];
    if (joint.child != link) continue;
    const Quaternion q_RG = model.links[static_cast<std::size_t>(link)].X_RL.q * collision.X_LG.q;
    if (std::abs((q_RG * Vector3::UnitZ()).dot(joint.axis_R.normalized())) > 0.999) return side;
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
      const int side = WheelSide(model, static_cast<int>(k), collision);
      if (side < 0) continue;
      const std::size_t s = static_cast<std::size_t>(side);
      const JointModel& joint =
          model
              .joints[static_cast<std::size_t>(side == 0 ? model.drive.left_joint : model.drive.right_joint)];
      const Pose X_RG = PlaceInR(model.links[k], collision);
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
    why = "its wheels must be equal and as far from the middle on either side";
    return std::nullopt;
  }
  pair.radius_m = (radius_m[0] + radius_m[1]) / 2;
  pair.half_track_m = (y_m[0] - y_m[1]) / 2;
  return pair;
}

OneBody MakeOneBody(const RobotModel& model, bool planar, double floor_friction, double gravity_m_s2) {
  OneBody body;
  body.model = &model;
  body.planar = planar;
  AddLinks(body);
  Measure(body);
  SetDrive(body, floor_friction, gravity_m_s2);
  return body;
}

}  // namespace coopdyn
