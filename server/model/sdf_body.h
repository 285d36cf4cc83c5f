// SPDX-License-Identifier: MIT
// The parts of a robot that libsdformat reads: links with their shapes (sdf_links.cc) and masses
// (sdf_inertia.cc), joints (sdf_joints.cc), and its measures (model_measure.cc). One thread.
#pragma once

#include <ignition/math/Pose3.hh>
#include <memory>
#include <sdf/Model.hh>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/model/model_source.h"
#include "server/model/sdf_parts.h"

namespace coopdyn {

/// What the parts have in common while one model is read.
struct ModelReading {
  std::string file;
  const ModelSource& source;
  RobotModel& robot;
  Diagnostics& diagnostics;
  ModelLines lines{};
  std::vector<FixedJoint> fixed{};
  std::vector<Gearbox> gearboxes{};
  Assembly assembly{};

  void Error(int line, std::string text) { diagnostics.Error({file, line}, std::move(text)); }
  void Warn(int line, std::string text) { diagnostics.Warning({file, line}, std::move(text)); }
  void Mended(int line, std::string text) { diagnostics.Mended({file, line}, std::move(text)); }
  /// An error in a model of our own; of one made for other programs a warning, and the reader helps itself:
  /// `else` says how.
  void Complain(int line, const std::string& text, const std::string& otherwise,
                Diagnostic::Level level = Diagnostic::Level::kMended) {
    source.foreign ? diagnostics.Add({level, {file, line}, text + ": " + otherwise}) : Error(line, text);
  }
  /// In the frame `relative_to`; reported if it is not finite or far away.
  Pose Resolve(const sdf::SemanticPose& pose, const std::string& relative_to, const sdf::ElementPtr& element,
               const std::string& what);
  Pose CheckedPose(const ignition::math::Pose3d& pose, const sdf::ElementPtr& element,
                   const std::string& what);
};

int LineOf(const sdf::ElementPtr& element);
Vector3 ToVector(const ignition::math::Vector3d& v);

/// A model, or one inside it: `prefix` of its names, and where it stands in R.
struct ModelScope {
  const sdf::Model& model;
  const tinyxml2::XMLElement& xml;
  std::string prefix;
  Pose X_RM;
};
/// `model`, and those inside it.
std::vector<ModelScope> ScopesOf(const sdf::Model& model, const tinyxml2::XMLElement& xml,
                                 ModelReading& reading);

/// Mass, centre of mass and moments of links.
class InertiaReader {
 public:
  InertiaReader(const std::vector<ModelScope>& scopes, ModelReading& reading);
  /// `out` has its name and shapes. `xml`: its element in the composed text; null if there is none.
  void Read(const sdf::Link& link, const tinyxml2::XMLElement* xml, LinkModel& out) const;

 private:
  /// By the densities of its collisions, kg/m³; of a mesh about the middle of its box.
  void Weigh(const tinyxml2::XMLElement& xml, LinkModel& out) const;
  /// `is_solid`: its moments are those of its first shape.
  void ReadInertial(const sdf::Link& link, bool is_solid, LinkModel& out) const;

  ModelReading& reading_;
  std::set<std::string> welded_;  // links whose mass others have, to which fixed joints hold them
  std::set<std::string> still_;   // links that are fixed to the world
};

void ReadLinks(const std::vector<ModelScope>& scopes, ModelReading& reading);
void ReadJoints(const std::vector<ModelScope>& scopes, ModelReading& reading);

/// Fills reading.assembly, before links are welded; and finds the places of its sensors.
void ReadAssembly(const std::vector<ModelScope>& scopes, ModelReading& reading);

/// Footprint and height of the collisions. A robot of our own may not reach below the floor; one made for
/// other programs is lifted, unless a world says where its origin stands.
void MeasureModel(ModelReading& reading);
/// The height of the lowest point of what moves, over the floor; infinite if there is nothing.
double LowestOf(const RobotModel& robot, const Pose& X_WR);
/// The robot of an SDF that has one <model> made for other programs. `in_world`: a world says where it
/// stands.
std::shared_ptr<const RobotModel> ReadRobotModelTree(XmlNode root, const std::string& file,
                                                     const std::string& type, const Resources* resources,
                                                     bool in_world, Diagnostics& diagnostics);

/// Moves links and joints beyond joint `index` along it; false if it closes a loop.
bool MoveJoint(RobotModel& robot, std::size_t index, double by);
/// Puts each joint to its `start`, and what follows others with them.
void MoveToStart(ModelReading& reading);

/// What moves collides by convex hulls: a concave mesh by several, of which all but the first stand after the
/// other collisions of the link.
void MakeHulls(ModelReading& reading);

}  // namespace coopdyn
