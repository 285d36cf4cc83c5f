// SPDX-License-Identifier: MIT
#include "server/sensing/robot_hull.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

constexpr double kPad_m = Extent::kPad_m;
constexpr double kParallel = 1e-9;
// Factor by which a slight tilt widens a robot.
constexpr double kLean = 1.02;
// How far a wheel may wobble in its joint.
constexpr double kWobble_m = 0.02;

const JointModel* JointOf(const RobotModel& model, int link) {
  const auto found = std::find_if(model.joints.begin(), model.joints.end(), [link](const JointModel& joint) {
    return joint.child == link && joint.joins();
  });
  return found == model.joints.end() ? nullptr : &*found;
}

const BodyState& BodyOfLink(const Frame& frame, const SceneRobot& robot, int link) {
  return frame.bodies[static_cast<std::size_t>(robot.first_body) + static_cast<std::size_t>(link)];
}

double Across(const Vector3& v) {
  return std::sqrt(v.x() * v.x() + v.y() * v.y());
}

bool MayMeet(const Ray& ray, const Vector3& center, double radius_m, double nearest_m) {
  const Vector3 to_center = center - ray.origin;
  const double along = to_center.dot(ray.direction);
  if (along < -radius_m || along - radius_m > nearest_m) return false;
  return to_center.squaredNorm() - along * along <= radius_m * radius_m + kPad_m;
}

}  // namespace

RobotHull::RobotHull(const RobotModel& model) {
  std::vector<Extent> extents;  // of parts_
  for (std::size_t link = 0; link < model.links.size(); ++link) {
    for (const LinkShape& collision : model.links[link].collisions) {
      const Part part = MakePart(model, static_cast<int>(link), collision);
      const auto* cylinder = std::get_if<Cylinder>(&part.shape);
      const Vector3 axis_R = part.X_RG.q * Vector3::UnitZ();
      if (!trunk_ && link == 0 && cylinder != nullptr && Across(axis_R) < 1e-15) {
        const double half_m = cylinder->length_m / 2;
        trunk_ = Trunk{*cylinder, part.X_RG.p, part.X_RG.p.head<2>().isZero(0), part.X_RG.p.z() - half_m,
                       part.X_RG.p.z() + half_m};
        chassis_.Include(Across(part.X_RG.p) + cylinder->radius_m, trunk_->min_z, trunk_->max_z);
        continue;
      }
      const Extent extent = ExtentOf(model, part);
      extents.push_back(extent);
      (link == 0 ? chassis_ : all_).Include(extent.radius_m, extent.min_z, extent.max_z);
      parts_.push_back(part);
    }
  }
  if (!chassis_.empty()) all_.Include(chassis_.radius_m, chassis_.min_z, chassis_.max_z);
  all_hidden_ = trunk_.has_value();
  for (std::size_t i = 0; trunk_ && i < parts_.size(); ++i) {
    parts_[i].hidden = extents[i].radius_m < trunk_->shape.radius_m - Across(trunk_->p_RG);
    all_hidden_ = all_hidden_ && parts_[i].hidden;
  }
  if (!all_.empty()) {
    whole_radius_m_ = portable::Hypot(all_.radius_m, std::max(std::abs(all_.min_z), std::abs(all_.max_z)));
  }
  upright_radius_m_ = all_.radius_m;
  for (const Part& part : parts_) {
    if (part.link > 0) {
      upright_radius_m_ = std::max(upright_radius_m_, Across(part.p_RC) + part.body_radius_m);
    }
    whole_radius_m_ = std::max(whole_radius_m_, part.p_RC.norm() + 2 * part.body_radius_m);
  }
  upright_radius_m_ *= kLean;
  whole_radius_m_ += kWobble_m;
}

RobotHull::Part RobotHull::MakePart(const RobotModel& model, int link, const LinkShape& collision) {
  const LinkModel& link_model = model.links[static_cast<std::size_t>(link)];
  const Pose X_RG = link_model.X_RL * collision.X_LG;
  Part part;
  part.shape = collision.shape;
  part.link = link;
  part.X_LG = collision.X_LG;
  part.X_RG = X_RG;
  part.p_RC = X_RG.p;
  part.radius_m = BoundingRadius(collision.shape) + kPad_m;
  part.body_radius_m = part.radius_m + (collision.X_LG.p - link_model.X_LI.p).norm();
  if (const JointModel* joint = JointOf(model, link); link > 0 && joint != nullptr) {
    // The part turns about the joint's axis, and so does its centre unless it lies on the axis.
    const Vector3 axis_R = joint->axis_R.normalized();
    part.p_RC = joint->p_RJ + axis_R * axis_R.dot(part.X_RG.p - joint->p_RJ);
    part.radius_m += (part.X_RG.p - part.p_RC).norm();
  }
  return part;
}

Extent RobotHull::ExtentOf(const RobotModel& model, const Part& part) {
  Extent extent;
  const Vector3 axis_R = part.X_RG.q * Vector3::UnitZ();
  const auto* cylinder = std::get_if<Cylinder>(&part.shape);
  const JointModel* joint = JointOf(model, part.link);
  const bool is_wheel = joint != nullptr && cylinder != nullptr && std::abs(axis_R.z()) < kParallel &&
                        (part.X_RG.p - part.p_RC).norm() < kParallel &&
                        axis_R.cross(joint->axis_R.normalized()).norm() < kParallel;
  if (is_wheel) {
    // Turning does not change it: a disc on edge.
    const double along = std::abs(axis_R.dot(part.X_RG.p)) + cylinder->length_m / 2;
    const double ahead = std::abs(axis_R.cross(Vector3::UnitZ()).dot(part.X_RG.p)) + cylinder->radius_m;
    extent.Include(portable::Hypot(along, ahead) + kPad_m, part.X_RG.p.z() - cylinder->radius_m - kPad_m,
                   part.X_RG.p.z() + cylinder->radius_m + kPad_m);
  } else {
    extent.Include(Across(part.p_RC) + part.radius_m, part.p_RC.z() - part.radius_m,
                   part.p_RC.z() + part.radius_m);
  }
  return extent;
}

Extent RobotHull::Bounds(const Frame& frame, int robot, const Pose& X_WR) const {
  const SceneRobot& scene_robot = frame.scene->robots[static_cast<std::size_t>(robot)];
  const Tilt tilt(X_WR.q);
  if (all_.empty()) return {};
  if (scene_robot.one_body()) return all_.Upright(X_WR.p.z(), tilt);
  Extent bounds = chassis_.empty() ? Extent{} : chassis_.Upright(X_WR.p.z(), tilt);
  for (const Part& part : parts_) {
    if (part.link == 0) continue;
    const Vector3& p_WB = BodyOfLink(frame, scene_robot, part.link).p_WB;
    bounds.Include(Across(p_WB - X_WR.p) + part.body_radius_m, p_WB.z() - part.body_radius_m,
                   p_WB.z() + part.body_radius_m);
  }
  return bounds;
}

void RobotHull::Cast(const Frame& frame, int robot, const Pose& X_WR, const Ray& ray_W, double& nearest_m,
                     int ignored_link) const {
  bool between_ends = false;
  if (trunk_ && ignored_link != 0) {
    const Quaternion& q = X_WR.q;
    const Vector3 axis_W(2 * (q.x() * q.z() + q.w() * q.y()), 2 * (q.y() * q.z() - q.w() * q.x()),
                         1 - 2 * (q.x() * q.x() + q.y() * q.y()));
    Vector3 to_origin = ray_W.origin - X_WR.p;
    const double start_z = axis_W.dot(to_origin);
    const double d_z = axis_W.dot(ray_W.direction);
    const double end_z = start_z + nearest_m * d_z;
    const double low = std::min(start_z, end_z), high = std::max(start_z, end_z);
    between_ends = low >= trunk_->min_z && high <= trunk_->max_z;
    if (high >= trunk_->min_z && low <= trunk_->max_z) {
      if (!trunk_->central) to_origin -= q * Vector3(trunk_->p_RG.x(), trunk_->p_RG.y(), 0);
      to_origin -= trunk_->p_RG.z() * axis_W;
      nearest_m = std::min(nearest_m, RayToCylinder({to_origin, ray_W.direction}, trunk_->shape, axis_W));
    }
  }
  if (between_ends && all_hidden_ && frame.scene->robots[static_cast<std::size_t>(robot)].one_body()) {
    return;
  }
  CastParts(frame, robot, X_WR, ray_W, between_ends, ignored_link, nearest_m);
}

void RobotHull::CastParts(const Frame& frame, int robot, const Pose& X_WR, const Ray& ray_W,
                          bool between_ends, int ignored_link, double& nearest_m) const {
  const SceneRobot& scene_robot = frame.scene->robots[static_cast<std::size_t>(robot)];
  const bool rigid = scene_robot.one_body();
  for (const Part& part : parts_) {
    const bool in_place = rigid || part.link == 0;
    if ((part.hidden && between_ends && in_place) || part.link == ignored_link) continue;
    const Vector3 center_W = in_place ? X_WR * part.p_RC : BodyOfLink(frame, scene_robot, part.link).p_WB;
    if (!MayMeet(ray_W, center_W, in_place ? part.radius_m : part.body_radius_m, nearest_m)) continue;
    const Pose X_WG = PlaceOf(frame, robot, X_WR, part);
    const Matrix3 R_GW = X_WG.q.toRotationMatrix().transpose();
    const Ray ray_G{R_GW * (ray_W.origin - X_WG.p), R_GW * ray_W.direction};
    nearest_m = std::min(nearest_m, RayToShape(ray_G, part.shape));
  }
}

}  // namespace coopdyn
