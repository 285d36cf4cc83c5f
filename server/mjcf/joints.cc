// SPDX-License-Identifier: MIT
// Writes joints with their stops, motors, springs and dampers.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/mjcf/parts.h"
#include "server/mjcf/sdf_text.h"

namespace coopdyn::mjcf {

namespace {

using tinyxml2::XMLElement;

constexpr double kUsualSpeed = 10;  // rad/s or m/s; MJCF has no speed limits

/// Adds a link between two joints of a body. It weighs a millionth of the body, which has no effect because
/// joints are solved in their own coordinates.
void AddCarrier(const std::string& name, int body, const Pose& X_MB, const mjModel& m, XMLElement& model) {
  constexpr double kShare = 1e-6, kLeast = 1e-9, kLeast_kg_m2 = 1e-13;
  XMLElement& link = AddNamed(model, "link", name);
  link.SetAttribute("coopdyn:carrier", "true");
  AddPose(link, X_MB);
  XMLElement& inertial = Add(link, "inertial");
  Add(inertial, "mass", Number(std::max(kLeast, kShare * m.body_mass[body])));
  XMLElement& inertia = Add(inertial, "inertia");
  const mjtNum* const moments = m.body_inertia + 3 * body;
  const double least = std::max(kLeast_kg_m2, kShare * std::min({moments[0], moments[1], moments[2]}));
  for (const char* key : {"ixx", "iyy", "izz"}) Add(inertia, key, Number(least));
  for (const char* key : {"ixy", "ixz", "iyz"}) Add(inertia, key, "0");
}

void AddLimits(int joint, bool has_motor, const Source& source, XMLElement& axis) {
  const mjModel& m = source.model();
  const double effort = has_motor ? source.Effort(joint) : 0;
  if (!m.jnt_limited[joint] && effort <= 0) return;
  XMLElement& limit = Add(axis, "limit");
  if (m.jnt_limited[joint]) {
    const double zero = m.qpos0[m.jnt_qposadr[joint]];
    Add(limit, "lower", Number(m.jnt_range[2 * joint] - zero));
    Add(limit, "upper", Number(m.jnt_range[2 * joint + 1] - zero));
  }
  if (effort <= 0) return;
  Add(limit, "effort", Number(effort));
  Add(limit, "velocity", Number(source.Speed(joint) > 0 ? source.Speed(joint) : kUsualSpeed));
}

void AddDynamics(int joint, const Source& source, XMLElement& axis) {
  const mjModel& m = source.model();
  const int dof = m.jnt_dofadr[joint], at = m.jnt_qposadr[joint];
  const double damping = m.dof_damping[dof], friction = m.dof_frictionloss[dof],
               stiffness = m.jnt_stiffness[joint];
  if (damping == 0 && friction == 0 && stiffness == 0) return;
  XMLElement& dynamics = Add(axis, "dynamics");
  if (damping > 0) Add(dynamics, "damping", Number(damping));
  if (stiffness > 0) {
    Add(dynamics, "spring_reference", Number(m.qpos_spring[at] - m.qpos0[at]));
    Add(dynamics, "spring_stiffness", Number(stiffness));
  }
  if (friction > 0) Add(dynamics, "friction", Number(friction));
}

void AddAxis(int joint, const Couplings& couplings, const Source& source, XMLElement& element) {
  const mjModel& m = source.model();
  XMLElement& axis = Add(element, "axis");
  Add(axis, "xyz", Numbers(ToVector(m.jnt_axis + 3 * joint)));
  const auto follower = couplings.followers.find(joint);
  const bool follows = follower != couplings.followers.end();
  AddLimits(joint, !follows, source, axis);
  AddDynamics(joint, source, axis);
  if (!follows) return;
  XMLElement& mimic = Add(axis, "mimic");
  mimic.SetAttribute("joint", source.JointName(follower->second.leader).c_str());
  Add(mimic, "multiplier", Number(follower->second.multiplier));
  Add(mimic, "offset", Number(follower->second.offset));
  Add(mimic, "reference", "0");
}

void WarnBall(int joint, const Source& source) {
  const mjModel& m = source.model();
  const int dof = m.jnt_dofadr[joint];
  if (m.jnt_limited[joint] || m.jnt_stiffness[joint] > 0 || m.dof_damping[dof] > 0 ||
      m.dof_frictionloss[dof] > 0 || m.dof_armature[dof] > 0)
    source.words().Say(
        "range, stiffness, damping, armature and frictionloss of a ball joint are left out: it turns freely");
}

}  // namespace

std::string FirstJointName(int body, const Source& source) {
  const mjModel& m = source.model();
  return m.body_jntnum[body] == 0 ? source.BodyName(body) + "_fixed" : source.JointName(m.body_jntadr[body]);
}

void AddJoints(int body, const Pose& X_MB, const Couplings& couplings, bool has_loops, const Source& source,
               XMLElement& model) {
  const mjModel& m = source.model();
  const std::string child = source.BodyName(body);
  std::string parent = source.BodyName(m.body_parentid[body]);
  const int count = m.body_jntnum[body], first = m.body_jntadr[body];
  if (count > 0 && m.jnt_type[first] == mjJNT_FREE) return;
  const auto start = [&](const std::string& name, const char* type, const std::string& to) -> XMLElement& {
    XMLElement& joint = AddNamed(model, "joint", name);
    joint.SetAttribute("type", type);
    Add(joint, "parent", parent);
    Add(joint, "child", to);
    return joint;
  };
  if (count == 0) start(FirstJointName(body, source), "fixed", child);
  for (int i = 0; i < count; ++i) {
    const int joint = first + i;
    const std::string name = source.JointName(joint);
    const bool is_last = i + 1 == count;
    const std::string to = is_last ? child : name + "_carrier";
    if (!is_last) AddCarrier(to, body, X_MB, m, model);
    const bool is_ball = m.jnt_type[joint] == mjJNT_BALL, slides = m.jnt_type[joint] == mjJNT_SLIDE;
    const bool is_locked = couplings.locked.contains(joint);
    const char* const type = is_locked              ? "fixed"
                             : is_ball              ? "ball"
                             : slides               ? "prismatic"
                             : m.jnt_limited[joint] ? "revolute"
                                                    : "continuous";
    XMLElement& element = start(name, type, to);
    Pose X_BJ;
    X_BJ.p = ToVector(m.jnt_pos + 3 * joint);
    AddPose(element, X_BJ);
    if (is_ball) WarnBall(joint, source);
    if (!is_ball && !is_locked) AddAxis(joint, couplings, source, element);
    const double armature = m.dof_armature[m.jnt_dofadr[joint]];
    if (!is_ball && !is_locked && armature > 0)
      element.SetAttribute("coopdyn:armature", Number(armature).c_str());
    const double from = source.Start(joint);
    if (!is_ball && !is_locked && std::abs(from) > 1e-9 && !couplings.followers.contains(joint)) {
      if (has_loops)
        source.words().Say("keyframe 'home' is not used, because joints close a loop", false);
      else
        element.SetAttribute("coopdyn:start", Number(from).c_str());
    }
    parent = to;
  }
}

}  // namespace coopdyn::mjcf
