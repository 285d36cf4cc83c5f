// SPDX-License-Identifier: MIT
// Reads connectors in the YARS paper's grammar.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "server/base/printable.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/six_axis.h"

namespace coopdyn::rosiml {

namespace {

class PaperConnectors : Reader {
 public:
  using Reader::Reader;

  /// Reads connectors. Call it after all objects have been read: connectors refer to them.
  void Read(const Element& compound, Movable& movable) {
    ForEachChild(compound, [&](const Element& child) {
      if (std::string_view(child.Name()) == "compound") Read(child, movable);
      if (std::string_view(child.Name()) == "connector" && IsNew(lines_, child))
        ReadConnector(child, movable);
    });
  }

 private:
  void ReadConnector(const Element& element, Movable& movable) {
    const std::string type = Text(element, "type");
    Joint joint;
    joint.name = Text(element, "name");
    joint.line = element.GetLineNum();
    joint.kind = type == "slider"                            ? Joint::Kind::kSlider
                 : type == "ball"                            ? Joint::Kind::kBall
                 : type == "fixed"                           ? Joint::Kind::kFixed
                 : type == "hinge" || type == "complexHinge" ? Joint::Kind::kHinge
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
    if (type == "complexHinge") {
      ReadDriveTrain(element, joint);
    } else {
      RefuseDriveTrain(element, type);
    }
    const Joint added = joint;
    const std::size_t before = movable.joints.size();
    AddJoint(movable, std::move(joint), element);
    if (movable.joints.size() == before) return;
    AddExchange(element, added, "", movable);
    ForEachChild(element, [&](const Element& child) {
      if (std::string_view(child.Name()) != "axis") return;
      const std::string name = Text(child, "name");
      const auto axis = std::ranges::find(added.axes, name, &Joint::name);
      if (axis != added.axes.end()) AddExchange(child, *axis, added.name, movable);
    });
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

  /// Reads the axes of a joint with several axes.
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

  /// Adds the motor and sensor values of the last added joint, or of its axis `joint` if `whole` names the
  /// joint.
  void AddExchange(const Element& element, const Joint& joint, const std::string& whole, Movable& movable) {
    const int index = static_cast<int>(movable.joints.size()) - 1;
    const std::string axis = whole.empty() ? "" : joint.name;
    const std::string called = whole.empty() ? joint.name : whole + "_" + joint.name;
    const Element* const drive = Child(element, "drive");
    if (joint.is_driven) {
      const Element& at = drive == nullptr ? element : *drive;
      const std::string type = drive == nullptr ? "" : Text(*drive, "type");
      MotorValue motor{
          .name = called, .joint = index, .axis = axis, .mode = "velocity", .line = at.GetLineNum()};
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
      if (what == "current" && !joint.drive_train)
        return Warn(read, "only a complexHinge tells its current: <read what=\"current\"/> is left out");
      if (what == "energy" && !joint.is_driven)
        return Warn(read, "only a joint with a motor tells its energy: <read what=\"energy\"/> is left out");
      const bool is_angle = what == "position" && joint.kind == Joint::Kind::kHinge;
      SensorValue value{.name = called + "_" + what,
                        .joint = index,
                        .axis = axis,
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

  /// Reports elements that only a complex hinge may have.
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
    // Without <pwm> elements, the motor is that of the <drive>.
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

  std::map<std::string, int> lines_;  // first line of each name
};

}  // namespace

void ReadConnectors(const Element& body, Movable& movable, const std::string& file,
                    Diagnostics& diagnostics) {
  PaperConnectors(file, diagnostics).Read(body, movable);
}

}  // namespace coopdyn::rosiml
