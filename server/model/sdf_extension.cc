// SPDX-License-Identifier: MIT
#include "server/model/sdf_extension.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <variant>

#include "server/model/values.h"
#include "server/model/xml_attributes.h"

namespace coopdyn {

namespace {

using tinyxml2::XMLElement;

constexpr double kTiny = 1e-6;  // m; contact points of wheels are exact to this
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaxLength_m = 1e5;

/// What `<coopdyn:distance_sensors>` says for all its sectors, or one sector for itself.
struct SectorDefaults {
  std::optional<double> radius_m, height_m;
  double opening_rad = 0;
  int rays = 1;
  double max_range_m = 0;
  double noise_stddev_m = 0;
};

/// In the order of their ports.
const std::vector<std::string>& ModuleTypes() {
  static const std::vector<std::string> kTypes = {"motors", "distance", "target", "pose", "neighbours"};
  return kTypes;
}

class ExtensionReader {
 public:
  ExtensionReader(const std::string& file, std::span<const double> max_speeds, RobotModel& robot,
                  Diagnostics& diagnostics)
      : file_(file), max_speeds_(max_speeds), robot_(robot), diagnostics_(diagnostics) {}

  void Read(const XMLElement& model) {
    const std::vector<std::string> known = {"coopdyn:drive", "coopdyn:distance_sensors",
                                            "coopdyn:target_sensor", "coopdyn:neighbours", "coopdyn:module"};
    std::set<std::string> seen;
    for (const XMLElement* child = model.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const std::string name = child->Name();
      if (!name.starts_with("coopdyn:")) continue;
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        diagnostics_.Error({file_, child->GetLineNum()},
                           "unknown element <" + name + ">" + DidYouMean(name, known));
        continue;
      }
      if (!seen.insert(name).second && name != "coopdyn:module") {
        diagnostics_.Error({file_, child->GetLineNum()}, "<" + name + "> stands here twice: keep one");
        continue;
      }
      if (name == "coopdyn:drive") ReadDrive(*child);
      if (name == "coopdyn:distance_sensors") ReadDistanceSensors(*child);
      if (name == "coopdyn:target_sensor") ReadTargetSensor(*child);
      if (name == "coopdyn:neighbours") ReadNeighbours(*child);
      if (name == "coopdyn:module") ReadModule(*child);
    }
    CheckModules(model);
  }

 private:
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

  /// Radius and contact point of the wheel on `joint`; nothing if it is no wheel of a drive (then reported).
  std::optional<double> CheckWheel(XmlAttributes& attributes, const JointModel& joint, double side) {
    const LinkModel& link = robot_.links[static_cast<std::size_t>(joint.child)];
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
    attributes.Finish();
    if (!left || !right) return;
    if (*left == *right) {
      attributes.Error("left_joint and right_joint are the same");
      return;
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
      if (!(joint->max_effort_nm > 0) || !std::isfinite(joint->max_effort_nm) || joint->max_effort_nm > 1e6) {
        attributes.Error("the joint '" + joint->name +
                         "' needs <limit><effort>: its motor's torque in N m, above 0");
      }
      const double speed = max_speeds_[static_cast<std::size_t>(joint - robot_.joints.data())];
      if (!(speed > 0) || !std::isfinite(speed) || speed > 1e4) {
        attributes.Error("the joint '" + joint->name +
                         "' needs <limit><velocity>: its top speed in rad/s, above 0");
      }
    }
    const DriveModel drive{.wheel_radius_m = *left_radius,
                           .track_m = contact_y_[0] - contact_y_[1],
                           .max_wheel_speed_rad_s = std::min(max_speeds_[static_cast<std::size_t>(*left)],
                                                             max_speeds_[static_cast<std::size_t>(*right)]),
                           .max_torque_nm = std::min(left_joint.max_effort_nm, right_joint.max_effort_nm)};
    robot_.actuators.push_back({"", {*left, *right}, drive});
  }

  SectorDefaults ReadSectorAttributes(XmlAttributes& attributes, SectorDefaults values) {
    if (auto v = attributes.Number("radius", 0, kMaxLength_m)) values.radius_m = v;
    if (auto v = attributes.Number("height", 0, kMaxLength_m)) values.height_m = v;
    if (auto v = attributes.Number("opening_deg", 0, 360)) values.opening_rad = *v * kDegree;
    if (auto v = attributes.Integer("rays", 1, 1000)) values.rays = *v;
    if (auto v = attributes.Number("max_range", 1e-3, kMaxLength_m)) values.max_range_m = *v;
    if (auto v = attributes.Number("noise_stddev", 0, kMaxLength_m)) values.noise_stddev_m = *v;
    return values;
  }

  void ReadDistanceSensors(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    const SectorDefaults common = ReadSectorAttributes(attributes, {});
    attributes.Finish();
    for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (std::string_view(child->Name()) == "coopdyn:sector") {
        ReadSector(*child, common);
      } else {
        diagnostics_.Error({file_, child->GetLineNum()}, std::string("unknown element <") + child->Name() +
                                                             ">; did you mean 'coopdyn:sector'?");
      }
    }
    if (robot_.distance_sensors.empty())
      attributes.Error("write at least one <coopdyn:sector bearing_deg=\"…\"/>");
    std::stable_sort(robot_.distance_sensors.begin(), robot_.distance_sensors.end(),
                     [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
  }

  void ReadSector(const XMLElement& element, const SectorDefaults& common) {
    XmlAttributes attributes(element, file_, diagnostics_);
    const SectorDefaults values = ReadSectorAttributes(attributes, common);
    const std::optional<double> bearing_deg = attributes.Number("bearing_deg", -180, 180);
    const auto pose = attributes.Numbers("pose", 6);
    attributes.Finish();
    DistanceSensorModel sensor;
    if (pose) {
      const std::vector<double>& v = *pose;
      for (const double x : v) {
        if (std::abs(x) > kMaxLength_m) attributes.Error("the pose is too far away");
      }
      sensor.X_RS = {Vector3(v[0], v[1], v[2]), FromRollPitchYaw(v[3], v[4], v[5])};
      sensor.bearing_rad = Heading(sensor.X_RS.q);
      if (bearing_deg) attributes.Error("give either 'pose' or 'bearing_deg', not both");
    } else if (bearing_deg && values.radius_m && values.height_m) {
      sensor.bearing_rad = WrapAngle(*bearing_deg * kDegree);
      const double b = sensor.bearing_rad;
      sensor.X_RS = {
          Vector3(*values.radius_m * std::cos(b), *values.radius_m * std::sin(b), *values.height_m),
          FromRollPitchYaw(0, 0, b)};
    } else {
      attributes.Error(
          "needs 'bearing_deg' with 'radius' and 'height' (here or in <coopdyn:distance_sensors>), or "
          "'pose'");
    }
    if (values.max_range_m <= 0)
      attributes.Error("needs 'max_range' in m, here or in <coopdyn:distance_sensors>");
    if (values.rays == 1 && values.opening_rad > 0) {
      attributes.Error("one ray cannot sample an opening: write rays=\"5\" or opening_deg=\"0\"");
    }
    sensor.opening_rad = values.opening_rad;
    sensor.rays = values.rays;
    sensor.max_range_m = values.max_range_m;
    sensor.noise_stddev_m = values.noise_stddev_m;
    robot_.distance_sensors.push_back(sensor);
  }

  void ReadTargetSensor(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    TargetSensorModel& sensor = robot_.target_sensor;
    if (auto v = attributes.Number("max_range", 1e-3, kMaxLength_m)) sensor.max_range_m = *v;
    if (auto v = attributes.Flag("see_through")) sensor.see_through = *v;
    if (auto v = attributes.Number("distance_noise_stddev", 0, kMaxLength_m))
      sensor.distance_noise_stddev_m = *v;
    if (auto v = attributes.Number("bearing_noise_stddev_deg", 0, 180)) {
      sensor.bearing_noise_stddev_rad = *v * kDegree;
    }
    attributes.Finish();
  }

  void ReadNeighbours(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    attributes.Require("range");
    NeighboursModel& sensor = robot_.neighbours;
    neighbours_ = &element;
    if (auto v = attributes.Number("range", 1e-3, kMaxLength_m)) sensor.range_m = *v;
    sensor.message_range_m = attributes.Number("message_range", 0, kMaxLength_m).value_or(sensor.range_m);
    if (auto v = attributes.Number("loss", 0, 1)) sensor.loss = *v;
    if (auto v = attributes.Integer("delay_steps", 0, NeighboursModel::kMaxDelaySteps))
      sensor.delay_steps = *v;
    if (auto v = attributes.Number("distance_noise_stddev", 0, kMaxLength_m))
      sensor.distance_noise_stddev_m = *v;
    if (auto v = attributes.Number("bearing_noise_stddev_deg", 0, 180)) {
      sensor.bearing_noise_stddev_rad = *v * kDegree;
    }
    attributes.Finish();
  }

  void ReadModule(const XMLElement& element) {
    XmlAttributes attributes(element, file_, diagnostics_);
    attributes.Require("type");
    const std::vector<std::string>& types = ModuleTypes();
    const std::optional<std::string> type = attributes.Text("type");
    const std::string name = attributes.Text("name").value_or(type.value_or(""));
    attributes.Finish();
    if (!type) return;
    if (std::find(types.begin(), types.end(), *type) == types.end()) {
      attributes.Error("unknown module type '" + *type + "'" + DidYouMean(*type, types));
      return;
    }
    const bool good = !name.empty() && name.size() <= 32 && name.front() >= 'a' && name.front() <= 'z' &&
                      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
    if (!good)
      attributes.Error("a module's name is made of a-z, 0-9 and _, a letter first; not '" + name + "'");
    for (const ModuleModel& module : robot_.modules) {
      if (module.name == name)
        attributes.Error("there are two modules '" + name + "': give one another name");
      if (module.type == *type) attributes.Error("there are two modules of type '" + *type + "': keep one");
    }
    robot_.modules.push_back({*type, name});
    if (*type == "motors") {
      if (!robot_.actuators.empty()) {
        robot_.actuators.front().module = name;
      } else if (!diagnostics_.has_errors()) {
        attributes.Error("a module 'motors' needs <coopdyn:drive> before it");
      }
    }
    if (*type == "distance" && robot_.distance_sensors.empty() && !diagnostics_.has_errors()) {
      attributes.Error("a module 'distance' needs <coopdyn:distance_sensors> before it");
    }
    if (*type == "neighbours" && neighbours_ == nullptr && !diagnostics_.has_errors()) {
      attributes.Error("a module 'neighbours' needs <coopdyn:neighbours range=\"1\"/> before it");
    }
  }

  /// Ports are given in this order.
  void CheckModules(const XMLElement& model) {
    const std::vector<std::string>& order = ModuleTypes();
    std::stable_sort(robot_.modules.begin(), robot_.modules.end(), [&](const auto& a, const auto& b) {
      return std::find(order.begin(), order.end(), a.type) < std::find(order.begin(), order.end(), b.type);
    });
    if (robot_.modules.empty()) {
      diagnostics_.Error({file_, model.GetLineNum()},
                         "the robot has no module: write e.g. <coopdyn:module type=\"motors\"/>");
    }
    const bool has_neighbours = std::any_of(robot_.modules.begin(), robot_.modules.end(),
                                            [](const auto& module) { return module.type == "neighbours"; });
    if (neighbours_ != nullptr && !has_neighbours) {
      diagnostics_.Error({file_, neighbours_->GetLineNum()},
                         "<coopdyn:neighbours> needs its module: write <coopdyn:module type=\"neighbours\"/> "
                         "after it");
    }
  }

  const std::string& file_;
  std::span<const double> max_speeds_;  // of the joints, rad/s
  RobotModel& robot_;
  Diagnostics& diagnostics_;
  double contact_y_[2] = {0, 0};  // of the left and the right wheel
  const XMLElement* neighbours_ = nullptr;
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

void ReadExtension(const XMLElement& model, const std::string& file, std::span<const double> max_speeds_rad_s,
                   RobotModel& robot, Diagnostics& diagnostics) {
  ExtensionReader(file, max_speeds_rad_s, robot, diagnostics).Read(model);
}

}  // namespace coopdyn
