// SPDX-License-Identifier: MIT
// RoSiML as the YARS paper tells it: simulator, environment, movables.
#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/reader.h"

namespace coopdyn::rosiml {

namespace {

/// The numbers of a value "least most", or one alone.
std::pair<double, double> RangeOf(std::string_view text) {
  const std::vector<std::string> words = SplitWords(text);
  const double least = words.empty() ? 0 : ParseNumber(words.front()).value_or(0);
  return {least, words.size() < 2 ? least : ParseNumber(words[1]).value_or(least)};
}

Random RandomOf(const Element& parent) {
  Random random;
  const Element* randomise = Child(parent, "randomise");
  if (randomise == nullptr) return random;
  random.line = randomise->GetLineNum();
  for (const auto* one = randomise->FirstAttribute(); one != nullptr; one = one->Next())
    random.ranges[one->Name()] = RangeOf(one->Value());
  return random;
}

class PaperReader : Reader {
 public:
  using Reader::Reader;

  Experiment Read(const Element& root) {
    if (const Element* simulator = Child(root, "simulator")) ReadSimulator(*simulator);
    if (const Element* environment = Child(root, "environment")) ReadEnvironment(*environment);
    if (const Element* movables = Child(root, "movables")) {
      ForEachChild(*movables, [this](const Element& movable) {
        if (std::string_view(movable.Name()) == "movable") ReadMovable(movable);
      });
    }
    return std::move(experiment_);
  }

 private:
  void Simulate(const Element& at, std::string text) {
    experiment_.simulation.push_back({std::move(text), at.GetLineNum()});
  }

  void ReadSimulator(const Element& simulator) {
    if (const auto frequency = Number(simulator, "frequency")) {
      if (const auto step = StepOf(simulator, *frequency)) experiment_.simulation.push_back(*step);
    }
    frequency_hz_ = Number(simulator, "frequency", kUsual_hz);
    if (const auto controller_hz = Number(simulator, "controllerFrequency"))
      exchange_steps_ = StepsOf(simulator, frequency_hz_, *controller_hz);
    if (const auto seed = Number(simulator, "seed")) Simulate(simulator, "seed " + Whole(*seed));
    for (const char* key : {"duration", "speed", "gravity"}) {
      if (const auto value = Number(simulator, key))
        Simulate(simulator, std::string(key) + " " + Exact(*value));
    }
    if (const std::string mode = Text(simulator, "mode"); !mode.empty()) Simulate(simulator, "mode " + mode);
  }

  void ReadEnvironment(const Element& environment) {
    ForEachChild(environment, [this](const Element& child) {
      const std::string_view kind = child.Name();
      if (kind == "ground") {
        ReadGround(child);
      } else if (kind == "ambient") {
        Simulate(child, "ambient_light " + Exact(Number(child, "value", 0)));
        experiment_.ambient = RandomOf(child);
      } else if (kind == "light") {
        experiment_.lights.push_back({PoseOf(child).p, Colour(child, "colour"), Number(child, "power", 1),
                                      Flag(child, "shadows", true), RandomOf(child), child.GetLineNum()});
      } else if (kind == "object" || IsShape(kind)) {
        Movable thing;
        thing.name = Text(child, "name");
        thing.line = child.GetLineNum();
        thing.random = RandomOf(child);
        ReadObject(child, Pose{}, thing);
        if (!thing.bodies.empty()) experiment_.things.push_back(std::move(thing));
      }
    });
  }

  void ReadGround(const Element& ground) {
    const int line = ground.GetLineNum();
    if (Number(ground, "width") || Number(ground, "depth"))
      experiment_.floor_size = {Number(ground, "width", 20), Number(ground, "depth", 20)};
    if (const auto friction = Number(ground, "friction"))
      experiment_.floor.push_back({"friction " + Exact(*friction), line});
    if (const std::string colour = Colour(ground, "colour"); !colour.empty())
      experiment_.floor.push_back({"color " + colour, line});
  }

  static bool IsShape(std::string_view kind) {
    return kind == "box" || kind == "sphere" || kind == "cylinder" || kind == "capsule";
  }

  /// A rigid body: an <object> with shapes, or one shape by itself.
  void ReadObject(const Element& element, const Pose& X_WC, Movable& movable) {
    Body body;
    body.name = Text(element, "name");
    body.X_WB = X_WC * PoseIn(element);
    body.mass_kg = Number(element, "mass", 0);
    body.friction = Number(element, "friction", 1);
    body.restitution = Number(element, "bounce", 0);
    body.colour = Colour(element, "colour");
    body.line = element.GetLineNum();
    const auto add = [&body](const Element& shape, const Pose& X_BG) {
      body.parts.push_back(
          {ShapeOf(shape.Name(), shape), X_BG, 0, Colour(shape, "colour"), shape.GetLineNum()});
    };
    if (IsShape(element.Name())) {
      add(element, Pose{});
    } else {
      ForEachChild(element, [&](const Element& child) {
        if (IsShape(child.Name())) add(child, PoseIn(child));
      });
      if (body.parts.empty())
        Error(element, "<object> needs a shape: <box>, <sphere>, <cylinder> or <capsule>");
    }
    // As if it were of one material.
    double volume = 0;
    for (const Part& part : body.parts) volume += Volume(part.shape);
    for (Part& part : body.parts) part.mass_kg = volume > 0 ? body.mass_kg * Volume(part.shape) / volume : 0;
    const Pose X_WB = body.X_WB;
    if (Add(movable, std::move(body), element)) AddName(movable, Text(element, "name"), X_WB, element);
  }

  void ReadMovable(const Element& element) {
    Movable movable;
    movable.name = Text(element, "name");
    movable.line = element.GetLineNum();
    movable.is_robot = true;
    movable.X_WM = PoseIn(element);
    movable.colour = Colour(element, "colour");
    movable.random = RandomOf(element);
    const Element* body = Child(element, "body");
    if (body != nullptr) {
      ReadCompound(*body, movable.X_WM, movable);
      ReadConnectors(*body, movable);
    }
    if (body != nullptr && movable.bodies.empty())
      Error(*body, "<body> needs an <object>, by itself or in a <compound>");
    const std::string type = Text(element, "type");
    ReadController(element, type, movable);
    if (type == "passive" || type == "moving") {
      for (Joint& joint : movable.joints) {
        joint.is_driven = false;
        if (joint.drive_train) joint.friction = joint.drive_train->dynamic_friction_nm;
      }
    }
    if (type == "passive" || type == "moving") movable.motors.clear();
    movable.exchange_steps = exchange_steps_;
    if (type == "passive") {
      movable.sensors.clear();
      movable.values.clear();
      movable.aborts.clear();
    }
    experiment_.robots.push_back(std::move(movable));
  }

  void ReadController(const Element& element, const std::string& type, Movable& movable) {
    const Element* controller = Child(element, "controller");
    if (type == "moving")
      Warn(element, "type 'moving' is not simulated yet: no controller puts forces on its body");
    if (type == "controlled" && controller == nullptr)
      Error(element,
            "a movable of type 'controlled' needs <controller library=\"NAME\"/>, a loaded controller");
    if (type != "controlled" && type != "moving" && controller != nullptr)
      Error(*controller, "only a movable of type 'controlled' or 'moving' has a <controller>");
    if (type != "controlled" || controller == nullptr) return;
    const auto simple = [this](const Element& at, const std::string& word) {
      if (word.empty() || word != Simple(word, 63))
        Error(at, "'" + Printable(word) + "' is no name of letters, digits and _");
      return word;
    };
    movable.controller = simple(*controller, Text(*controller, "library"));
    ForEachChild(*controller, [&](const Element& parameter) {
      movable.controller +=
          " " + simple(parameter, Text(parameter, "name")) + "=" + Exact(Number(parameter, "value", 0));
    });
  }

  void ReadCompound(const Element& compound, const Pose& X_WC, Movable& movable) {
    ForEachChild(compound, [&](const Element& child) {
      const std::string_view kind = child.Name();
      if (kind == "compound") ReadCompound(child, X_WC * PoseIn(child), movable);
      if (kind != "object") return;
      const std::size_t before = movable.bodies.size();
      ReadObject(child, X_WC, movable);
      if (movable.bodies.size() > before)
        ForEachChild(child, [&](const Element& sensor) { ReadSensor(sensor, movable); });
    });
  }

  /// After all objects, which they name.
  void ReadConnectors(const Element& compound, Movable& movable) {
    ForEachChild(compound, [&](const Element& child) {
      if (std::string_view(child.Name()) == "compound") ReadConnectors(child, movable);
      if (std::string_view(child.Name()) == "connector") ReadConnector(child, movable);
    });
  }

  /// Of the last body.
  void ReadSensor(const Element& element, Movable& movable) {
    using Kind = Sensor::Kind;
    constexpr std::pair<std::string_view, Kind> kKinds[] = {{"proximity", Kind::kProximity},
                                                            {"ldr", Kind::kLight},
                                                            {"compass", Kind::kCompass},
                                                            {"contact", Kind::kContact},
                                                            {"imu", Kind::kImu},
                                                            {"sharp", Kind::kSharp},
                                                            {"camera", Kind::kCamera},
                                                            {"ambientLight", Kind::kAmbient}};
    const auto* const known = std::find_if(std::begin(kKinds), std::end(kKinds),
                                           [&](const auto& one) { return one.first == element.Name(); });
    if (known == std::end(kKinds)) return ReadPlace(element, movable);
    Sensor sensor;
    sensor.name = Text(element, "name");
    sensor.kind = known->second;
    sensor.body = static_cast<int>(movable.bodies.size()) - 1;
    sensor.X_WS = movable.bodies.back().X_WB * PoseIn(element);
    sensor.range_m = Number(element, "range", 1);
    sensor.opening_deg = Number(element, "opening", sensor.kind == Kind::kCamera ? 60 : 0);
    sensor.opening_up_deg = Number(element, "openingUp", sensor.opening_deg);
    const std::string pattern = Text(element, "pattern");
    sensor.pattern = pattern == "fan"    ? Sensor::Pattern::kFan
                     : pattern == "cone" ? Sensor::Pattern::kCone
                                         : Sensor::Pattern::kCross;
    constexpr int kUsualRays = 5;
    const bool is_open =
        sensor.opening_deg > 0 || (sensor.pattern == Sensor::Pattern::kCross && sensor.opening_up_deg > 0);
    sensor.rays = is_open ? static_cast<int>(Number(element, "rays", kUsualRays)) : 1;
    sensor.colour = Colour(element, "colour");
    sensor.model = Text(element, "model");
    sensor.noise = Number(element, "noise", 0);
    sensor.width = static_cast<int>(Number(element, "width", 320));
    sensor.height = static_cast<int>(Number(element, "height", 240));
    sensor.line = element.GetLineNum();
    AddValue(element, sensor, movable);
    movable.sensors.push_back(std::move(sensor));
  }

  /// What is exchanged of the sensor that is added next.
  void AddValue(const Element& element, const Sensor& sensor, Movable& movable) {
    using Kind = Sensor::Kind;
    const int index = static_cast<int>(movable.sensors.size());
    if (Flag(element, "abort", false)) movable.aborts.push_back(index);
    if (sensor.kind == Kind::kCamera || sensor.kind == Kind::kImu) return;  // not one value
    std::optional<std::pair<double, double>> internal;
    if (sensor.kind == Kind::kProximity) internal = {0, sensor.range_m};
    if (sensor.kind == Kind::kContact) internal = {0, 1};
    if (sensor.kind == Kind::kCompass) internal = {-std::numbers::pi, std::numbers::pi};
    movable.values.push_back({.name = sensor.name,
                              .sensor = index,
                              .auxiliary = Flag(element, "auxiliary", sensor.kind == Kind::kAmbient),
                              .mapped = MappedOf(element, internal),
                              .line = sensor.line});
  }

  /// Where the last body is, or how it moves.
  void ReadPlace(const Element& element, Movable& movable) {
    static constexpr std::pair<std::string_view, const char*> kPlaces[] = {{"position", "x y z"},
                                                                           {"orientation", "roll pitch yaw"},
                                                                           {"velocity", "vx vy vz"},
                                                                           {"angularVelocity", "wx wy wz"}};
    const auto* const known = std::find_if(std::begin(kPlaces), std::end(kPlaces),
                                           [&](const auto& one) { return one.first == element.Name(); });
    if (known == std::end(kPlaces)) return;
    SensorValue value{.name = Text(element, "name"), .line = element.GetLineNum()};
    value.auxiliary = Flag(element, "auxiliary", true);
    value.in_body = Text(element, "frame") == "body";
    value.mapped = MappedOf(element, std::nullopt);
    value.of = SplitWords(known->second);
    value.body = static_cast<int>(movable.bodies.size()) - 1;
    value.X_WN = movable.bodies.back().X_WB;
    for (const auto& [axis, number] : {std::pair("z", 2), std::pair("y", 1), std::pair("x", 0)}) {
      if (!Flag(element, axis, true)) value.of.erase(value.of.begin() + number);
    }
    movable.values.push_back(std::move(value));
  }

  void ReadConnector(const Element& element, Movable& movable) {
    const std::string type = Text(element, "type");
    if (type == "hinge2") {
      Warn(element, "a connector of type '" + type +
                        "' is not simulated yet: it is left out, and its objects are loose");
      return;
    }
    Joint joint;
    joint.name = Text(element, "name");
    joint.line = element.GetLineNum();
    joint.kind = type == "slider"  ? Joint::Kind::kSlider
                 : type == "ball"  ? Joint::Kind::kBall
                 : type == "fixed" ? Joint::Kind::kFixed
                                   : Joint::Kind::kHinge;
    const std::string destination = Text(element, "destination");
    const Named* const source = Find(movable, Text(element, "source"), element);
    const Named* const to = destination.empty() ? nullptr : Find(movable, destination, element);
    if (source == nullptr || (!destination.empty() && to == nullptr)) return;
    joint.source = source->body;
    if (to != nullptr) joint.destination = to->body;
    joint.counts_source = to == nullptr;
    joint.X_WJ = source->X_WN * PoseIn(element);
    if (const Element* drive = Child(element, "drive")) {
      joint.is_driven = joint.kind == Joint::Kind::kHinge || joint.kind == Joint::Kind::kSlider;
      if (!joint.is_driven) Error(*drive, "only a hinge or a slider has a <drive>");
      const std::string kind = Text(*drive, "type");
      joint.is_wheel = kind.empty() || kind == "velocity";
      joint.max_effort = Number(*drive, "maxForce", 0);
      joint.max_velocity = Number(*drive, "maxVelocity", 0);
    }
    ReadResistance(element, joint);
    if (type == "complexHinge") {
      ReadDriveTrain(element, joint);
    } else {
      RefuseDriveTrain(element, type);
    }
    const Joint added = joint;
    const std::size_t before = movable.joints.size();
    AddJoint(movable, std::move(joint), element);
    if (movable.joints.size() > before) AddExchange(element, added, movable);
  }

  /// What is set and read of the joint added last.
  void AddExchange(const Element& element, const Joint& joint, Movable& movable) {
    const int index = static_cast<int>(movable.joints.size()) - 1;
    const Element* const drive = Child(element, "drive");
    if (joint.is_driven) {
      const Element& at = drive == nullptr ? element : *drive;
      const std::string type = drive == nullptr ? "" : Text(*drive, "type");
      MotorValue motor{.name = joint.name, .joint = index, .mode = "velocity", .line = at.GetLineNum()};
      std::optional<std::pair<double, double>> internal{{-joint.max_velocity, joint.max_velocity}};
      if (joint.drive_train && (type.empty() || Child(element, "pwm") != nullptr)) {
        motor.mode = "pwm";
        internal = {-1, 1};
      }
      if (type == "position") {
        motor.mode = "direct";
        internal = joint.limit;
      } else if (type == "force") {
        motor.mode = "effort";
        internal = {-joint.max_effort, joint.max_effort};
      }
      if (drive != nullptr) motor.mapped = MappedOf(*drive, internal);
      if (drive == nullptr) motor.mapped.internal = internal;
      movable.motors.push_back(std::move(motor));
    }
    ForEachChild(element, [&](const Element& read) {
      if (std::string_view(read.Name()) != "read") return;
      if (joint.kind != Joint::Kind::kHinge && joint.kind != Joint::Kind::kSlider)
        return Error(read, "only a hinge or a slider has a position, velocity and force to <read>");
      const std::string what = Text(read, "what");
      if ((what == "current" || what == "energy") && !joint.drive_train)
        return Warn(read, "<read what=\"" + what + "\"/> is told of a complexHinge alone: it is left out");
      const bool is_angle = what == "position" && joint.kind == Joint::Kind::kHinge;
      SensorValue value{.name = joint.name + "_" + what,
                        .joint = index,
                        .of = {what == "force" ? "effort" : what},
                        .auxiliary = Flag(read, "auxiliary", false),
                        .line = read.GetLineNum()};
      std::optional<std::pair<double, double>> internal;
      if (what == "position") internal = joint.limit;
      if (what == "velocity" && joint.is_driven) internal = {-joint.max_velocity, joint.max_velocity};
      if (what == "force" && joint.is_driven) internal = {-joint.max_effort, joint.max_effort};
      value.mapped = MappedOf(read, internal, is_angle ? kRadPerDeg : 1);
      movable.values.push_back(std::move(value));
    });
  }

  void ReadResistance(const Element& element, Joint& joint) {
    const double unit = joint.kind == Joint::Kind::kSlider ? 1 : kRadPerDeg;
    if (const Element* limit = Child(element, "limit")) {
      joint.limit = {Number(*limit, "min", 0) * unit, Number(*limit, "max", 0) * unit};
      if (joint.limit->first > joint.limit->second)
        Error(*limit, "'min' of <limit> must not lie above 'max'");
    }
    joint.stiffness = NumberIn(element, "spring", "stiffness", 0);
    joint.rest = NumberIn(element, "spring", "rest", 0) * unit;
    joint.damping = NumberIn(element, "damper", "value", 0);
    joint.friction = NumberIn(element, "friction", "value", 0);
  }

  /// What only a complex hinge has.
  void RefuseDriveTrain(const Element& element, const std::string& type) {
    ForEachChild(element, [&](const Element& child) {
      for (const char* word : {"backlash", "rotor", "coupling", "pwm"}) {
        if (std::string_view(child.Name()) == word)
          Error(child,
                std::string("only a connector of type 'complexHinge' has a <") + word + ">, not a " + type);
      }
    });
    const Element* friction = Child(element, "friction");
    if (friction != nullptr && (Number(*friction, "static") || Number(*friction, "threshold")))
      Error(*friction, "only a connector of type 'complexHinge' has static friction");
  }

  void ReadDriveTrain(const Element& element, Joint& joint) {
    DriveTrain train;
    train.line = element.GetLineNum();
    ForEachChild(element, [&](const Element& row) {
      if (std::string_view(row.Name()) != "pwm") return;
      train.pwm.push_back({Number(row, "duty", 1), Number(row, "noLoadSpeed", 0),
                           Number(row, "stallTorque", 0), Number(row, "stallCurrent", 0), row.GetLineNum()});
    });
    train.ratio = NumberIn(element, "rotor", "ratio", 1);
    train.efficiency = NumberIn(element, "rotor", "efficiency", 1);
    if (const Element* rotor = Child(element, "rotor")) train.rotor_inertia_kg_m2 = Number(*rotor, "inertia");
    train.backlash_deg = NumberIn(element, "backlash", "gap", 0);
    if (const Element* coupling = Child(element, "coupling")) {
      train.stiffness_nm_rad = Number(*coupling, "stiffness");
      train.damping_nms_rad = Number(*coupling, "damping", 0);
      train.preload_nm = Number(*coupling, "preload", 0);
    }
    train.dynamic_friction_nm = joint.friction;
    train.static_friction_nm = NumberIn(element, "friction", "static", joint.friction);
    if (const Element* friction = Child(element, "friction"))
      train.stiction_speed_rad_s = Number(*friction, "threshold");
    // Without a table the motor is that of its <drive>.
    if (train.pwm.empty() && joint.is_driven)
      train.pwm.push_back(
          {1, joint.max_velocity * train.ratio, joint.max_effort / train.ratio, 0, train.line});
    if (train.pwm.empty()) {
      Warn(element, "the complexHinge '" + Printable(joint.name) +
                        "' has neither <drive> nor <pwm>: it is a hinge without a motor");
      return;
    }
    joint.is_driven = true;
    joint.is_wheel = false;
    joint.friction = 0;
    joint.drive_train = std::move(train);
  }

  static constexpr double kUsual_hz = 100;

  Experiment experiment_;
  double frequency_hz_ = kUsual_hz;
  int exchange_steps_ = 1;
};

}  // namespace

Experiment ReadPaper(const Element& root, const std::string& file, Diagnostics& diagnostics) {
  return PaperReader(file, diagnostics).Read(root);
}

}  // namespace coopdyn::rosiml
