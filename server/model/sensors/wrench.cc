// SPDX-License-Identifier: MIT
// Force and torque sensors, and the parts of the robot beyond their joints.
#include <Eigen/Dense>
#include <algorithm>

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The file's links that remain connected to links[from] without joint `cut`.
std::vector<bool> SideOf(const Assembly& assembly, int from, std::size_t cut) {
  std::vector<bool> side(assembly.links.size());
  side[static_cast<std::size_t>(from)] = true;
  for (bool changed = true; std::exchange(changed, false);) {
    for (std::size_t i = 0; i < assembly.joints.size(); ++i) {
      const FileJoint& joint = assembly.joints[i];
      if (i == cut || joint.parent == FixedJoint::kWorld) continue;
      const auto parent = static_cast<std::size_t>(joint.parent),
                 child = static_cast<std::size_t>(joint.child);
      if (side[parent] == side[child]) continue;
      side[parent] = side[child] = true;
      changed = true;
    }
  }
  return side;
}

/// Mass, centre of mass and moments of the file's links `in` that are parts of link `of`.
WrenchModel::Part PartOf(const RobotModel& robot, const Assembly& assembly, const std::vector<bool>& in,
                         int of) {
  const LinkModel& link = robot.links[static_cast<std::size_t>(of)];
  const Pose X_LR = link.X_RL.Inverse();
  WrenchModel::Part part;
  part.link = of;
  Vector3 moment = Vector3::Zero();
  std::vector<std::pair<const FileLink*, Pose>> bodies;  // each with X_LI
  bool all = true;
  for (std::size_t i = 0; i < assembly.links.size(); ++i) {
    if (robot.frames[i].link != of) continue;
    if (!in[i]) {
      all = false;
      continue;
    }
    const FileLink& one = assembly.links[i];
    for (std::size_t c = 0; c < one.collisions.size(); ++c)
      part.collisions.push_back(one.first_collision + c);
    if (one.mass_kg <= 0) continue;
    bodies.emplace_back(&one, X_LR * robot.frames[i].X_RF * one.X_FI);
    part.mass_kg += one.mass_kg;
    moment += one.mass_kg * bodies.back().second.p;
  }
  std::ranges::sort(part.collisions);
  if (all) {
    part.mass_kg = link.mass_kg;
    part.X_LI = link.X_LI;
    part.inertia_kg_m2 = link.inertia_kg_m2;
    return part;
  }
  if (part.mass_kg <= 0) return part;
  part.X_LI.p = moment / part.mass_kg;
  Matrix3 inertia = Matrix3::Zero();
  for (const auto& [one, X_LI] : bodies) {
    const Matrix3 R = X_LI.q.toRotationMatrix();
    const Vector3 d = X_LI.p - part.X_LI.p;
    inertia += R * one->inertia_kg_m2.asDiagonal() * R.transpose() +
               one->mass_kg * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> moments(inertia);
  Matrix3 axes = moments.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  part.X_LI.q = Quaternion(axes).normalized();
  part.inertia_kg_m2 = moments.eigenvalues();
  return part;
}

}  // namespace

std::optional<WrenchFrame> ParseWrenchFrame(std::string_view word) {
  if (word == "child") return WrenchFrame::kChild;
  if (word == "parent") return WrenchFrame::kParent;
  if (word == "sensor") return WrenchFrame::kSensor;
  return std::nullopt;
}

std::string AttachWrench(const RobotModel& robot, const Assembly& assembly, WrenchFrame frame,
                         const Pose& X_JS, WrenchModel& wrench) {
  const auto found = std::ranges::find(assembly.joints, wrench.joint, &FileJoint::name);
  if (found == assembly.joints.end()) {
    std::vector<std::string> names;
    for (const FileJoint& joint : assembly.joints) names.push_back(joint.name);
    return "there is no joint '" + wrench.joint + "'" + DidYouMean(wrench.joint, names);
  }
  const auto index = static_cast<std::size_t>(found - assembly.joints.begin());
  const std::vector<bool> side = SideOf(assembly, found->child, index);
  const bool on_world = found->parent == FixedJoint::kWorld;
  if (!on_world && side[static_cast<std::size_t>(found->parent)]) {
    return "joint '" + wrench.joint +
           "' is in a closed loop, where its force is not that of what hangs on it: put the sensor on a "
           "joint "
           "outside the loop";
  }
  for (std::size_t i = 0; i < assembly.joints.size(); ++i) {
    const FileJoint& joint = assembly.joints[i];
    if (i == index || joint.parent != FixedJoint::kWorld || !side[static_cast<std::size_t>(joint.child)])
      continue;
    return "the child of joint '" + wrench.joint +
           "' is fixed to the world, so nothing hangs on the joint: turn the joint round, or put the sensor "
           "on "
           "another";
  }
  const auto child = static_cast<std::size_t>(found->child);
  const int child_link = robot.frames[child].link;
  const Pose X_RJ = robot.frames[child].X_RF * found->X_FJ;
  Pose X_RM{X_RJ.p, Quaternion::Identity()};
  int on = child_link;
  if (frame == WrenchFrame::kChild) {
    X_RM.q = robot.frames[child].X_RF.q;
  } else if (frame == WrenchFrame::kSensor) {
    X_RM.q = X_RJ.q * X_JS.q;
  } else if (on_world) {
    on = 0;
  } else {
    on = robot.frames[static_cast<std::size_t>(found->parent)].link;
    X_RM.q = robot.frames[static_cast<std::size_t>(found->parent)].X_RF.q;
  }
  wrench.mount = {on, robot.links[static_cast<std::size_t>(on)].X_RL.Inverse() * X_RM};
  wrench.part = PartOf(robot, assembly, side, child_link);
  wrench.beyond.clear();
  for (std::size_t i = 0; i < side.size(); ++i) {
    const int link = robot.frames[i].link;
    if (side[i] && link != child_link && std::ranges::find(wrench.beyond, link) == wrench.beyond.end())
      wrench.beyond.push_back(link);
  }
  std::ranges::sort(wrench.beyond);
  return {};
}

void WrenchModel::Read(const SensorSource& source) {
  XmlAttributes& attributes = source.attributes;
  attributes.Require("joint");
  joint = attributes.Text("joint").value_or("");
  const std::string frame_word = attributes.Text("frame").value_or("child");
  const std::string direction = attributes.Text("direction").value_or("child_to_parent");
  Pose X_JS;
  const auto pose = attributes.Numbers("pose", 6);
  if (pose && frame_word != "sensor")
    attributes.Error("a pose needs frame=\"sensor\": without it the axes are those of a link");
  if (const auto& v = pose)
    X_JS = {Vector3((*v)[0], (*v)[1], (*v)[2]), FromRollPitchYaw((*v)[3], (*v)[4], (*v)[5])};
  ValueNoise force, torque;
  ReadNoise(attributes, "force_", force);
  ReadNoise(attributes, "torque_", torque);
  force_noise.fill(force);
  torque_noise.fill(torque);
  const auto frame = ParseWrenchFrame(frame_word);
  if (!frame) attributes.Error("frame is child, parent or sensor, not '" + frame_word + "'");
  if (direction != "child_to_parent" && direction != "parent_to_child") {
    attributes.Error(
        "direction is child_to_parent (what the child does to the parent) or parent_to_child, not '" +
        direction + "'");
  }
  on_parent = direction != "parent_to_child";
  if (joint.empty() || !frame) return;
  const std::string wrong = AttachWrench(source.robot, source.assembly, *frame, X_JS, *this);
  if (!wrong.empty()) attributes.Error(wrong);
}

std::string WrenchModel::Text(const RobotModel& robot) const {
  double mass_kg = part.mass_kg;
  for (const int link : beyond) mass_kg += robot.links[static_cast<std::size_t>(link)].mass_kg;
  return "at " + joint + ", on which " + Rounded4(mass_kg) + " kg hang";
}

}  // namespace coopdyn
