// SPDX-License-Identifier: MIT
// The parts of reading a robot's SDF: what libsdformat lets pass (sdf_check.cc), and our own elements in the
// namespace `coopdyn:` (docs/formats.md): the drive, modules, which visuals take the robot's colour
// (sdf_extension.cc) and sensors (sdf_sensors.h), and the fixed joints of SDF (sdf_weld.cc). All with lines,
// from the raw XML.
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

/// More than any robot has; what libsdformat takes for a model grows with the square of some of them.
inline constexpr std::size_t kMaxModelBytes = 4u << 20;
inline constexpr int kMaxModelParts = 300;  // of each kind: links, joints, frames
inline constexpr int kMaxModelElements = 10'000;
inline constexpr int kMaxWorldElements = 100'000;
inline constexpr int kMaxElementAttributes = 64;
inline constexpr double kMaxMotorEffort = 1e6, kMaxMotorVelocity = 1e4;  // N m or N, rad/s or m/s

/// False, and reported, if the `text` of a model, or one of its elements, is longer than one can be. Before
/// it is parsed.
bool IsModelSize(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// False, and reported, if there is more of something below `root` than one robot has.
bool IsModelCount(const tinyxml2::XMLElement& root, const std::string& file, Diagnostics& diagnostics);

/// Compares the elements below `root` (`<sdf>`) with SDF's own description in `description`. Errors: unknown
/// elements and attributes, missing required attributes, unreadable or non-finite values, shapes that we
/// cannot simulate. Warnings: what SDF knows and coopdyn does not use. Elements of other namespaces are left
/// to their owners.
void CheckSdf(const tinyxml2::XMLElement& root, const sdf::ElementPtr& description, const std::string& file,
              Diagnostics& diagnostics);

/// Whether the reader uses elements `name` in `parent`.
bool IsUsedElement(std::string_view parent, const std::string& name);

/// Reads what a drive plug-in of Gazebo says (gazebo.cc): the drive of `robot`, with its module `motors`.
/// What does not fit is a warning.
void AdoptDrive(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);
/// The same of a controller of one joint, which then has a motor.
void AdoptJoint(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// A `<sensor>` of SDF.
struct SdfSensor {
  std::string name;   // as in the file
  std::string scope;  // prefix of the names of its model
  std::string host;   // the link or joint in which it stands, without the prefix, as libsdformat knows it
  std::string joint;  // as everybody else knows it
  bool on_joint = false;
  std::string module;  // what its module is to be called
  SensorKind kind;
  SensorTiming timing;
  std::vector<std::string> collisions;  // of a contact sensor
  std::string wrench_frame;             // child, parent or sensor
  Pose X_SC;                            // of a camera in it
  SourceLine where;
  std::size_t link = 0;  // of the file
  Pose X_FS;             // in that link; in its joint
};
/// The `<sensor>`s in `model` (`<model>`) and those inside it; what is wrong with them is reported. Their
/// places are not known yet.
std::vector<SdfSensor> ReadSensorElements(const tinyxml2::XMLElement& model, const std::string& file,
                                          Diagnostics& diagnostics);
/// What a module is called after something of another program: lower case, other characters as _.
std::string ModuleName(std::string_view name);
/// Whether coopdyn has such a `type` of `<sensor>`.
bool IsUsedSensor(std::string_view type);

/// A fixed joint between two links, or of the world and a link.
struct FixedJoint {
  static constexpr int kWorld = -1;
  int parent = 0, child = 0;  // index into links; parent may be kWorld
  int line = 0;
  std::string name{};
};
/// SDF's gearbox: the angle of `child` about `axis2_R` is -ratio · the angle of `parent` about `axis_R`, both
/// against `reference`.
struct Gearbox {
  std::string name, parent, child, reference;  // of links
  Vector3 axis_R, axis2_R;
  double ratio = 1;
  int line = 0;
};
/// Reads the couplings of `robot`: the `<mimic>`s of `model` (`<model>`), as GatherMimics() writes them, and
/// `gearboxes`. `robot` has its links, joints and frames. `fixed`: joints that cannot move.
/// `is_foreign`: what is wrong is left out, with a warning.
void ReadCouplings(const tinyxml2::XMLElement& model, std::span<const Gearbox> gearboxes,
                   std::span<const FixedJoint> fixed, bool is_foreign, const std::string& file,
                   RobotModel& robot, Diagnostics& diagnostics);

/// Where a model's links and joints stand in its file.
struct ModelLines {
  std::vector<int> links, joints;
};
/// Adds to the mass of `to` that of a body: `inertia_kg_m2` about its centre of mass, along the axes of X_LI.
void AddMass(double added_kg, const Vector3& inertia_kg_m2, const Pose& X_LI, LinkModel& to);
/// The two links of each muscle in `model` (`<model>`), index into the links of `robot`, before they are
/// welded; what names others is left out.
std::vector<std::pair<int, int>> TiesOf(const tinyxml2::XMLElement& model, const RobotModel& robot);
/// Makes one link of those that `fixed` holds together, and the base the first of all: what is fixed to the
/// world, else the first link that is no joint's child. What does not hang together, be it by `ties`, is an
/// error, in a `foreign` model a warning. `lines`: of `robot` as given.
void WeldLinks(std::span<const FixedJoint> fixed, std::vector<std::pair<int, int>> ties,
               const ModelLines& lines, const std::string& file, RobotModel& robot, bool foreign,
               Diagnostics& diagnostics);

/// A link of the model's file, before fixed joints made it a part of another.
struct FileLink {
  std::string name;
  std::vector<std::string> collisions{};  // their names
  double mass_kg = 0;
  Pose X_FI{};
  Vector3 inertia_kg_m2 = Vector3::Zero();
  std::size_t first_collision = 0;  // among LinkModel::collisions of its link
};
/// A joint of the model's file, the fixed ones too.
struct FileJoint {
  std::string name;
  int parent = 0, child = 0;  // index into Assembly::links; parent may be FixedJoint::kWorld
  Pose X_FJ;                  // in the child
};
/// Of what a robot was put together. robot.frames[i] says where links[i] has gone.
struct Assembly {
  std::vector<FileLink> links;
  std::vector<FileJoint> joints;
  std::vector<SdfSensor> sensors{};  // SDF's own
};
/// Says where the collisions of the file's links are in the links of `robot`.
void FindCollisions(const RobotModel& robot, Assembly& assembly);

/// Whether `visual` (`<visual>`) says coopdyn:color="robot". Another value is an error.
bool TakesRobotColor(const tinyxml2::XMLElement& visual, const std::string& file, Diagnostics& diagnostics);

/// Reads our elements in `model` (`<model>`), and the sensors of `assembly`, into `robot`, whose links and
/// joints are complete.
void ReadExtension(const tinyxml2::XMLElement& model, const std::string& file, const Assembly& assembly,
                   RobotModel& robot, Diagnostics& diagnostics);

/// Reads a `<coopdyn:drivetrain>` of `joint`, whose axis is complete.
void ReadDriveTrain(const tinyxml2::XMLElement& element, const std::string& file, JointModel& joint,
                    Diagnostics& diagnostics);
/// Reads a `<coopdyn:muscle>` of `robot`, whose joints, links and groups are complete.
void ReadMuscle(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// Reads a `<coopdyn:thruster>`, likewise.
void ReadThruster(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                  Diagnostics& diagnostics);
/// Makes a thruster of the rotor of a plug-in of Gazebo. What does not fit is a warning.
void AdoptRotor(const tinyxml2::XMLElement& element, const std::string& file, RobotModel& robot,
                Diagnostics& diagnostics);

/// The attributes of one XML element, each asked for by name; what nobody asked for is reported. `element`
/// and `diagnostics` outlive it. One thread.
class XmlAttributes {
 public:
  XmlAttributes(const tinyxml2::XMLElement& element, std::string file, Diagnostics& diagnostics);

  /// Its text; nothing if missing.
  std::optional<std::string> Text(const std::string& name);
  /// A finite number in [min, max]; nothing if missing or wrong (then reported).
  std::optional<double> Number(const std::string& name, double min, double max);
  std::optional<int> Integer(const std::string& name, int min, int max);
  /// true or false.
  std::optional<bool> Flag(const std::string& name);
  /// `count` finite numbers.
  std::optional<std::vector<double>> Numbers(const std::string& name, std::size_t count);

  void Error(const std::string& text);
  /// Reports that attribute `name` is needed, if it is missing.
  void Require(const std::string& name);
  /// Reports the attributes that were never asked for.
  void Finish();
  SourceLine where() const;

 private:
  const tinyxml2::XMLElement& element_;
  std::string file_;
  Diagnostics& diagnostics_;
  std::vector<std::string> known_;
};

/// Adds `joint`, which joins nothing, to the actuator of its `kind`, whose module is called `module`.
/// Reports what keeps it out.
void AddToModule(XmlAttributes& attributes, JointModel joint, const decltype(ActuatorModel::kind)& kind,
                 const std::string& module, RobotModel& robot);
/// Reports a name that no module can have.
void CheckModuleName(XmlAttributes& attributes, const std::string& name);
/// Reads a `<coopdyn:group>`: a control board of `robot`, whose joints, links and drive are complete.
void ReadGroup(XmlAttributes& attributes, RobotModel& robot, Diagnostics& diagnostics);
/// Makes a control board of those joints that a `<ros2_control>` commands which no other actuator has.
void AdoptGroup(XmlAttributes& attributes, RobotModel& robot);
/// Gives a robot without groups the group `joints` of all joints with an effort and a velocity that no drive
/// has, if there are any.
void AddDefaultGroup(RobotModel& robot);

}  // namespace coopdyn
