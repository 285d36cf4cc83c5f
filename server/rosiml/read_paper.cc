// SPDX-License-Identifier: MIT
// RoSiML as the YARS paper tells it: simulator, environment, movables.
#include <algorithm>
#include <utility>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/six_axis.h"

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
        for (Joint& axis : joint.axes) axis.is_driven = false;
      }
    }
    if (type == "passive") movable.sensors.clear();
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
    constexpr std::pair<std::string_view, Kind> kKinds[] = {
        {"proximity", Kind::kProximity}, {"ldr", Kind::kLight}, {"compass", Kind::kCompass},
        {"contact", Kind::kContact},     {"imu", Kind::kImu},   {"sharp", Kind::kSharp},
        {"camera", Kind::kCamera}};
    const auto* const known = std::find_if(std::begin(kKinds), std::end(kKinds),
                                           [&](const auto& one) { return one.first == element.Name(); });
    if (known == std::end(kKinds)) return;
    if (known->second == Kind::kSharp && Text(element, "model") == "dm2y3a003k0f") {
      Warn(element,
           "the Sharp DM2Y3A003K0F is not simulated yet: its curve is not known; write model=\"gp2d12\", or "
           "a <proximity>");
      return;
    }
    Sensor sensor;
    sensor.name = Text(element, "name");
    sensor.kind = known->second;
    sensor.body = static_cast<int>(movable.bodies.size()) - 1;
    sensor.X_WS = movable.bodies.back().X_WB * PoseIn(element);
    sensor.range_m = Number(element, "range", 1);
    sensor.opening_deg = Number(element, "opening", sensor.kind == Kind::kCamera ? 60 : 0);
    constexpr int kUsualRays = 5;
    sensor.rays = sensor.opening_deg > 0 ? static_cast<int>(Number(element, "rays", kUsualRays)) : 1;
    sensor.noise = Number(element, "noise", 0);
    sensor.width = static_cast<int>(Number(element, "width", 320));
    sensor.height = static_cast<int>(Number(element, "height", 240));
    sensor.line = element.GetLineNum();
    movable.sensors.push_back(std::move(sensor));
  }

  void ReadConnector(const Element& element, Movable& movable) {
    const std::string type = Text(element, "type");
    if (type == "complexHinge") {
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
                 : type == "hinge" ? Joint::Kind::kHinge
                                   : Joint::Kind::kSixAxis;
    const std::string destination = Text(element, "destination");
    const Named* const source = Find(movable, Text(element, "source"), element);
    const Named* const to = destination.empty() ? nullptr : Find(movable, destination, element);
    if (source == nullptr || (!destination.empty() && to == nullptr)) return;
    joint.source = source->body;
    if (to != nullptr) joint.destination = to->body;
    joint.counts_source = to == nullptr;
    joint.X_WJ = source->X_WN * PoseIn(element);
    ReadDrive(element, joint);
    if (joint.kind == Joint::Kind::kSixAxis) {
      ReadAxes(element, type, joint);
    } else {
      ReadResistance(element, joint);
      if (const Element* axis = Child(element, "axis"))
        Error(*axis, "only a connector of type universal, hinge2 or sixAxis has an <axis>");
    }
    AddJoint(movable, std::move(joint), element);
  }

  void ReadDrive(const Element& element, Joint& joint) {
    const Element* drive = Child(element, "drive");
    if (drive == nullptr) return;
    joint.is_driven = joint.kind == Joint::Kind::kHinge || joint.kind == Joint::Kind::kSlider;
    if (!joint.is_driven) Error(*drive, "only a hinge, a slider or an <axis> has a <drive>");
    const std::string kind = Text(*drive, "type");
    joint.is_wheel = kind.empty() || kind == "velocity";
    joint.max_effort = Number(*drive, "maxForce", 0);
    joint.max_velocity = Number(*drive, "maxVelocity", 0);
  }

  /// Of a joint of several axes.
  void ReadAxes(const Element& element, const std::string& type, Joint& joint) {
    for (const char* word : {"limit", "spring", "damper", "friction"}) {
      if (const Element* child = Child(element, word))
        Error(*child, std::string("<") + word + "> of a connector of type '" + type +
                          "' stands in its <axis name=\"rx\">, ...");
    }
    joint.axes = AxesOfType(type);
    for (Joint& axis : joint.axes) axis.line = joint.line;
    std::vector<std::string> known;
    ForEachChild(element, [&](const Element& child) {
      if (std::string_view(child.Name()) != "axis") return;
      const std::string name = Text(child, "name");
      Joint* const axis = FindAxis(joint.axes, type, name);
      if (axis == nullptr || std::ranges::find(known, name) != known.end()) {
        Error(child, "a connector of type '" + type + "' has no further axis '" + Printable(name) + "'");
        return;
      }
      known.push_back(name);
      axis->line = child.GetLineNum();
      ReadDrive(child, *axis);
      ReadResistance(child, *axis);
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
    ForEachChild(element, [&](const Element& read) {
      if (std::string_view(read.Name()) != "read") return;
      const std::string what = Text(read, "what");
      if (what == "force" || what == "current" || what == "energy")
        Warn(read,
             "<read what=\"" + what + "\"/> is not simulated yet: motors tell positions and velocities");
      else if (!joint.is_driven)
        Warn(read, "<read> of a connector without <drive> is not simulated yet: it has no module");
    });
  }

  Experiment experiment_;
};

}  // namespace

Experiment ReadPaper(const Element& root, const std::string& file, Diagnostics& diagnostics) {
  return PaperReader(file, diagnostics).Read(root);
}

}  // namespace coopdyn::rosiml
