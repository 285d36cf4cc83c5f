// SPDX-License-Identifier: MIT
// Finds the places of SDF's <sensor>s and the collisions of links, and adds the sensors' modules.
#include <algorithm>
#include <sdf/sdf.hh>
#include <utility>

#include "server/model/sdf_body.h"
#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The pose of `sensor` in its link or joint, from libsdformat.
Pose PlaceOf(const SdfSensor& sensor, const std::vector<ModelScope>& scopes, ModelReading& reading) {
  const auto scope = std::ranges::find(scopes, sensor.scope, &ModelScope::prefix);
  if (scope == scopes.end()) return {};
  const std::string what = "sensor '" + sensor.name + "'";
  const sdf::Sensor* found = nullptr;
  if (sensor.on_joint) {
    const sdf::Joint* joint = scope->model.JointByName(sensor.host);
    if (joint != nullptr) found = joint->SensorByName(sensor.name);
  } else {
    const sdf::Link* link = scope->model.LinkByName(sensor.host);
    if (link != nullptr) found = link->SensorByName(sensor.name);
  }
  if (found == nullptr) return {};
  // libsdformat does not resolve frames for sensors of joints.
  if (sensor.on_joint) {
    if (!found->PoseRelativeTo().empty())
      reading.Warn(sensor.where.line,
                   what + ": relative_to of its <pose> is not used: it is in the joint's frame");
    return reading.CheckedPose(found->RawPose(), found->Element(), what);
  }
  return reading.Resolve(found->SemanticPose(), sensor.host, found->Element(), what);
}

}  // namespace

void ReadAssembly(const std::vector<ModelScope>& scopes, ModelReading& reading) {
  Assembly& assembly = reading.assembly;
  const RobotModel& robot = reading.robot;
  for (std::size_t i = 0; i < assembly.links.size(); ++i) {
    FileLink& link = assembly.links[i];
    link.mass_kg = robot.links[i].mass_kg;
    link.X_FI = robot.links[i].X_LI;
    link.inertia_kg_m2 = robot.links[i].inertia_kg_m2;
  }
  for (FileJoint& joint : assembly.joints) {
    const auto moving = std::ranges::find(robot.joints, joint.name, &JointModel::name);
    const auto fixed = std::ranges::find(reading.fixed, joint.name, &FixedJoint::name);
    if (moving != robot.joints.end()) {
      joint.parent = moving->parent;
    } else if (fixed != reading.fixed.end()) {
      joint.parent = fixed->parent;
    }
  }
  for (SdfSensor& sensor : assembly.sensors) {
    sensor.X_FS = PlaceOf(sensor, scopes, reading);
    const auto link = std::ranges::find(assembly.links, sensor.scope + sensor.host, &FileLink::name);
    if (link != assembly.links.end()) sensor.link = static_cast<std::size_t>(link - assembly.links.begin());
  }
}

void FindCollisions(const RobotModel& robot, Assembly& assembly) {
  std::vector<std::size_t> taken(robot.links.size());
  // A link's own collisions come first, then those of links welded to it, in file order.
  for (const bool own : {true, false}) {
    for (std::size_t i = 0; i < assembly.links.size(); ++i) {
      const auto link = static_cast<std::size_t>(robot.frames[i].link);
      if ((robot.links[link].name == assembly.links[i].name) != own) continue;
      assembly.links[i].first_collision = taken[link];
      taken[link] += assembly.links[i].collisions.size();
    }
  }
}

std::vector<ContactModel::Part> CollisionsOf(const RobotModel& robot, const Assembly& assembly,
                                             std::size_t frame, std::string_view name) {
  std::vector<ContactModel::Part> parts;
  const FileLink& link = assembly.links[frame];
  for (std::size_t c = 0; c < link.collisions.size(); ++c) {
    if (name.empty() || link.collisions[c] == name)
      parts.push_back({robot.frames[frame].link, link.first_collision + c});
  }
  return parts;
}

void SensorReader::AddElements(bool foreign) {
  constexpr std::size_t kMaxModules = 100;
  std::size_t left_out = 0;
  for (const SdfSensor& sensor : assembly_.sensors) {
    const auto complain = [&](const std::string& text, const std::string& otherwise,
                              Diagnostic::Level level = Diagnostic::Level::kWarning) {
      const std::string what = "sensor '" + sensor.name + "': " + text;
      foreign ? diagnostics_.Add({level, sensor.where, what + ": " + otherwise})
              : diagnostics_.Error(sensor.where, what);
    };
    SensorKind kind = sensor.kind;
    const Mount mount = MountOn(robot_, sensor.link, sensor.X_FS * sensor.X_SC);
    if (auto* imu = std::get_if<ImuModel>(&kind)) imu->mount = mount;
    if (auto* lidar = std::get_if<LidarModel>(&kind)) lidar->mount = mount;
    if (auto* camera = std::get_if<CameraModel>(&kind)) camera->mount = mount;
    if (auto* sonar = std::get_if<SonarModel>(&kind)) sonar->beams.front().mount = mount;
    if (auto* wrench = std::get_if<WrenchModel>(&kind)) {
      wrench->joint = sensor.joint;
      const auto frame = ParseWrenchFrame(sensor.wrench_frame).value_or(WrenchFrame::kChild);
      const std::string wrong = AttachWrench(robot_, assembly_, frame, sensor.X_FS, *wrench);
      if (!wrong.empty()) {
        complain(wrong, "it is left out");
        continue;
      }
    }
    if (auto* contact = std::get_if<ContactModel>(&kind)) {
      for (const std::string& name : sensor.collisions) {
        const std::string own = name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1);
        const auto parts = CollisionsOf(robot_, assembly_, sensor.link, own);
        contact->parts.insert(contact->parts.end(), parts.begin(), parts.end());
        if (!parts.empty() || own.empty()) continue;
        complain("link '" + sensor.host + "' has no collision '" + own + "'" +
                     DidYouMean(own, assembly_.links[sensor.link].collisions),
                 "all shapes of the link are taken", Diagnostic::Level::kMended);
      }
      if (contact->parts.empty()) contact->parts = CollisionsOf(robot_, assembly_, sensor.link);
    }
    const std::vector<ModuleModel> modules = robot_.modules();
    if (modules.size() >= kMaxModules) {
      if (left_out++ == 0)
        complain("a robot has at most " + std::to_string(kMaxModules) + " modules",
                 "this one and those that follow are left out");
      continue;
    }
    std::string module = sensor.module;
    for (int i = 2; std::ranges::find(modules, module, &ModuleModel::name) != modules.end(); ++i) {
      constexpr std::size_t kRoom = 28;
      module = sensor.module.substr(0, kRoom) + "_" + std::to_string(i);
    }
    robot_.AddSensor(module, std::move(kind), sensor.timing);
  }
}

}  // namespace coopdyn
