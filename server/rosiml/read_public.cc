// SPDX-License-Identifier: MIT
// Reads the grammar 0.8 of the public YARS.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <ranges>
#include <utility>

#include "server/base/portable_math.h"
#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/names.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/six_axis.h"

namespace coopdyn::rosiml {

namespace {

class PublicReader : Reader {
 public:
  using Reader::Reader;

  Experiment Read(const Element& root, const HasController& has_controller) {
    has_controller_ = has_controller;
    if (!Text(root, "version").starts_with("0.8") && !Text(root, "version").empty())
      Warn(root, "version " + Printable(Text(root, "version")) +
                     " is read as 0.8: a word that has changed is not found");
    if (const Element* simulator = Child(root, "simulator")) ReadSimulator(*simulator);
    if (const Element* macros = Child(root, "macros")) ReadMacros(*macros);
    if (const Element* environment = Child(root, "environment")) ReadEnvironment(*environment);
    if (const Element* robots = Child(root, "robots")) {
      ForEachChild(*robots, [this](const Element& robot) {
        if (std::string_view(robot.Name()) == "robot") ReadRobot(robot);
      });
    }
    // In YARS friction is the product of both bodies', and the ground's is 1. coopdyn uses the lesser of the
    // two, which must never be the ground's.
    experiment_.floor.push_back({"friction 1000", root.GetLineNum()});
    return std::move(experiment_);
  }

 private:
  void ReadSimulator(const Element& simulator) {
    const double frequency_hz = Number(simulator, "frequency", 0);
    const auto step = StepOf(simulator, frequency_hz);
    frequency_hz_ = step ? frequency_hz : 0;
    if (!step) return;
    experiment_.simulation.push_back(*step);
    const Element* control = Child(simulator, "control");
    if (control == nullptr) return;
    const int line = control->GetLineNum();
    const double iterations = Number(*control, "iterations", -1);
    if (iterations > 0)
      experiment_.simulation.push_back({"duration " + Exact(iterations / frequency_hz), line});
    if (const auto seed = Number(*control, "seed"); seed && *seed >= 0)
      experiment_.simulation.push_back({"seed " + Whole(*seed), line});
  }

  void ReadMacros(const Element& macros) {
    macros_element_ = &macros;
    ForEachChild(macros, [this](const Element& macro) { NoteMacro(macro); });
  }
  /// False if macros have errors. Some errors in macros are only found where macros are used.
  bool HasSoundMacros() const { return macros_element_ == nullptr || IsSound(*macros_element_); }

  void NoteMacro(const Element& macro) {
    const std::string name = Text(macro, "name");
    const auto [first, is_new] = macros_.emplace(name, &macro);
    if (!is_new && !name.empty())
      Error(macro, "there are two macros '" + Printable(name) + "' (the first in line " +
                       std::to_string(first->second->GetLineNum()) + "): give one another name");
  }

  void ReadEnvironment(const Element& environment) {
    if (const Element* gravity = Child(environment, "gravitation")) ReadGravity(*gravity);
    ForEachChild(environment, [this](const Element& child) {
      const std::string_view kind = child.Name();
      if (kind == "pointLightSource") {
        Light light;
        light.p_W = PoseOf(child).p;
        light.colour = Colour(child, "colour");
        light.power = Number(child, "brightness", 1);
        light.line = child.GetLineNum();
        experiment_.lights.push_back(std::move(light));
      } else if (kind == "ambientLight") {
        experiment_.simulation.push_back(
            {"ambient_light " + Exact(Number(child, "brightness", 0)), child.GetLineNum()});
      } else if (IsObject(kind)) {
        Movable all;  // a macro may have several bodies
        ReadObject(child, Pose{}, "", all, 0);
        for (Body& body : all.bodies) {
          Movable thing;
          thing.name = body.name;
          thing.line = body.line;
          thing.bodies.push_back(std::move(body));
          thing.is_sound = IsNew(lines_, child, thing.name) && HasSoundMacros() && IsSound(child);
          experiment_.things.push_back(std::move(thing));
        }
      }
    });
  }

  void ReadGravity(const Element& gravity) {
    const double x = Number(gravity, "x", 0), y = Number(gravity, "y", 0), z = Number(gravity, "z", 0);
    const std::string numbers = x == 0 && y == 0 ? Exact(-z) : Exact(x) + " " + Exact(y) + " " + Exact(z);
    experiment_.simulation.push_back({"gravity " + numbers, gravity.GetLineNum()});
  }

  /// Reads a body, or the bodies of a macro, placed by X_WO; prepends `prefix` to their names.
  void ReadObject(const Element& object, const Pose& X_WO, const std::string& prefix, Movable& movable,
                  int depth) {
    const std::string_view kind = object.Name();
    const std::string name = prefix + Text(object, "name");
    const Pose X_WB = X_WO * PoseIn(object);
    if (kind == "macro") return ReadMacro(object, X_WB, name, movable, depth);
    Body body;
    body.name = name;
    body.X_WB = X_WB;
    body.line = object.GetLineNum();
    std::vector<std::pair<const Element*, Pose>> parts;
    const Element* geometry = kind == "composite" ? Child(object, "geometry") : nullptr;
    if (geometry != nullptr) {
      ForEachChild(*geometry, [&](const Element& part) {
        if (IsObject(part.Name())) parts.emplace_back(&part, PoseIn(part));
      });
      if (parts.empty()) Error(object, "<geometry> of a composite needs a shape, for example <box>");
    } else if (kind != "composite") {
      parts.emplace_back(&object, Pose{});
    }
    for (const auto& [part, X_BG] : parts) body.parts.push_back(PartOf(*part, X_BG));
    ReadPhysics(object, body);
    const std::vector<Part> shapes = body.parts;
    if (!Add(movable, std::move(body), object)) {
      is_full_ = true;
      return;
    }
    AddName(movable, name, X_WB, object);
    for (std::size_t i = 0; geometry != nullptr && i < shapes.size(); ++i) {
      const std::string part_name = prefix + Text(*parts[i].first, "name");
      AddName(movable, part_name, X_WB * shapes[i].X_BG, *parts[i].first);
    }
  }

  Part PartOf(const Element& object, const Pose& X_BG) {
    Part part;
    const Element* lengths = Child(object, "dimension");
    if (std::string_view(object.Name()) == "ply") {
      part.shape = Mesh{};
      part.mesh_file = Text(object, "filename");
    } else if (lengths != nullptr) {
      part.shape = ShapeOf(object.Name(), *lengths);
    }
    part.X_BG = X_BG;
    const Element* physics = Child(object, "physics");
    part.mass_kg = physics == nullptr ? 1 : NumberIn(*physics, "mass", "kg", 1);
    part.line = object.GetLineNum();
    return part;
  }

  static void ReadPhysics(const Element& object, Body& body) {
    for (const Part& part : body.parts) body.mass_kg += part.mass_kg;
    const Element* physics = Child(object, "physics");
    if (physics == nullptr) return;
    if (NumberIn(*physics, "mass", "kg", 1) == 0) body.mass_kg = 0;
    body.friction = NumberIn(*physics, "friction", "value", 0);
    body.restitution = NumberIn(*physics, "restitution", "value", 0);
    if (const Element* centre = Child(*physics, "centreOfMass")) body.centre_of_mass = PoseOf(*centre).p;
  }

  void ReadMacro(const Element& use, const Pose& X_WM, const std::string& prefix, Movable& movable,
                 int depth) {
    constexpr int kMaxDepth = 10, kMaxUses = 10'000;
    const std::string ref = Text(use, "ref");
    const auto macro = macros_.find(ref);
    if (macro == macros_.end()) {
      if (!ref.empty())
        Error(use, "there is no macro '" + Printable(ref) + "'" +
                       MeantOf(ref, std::views::keys(macros_), std::identity(), diagnostics()));
      return;
    }
    if (is_full_) return;
    if (depth >= kMaxDepth || ++uses_ > kMaxUses) {
      Error(use, depth >= kMaxDepth ? "macros inside macros, more than 10 deep: does one use itself?"
                                    : "macros are used more than 10,000 times");
      is_full_ = true;
      return;
    }
    ForEachChild(*macro->second, [&](const Element& object) {
      if (IsObject(object.Name()) && !is_full_) ReadObject(object, X_WM, prefix, movable, depth + 1);
    });
  }

  void ReadRobot(const Element& element) {
    Movable robot;
    robot_element_ = &element;
    robot.name = Text(element, "name");
    robot.line = element.GetLineNum();
    robot.is_robot = true;
    robot.X_WM = PoseIn(element);
    if (const Element* body = Child(element, "body")) {
      ForEachChild(*body, [&](const Element& object) {
        if (IsObject(object.Name())) ReadObject(object, robot.X_WM, "", robot, 0);
      });
    }
    if (robot.bodies.empty() && IsSound(element))
      Error(element, "the robot has no body: write at least one <box>, <sphere>, …");
    if (const Element* actuators = Child(element, "actuators"))
      ReadActuators(*actuators, robot, file(), diagnostics());
    if (const Element* sensors = Child(element, "sensors")) ReadSensors(*sensors, robot);
    if (const Element* controller = Child(element, "controller")) {
      robot.controller = LoadedController(*controller, !robot.motors.empty(), has_controller_);
      robot.port = PortOf(*controller);
      constexpr double kUsual_hz = 10;
      robot.exchange_steps = StepsOf(*controller, frequency_hz_, Number(*controller, "frequency", kUsual_hz));
    }
    robot.is_sound = IsNew(lines_, element) && HasSoundMacros() && IsSound(element);
    experiment_.robots.push_back(std::move(robot));
  }

  void ReadSensors(const Element& sensors, Movable& robot) {
    std::map<std::string, int> lines;
    ForEachChild(sensors, [&](const Element& sensor) {
      if (IsNew(lines, sensor)) ReadSensor(sensor, robot);
    });
  }

  void ReadSensor(const Element& element, Movable& robot) {
    const std::string_view kind = element.Name();
    const std::string object = TextIn(element, "object", "name");
    if (kind == "velocity" || kind == "deflection") return ReadJointSensor(element, object, robot);
    if (kind == "muscle") return ReadMuscleSensor(element, object, robot);
    const bool is_sharp = kind == "sharpGP2D12_37" || kind == "sharpDM2Y3A003K0F";
    const bool is_known = is_sharp || kind == "proximity" || kind == "ldr" || kind == "binaryContact" ||
                          kind == "camera" || kind == "position" || kind == "orientation" || kind == "ov" ||
                          kind == "oav";
    Sensor sensor;
    sensor.name = Text(element, "name");
    sensor.line = element.GetLineNum();
    if (kind == "ambientLight") {
      sensor.kind = Sensor::Kind::kAmbient;  // the same everywhere, so it has no place
      robot.values.push_back({.name = sensor.name,
                              .sensor = static_cast<int>(robot.sensors.size()),
                              .auxiliary = true,
                              .mapped = MappedOf(element, std::nullopt),
                              .line = sensor.line});
      robot.sensors.push_back(std::move(sensor));
      return;
    }
    const Named* const at = is_known ? Find(robot, object, element) : nullptr;
    if (at == nullptr) return;
    sensor.body = at->body;
    const Pose X_WS = at->X_WN * PoseIn(element);
    sensor.X_WS = {X_WS.p, LookAlong(X_WS.q * Vector3::UnitZ())};
    const double opening_x_deg = NumberIn(element, "openingAngles", "x", 0),
                 opening_y_deg = NumberIn(element, "openingAngles", "y", 0);
    if (kind == "proximity" || kind == "camera") {
      // Sensors look along z in YARS and along x in coopdyn. Their horizontal opening is about x in YARS and
      // about z in coopdyn.
      sensor.X_WS.q = X_WS.q * FromRollPitchYaw(0, -std::numbers::pi / 2, 0);
    }
    if (kind == "proximity") {
      sensor.kind = Sensor::Kind::kProximity;
      sensor.range_m = NumberIn(element, "distance", "meter", 1);
      sensor.opening_deg = 2 * opening_x_deg;
      sensor.opening_up_deg = 2 * opening_y_deg;
      constexpr int kRays = 5;
      sensor.rays = opening_x_deg > 0 || opening_y_deg > 0 ? kRays : 1;
    } else if (kind == "camera") {
      ReadCamera(opening_x_deg, opening_y_deg, sensor);
    } else if (is_sharp) {
      sensor.kind = Sensor::Kind::kSharp;
      sensor.model = kind == "sharpGP2D12_37" ? "gp2d12" : "dm2y3a003k0f";
    } else if (kind == "ldr") {
      sensor.kind = Sensor::Kind::kLight;
      sensor.opening_deg = 2 * Number(element, "opening", 0);
      if (const Element* colour = Child(element, "colour")) sensor.colour = Colour(*colour, "value");
    } else if (kind == "binaryContact") {
      sensor.kind = Sensor::Kind::kContact;
    } else if (kind == "oav") {
      sensor.kind = Sensor::Kind::kImu;
      sensor.X_WS = at->X_WN;
      AddPlace(element, *at, {"wx", "wy", "wz"}, robot);
    } else {
      // Each robot's module `pose` also reports these for its base.
      if (kind == "position") AddPlace(element, *at, {"x", "y", "z"}, robot);
      if (kind == "orientation") AddPlace(element, *at, {"roll", "pitch", "yaw"}, robot);
      if (kind == "ov") AddPlace(element, *at, {"vx", "vy", "vz"}, robot);
      return;
    }
    if (kind != "oav" && kind != "camera") {
      SensorValue value{
          .name = sensor.name, .sensor = static_cast<int>(robot.sensors.size()), .line = sensor.line};
      std::optional<std::pair<double, double>> internal{{0, kind == "proximity" ? sensor.range_m : 1}};
      if (is_sharp) internal.reset();  // volts, or a number as given by a <domain>
      value.mapped = MappedOf(element, internal);
      if (kind == "binaryContact") {
        // Its <domain> is the range of the exchanged value.
        value.mapped.external = Child(element, "domain") == nullptr ? std::nullopt : value.mapped.internal;
        value.mapped.internal = {0, 1};
      }
      robot.values.push_back(std::move(value));
    }
    robot.sensors.push_back(std::move(sensor));
  }

  /// Reads a sensor of a muscle's force, velocity and length. The module `muscles` also reports the factors.
  void ReadMuscleSensor(const Element& element, const std::string& name, Movable& robot) {
    const auto found = std::ranges::find(robot.muscles, name, &Muscle::name);
    if (found == robot.muscles.end()) {
      if (!name.empty() && IsSound(*robot_element_))
        Warn(element, "there is no muscle '" + Printable(name) + "'" +
                          MeantOf(name, robot.muscles, &Muscle::name, diagnostics()));
      return;
    }
    SensorValue value{.name = Text(element, "name"),
                      .muscle = static_cast<int>(found - robot.muscles.begin()),
                      .of = {"effort", "velocity", "position"},
                      .line = element.GetLineNum()};
    // Several domains belong to YARS's five values: do not map these three.
    const Element* domain = Child(element, "domain");
    if (domain == nullptr || domain->NextSiblingElement("domain") == nullptr)
      value.mapped = MappedOf(element, std::nullopt);
    robot.values.push_back(std::move(value));
  }

  /// Adds the values of `all` whose axes <coordinates> selects.
  void AddPlace(const Element& element, const Named& at, std::vector<std::string> all, Movable& robot) {
    SensorValue value{.name = Text(element, "name"),
                      .body = at.body,
                      .X_WN = at.X_WN,
                      .in_body = all.front().front() == 'v' || all.front().front() == 'w',
                      .line = element.GetLineNum()};
    if (Flag(element, "global", false)) value.in_body = false;
    const Element* coordinates = Child(element, "coordinates");
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (coordinates == nullptr || Flag(*coordinates, kAxes[i], true)) value.of.push_back(all[i]);
    }
    value.mapped = MappedOf(element, std::nullopt);
    robot.values.push_back(std::move(value));
  }

  /// YARS has no image size: use the default width, and square pixels.
  static void ReadCamera(double x_deg, double y_deg, Sensor& sensor) {
    constexpr double kLeast_deg = 1, kMost_deg = 87;
    x_deg = std::clamp(x_deg, kLeast_deg, kMost_deg);
    y_deg = std::clamp(y_deg, kLeast_deg, kMost_deg);
    sensor.kind = Sensor::Kind::kCamera;
    sensor.opening_deg = 2 * x_deg;
    const double ratio = portable::Tan(y_deg * kRadPerDeg) / portable::Tan(x_deg * kRadPerDeg);
    constexpr double kHighest = 4096;
    sensor.height = static_cast<int>(std::clamp(std::round(sensor.width * ratio), 1.0, kHighest));
  }

  void ReadJointSensor(const Element& element, const std::string& name, Movable& robot) {
    const auto joint = std::ranges::find(robot.joints, name, &Joint::name);
    if (joint == robot.joints.end()) {
      // A joint with an error has been left out.
      if (!name.empty() && !robot.joints.empty() && IsSound(*robot_element_))
        Warn(element, "there is no joint '" + Printable(name) + "' that is simulated" +
                          MeantOf(name, robot.joints, &Joint::name, diagnostics()));
      return;
    }
    const bool is_deflection = std::string_view(element.Name()) == "deflection";
    const bool is_angle = is_deflection && joint->kind == Joint::Kind::kHinge;
    SensorValue value{.name = Text(element, "name"),
                      .joint = static_cast<int>(joint - robot.joints.begin()),
                      .of = {is_deflection ? "position" : "velocity"},
                      .line = element.GetLineNum()};
    value.mapped = MappedOf(element, std::nullopt, is_angle ? kRadPerDeg : 1);
    robot.values.push_back(std::move(value));
  }

  Experiment experiment_;
  std::map<std::string, const Element*> macros_;
  int uses_ = 0;             // of macros
  bool is_full_ = false;     // macros nest too deeply or make too many bodies
  double frequency_hz_ = 0;  // 0 if invalid
  const Element* macros_element_ = nullptr;
  const Element* robot_element_ = nullptr;  // the robot being read
  std::map<std::string, int> lines_;        // first line of each name of things and robots
  HasController has_controller_;
};

}  // namespace

Experiment ReadPublic(const Element& root, const std::string& file, const HasController& has_controller,
                      Diagnostics& diagnostics) {
  return PublicReader(file, diagnostics).Read(root, has_controller);
}

}  // namespace coopdyn::rosiml
