// SPDX-License-Identifier: MIT
// The parts of reading a robot's SDF that use the raw XML, with line numbers: checks that libsdformat omits
// (sdf_check.cc), coopdyn's own elements in the namespace `coopdyn:` (docs/formats.md), i.e. the drive,
// modules, visuals in the robot's colour (sdf_extension.cc) and sensors (sdf_sensors.h), and SDF's fixed
// joints (sdf_weld.cc).
#pragma once

#include <cstddef>
#include <optional>
#include <sdf/Element.hh>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/robot_model.h"

namespace tinyxml2 {
class XMLElement;
}

namespace coopdyn {

// Limits beyond any robot's size. libsdformat's time grows with the square of some of these numbers.
inline constexpr std::size_t kMaxModelBytes = 4u << 20;
inline constexpr int kMaxModelParts = 300;  // of each kind: links, joints, frames
inline constexpr int kMaxModelElements = 10'000;
inline constexpr int kMaxWorldElements = 100'000;
inline constexpr int kMaxElementAttributes = 64;
inline constexpr double kMaxMotorEffort = 1e6, kMaxMotorVelocity = 1e4;  // N m or N, rad/s or m/s

/// Reports an error and returns false if the `text` of a model, or one of its elements, is too long. Call it
/// before parsing.
bool IsModelSize(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// Reports an error and returns false if there are too many parts or elements below `root`.
bool IsModelCount(const tinyxml2::XMLElement& root, const std::string& file, Diagnostics& diagnostics);

/// Compares the elements below `root` (`<sdf>`) with SDF's own schema in `description`. Errors: unknown
/// elements and attributes, missing required attributes, unreadable or non-finite values, shapes that coopdyn
/// cannot simulate. Warnings: SDF elements that coopdyn does not use. Ignores elements of other namespaces.
void CheckSdf(const tinyxml2::XMLElement& root, const sdf::ElementPtr& description, const std::string& file,
              Diagnostics& diagnostics);

/// True if the reader uses elements `name` in `parent`.
bool IsUsedElement(std::string_view parent, const std::string& name);

/// Reads the drive of `robot`, with its module `motors`, from the element that replaces a Gazebo drive plugin
/// (gazebo_plugins.cc). Warns about parts that do not fit.
void AdoptDrive(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);
/// The same for a controller plugin of one joint, which then has a motor.
void AdoptJoint(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// A `<sensor>` of SDF.
struct SdfSensor {
  std::string name;   // as in the file
  std::string scope;  // prefix of its model's names
  std::string host;   // the link or joint that contains it, without prefix, as named for libsdformat
  std::string joint;  // the joint's original name
  bool on_joint = false;
  std::string module;  // name of its module
  SensorKind kind;
  SensorTiming timing;
  std::vector<std::string> collisions;  // of a contact sensor
  std::string wrench_frame;             // child, parent or sensor
  Pose X_SC;                            // pose of a camera in the sensor
  SourceLine where;
  std::size_t link = 0;  // index among the file's links
  Pose X_FS;             // pose in that link, or in the joint
};
/// The `<sensor>`s in `model` (`<model>`) and its nested models, still without their places. Reports errors.
std::vector<SdfSensor> ReadSensorElements(const tinyxml2::XMLElement& model, const std::string& file,
                                          Diagnostics& diagnostics);
/// A module name made from a name of another program: lower case, invalid characters become _.
std::string ModuleName(std::string_view name);
/// True if coopdyn simulates this `type` of `<sensor>`.
bool IsUsedSensor(std::string_view type);

/// A fixed joint between two links, or between the world and a link.
struct FixedJoint {
  static constexpr int kWorld = -1;
  int parent = 0, child = 0;  // index into links; parent may be kWorld
  int line = 0;
  std::string name{};
};
/// SDF's gearbox: the angle of `child` about `axis2_R` is -ratio · the angle of `parent` about `axis_R`, both
/// relative to `reference`.
struct Gearbox {
  std::string name, parent, child, reference;  // the gearbox's name, and names of links
  Vector3 axis_R, axis2_R;
  double ratio = 1;
  int line = 0;
};
/// Reads the couplings of `robot`: the `<mimic>`s of `model` (`<model>`), as written by GatherMimics(), and
/// `gearboxes`. `fixed`: joints that cannot move. `is_foreign`: leave out wrong couplings with a warning.
/// @pre `robot` has its links, joints and frames
void ReadCouplings(const tinyxml2::XMLElement& model, std::span<const Gearbox> gearboxes,
                   std::span<const FixedJoint> fixed, bool is_foreign, const std::string& file,
                   RobotModel& robot, Diagnostics& diagnostics);

/// The lines of a model's links and joints in its file.
struct ModelLines {
  std::vector<int> links, joints;
};
/// Adds a body's mass and inertia to `to`. `inertia_kg_m2`: about the body's centre of mass, along the axes
/// of X_LI.
void AddMass(double added_kg, const Vector3& inertia_kg_m2, const Pose& X_LI, LinkModel& to);
/// The two links of each muscle in `model` (`<model>`), as indices into the links of `robot` before welding.
/// Leaves out muscles with unknown links.
std::vector<std::pair<int, int>> TiesOf(const tinyxml2::XMLElement& model, const RobotModel& robot);
/// Merges links that `fixed` joints hold together, and makes the base the first link: the link fixed to the
/// world, else the first link that is no joint's child. Links that neither joints nor `ties` connect to the
/// base are an error, or a warning in a `foreign` model. `lines`: of `robot` as passed.
void WeldLinks(std::span<const FixedJoint> fixed, std::vector<std::pair<int, int>> ties,
               const ModelLines& lines, const std::string& file, RobotModel& robot, bool foreign,
               Diagnostics& diagnostics);

/// A link of the model's file, before fixed joints merged it into another.
struct FileLink {
  std::string name;
  std::vector<std::string> collisions{};  // their names
  double mass_kg = 0;
  Pose X_FI{};
  Vector3 inertia_kg_m2 = Vector3::Zero();
  std::size_t first_collision = 0;  // among LinkModel::collisions of its link
};
/// A joint of the model's file, including fixed ones.
struct FileJoint {
  std::string name;
  int parent = 0, child = 0;  // index into Assembly::links; parent may be FixedJoint::kWorld
  Pose X_FJ;                  // in the child
};
/// The file's parts from which a robot was assembled. robot.frames[i] is the place of links[i].
struct Assembly {
  std::vector<FileLink> links;
  std::vector<FileJoint> joints;
  std::vector<SdfSensor> sensors{};  // SDF's own
};
/// Sets FileLink::first_collision for the links of `assembly`.
void FindCollisions(const RobotModel& robot, Assembly& assembly);

/// True if `visual` (`<visual>`) has coopdyn:color="robot". Reports other values as errors.
bool TakesRobotColor(const tinyxml2::XMLElement& visual, const std::string& file, Diagnostics& diagnostics);

/// Reads coopdyn's elements in `model` (`<model>`) and the sensors of `assembly` into `robot`. @pre its links
/// and joints are complete
void ReadExtension(const tinyxml2::XMLElement& model, const std::string& file, const Assembly& assembly,
                   RobotModel& robot, Diagnostics& diagnostics);

/// Reads a `<coopdyn:drivetrain>` into `joint`. @pre the joint's axis is complete
void ReadDriveTrain(const tinyxml2::XMLElement& element, const std::string& file, JointModel& joint,
                    Diagnostics& diagnostics);
/// Reads a `<coopdyn:muscle>` into `robot`. @pre joints, links and groups of `robot` are complete
void ReadMuscle(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// Reads a `<coopdyn:thruster>` into `robot`. @pre as for ReadMuscle()
void ReadThruster(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                  Diagnostics& diagnostics);
/// Makes a thruster from the rotor of a Gazebo plugin. Warns about parts that do not fit.
void AdoptRotor(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// Reads attributes of one XML element by name, and reports those that were never read. `element` and
/// `diagnostics` must outlive it. One thread.
class XmlAttributes {
 public:
  XmlAttributes(const tinyxml2::XMLElement& element, std::string file, Diagnostics& diagnostics);

  /// The attribute's text; nullopt if missing.
  std::optional<std::string> Text(const std::string& name);
  /// A finite number in [min, max]; nullopt if missing or invalid (then reported).
  std::optional<double> Number(const std::string& name, double min, double max);
  std::optional<int> Integer(const std::string& name, int min, int max);
  /// true or false.
  std::optional<bool> Flag(const std::string& name);
  /// `count` finite numbers.
  std::optional<std::vector<double>> Numbers(const std::string& name, std::size_t count);

  void Error(const std::string& text);
  /// Reports an error if attribute `name` is missing.
  void Require(const std::string& name);
  /// Reports the attributes that were never read.
  void Finish();
  SourceLine where() const;

 private:
  const tinyxml2::XMLElement& element_;
  std::string file_;
  Diagnostics& diagnostics_;
  std::vector<std::string> known_;
};

/// Adds `joint`, a muscle, thruster or limiter, to the actuator of its `kind` with the module name `module`.
/// Reports an error if that is impossible.
void AddToModule(XmlAttributes& attributes, JointModel joint, const decltype(ActuatorModel::kind)& kind,
                 const std::string& module, RobotModel& robot);
/// Reports an invalid module name.
void CheckModuleName(XmlAttributes& attributes, const std::string& name);
/// Reads a `<coopdyn:group>`, a control board. @pre joints, links and drive of `robot` are complete
void ReadGroup(XmlAttributes& attributes, RobotModel& robot, Diagnostics& diagnostics);
/// Makes a control board of the joints that a `<ros2_control>` commands, except joints of other actuators.
void AdoptGroup(XmlAttributes& attributes, RobotModel& robot);
/// If the robot has no groups, adds the group `joints` of all joints that have an effort and a velocity and
/// do not belong to a drive, if any.
void AddDefaultGroup(RobotModel& robot);

}  // namespace coopdyn
