// SPDX-License-Identifier: MIT
#include "server/state/frame.h"

#include <cmath>

namespace coopdyn {

namespace {

Pose BodyPose(const Frame& frame, int body) {
  const BodyState& state = frame.bodies[static_cast<std::size_t>(body)];
  return {state.p_WB, state.orientation()};
}

}  // namespace

Pose LinkPose(const Frame& frame, int index, int link) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const RobotModel& model = *robot.entry.model;
  const LinkModel& link_model = model.links[static_cast<std::size_t>(link)];
  if (robot.one_body()) {
    const Pose X_WR = RobotPose(frame, index);
    const JointModel* axle = nullptr;
    double angle_rad = 0;
    for (std::size_t side = 0; side < 2; ++side) {
      const int driven = side == 0 ? model.drive.left_joint : model.drive.right_joint;
      if (driven < 0 || static_cast<std::size_t>(driven) >= model.joints.size()) continue;
      if (model.joints[static_cast<std::size_t>(driven)].child != link) continue;
      axle = &model.joints[static_cast<std::size_t>(driven)];
      angle_rad = frame.robots[static_cast<std::size_t>(index)].wheel_angle_rad[side];
    }
    if (axle == nullptr || !(std::abs(angle_rad) > 0)) return X_WR * link_model.X_RL;
    const Quaternion turn(Eigen::AngleAxisd(angle_rad, axle->axis_R.normalized()));
    return X_WR * Pose{axle->p_RJ - turn * axle->p_RJ, turn} * link_model.X_RL;
  }
  return BodyPose(frame, robot.first_body + link) * link_model.X_LI.Inverse();
}

Pose RobotPose(const Frame& frame, int index) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const BodyState& body = frame.bodies[static_cast<std::size_t>(robot.first_body)];
  const Quaternion q = body.orientation();
  return {body.p_WB + q * robot.X_BR.p, robot.axes_of_R ? q : q * robot.X_BR.q};
}

Pose ObjectPose(const Frame& frame, const SceneObject& object) {
  return object.body < 0 ? object.object.X_WO : BodyPose(frame, object.body);
}

}  // namespace coopdyn
