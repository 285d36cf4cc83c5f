// SPDX-License-Identifier: MIT
// Computes the start pose of a robot, in which joints may not be at 0.
#include <algorithm>
#include <utility>

#include "server/base/portable_math.h"
#include "server/model/robot_model.h"
#include "server/model/sdf_body.h"

namespace coopdyn {

namespace {

/// The links connected to `link` by joints other than `joint`, including `link`.
std::vector<bool> LinksBeyond(const RobotModel& robot, std::size_t joint, int link) {
  std::vector<bool> beyond(robot.links.size());
  beyond[static_cast<std::size_t>(link)] = true;
  for (std::size_t round = 0; round < robot.joints.size(); ++round) {
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      if (i == joint || !robot.joints[i].joins()) continue;
      const auto parent = static_cast<std::size_t>(robot.joints[i].parent);
      const auto child = static_cast<std::size_t>(robot.joints[i].child);
      if (beyond[parent] != beyond[child]) beyond[parent] = beyond[child] = true;
    }
  }
  return beyond;
}

}  // namespace

bool MoveJoint(RobotModel& robot, std::size_t index, double by) {
  const JointModel joint = robot.joints[index];
  std::vector<bool> beyond = LinksBeyond(robot, index, joint.child);
  if (beyond[static_cast<std::size_t>(joint.parent)]) return false;
  // The base must not move: move the other side.
  if (beyond[0]) {
    beyond = LinksBeyond(robot, index, joint.parent);
    by = -by;
  }
  const Vector3 axis = joint.axis_R.normalized();
  Pose X;
  if (joint.kind != JointModel::Kind::kSlider) X.q = portable::AngleAxis(by, axis);
  const double way_m = joint.kind == JointModel::Kind::kSlider ? by : joint.pitch_m_rad * by;
  X.p = joint.p_RJ - X.q * joint.p_RJ + way_m * axis;
  const auto moves = [&](int link) { return beyond[static_cast<std::size_t>(link)]; };
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (beyond[i]) robot.links[i].X_RL = X * robot.links[i].X_RL;
  }
  for (FrameModel& frame : robot.frames) {
    if (moves(frame.link)) frame.X_RF = X * frame.X_RF;
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    JointModel& other = robot.joints[i];
    if (i == index || !moves(other.parent)) continue;
    other.p_RJ = X * other.p_RJ;
    other.axis_R = X.q * other.axis_R;
    other.axis2_R = X.q * other.axis2_R;
  }
  return true;
}

void MoveToStart(ModelReading& reading) {
  RobotModel& robot = reading.robot;
  for (const CouplingModel& coupling : robot.couplings) {
    const JointModel& leader = robot.joints[static_cast<std::size_t>(coupling.leader)];
    robot.joints[static_cast<std::size_t>(coupling.follower)].start =
        coupling.multiplier * leader.start + coupling.offset;
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    JointModel& joint = robot.joints[i];
    if (joint.start == 0 || MoveJoint(robot, i, joint.start)) continue;
    joint.start = 0;
    reading.Warn(
        reading.lines.joints[i],
        "joint '" + joint.name +
            "' closes a loop, so it starts at 0, and is pushed into its limits: write the model in a "
            "pose within them");
  }
}

RobotModel AtZero(const RobotModel& robot) {
  RobotModel model = robot;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].start != 0) MoveJoint(model, i, -std::exchange(model.joints[i].start, 0));
  }
  return model;
}

}  // namespace coopdyn
