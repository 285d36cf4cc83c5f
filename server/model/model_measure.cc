// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"
#include "server/model/sdf_body.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The largest horizontal distance of a shape's points from R's z axis.
double Reach(const Shape& shape, const Pose& X_RG) {
  const double centre = X_RG.p.head<2>().norm();
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return centre + sphere->radius_m;
  double reach = 0;
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                         (corner & 4) != 0 ? 0.5 : -0.5);
      reach = std::max(reach, (X_RG * box->size_m.cwiseProduct(sign)).head<2>().norm());
    }
    return reach;
  }
  if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    for (const Vector3& v : mesh->data->vertices) reach = std::max(reach, (X_RG * v).head<2>().norm());
    return reach;
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    for (const double end : {-0.5, 0.5}) {
      const Vector3 p(0, 0, end * capsule->length_m);
      reach = std::max(reach, (X_RG * p).head<2>().norm() + capsule->radius_m);
    }
    return reach;
  }
  const auto& cylinder = std::get<Cylinder>(shape);
  const Matrix3 R = X_RG.q.toRotationMatrix();
  if (std::abs(R(2, 2)) > 1 - 1e-9) return centre + cylinder.radius_m;
  // Sample the rims: the error is 0.1 mm at 1 m.
  constexpr int kPoints = 360;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPoints;
    for (const double end : {-0.5, 0.5}) {
      const Vector3 p(cylinder.radius_m * portable::Cos(angle), cylinder.radius_m * portable::Sin(angle),
                      end * cylinder.length_m);
      reach = std::max(reach, (X_RG * p).head<2>().norm());
    }
  }
  return reach;
}

/// The lowest and highest z of a shape in R.
std::pair<double, double> HeightsOf(const Shape& shape, const Pose& X_RG) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    double low = JointModel::kInfinity, high = -low;
    for (const Vector3& v : mesh->data->vertices) {
      const double z = (X_RG * v).z();
      low = std::min(low, z);
      high = std::max(high, z);
    }
    return {low, high};
  }
  const double half_m = HalfExtents(shape, X_RG.q).z();
  return {X_RG.p.z() - half_m, X_RG.p.z() + half_m};
}

/// The shapes that determine a robot's size.
const std::vector<LinkShape>& Body(const LinkModel& link, bool has_collisions) {
  return has_collisions ? link.collisions : link.visuals;
}

bool Collides(const RobotModel& robot) {
  return std::ranges::any_of(robot.links, [](const LinkModel& link) { return !link.collisions.empty(); });
}

/// Lifts a model onto the floor.
void Lift(ModelReading& reading, double low_m) {
  RobotModel& robot = reading.robot;
  for (LinkModel& link : robot.links) link.X_RL.p.z() -= low_m;
  for (JointModel& joint : robot.joints) joint.p_RJ.z() -= low_m;
  for (FrameModel& frame : robot.frames) frame.X_RF.p.z() -= low_m;
  robot.p_MR.z() += low_m;
  if (low_m < -1e-3) {
    reading.Mended(1, "the model reaches " + FormatNumber(std::round(-low_m * 1e4) / 1e4) +
                          " m below its origin: it stands that much higher, on the floor");
  }
}

void RefuseBelowFloor(ModelReading& reading) {
  for (const LinkModel& link : reading.robot.links) {
    for (const LinkShape& shape : link.collisions) {
      const double low = HeightsOf(shape.shape, link.X_RL * shape.X_LG).first;
      if (low >= -1e-6) continue;
      reading.Error(0, "a collision of link '" + link.name + "' reaches " +
                           FormatNumber(std::round(-low * 1e6) * 1e-3) + " mm below the floor z = 0");
    }
  }
}

}  // namespace

void MeasureModel(ModelReading& reading) {
  RobotModel& robot = reading.robot;
  const bool collides = Collides(robot);
  if (!collides && !reading.source.foreign) return reading.Error(0, "the robot has no <collision>");
  if (!collides) {
    const std::string text = "no shape of the robot collides with anything: write a <collision>";
    if (robot.fixed_base) {
      reading.diagnostics.Note({reading.file, 1}, text);
    } else {
      reading.Warn(1, text + ", or it falls through the floor");
    }
  }
  const ModelSource& source = reading.source;
  if (source.foreign ? !source.in_world : source.lifts && !robot.fixed_base) {
    if (const double low_m = LowestOf(robot, Pose()); low_m < 0) Lift(reading, low_m);
  } else if (!source.foreign && !robot.fixed_base) {
    RefuseBelowFloor(reading);
  }
  for (const LinkModel& link : robot.links) {
    for (const LinkShape& shape : Body(link, collides)) {
      const Pose X_RG = link.X_RL * shape.X_LG;
      robot.height_m = std::max(robot.height_m, HeightsOf(shape.shape, X_RG).second);
      robot.footprint_radius_m = std::max(robot.footprint_radius_m, Reach(shape.shape, X_RG));
    }
  }
  if (robot.footprint_radius_m <= 0) {
    robot.footprint_radius_m = 0.1;
    robot.height_m = std::max(robot.height_m, 0.1);
  }
}

double LowestOf(const RobotModel& robot, const Pose& X_WR) {
  const bool collides = Collides(robot);
  double low_m = JointModel::kInfinity;
  for (const LinkModel& link : robot.links) {
    if (robot.fixed_base && &link == robot.links.data()) continue;
    for (const LinkShape& shape : Body(link, collides))
      low_m = std::min(low_m, HeightsOf(shape.shape, X_WR * link.X_RL * shape.X_LG).first);
  }
  return low_m;
}

}  // namespace coopdyn
