// SPDX-License-Identifier: MIT
// Reads the parts of a robot that libsdformat parses: links with their shapes (sdf_links.cc) and masses
// (sdf_inertia.cc), joints (sdf_joints.cc), and dimensions (model_measure.cc). One thread.
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

/// State shared by the readers of one model.
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
  /// Reports an error in a coopdyn model. In a model made for other programs reports a warning instead;
  /// `otherwise` says what the reader does.
  void Complain(int line, const std::string& text, const std::string& otherwise,
                Diagnostic::Level level = Diagnostic::Level::kMended) {
    source.foreign ? diagnostics.Add({level, {file, line}, text + ": " + otherwise}) : Error(line, text);
  }
  /// The pose in the frame `relative_to`. Reports a pose that is not finite or too far away.
  Pose Resolve(const sdf::SemanticPose& pose, const std::string& relative_to, const sdf::ElementPtr& element,
               const std::string& what);
  Pose CheckedPose(const ignition::math::Pose3d& pose, const sdf::ElementPtr& element,
                   const std::string& what);
};

int LineOf(const sdf::ElementPtr& element);
Vector3 ToVector(const ignition::math::Vector3d& v);

/// A model or nested model, the prefix of its names, and its pose in R.
struct ModelScope {
  const sdf::Model& model;
  const tinyxml2::XMLElement& xml;
  std::string prefix;
  Pose X_RM;
};
/// `model` and its nested models.
std::vector<ModelScope> ScopesOf(const sdf::Model& model, const tinyxml2::XMLElement& xml,
                                 ModelReading& reading);

/// Reads mass, centre of mass and moments of inertia of links.
class InertiaReader {
 public:
  InertiaReader(const std::vector<ModelScope>& scopes, ModelReading& reading);
  /// Reads the inertia of `link` into `out`, which has its name and shapes. `xml`: the link's element in the
  /// composed text; null if none.
  void Read(const sdf::Link& link, const tinyxml2::XMLElement* xml, LinkModel& out) const;

 private:
  /// Computes the inertia from the densities of the collisions, kg/m³; for a mesh about the centre of its
  /// box.
  void Weigh(const tinyxml2::XMLElement& xml, LinkModel& out) const;
  /// `is_solid`: use the moments of the first shape as a solid.
  void ReadInertial(const sdf::Link& link, bool is_solid, LinkModel& out) const;

  ModelReading& reading_;
  std::set<std::string> welded_;  // links joined by fixed joints to links that have the mass
  std::set<std::string> still_;   // links fixed to the world
};

void ReadLinks(const std::vector<ModelScope>& scopes, ModelReading& reading);
void ReadJoints(const std::vector<ModelScope>& scopes, ModelReading& reading);

/// Fills reading.assembly, and finds the places of its sensors. Call it before links are welded.
void ReadAssembly(const std::vector<ModelScope>& scopes, ModelReading& reading);

/// Computes footprint and height of the collisions. Reports a coopdyn robot that reaches below the floor;
/// lifts a robot made for other programs, unless a world places its origin.
void MeasureModel(ModelReading& reading);
/// Height above the floor of the lowest point that moves; infinite if nothing moves.
double LowestOf(const RobotModel& robot, const Pose& X_WR);
/// Reads a robot from an SDF `root` with one <model> made for other programs. `in_world`: a world places the
/// model.
std::shared_ptr<const RobotModel> ReadRobotModelTree(XmlNode root, const std::string& file,
                                                     const std::string& type, const Resources* resources,
                                                     bool in_world, Diagnostics& diagnostics);

/// Moves joint `index` by `by`, with the links and joints beyond it. False if the joint closes a loop.
bool MoveJoint(RobotModel& robot, std::size_t index, double by);
/// Moves each joint to its `start`, and its followers with it.
void MoveToStart(ModelReading& reading);

/// Replaces the collision meshes of moving links by convex hulls. A concave mesh becomes several; all but the
/// first are appended to the link's collisions.
void MakeHulls(ModelReading& reading);

}  // namespace coopdyn
