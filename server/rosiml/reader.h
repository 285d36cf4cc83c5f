// SPDX-License-Identifier: MIT
// Shared parts of the readers of both grammars. One thread.
#pragma once

#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "server/base/diagnostics.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/translate.h"
#include "server/rosiml/xml.h"

namespace coopdyn::rosiml {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

Experiment ReadPublic(const Element& root, const std::string& file, const HasController& has_controller,
                      Diagnostics& diagnostics);
Experiment ReadPaper(const Element& root, const std::string& file, Diagnostics& diagnostics);
/// Adds the joints and muscles of a robot of the public grammar. @pre `robot` has all its bodies
void ReadActuators(const Element& actuators, Movable& robot, const std::string& file,
                   Diagnostics& diagnostics);
/// Adds the joints of a body of the paper's grammar to `movable`. @pre `movable` has all its objects
void ReadConnectors(const Element& body, Movable& movable, const std::string& file, Diagnostics& diagnostics);

class Reader {
 public:
  Reader(const std::string& file, Diagnostics& diagnostics) : file_(file), diagnostics_(diagnostics) {}

  const std::string& file() const { return file_; }
  Diagnostics& diagnostics() { return diagnostics_; }
  void Error(const Element& at, std::string text) {
    diagnostics_.Error({file_, at.GetLineNum()}, std::move(text));
  }
  void Warn(const Element& at, std::string text) {
    diagnostics_.Warning({file_, at.GetLineNum()}, std::move(text));
  }

  /// True if an element of the public grammar is a body or a macro of bodies.
  static bool IsObject(std::string_view kind) {
    for (const char* object : {"box", "sphere", "cylinder", "capsule", "ply", "composite", "macro"}) {
      if (kind == object) return true;
    }
    return false;
  }

  /// A box, sphere, cylinder or capsule with the dimensions in the attributes of `lengths`.
  static Shape ShapeOf(std::string_view kind, const Element& lengths);
  /// An orientation whose x axis is along `direction`, without roll if possible.
  static Quaternion LookAlong(const Vector3& direction);

  /// Adds a body. Reports an error and returns false if the experiment has too many.
  bool Add(Movable& movable, Body body, const Element& at);
  /// Names the last body or a part of it. Reports duplicate names.
  void AddName(Movable& movable, const std::string& name, const Pose& X_WN, const Element& at);
  /// The body or part `name`. Reports an error and returns null if it does not exist.
  const Named* Find(const Movable& movable, const std::string& name, const Element& at);
  /// Reports an error and returns false if the name is in use. `lines`: first line of each name.
  bool IsNew(std::map<std::string, int>& lines, const Element& element, const std::string& name);
  bool IsNew(std::map<std::string, int>& lines, const Element& element) {
    return IsNew(lines, element, Text(element, "name"));
  }
  /// True if no error has been reported in the element's lines.
  bool IsSound(const Element& element) const;
  /// Adds a joint. Reports one that joins a body with itself.
  void AddJoint(Movable& movable, Joint joint, const Element& at);
  /// The line `step` of [SIMULATION] for `frequency_hz` steps per second.
  std::optional<Setting> StepOf(const Element& simulator, double frequency_hz);

  /// Reads <mapping>, <domain>, <noise> and <filter> of a motor or sensor whose values lie in `internal`.
  Mapped MappedOf(const Element& element, std::optional<std::pair<double, double>> internal,
                  double domain_unit = 1);
  /// Steps between two exchanges of a controller that runs at `controller_hz`.
  int StepsOf(const Element& at, double frequency_hz, double controller_hz);
  /// Reports an error and returns true if a controller has too many parameters.
  bool HasTooManyParameters(const Element& controller);
  /// The line that configures the loaded controller named by a <controller> of the public grammar; empty:
  /// clients drive the robot.
  std::string LoadedController(const Element& element, bool has_motors, const HasController& has_controller);
  /// The port of a controller of module TCPIP; 0 if unspecified.
  int PortOf(const Element& controller);

 private:
  void ReadFilter(const Element& filter, Mapped& mapped);

  const std::string& file_;
  Diagnostics& diagnostics_;
  int bodies_ = 0;  // bodies and parts of the whole experiment
};

}  // namespace coopdyn::rosiml
