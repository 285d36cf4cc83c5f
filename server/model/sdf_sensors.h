// SPDX-License-Identifier: MIT
// The sensors in a robot's SDF (docs/formats.md): elements such as `<coopdyn:compass>` say what they are
// like, and a `<coopdyn:module>` gives each its socket.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/robot_model.h"
#include "server/model/xml_attributes.h"

namespace coopdyn {

/// Reads the sensors of one robot. The arguments outlive it. One thread.
class SensorReader {
 public:
  SensorReader(const std::string& file, RobotModel& robot, Diagnostics& diagnostics)
      : file_(file), robot_(robot), diagnostics_(diagnostics) {}

  /// The names of all elements that describe a sensor.
  static std::vector<std::string> Elements();

  /// Reads such an element; false if `element` is none. All come before the first module.
  bool Read(const tinyxml2::XMLElement& element);
  /// Gives the robot the sensor of a module, as the element with the module's name says, else the one
  /// without a name.
  void AddModule(XmlAttributes& attributes, const std::string& type, const std::string& name);
  /// Reports the elements that no module has used.
  void Finish();

 private:
  struct Described {
    std::string name;  // of the module; empty: any that has none of its own
    SensorKind kind;
    SourceLine where;
    bool used = false;
  };

  const std::string& file_;
  RobotModel& robot_;
  Diagnostics& diagnostics_;
  std::vector<Described> described_;
};

}  // namespace coopdyn
