// SPDX-License-Identifier: MIT
#include "server/state/frame.h"

namespace coopdyn {

namespace {

Pose BodyPose(const Frame& frame, int body) {
  const BodyState& state = frame.bodies[static_cast<std::size_t>(body)];
  return {state.p_WB, state.orientation()};
}

}  // namespace

Pose LinkPose(const Frame& frame, int index, int link) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const LinkModel& model = robot.entry.model->links[static_cast<std::size_t>(link)];
  return BodyPose(frame, robot.first_body + link) * model.X_LI.Inverse();
}

Pose RobotPose(const Frame& frame, int index) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  return LinkPose(frame, index, 0) * robot.entry.model->links.front().X_RL.Inverse();
}

Pose ObjectPose(const Frame& frame, const SceneObject& object) {
  return object.body < 0 ? object.object.X_WO : BodyPose(frame, object.body);
}

}  // namespace coopdyn
