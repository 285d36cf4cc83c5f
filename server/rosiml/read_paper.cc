// SPDX-License-Identifier: MIT
// Reads RoSiML in the YARS paper's grammar: simulator, environment, movables.
#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/six_axis.h"

namespace coopdyn::rosiml {

namespace {

/// The range of a value "MIN MAX" or of a single number.
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
    ForEachChild(root, [this](const Element& child) {
      if (std::string_view(child.Name()) == "score") ReadScore(child);
    });
    return std::move(experiment_);
  }

 private:
  void Simulate(const Element& at, std::string text) {
    experiment_.simulation.push_back({std::move(text), at.GetLineNum()});
  }

  void ReadSimulator(const Element& simulator) {
    if (simulator.Attribute("frequency") != nullptr) {
      const auto step = StepOf(simulator, Number(simulator, "frequency", 0));
      if (step) experiment_.simulation.push_back(*step);
      frequency_hz_ = step ? Number(simulator, "frequency", 0) : 0;
    }
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
                                      Flag(child, "shadows", true), RandomOf(child), child.GetLineNum(),
                                      Text(child, "name"), IsNew(lines_, child) && IsSound(child)});
      } else if (kind == "object" || IsShape(kind)) {
        Movable thing;
        thing.name = Text(child, "name");
        thing.line = child.GetLineNum();
        thing.random = RandomOf(child);
        ReadObject(child, Pose{}, thing);
        thing.is_sound = IsNew(lines_, child) && IsSound(child);
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

  /// Reads a rigid body: an <object> with shapes, or a single shape.
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
    // Distribute the mass by volume, for a uniform density.
    double volume = 0;
    for (const Part& part : body.parts) volume += Volume(part.shape);
    for (Part& part : body.parts) part.mass_kg = volume > 0 ? body.mass_kg * Volume(part.shape) / volume : 0;
    const Pose X_WB = body.X_WB;
    if (Add(movable, std::move(body), element)) AddName(movable, Text(element, "name"), X_WB, element);
  }

  void ReadMovable(const Element& element) {
    Movable movable;
    sensor_lines_.clear();
    movable.name = Text(element, "name");
    movable.line = element.GetLineNum();
    movable.is_robot = true;
    movable.X_WM = PoseIn(element);
    movable.colour = Colour(element, "colour");
    movable.random = RandomOf(element);
    const Element* body = Child(element, "body");
    if (body != nullptr) {
      ReadCompound(*body, movable.X_WM, movable);
      ReadConnectors(*body, movable, file(), diagnostics());
    }
    if (body != nullptr && movable.bodies.empty())
      Error(*body, "<body> needs an <object>, by itself or in a <compound>");
    const std::string type = Text(element, "type");
    ReadController(element, type, movable);
    if (type == "passive" || type == "moving") {
      for (Joint& joint : movable.joints) {
        joint.is_driven = false;
        for (Joint& axis : joint.axes) axis.is_driven = false;
        if (joint.drive_train) joint.friction = joint.drive_train->dynamic_friction_nm;
      }
    }
    if (type == "passive" || type == "moving") movable.motors.clear();
    ReadThrusters(element, type, movable);
    movable.exchange_steps = exchange_steps_;
    if (type == "passive") {
      movable.sensors.clear();
      movable.values.clear();
      movable.aborts.clear();
    }
    movable.is_sound = IsNew(lines_, element) && IsSound(element);
    experiment_.robots.push_back(std::move(movable));
  }

  void ReadController(const Element& element, const std::string& type, Movable& movable) {
    const Element* controller = Child(element, "controller");
    if (type == "controlled" && controller == nullptr)
      Error(element,
            "a movable of type 'controlled' needs <controller library=\"NAME\"/>, a loaded controller");
    if (type != "controlled" && type != "moving" && controller != nullptr)
      Error(*controller, "only a movable of type 'controlled' or 'moving' has a <controller>");
    if (controller == nullptr) return;
    const auto simple = [this](const Element& at, const std::string& word) {
      if (word.empty() || word != Simple(word, 63))
        Error(at, "'" + Printable(word) + "' is no name of letters, digits and _");
      return word;
    };
    movable.controller = simple(*controller, Text(*controller, "library"));
    if (HasTooManyParameters(*controller)) return;
    ForEachChild(*controller, [&](const Element& parameter) {
      movable.controller +=
          " " + simple(parameter, Text(parameter, "name")) + "=" + Exact(Number(parameter, "value", 0));
    });
  }

  /// Reads the forces and torques along and about the axes of the first body of a movable of type 'moving'.
  void ReadThrusters(const Element& element, const std::string& type, Movable& movable) {
    const Element *force = Child(element, "force"), *torque = Child(element, "torque");
    if (type == "moving" && force == nullptr && torque == nullptr)
      Error(element,
            "a movable of type 'moving' needs <force max=\"…\"/> (N) or <torque max=\"…\"/> (N m): the most "
            "that pushes its body");
    for (const Element* kind : {force, torque}) {
      if (kind == nullptr) continue;
      if (type != "moving") {
        Error(*kind, std::string("only a movable of type 'moving' has a <") + kind->Name() + ">");
        continue;
      }
      const double most = Number(*kind, "max", 0);
      for (int axis = 0; axis < 3; ++axis) {
        Thruster thruster{.name = std::string(kind->Name()) + "_" + "xyz"[axis],
                          .axis = axis,
                          .turns = kind == torque,
                          .most = most,
                          .line = kind->GetLineNum()};
        movable.motors.push_back({.name = thruster.name,
                                  .joint = -1,
                                  .mode = "effort",
                                  .mapped = MappedOf(*kind, std::pair(-most, most)),
                                  .line = thruster.line,
                                  .thruster = static_cast<int>(movable.thrusters.size())});
        movable.thrusters.push_back(std::move(thruster));
      }
    }
  }

  void ReadCompound(const Element& compound, const Pose& X_WC, Movable& movable) {
    ForEachChild(compound, [&](const Element& child) {
      const std::string_view kind = child.Name();
      if (kind == "compound") ReadCompound(child, X_WC * PoseIn(child), movable);
      if (kind != "object") return;
      const std::size_t before = movable.bodies.size();
      ReadObject(child, X_WC, movable);
      if (movable.bodies.size() > before)
        ForEachChild(child, [&](const Element& sensor) {
          if (IsNew(sensor_lines_, sensor)) ReadSensor(sensor, movable);
        });
    });
  }

  /// Reads a sensor on the last body.
  void ReadSensor(const Element& element, Movable& movable) {
    using Kind = Sensor::Kind;
    constexpr std::pair<std::string_view, Kind> kKinds[] = {{"proximity", Kind::kProximity},
                                                            {"ldr", Kind::kLight},
                                                            {"compass", Kind::kCompass},
                                                            {"contact", Kind::kContact},
                                                            {"imu", Kind::kImu},
                                                            {"sharp", Kind::kSharp},
                                                            {"camera", Kind::kCamera},
                                                            {"ambientLight", Kind::kAmbient},
                                                            {"neighbours", Kind::kNeighbours}};
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

  /// Adds the exchanged value of `sensor`, which will be the next one in Movable::sensors.
  void AddValue(const Element& element, const Sensor& sensor, Movable& movable) {
    using Kind = Sensor::Kind;
    const int index = static_cast<int>(movable.sensors.size());
    if (Flag(element, "abort", false)) movable.aborts.push_back(index);
    if (sensor.kind == Kind::kCamera || sensor.kind == Kind::kImu || sensor.kind == Kind::kNeighbours)
      return;  // these have more than one value
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

  /// Reads a sensor of the last body's pose or velocity.
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

  void ReadScore(const Element& element) {
    Score score;
    score.line = element.GetLineNum();
    score.of = NamesIn(Text(element, "of"));
    constexpr std::size_t kMostNames = 1000;
    if (score.of.size() > kMostNames) {
      Error(element, "'of' in <score> has at most " + std::to_string(kMostNames) + " names");
      score.of.clear();
    }
    score.target = Text(element, "target");
    const std::string kind = Text(element, "kind"), name = Text(element, "name");
    if (kind == "reach" && score.target.empty())
      Error(element, "a score of kind 'reach' needs a 'target', the name of a thing or a light");
    score.keys.push_back("kind " + kind);
    if (!name.empty()) {
      std::string simple = Simple(name, 60);
      std::ranges::replace(simple, '-', '_');
      score.keys.push_back("name " + simple);
    }
    for (const auto& [key, unit] : {std::pair("within", ""), {"tilt", "deg"}, {"cell", ""}, {"limit", ""}}) {
      if (const auto value = Number(element, key))
        score.keys.push_back(std::string(key) + " " + Exact(*value) + unit);
    }
    if (const std::string until = Text(element, "until"); !until.empty()) {
      const std::string_view text = Trim(until);
      const std::string sign(text.substr(0, text.find_first_not_of("<>=")));
      const auto value = ParseNumber(Trim(text.substr(sign.size())));
      if (text == "all")
        score.keys.emplace_back("until all");
      else if (!sign.empty() && sign.size() <= 2 && value)
        score.keys.push_back("until " + sign + " " + Exact(*value));
      else
        Error(element, "'until' in <score> is 'all' or a comparison such as '>= 3' or '&lt; 0.5', not '" +
                           Printable(until) + "'");
    }
    score.is_sound = IsNew(score_lines_, element) && IsSound(element);
    experiment_.scores.push_back(std::move(score));
  }

  /// The comma-separated names in `text`.
  static std::vector<std::string> NamesIn(std::string_view text) {
    std::vector<std::string> names;
    while (!text.empty()) {
      const std::size_t comma = std::min(text.find(','), text.size());
      names.emplace_back(Trim(text.substr(0, comma)));
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return names;
  }

  static constexpr double kUsual_hz = 100;

  Experiment experiment_;
  double frequency_hz_ = kUsual_hz;
  int exchange_steps_ = 1;
  // First line of each name: of all things, of the sensors of a movable, of scores.
  std::map<std::string, int> lines_, sensor_lines_, score_lines_;
};

}  // namespace

Experiment ReadPaper(const Element& root, const std::string& file, Diagnostics& diagnostics) {
  return PaperReader(file, diagnostics).Read(root);
}

}  // namespace coopdyn::rosiml
