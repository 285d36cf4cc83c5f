// SPDX-License-Identifier: MIT
// A robot as seen by rays: the collision shapes of its links, with bounds that decide most rays. One per
// robot type. Constant once made; any thread.
#pragma once

#include <optional>
#include <vector>

#include "server/geometry/ray.h"
#include "server/sensing/extent.h"
#include "server/state/frame.h"

namespace coopdyn {

class RobotHull {
 public:
  explicit RobotHull(const RobotModel& model);

  /// A vertical cylinder about R's origin that contains robot `robot`, of this type, whose frame is at
  /// `X_WR`. Empty if the type has no shapes.
  Extent Bounds(const Frame& frame, int robot, const Pose& X_WR) const;
  /// Maximum radius of Bounds() while the robot stands upright or nearly so.
  double upright_radius_m() const { return upright_radius_m_; }
  /// Maximum radius of Bounds() unless a wheel has left its place.
  double whole_radius_m() const { return whole_radius_m_; }

  /// Lowers `nearest_m` (finite) to the distance at which `ray_W` hits the robot, ignoring link
  /// `ignored_link`, if that is nearer.
  void Cast(const Frame& frame, int robot, const Pose& X_WR, const Ray& ray_W, double& nearest_m,
            int ignored_link = kNoLink) const;
  /// Calls visit(shape, X_WG) for each shape of all links except `ignored_link`.
  template <typename Visit>
  void ForShapes(const Frame& frame, int robot, const Pose& X_WR, int ignored_link, Visit visit) const {
    if (trunk_ && ignored_link != 0) visit(Shape(trunk_->shape), Pose{X_WR * trunk_->p_RG, X_WR.q});
    for (const Part& part : parts_) {
      if (part.link != ignored_link) visit(part.shape, PlaceOf(frame, robot, X_WR, part));
    }
  }
  static constexpr int kNoLink = -1;

 private:
  struct Part;
  static Pose PlaceOf(const Frame& frame, int robot, const Pose& X_WR, const Part& part) {
    return part.link == 0 ? X_WR * part.X_RG : LinkPose(frame, robot, part.link) * part.X_LG;
  }
  void CastParts(const Frame& frame, int robot, const Pose& X_WR, const Ray& ray_W, bool between_ends,
                 int ignored_link, double& nearest_m) const;

  /// A cylinder that stands upright in R: hit by most rays.
  struct Trunk {
    Cylinder shape;
    Vector3 p_RG = Vector3::Zero();
    bool central = true;          // its axis is R's z axis
    double min_z = 0, max_z = 0;  // in R
  };
  /// Any other shape. Its bounds hold at any angle of its link's joint.
  struct Part {
    Shape shape;
    int link = 0;
    Pose X_LG;
    Pose X_RG;                       // in the initial pose; constant for the chassis
    Vector3 p_RC = Vector3::Zero();  // centre of a bounding sphere
    double radius_m = 0;             // of that sphere
    double body_radius_m = 0;        // of a bounding sphere about the link's centre of mass
    bool hidden = false;             // inside the trunk's radius between the trunk's ends
  };
  static Part MakePart(const RobotModel& model, int link, const LinkShape& collision);
  static Extent ExtentOf(const RobotModel& model, const Part& part);

  std::optional<Trunk> trunk_;
  std::vector<Part> parts_;
  bool all_hidden_ = false;  // all of parts_ are hidden
  Extent chassis_, all_;     // of the chassis' shapes; of all shapes
  double upright_radius_m_ = 0, whole_radius_m_ = 0;
};

}  // namespace coopdyn
