// SPDX-License-Identifier: MIT
// What the readers of both grammars share. One thread.
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
/// Adds the joints and muscles of a robot of the public grammar, which has all its bodies.
void ReadActuators(const Element& actuators, Movable& robot, const std::string& file,
                   Diagnostics& diagnostics);
/// Adds the joints of a body of the paper's grammar to `movable`, which has all its objects.
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

  /// Whether an element of the public grammar is a body, or stands for some.
  static bool IsObject(std::string_view kind) {
    for (const char* object : {"box", "sphere", "cylinder", "capsule", "ply", "composite", "macro"}) {
      if (kind == object) return true;
    }
    return false;
  }

  /// box, sphere, cylinder or capsule with the lengths that `lengths` has.
  static Shape ShapeOf(std::string_view kind, const Element& lengths);
  /// Its orientation looks along `direction`, level if it can.
  static Quaternion LookAlong(const Vector3& direction);

  /// Adds a body; false, and reported, once there are more than an experiment may have.
  bool Add(Movable& movable, Body body, const Element& at);
  /// Gives the last body, or a part of it, a name. Reports one that another has.
  void AddName(Movable& movable, const std::string& name, const Pose& X_WN, const Element& at);
  /// The body or part called so; null, and reported, if there is none.
  const Named* Find(const Movable& movable, const std::string& name, const Element& at);
  /// False, and reported, if another one has its name. `lines`: where each name stands first.
  bool IsNew(std::map<std::string, int>& lines, const Element& element, const std::string& name);
  bool IsNew(std::map<std::string, int>& lines, const Element& element) {
    return IsNew(lines, element, Text(element, "name"));
  }
  /// Whether no error has been reported in its lines.
  bool IsSound(const Element& element) const;
  /// Reports a joint of a body with itself; adds any other.
  void AddJoint(Movable& movable, Joint joint, const Element& at);
  /// The line `step` of [SIMULATION] for this number of steps per second.
  std::optional<Setting> StepOf(const Element& simulator, double frequency_hz);

  /// <mapping>, <domain>, <noise> and <filter> of a motor or a sensor whose values lie in `internal`.
  Mapped MappedOf(const Element& element, std::optional<std::pair<double, double>> internal,
                  double domain_unit = 1);
  /// Steps of an exchange of a controller that is asked so often.
  int StepsOf(const Element& at, double frequency_hz, double controller_hz);
  /// Reports more parameters than a controller may have.
  bool HasTooManyParameters(const Element& controller);
  /// The line of the loaded controller that a <controller> of the public grammar names; empty: clients drive
  /// the robot.
  std::string LoadedController(const Element& element, bool has_motors, const HasController& has_controller);
  /// The port of a controller of module TCPIP; 0: it does not say one.
  int PortOf(const Element& controller);

 private:
  void ReadFilter(const Element& filter, Mapped& mapped);

  const std::string& file_;
  Diagnostics& diagnostics_;
  int bodies_ = 0;  // and parts, of the whole experiment
};

}  // namespace coopdyn::rosiml
