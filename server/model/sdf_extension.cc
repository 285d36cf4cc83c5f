// SPDX-License-Identifier: MIT
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "server/base/portable_math.h"
#include "server/model/sdf_parts.h"
#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

XmlAttributes::XmlAttributes(const tinyxml2::XMLElement& element, std::string file, Diagnostics& diagnostics)
    : element_(element), file_(std::move(file)), diagnostics_(diagnostics) {}

std::optional<std::string> XmlAttributes::Text(const std::string& name) {
  known_.push_back(name);
  const char* text = element_.Attribute(name.c_str());
  if (text == nullptr) return std::nullopt;
  return std::string(text);
}

std::optional<double> XmlAttributes::Number(const std::string& name, double min, double max) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  const std::optional<double> value = ParsePlain(*text);
  if (!value || *value < min || *value > max) {
    Error("'" + name + "' must be a number from " + FormatNumber(min) + " to " + FormatNumber(max) +
          ", not '" + *text + "'");
    return std::nullopt;
  }
  return value;
}

std::optional<int> XmlAttributes::Integer(const std::string& name, int min, int max) {
  const std::optional<double> value = Number(name, min, max);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) {
    Error("'" + name + "' must be a whole number, not " + FormatNumber(*value));
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<bool> XmlAttributes::Flag(const std::string& name) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  if (*text != "true" && *text != "false") {
    Error("'" + name + "' must be true or false, not '" + *text + "'");
    return std::nullopt;
  }
  return *text == "true";
}

std::optional<std::vector<double>> XmlAttributes::Numbers(const std::string& name, std::size_t count) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  std::vector<double> values;
  for (const std::string& word : SplitWords(*text)) {
    const std::optional<double> value = ParsePlain(word);
    if (value) values.push_back(*value);
    if (!value || values.size() > count) break;
  }
  if (values.size() != count || SplitWords(*text).size() != count) {
    Error("'" + name + "' must be " + std::to_string(count) + " finite numbers, not '" + *text + "'");
    return std::nullopt;
  }
  return values;
}

void XmlAttributes::Error(const std::string& text) {
  diagnostics_.Error(where(), std::string("<") + element_.Name() + ">: " + text);
}

void XmlAttributes::Require(const std::string& name) {
  if (element_.Attribute(name.c_str()) == nullptr) Error("the attribute '" + name + "' is missing");
}

void XmlAttributes::Finish() {
  for (const tinyxml2::XMLAttribute* attribute = element_.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    if (std::find(known_.begin(), known_.end(), attribute->Name()) == known_.end()) {
      Error(std::string("unknown attribute '") + attribute->Name() + "'" +
            DidYouMean(attribute->Name(), known_));
    }
  }
}

SourceLine XmlAttributes::where() const {
  return {file_, element_.GetLineNum()};
}

namespace {

using tinyxml2::XMLElement;

constexpr double kTiny = 1e-6;  // m, tolerance of the wheels' contact points
constexpr std::size_t kMaxModules = 100;

class ExtensionReader {
 public:
  ExtensionReader(const std::string& file, const Assembly& assembly, RobotModel& robot,
                  Diagnostics& diagnostics)
      : file_(file), assembly_(assembly), robot_(robot), diagnostics_(diagnostics) {}

  void Read(const XMLElement& model) {
    std::vector<std::string> known = {"coopdyn:drive", "coopdyn:group", "coopdyn:module", "coopdyn:muscle",
                                      "coopdyn:thruster"};
    for (const std::string& element : SensorReader::Elements()) known.push_back(element);
    const XMLElement* drive = nullptr;
    std::vector<const XMLElement*> modules, groups, muscles, thrusters, sensors;
    for (const XMLElement* child = model.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (!name.starts_with("coopdyn:") || name.starts_with("coopdyn:gazebo_") || name == "coopdyn:mimic")
        continue;
      if (name == "coopdyn:module") {
        modules.push_back(child);
      } else if (name == "coopdyn:drive") {
        if (drive != nullptr) Error(*child, "<coopdyn:drive> stands here twice: keep one");
        drive = child;
      } else if (name == "coopdyn:group") {
        groups.push_back(child);
      } else if (name == "coopdyn:muscle") {
        muscles.push_back(child);
      } else if (name == "coopdyn:thruster") {
        thrusters.push_back(child);
      } else {
        sensors.push_back(child);
      }
    }
    if (drive != nullptr) ReadDrive(*drive);
    Adopt(model);
    for (const XMLElement* group : groups) {
      XmlAttributes attributes(*group, file_, diagnostics_);
      ReadGroup(attributes, robot_, diagnostics_);
    }
    if (groups.empty()) AddDefaultGroup(robot_);
    for (const XMLElement* muscle : muscles) ReadMuscle(*muscle, file_, robot_, diagnostics_);
    for (const XMLElement* thruster : thrusters) ReadThruster(*thruster, file_, robot_, diagnostics_);
    ReadLimiters(model, robot_);
    for (const XMLElement* sensor : sensors) {
      const std::string name = sensor->Name();
      if (!sensors_.Read(*sensor)) Error(*sensor, "unknown element <" + name + ">" + DidYouMean(name, known));
    }
    for (const XMLElement* module : modules) ReadModule(*module);
    const XMLElement* root = model.Parent() == nullptr ? nullptr : model.Parent()->ToElement();
    const bool foreign = root != nullptr && root->Attribute("coopdyn:foreign") != nullptr;
    if (modules.empty() && (foreign || !robot_.has_boards())) AddDefaultModules();
    sensors_.AddElements(foreign);
    sensors_.Finish();
    TellOfWhatMoves();
  }

 private:
  /// Reads the elements that replace Gazebo's plugins.
  void Adopt(const XMLElement& model) {
    const XMLElement* drive = model.FirstChildElement("coopdyn:gazebo_drive");
    if (drive != nullptr) AdoptDrive(*drive, file_, robot_, diagnostics_);
    for (const XMLElement* one = model.FirstChildElement("coopdyn:gazebo_joint"); one != nullptr;
         one = one->NextSiblingElement("coopdyn:gazebo_joint")) {
      AdoptJoint(*one, file_, robot_, diagnostics_);
    }
    for (const XMLElement* one = model.FirstChildElement("coopdyn:gazebo_group"); one != nullptr;
         one = one->NextSiblingElement("coopdyn:gazebo_group")) {
      XmlAttributes attributes(*one, file_, diagnostics_);
      AdoptGroup(attributes, robot_);
    }
    for (const XMLElement* one = model.FirstChildElement("coopdyn:gazebo_rotor"); one != nullptr;
         one = one->NextSiblingElement("coopdyn:gazebo_rotor")) {
      AdoptRotor(*one, file_, robot_, diagnostics_);
    }
  }

  /// If the base is an empty link `world`, makes the pose module report the first link on it.
  void TellOfWhatMoves() {
    if (robot_.links.empty()) return;
    const LinkModel& base = robot_.links.front();
    if (base.name != "world" || !base.collisions.empty() || !base.visuals.empty()) return;
    const auto hangs = std::ranges::find_if(
        robot_.links, [](const LinkModel& link) { return link.name != "world" && !link.is_carrier; });
    if (hangs == robot_.links.end()) return;
    for (SensorModel& sensor : robot_.sensors) {
      if (auto* pose = std::get_if<PoseModel>(&sensor.kind))
        pose->link = static_cast<int>(hangs - robot_.links.begin());
    }
  }

  /// Adds the modules of a model without a `<coopdyn:module>`.
  void AddDefaultModules() {
    if (ActuatorModel* const drive = Drive()) drive->module = "motors";
    robot_.AddSensor(PoseModel::kType, PoseModel());
  }

  void Error(const XMLElement& element, std::string text) {
    diagnostics_.Error({file_, element.GetLineNum()}, std::move(text));
  }

  std::optional<int> FindJoint(XmlAttributes& attributes, const std::string& key) {
    attributes.Require(key);
    const std::optional<std::string> name = attributes.Text(key);
    if (!name) return std::nullopt;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      if (robot_.joints[i].name == *name) return static_cast<int>(i);
      names.push_back(robot_.joints[i].name);
    }
    attributes.Error("there is no joint '" + *name + "'" + DidYouMean(*name, names));
    return std::nullopt;
  }

  /// Radius of the wheel on `joint`, and its contact point. Reports an error and returns nullopt if it is not
  /// a valid wheel of a drive.
  std::optional<double> CheckWheel(XmlAttributes& attributes, const JointModel& joint, double side) {
    const LinkModel& link = robot_.links[static_cast<std::size_t>(joint.child)];
    if (joint.kind != JointModel::Kind::kHinge || joint.has_stop()) {
      attributes.Error("the wheel '" + link.name +
                       "' must turn without end: remove <lower> and <upper> of '" + joint.name + "'");
    }
    if (joint.is_resisted()) {
      diagnostics_.Warning(attributes.where(),
                           "the <dynamics> of '" + joint.name + "' is not used: its motor decides");
    }
    const LinkShape* tread = nullptr;
    double radius = 0;
    for (const LinkShape& collision : link.collisions) {
      if (const auto* sphere = std::get_if<Sphere>(&collision.shape)) radius = sphere->radius_m;
      if (const auto* cylinder = std::get_if<Cylinder>(&collision.shape)) radius = cylinder->radius_m;
      if (std::holds_alternative<Box>(collision.shape)) continue;
      tread = &collision;
      break;
    }
    if (tread == nullptr) {
      attributes.Error("the wheel '" + link.name + "' needs a <collision> that is a cylinder or a sphere");
      return std::nullopt;
    }
    const Pose X_RG = link.X_RL * tread->X_LG;
    const bool centred = (X_RG.p - joint.p_RJ - Vector3(0, X_RG.p.y() - joint.p_RJ.y(), 0)).norm() < kTiny;
    const bool upright =
        std::holds_alternative<Sphere>(tread->shape) || std::abs((X_RG.q * Vector3::UnitZ()).y()) > 1 - 1e-9;
    if (joint.axis_R.y() < 1 - 1e-9) {
      attributes.Error("the axis of '" + joint.name +
                       "' must point left, along 0 1 0 of the model, so that a " +
                       "positive speed drives forward");
    }
    if (!centred || !upright) {
      attributes.Error("the collision of '" + link.name + "' must be centred on the axis of '" + joint.name +
                       "', a cylinder along it");
    }
    if (std::abs(X_RG.p.x()) > kTiny || std::abs(X_RG.p.z() - radius) > kTiny || side * X_RG.p.y() <= 0) {
      attributes.Error("the wheel '" + link.name + "' must touch the floor z = 0 at x = 0, " +
                       (side > 0 ? "left (y > 0)" : "right (y < 0)") +
                       " of the model's origin; its centre is at " + FormatNumber(X_RG.p.x()) + " " +
                       FormatNumber(X_RG.p.y()) + " " + FormatNumber(X_RG.p.z()) + ", its radius " +
                       FormatNumber(radius));
    }
    contact_y_[side > 0 ? 0 : 1] = X_RG.p.y();
    return radius;
  }

  void ReadDrive(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    const std::optional<int> left = FindJoint(attributes, "left_joint");
    const std::optional<int> right = FindJoint(attributes, "right_joint");
    const bool steers =
        element.Attribute("steer_left") != nullptr || element.Attribute("steer_right") != nullptr;
    const std::optional<int> steer_left = steers ? FindJoint(attributes, "steer_left") : std::nullopt;
    const std::optional<int> steer_right = steers ? FindJoint(attributes, "steer_right") : std::nullopt;
    attributes.Finish();
    if (!left || !right || (steers && (!steer_left || !steer_right))) return;
    if (*left == *right) {
      attributes.Error("left_joint and right_joint are the same");
      return;
    }
    for (const int joint : {*left, *right}) {
      if (robot_.FindCoupling(joint) == nullptr) continue;
      attributes.Error("the joint '" + robot_.joints[static_cast<std::size_t>(joint)].name +
                       "' follows another (<mimic> or gearbox): a wheel of a drive has its own motor");
    }
    const JointModel& left_joint = robot_.joints[static_cast<std::size_t>(*left)];
    const JointModel& right_joint = robot_.joints[static_cast<std::size_t>(*right)];
    const std::optional<double> left_radius = CheckWheel(attributes, left_joint, 1);
    const std::optional<double> right_radius = CheckWheel(attributes, right_joint, -1);
    if (!left_radius || !right_radius) return;
    if (std::abs(*left_radius - *right_radius) > kTiny || std::abs(contact_y_[0] + contact_y_[1]) > kTiny) {
      attributes.Error("both wheels must have the same radius and distance from the middle");
    }
    for (const JointModel* joint : {&left_joint, &right_joint}) {
      if (!(joint->max_effort > 0) || !std::isfinite(joint->max_effort) || joint->max_effort > 1e6) {
        attributes.Error("the joint '" + joint->name +
                         "' needs <limit><effort>: its motor's torque in N m, above 0");
      }
      if (!(joint->max_velocity > 0) || !std::isfinite(joint->max_velocity) || joint->max_velocity > 1e4) {
        attributes.Error("the joint '" + joint->name +
                         "' needs <limit><velocity>: its top speed in rad/s, above 0");
      }
    }
    DriveModel drive{.wheel_radius_m = *left_radius,
                     .track_m = contact_y_[0] - contact_y_[1],
                     .max_wheel_speed_rad_s = std::min(left_joint.max_velocity, right_joint.max_velocity),
                     .max_torque_nm = std::min(left_joint.max_effort, right_joint.max_effort)};
    if (steers) drive.steering = ReadSteering(attributes, *steer_left, *steer_right);
    robot_.actuators.push_back({"", {*left, *right}, drive});
  }

  DriveModel::Steering ReadSteering(XmlAttributes& attributes, int left, int right) {
    const JointModel* const joints[] = {&robot_.joints[static_cast<std::size_t>(left)],
                                        &robot_.joints[static_cast<std::size_t>(right)]};
    DriveModel::Steering steering;
    steering.joints = {left, right};
    steering.wheelbase_m = joints[0]->p_RJ.x();
    steering.half_track_m = joints[0]->p_RJ.y();
    double angle_rad = std::numbers::pi / 3;  // beyond this the wheels only drag
    for (const JointModel* joint : joints) {
      const bool has_motor = joint->max_effort > 0 && std::isfinite(joint->max_effort) &&
                             joint->max_velocity > 0 && std::isfinite(joint->max_velocity);
      if (joint->kind != JointModel::Kind::kHinge || joint->axis_R.z() < 1 - 1e-9 || !has_motor) {
        attributes.Error("the joint '" + joint->name +
                         "' must turn about 0 0 1 of the model and needs <limit><effort> and <velocity>");
      }
      angle_rad = std::min({angle_rad, -joint->lower, joint->upper});
    }
    if (!(steering.wheelbase_m > kTiny) || !(steering.half_track_m > kTiny) ||
        std::abs(joints[1]->p_RJ.x() - steering.wheelbase_m) > kTiny ||
        std::abs(joints[1]->p_RJ.y() + steering.half_track_m) > kTiny) {
      attributes.Error(
          "the axes of steer_left and steer_right must stand before the axle (x > 0), at the "
          "same distance left and right of the middle");
    }
    // The inner wheel turns most.
    const double tangent = portable::Tan(angle_rad);
    steering.max_curvature_1_m = tangent / (steering.wheelbase_m + steering.half_track_m * tangent);
    return steering;
  }

  ActuatorModel* Drive() {
    for (ActuatorModel& actuator : robot_.actuators) {
      if (actuator.is_drive()) return &actuator;
    }
    return nullptr;
  }

  void ReadModule(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    attributes.Require("type");
    const std::optional<std::string> type = attributes.Text("type");
    const std::string name = attributes.Text("name").value_or(type.value_or(""));
    attributes.Finish();
    if (!type) return;
    CheckModuleName(attributes, name);
    const std::vector<ModuleModel> modules = robot_.modules();
    if (modules.size() >= kMaxModules) {
      attributes.Error("a robot has at most " + std::to_string(kMaxModules) + " modules: leave some out");
      return;
    }
    for (const ModuleModel& module : modules) {
      if (module.name == name)
        attributes.Error("there are two modules '" + name + "': give one another name");
    }
    if (*type == "joints") {
      attributes.Error("joints need no module: <coopdyn:group name=\"arm\" joints=\"…\"/> makes one");
      return;
    }
    if (*type == "muscles" || *type == "thrusters") {
      attributes.Error(*type + " need no module: <coopdyn:" + type->substr(0, type->size() - 1) +
                       " …/> makes one");
      return;
    }
    if (*type != "motors") {
      sensors_.AddModule(attributes, *type, name);
      return;
    }
    ActuatorModel* const drive = Drive();
    if (drive != nullptr && !drive->module.empty()) {
      attributes.Error("there are two modules of type 'motors': keep one");
    } else if (drive != nullptr) {
      drive->module = name;
    } else if (!diagnostics_.has_errors()) {
      attributes.Error("a module 'motors' needs <coopdyn:drive>: write it above");
    }
  }

  const std::string& file_;
  const Assembly& assembly_;
  RobotModel& robot_;
  Diagnostics& diagnostics_;
  SensorReader sensors_{file_, robot_, assembly_, diagnostics_};
  double contact_y_[2] = {0, 0};  // of the left and the right wheel
};

}  // namespace

bool TakesRobotColor(const XMLElement& visual, const std::string& file, Diagnostics& diagnostics) {
  const char* value = visual.Attribute("coopdyn:color");
  if (value == nullptr) return false;
  if (std::string_view(value) == "robot") return true;
  diagnostics.Error({file, visual.GetLineNum()}, std::string("coopdyn:color can only be \"robot\", not \"") +
                                                     value + "\"; other colours go into <material><diffuse>");
  return false;
}

void ReadExtension(const XMLElement& model, const std::string& file, const Assembly& assembly,
                   RobotModel& robot, Diagnostics& diagnostics) {
  ExtensionReader(file, assembly, robot, diagnostics).Read(model);
}

}  // namespace coopdyn
