// SPDX-License-Identifier: MIT
// What rays meet of a robot: the collision shapes of its links, and bounds around them that decide about most
// rays. Made once per robot type. Constant once made; any thread.
#pragma once

#include <optional>
#include <vector>

#include "server/geometry/ray.h"
#include "server/sensing/extent.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A robot's frame R in the world, its rotation as a matrix.
struct HullPose {
  Vector3 p = Vector3::Zero();
  Matrix3 R = Matrix3::Identity();

  explicit HullPose(const Pose& X_WR) : p(X_WR.p), R(X_WR.q.toRotationMatrix()) {}
};

class RobotHull {
 public:
  explicit RobotHull(const RobotModel& model);

  /// A vertical cylinder about R's origin that holds robot `robot`, one of this type, whose frame stands at
  /// `X_WR`. Empty if it has no shapes.
  Extent Bounds(const Frame& frame, int robot, const Pose& X_WR) const;
  /// No bounds are wider than this unless a wheel has left its place.
  double whole_radius_m() const { return whole_radius_m_; }

  /// Lowers `nearest_m`, a finite number, to the distance at which `ray_W` meets the robot if that is nearer.
  void Cast(const Frame& frame, int robot, const HullPose& X_WR, const Ray& ray_W, double& nearest_m) const;

 private:
  /// A cylinder that stands upright in R: most of what rays meet.
  struct Trunk {
    Cylinder shape;
    Vector3 p_RG = Vector3::Zero();
    double min_z = 0, max_z = 0;  // in R
  };
  /// Any other shape. The bounds hold however its link turns about its joint.
  struct Part {
    Shape shape;
    int link = 0;
    Pose X_LG;
    Vector3 p_RG = Vector3::Zero();  // in the initial pose, which is the chassis' for ever
    Matrix3 R_RG = Matrix3::Identity();
    Vector3 p_RC = Vector3::Zero();  // centre of a sphere about it
    double radius_m = 0;             // of that sphere
    double body_radius_m = 0;        // of one about its link's centre of mass
    bool hidden = false;             // between the trunk's ends nothing of it sticks out
  };
  static Part MakePart(const RobotModel& model, int link, const LinkShape& collision);
  static Extent ExtentOf(const RobotModel& model, const Part& part);

  std::optional<Trunk> trunk_;
  std::vector<Part> parts_;
  Extent chassis_, all_;  // of the chassis' shapes; of all
  double whole_radius_m_ = 0;
};

}  // namespace coopdyn
