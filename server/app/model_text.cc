// SPDX-License-Identifier: MIT
#include "server/app/model_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/model/sensor_text.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The extent of the collisions, or else of the visuals, of all links.
Vector3 Extent(const RobotModel& model, std::vector<LinkShape> LinkModel::*shapes) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vector3 low = Vector3::Constant(kFar), high = -low;
  for (const LinkModel& link : model.links) {
    for (const LinkShape& one : link.*shapes) {
      const Pose X_RG = link.X_RL * one.X_LG;
      const Vector3 half = HalfExtents(one.shape, X_RG.q);
      low = low.cwiseMin(X_RG.p - half);
      high = high.cwiseMax(X_RG.p + half);
    }
  }
  return (high - low).cwiseMax(0);
}

}  // namespace

std::vector<std::size_t> MovingJoints(const RobotModel& model) {
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const JointModel::Kind kind = model.joints[j].kind;
    if (kind != JointModel::Kind::kForce && kind != JointModel::Kind::kTorque &&
        kind != JointModel::Kind::kLimiter)
      joints.push_back(j);
  }
  return joints;
}

bool HasMotor(const RobotModel& model, std::size_t joint) {
  return std::ranges::any_of(model.actuators, [joint](const ActuatorModel& actuator) {
    return !actuator.module.empty() && std::ranges::count(actuator.joints, static_cast<int>(joint)) > 0;
  });
}

double MovingMass(const RobotModel& model) {
  double mass_kg = 0;
  for (std::size_t i = model.fixed_base ? 1 : 0; i < model.links.size(); ++i)
    mass_kg += model.links[i].mass_kg;
  return mass_kg;
}

Vector3 SizeOf(const RobotModel& model) {
  const Vector3 size = Extent(model, &LinkModel::collisions);
  return size.isZero() ? Extent(model, &LinkModel::visuals) : size;
}

std::string SummaryOf(const RobotModel& model) {
  const auto carriers =
      static_cast<std::size_t>(std::ranges::count(model.links, true, &LinkModel::is_carrier));
  return "robot " + model.type + ", " + CountOf(model.links.size() - carriers, "link") + ", " +
         CountOf(MovingJoints(model).size(), "joint") + ", " +
         (model.sector_count() == 0 ? "" : CountOf(model.sector_count(), "distance sensor") + ", ") +
         CountOf(model.modules().size(), "module") + "; " +
         (model.fixed_base && model.links.size() == 1
              ? std::string("fixed to the world")
              : (model.fixed_base ? "fixed to the world, moving mass " : "mass ") +
                    Rounded4(MovingMass(model)) + " kg") +
         ", footprint radius " + Rounded4(model.footprint_radius_m) + " m, height " +
         Rounded4(model.height_m) + " m";
}

std::vector<std::string> PartTexts(const RobotModel& model) {
  std::vector<std::string> lines;
  for (const LinkModel& link : model.links) {
    std::map<int, std::size_t> parts;  // by index of the mesh among the collisions
    for (const LinkShape& shape : link.collisions) {
      if (shape.piece_of >= 0) ++parts.try_emplace(shape.piece_of, 1).first->second;
    }
    if (parts.empty()) continue;
    std::vector<std::string> counts;
    for (const auto& [collision, count] : parts) counts.push_back(std::to_string(count));
    lines.push_back("link " + link.name + ": its " +
                    (parts.size() == 1 ? "mesh collides" : std::to_string(parts.size()) + " meshes collide") +
                    " as " + JoinNames(counts) + " convex parts");
  }
  return lines;
}

std::string JointText(const RobotModel& model, std::size_t j) {
  const JointModel& joint = model.joints[j];
  std::string text = "joint " + joint.name + ": " + ToString(joint.kind);
  if (joint.kind == JointModel::Kind::kScrew) text += " of " + FormatNumber(joint.pitch_m_rad) + " m/rad";
  if (joint.has_stop()) {
    text +=
        ", from " + Rounded4(joint.lower) + " to " + Rounded4(joint.upper) + (joint.slides() ? " m" : " rad");
  }
  if (const CouplingModel* coupling = model.FindCoupling(static_cast<int>(j))) {
    text += ", follows: " + Rounded4(coupling->multiplier) + " * " +
            model.joints[static_cast<std::size_t>(coupling->leader)].name;
    if (coupling->offset != 0)
      text += (coupling->offset < 0 ? " - " : " + ") + Rounded4(std::abs(coupling->offset));
  } else if (joint.max_effort > 0 && std::isfinite(joint.max_effort)) {
    text += ", effort " + Rounded4(joint.max_effort) + (joint.slides() ? " N" : " N m");
    if (std::isfinite(joint.max_velocity))
      text += ", speed " + Rounded4(joint.max_velocity) + (joint.slides() ? " m/s" : " rad/s");
  }
  return text;
}

std::string ModuleText(const RobotModel& model, const ModuleModel& module) {
  std::string text = "module " + module.name + " (" + module.type + ")";
  for (const ActuatorModel& actuator : model.actuators) {
    if (actuator.is_drive() || actuator.module != module.name) continue;
    for (std::size_t i = 0; i < actuator.joints.size(); ++i)
      text += (i == 0 ? ": " : ", ") + model.joints[static_cast<std::size_t>(actuator.joints[i])].name;
  }
  const auto sensor = std::ranges::find(model.sensors, module.name, &SensorModel::name);
  const std::string words = sensor == model.sensors.end() ? "" : Describe(*sensor, model);
  if (!words.empty()) text += ": " + words;
  return text;
}

}  // namespace coopdyn
