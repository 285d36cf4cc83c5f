// SPDX-License-Identifier: MIT
#include "server/app/left_out.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

namespace coopdyn {

namespace {

/// Finds the module that replaces a plug-in; empty if the robot has none.
using FindModule = std::string (*)(const RobotModel& robot);

template <typename Kind>
std::string SensorOf(const RobotModel& robot) {
  const std::size_t found = robot.IndexOf<Kind>();
  return found == robot.sensors.size() ? "" : robot.sensors[found].name;
}

std::string ActuatorOf(const RobotModel& robot, bool (ActuatorModel::*is_kind)() const) {
  for (const ActuatorModel& actuator : robot.actuators) {
    if ((actuator.*is_kind)()) return actuator.module;
  }
  return {};
}
std::string DriveOf(const RobotModel& robot) {
  return ActuatorOf(robot, &ActuatorModel::is_drive);
}
std::string BoardOf(const RobotModel& robot) {
  return ActuatorOf(robot, &ActuatorModel::is_board);
}
std::string ThrustersOf(const RobotModel& robot) {
  return ActuatorOf(robot, &ActuatorModel::is_thrusters);
}

/// A kind of plug-in.
struct PluginRow {
  std::vector<std::string_view> words;  // matches if one is the start of a word in its name
  FindModule module;                    // null: no module replaces it
  std::string_view without;             // why it matters without that module; empty: it does not matter
  std::string_view harmless = {};       // why it does not matter
};

const std::vector<PluginRow>& PluginRows() {
  constexpr std::string_view kNoSensor = "there is no such sensor here; module 'pose' has the true values";
  constexpr std::string_view kOnlyTells = "it only publishes data that any client can read here";
  static const std::vector<PluginRow> rows = {
      {{"joint state", "joint pose pub"}, nullptr, "", kOnlyTells},
      {{"pose publisher", "p3d", "p3 d", "ground truth", "odometry publisher", "world odometry", "tf ",
        "groundtruth"},
       nullptr,
       "",
       kOnlyTells},
      {{"user commands", "scene broadcaster", "physics", "sensors", "contact system", "logical", "gui",
        "level", "log ", "hand of god", "performance", "apply joint force", "apply link wrench", "ros init",
        "ros api", "ros factory", "ros state", "ros properties", "factory"},
       nullptr,
       "",
       "coopdyn itself, or its clients, do this"},
      {{"led", "light", "visual", "particle", "projector", "color", "material", "label", "plot",
        "camera video", "video"},
       nullptr,
       "",
       "it only changes appearance"},
      {{"gps", "navsat", "nav sat", "magnetometer", "mag ", "barometer", "altimeter", "altitude", "air speed",
        "airspeed", "air pressure", "sonar altitude"},
       nullptr,
       kNoSensor},
      {{"imu"}, SensorOf<ImuModel>, "the robot has no IMU here: give a link <sensor type=\"imu\">"},
      {{"laser", "lidar", "ray", "velodyne", "gpu laser", "block laser", "scan"},
       SensorOf<LidarModel>,
       "the robot has no lidar here: give a link <sensor type=\"lidar\">"},
      {{"camera", "kinect", "openni", "depth", "realsense", "optical flow", "opticalflow"},
       SensorOf<CameraModel>,
       "the robot has no camera here: give a link <sensor type=\"camera\">"},
      {{"ft sensor", "ft ", "force torque", "f3d", "f3 d", "wrench"},
       SensorOf<WrenchModel>,
       "the robot has no force sensor here: give a joint <sensor type=\"force_torque\">"},
      {{"bumper", "contact", "touch"},
       SensorOf<ContactModel>,
       "the robot has no bumper here: give a link <sensor type=\"contact\">"},
      {{"sonar", "range"},
       SensorOf<SonarModel>,
       "the robot has no range finder here: give a link <sensor type=\"sonar\">"},
      {{"battery"}, SensorOf<BatteryModel>, "it never runs out: no battery empties here"},
      {{"diff drive", "skid", "ackermann", "tricycle", "planar move", "mecanum", "omni", "velocity control",
        "force based move", "object controller", "differential"},
       DriveOf,
       "the robot has no drive here; coopdyn drives two wheels, or steers (docs/models.md)"},
      {{"multicopter", "motor model", "rotor", "propeller", "thruster", "quadrotor", "uav"},
       ThrustersOf,
       "the robot has no thrusters here, so it will not fly or swim: write <coopdyn:thruster>s"},
      {{"lift drag", "liftdrag", "lift", "drag", "aero", "wing"},
       nullptr,
       "there is no air here: wings and propellers carry nothing"},
      {{"buoyancy", "hydrodynamics", "underwater", "uuv", "wave", "surface", "usv"},
       nullptr,
       "there is no water here: nothing floats, and nothing slows it"},
      {{"wind"}, nullptr, "there is no wind here"},
      {{"ardu", "px4", "mavlink", "groundstation", "autopilot", "gimbal"},
       nullptr,
       "its autopilot is not connected: drive the modules below instead"},
      {{"mimic"}, nullptr, "its joint does not follow: write <mimic> in the joint"},
      {{"gripper", "grasp", "vacuum", "suction", "attach", "detachable"},
       nullptr,
       "only friction holds things"},
      {{"control", "joint", "actuator", "effort", "yarp", "position", "velocity", "hardware"},
       BoardOf,
       "no joint has a motor here: write <effort> and <velocity> in their <limit>s"},
  };
  return rows;
}

constexpr const char* kTunes = "it tunes another solver";

/// The consequence of leaving out an element.
struct ElementRow {
  std::vector<std::string_view> names;
  std::string_view why;
  bool matters;
};

const std::vector<ElementRow>& ElementRows() {
  static const std::vector<ElementRow> rows = {
      {{"material",
        "script",
        "shader",
        "lighting",
        "cast_shadows",
        "castShadows",
        "transparency",
        "emissive",
        "laser_retro",
        "laserRetro",
        "light",
        "background",
        "sky",
        "grid",
        "shadows",
        "fog",
        "roughness",
        "metalness",
        "normal_map",
        "roughness_map",
        "metalness_map",
        "emissive_map",
        "texture",
        "visual",
        "double_sided",
        "render_order",
        "shininess",
        "ambient",
        "diffuse",
        "specular",
        "visibility_flags",
        "origin_visual",
        "particle_emitter",
        "projector",
        "road",
        "meta"},
       "it only changes appearance",
       false},
      {{"gui",
        "audio",
        "state",
        "spherical_coordinates",
        "atmosphere",
        "magnetic_field",
        "frame",
        "version",
        "allow_auto_disable",
        "must_be_loop_joint",
        "RefLink",
        "gazebo_ros",
        "gz_frame_id",
        "ignition_frame_id",
        "frame_id",
        "provideFeedback",
        "provide_feedback",
        "preserveFixedJoint",
        "disableFixedJointLumping",
        "topicName",
        "visualize",
        "lens",
        "save",
        "distortion",
        "orientation_reference_frame",
        "trigger",
        "camera_info_topic",
        "optical_frame_id",
        "static",
        "canRotateThroughContact",
        "noise_model"},
       "it changes nothing that moves or is measured",
       false},
      {{"kp",
        "kd",
        "maxVel",
        "minDepth",
        "maxContacts",
        "max_contacts",
        "max_vel",
        "min_depth",
        "soft_cfm",
        "soft_erp",
        "contact",
        "surface",
        "solver",
        "ode",
        "bullet",
        "dart",
        "simbody",
        "physics",
        "implicitSpringDamper",
        "implicit_spring_damper",
        "stopCfm",
        "stopErp",
        "stop_cfm",
        "stop_erp",
        "cfm_damping",
        "limit",
        "suspension",
        "fudge_factor",
        "fudgeFactor",
        "slip",
        "slip1",
        "slip2",
        "surface_radius",
        "use_surface_radius",
        "stiffness",
        "dissipation",
        "contact_coefficients",
        "lateral_friction",
        "rolling_friction",
        "spinning_friction",
        "inertia_scaling"},
       kTunes,
       false},
      {{"gravity", "turnGravityOff"}, "its links fall like all other links", true},
      {{"self_collide", "selfCollide", "self_collision_checking"},
       "links of one robot go through each other here",
       true},
      {{"velocity_decay", "dampingFactor", "linear_damping", "angular_damping", "velocityDecay"},
       "its links are not slowed down by the air",
       true},
      {{"kinematic"}, "forces move it, like everything that moves", true},
      {{"enable_wind", "wind"}, "there is no wind here", true},
      {{"actor"}, "there are no actors here", true},
      {{"population"}, "the things that it would place are missing", true},
      {{"loop_joint"}, "the loop stays open", true},
      {{"force_element"}, "its force is missing", true},
      {{"collision_filter_group", "drake:collision_filter_group"},
       "links of one robot never collide with each other here, but with all else",
       false},
      {{"battery"}, "it never runs out: no battery empties here", true},
      {{"fluid_added_mass", "buoyancy"}, "there is no water here", true},
      {{"mujoco"}, "only MuJoCo's URDF reader uses it", false},
      {{"mu_viscous", "mu_coulomb", "command_effort", "current", "gear_velocity", "K", "D"},
       "only its maker's programs read it; URDF has <dynamics damping friction>",
       false},
  };
  return rows;
}

/// "JointStatePublisher" and "joint-state-publisher" as " joint state publisher ".
std::string WordsOf(std::string_view name) {
  std::string words = " ";
  bool was_lower = false;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) == 0) {
      if (words.back() != ' ') words += ' ';
    } else {
      if (std::isupper(letter) != 0 && was_lower) words += ' ';
      words += static_cast<char>(std::tolower(letter));
    }
    was_lower = std::islower(letter) != 0;
  }
  return words + " ";
}

/// The text between the first `open` and the next `close`.
std::string Between(const std::string& text, char open, char close) {
  const std::size_t first = text.find(open);
  if (first == std::string::npos) return {};
  return text.substr(first + 1, text.find(close, first + 1) - first - 1);
}

Consequence OfPlugin(const std::string& file, const RobotModel* robot) {
  const std::string words = WordsOf(file);
  const auto fits = [&](std::string_view word) {
    return words.find(" " + std::string(word)) != std::string::npos;
  };
  for (const PluginRow& row : PluginRows()) {
    if (std::ranges::none_of(row.words, fits)) continue;
    if (row.without.empty()) return {false, std::string(row.harmless)};
    const std::string module = row.module == nullptr || robot == nullptr ? "" : row.module(*robot);
    if (!module.empty()) return {false, "module '" + module + "' is there anyway"};
    return {true, std::string(row.without)};
  }
  return {true, "coopdyn runs no third-party plug-ins, so its effect is missing"};
}

/// URDF's own <sensor>, which <gazebo> usually repeats.
Consequence OfUrdfSensor(const RobotModel* robot) {
  const bool has_sensor = robot != nullptr && std::ranges::any_of(robot->sensors, [](const SensorModel& one) {
                            return one.type() != PoseModel::kType;
                          });
  if (has_sensor) return {false, "the sensors in <gazebo> count"};
  return {true, "sensors stand in <gazebo reference=\"LINK\">"};
}

}  // namespace

Consequence ConsequenceOf(const std::string& what, const RobotModel* robot) {
  if (what.starts_with("plug-in ")) return OfPlugin(Between(what, '\'', '\''), robot);
  if (what.starts_with("a second")) return {true, "the robot uses only the first one"};
  if (!what.starts_with('<')) return {true, ""};
  const std::string element = Between(what, '<', '>');
  const std::string name = element.substr(0, element.find(' '));
  if (name == "plugin") return {false, "it only says where Gazebo publishes"};
  if (what == "<sensor> in <robot>") return OfUrdfSensor(robot);
  if (name == "sensor") return {true, "there is no such sensor here"};
  if (what.ends_with("in <bullet>")) return {false, kTunes};
  if (name == "collision") {
    if (what.ends_with("in <gazebo reference>")) return {false, kTunes};
    return {true, "that part collides with nothing"};
  }
  for (const ElementRow& row : ElementRows()) {
    if (std::ranges::find(row.names, name) != row.names.end()) return {row.matters, std::string(row.why)};
  }
  return {true, "coopdyn does not know it, so its effect is missing"};
}

Consequence ConsequenceOf(const Diagnostic& warning, const RobotModel* robot) {
  if (!warning.what.empty()) return ConsequenceOf(warning.what, robot);
  constexpr std::pair<std::string_view, const char*> kSaid[] = {
      {"is not used beside a damper", "it moves more easily than intended"},
      {"has no motor", "nothing can drive it here"},
      {"give it no motor", "nothing can drive it here"},
      {"it has no stops", "it turns further than intended"},
      {"it turns freely", "nothing holds or drives it here"},
      {"has no module 'motors'", "nothing can drive it here"},
      {"does not steer", "it only drives straight ahead"},
  };
  constexpr std::pair<std::string_view, const char*> kHarmless[] = {
      {"what only decorates the world is left out", "it only changes appearance"},
      {"' of 'integrator' of <option>", "coopdyn has an integrator of its own"},
  };
  for (const auto& [text, why] : kHarmless) {
    if (warning.text.find(text) != std::string::npos) return {false, why};
  }
  for (const auto& [text, why] : kSaid) {
    if (warning.text.find(text) != std::string::npos) return {true, why};
  }
  return {true, ""};
}

}  // namespace coopdyn
