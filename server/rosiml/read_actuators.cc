// SPDX-License-Identifier: MIT
// Reads actuators in the grammar 0.8 of the public YARS.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/base/printable.h"
#include "server/rosiml/reader.h"
#include "server/rosiml/six_axis.h"

namespace coopdyn::rosiml {

namespace {

class PublicActuators : Reader {
 public:
  using Reader::Reader;

  void Read(const Element& actuators, Movable& robot) {
    std::map<std::string, int> lines;
    ForEachChild(actuators, [&](const Element& actuator) {
      if (IsNew(lines, actuator)) ReadActuator(actuator, robot);
    });
  }

 private:
  void ReadActuator(const Element& element, Movable& robot) {
    const std::string_view kind = element.Name();
    if (kind == "muscle") return ReadMuscle(element, robot);
    if (kind != "hinge" && kind != "slider" && kind != "fixed" && kind != "generic") return;
    Joint joint;
    joint.name = Text(element, "name");
    joint.line = element.GetLineNum();
    joint.kind = kind == "hinge"    ? Joint::Kind::kHinge
                 : kind == "slider" ? Joint::Kind::kSlider
                 : kind == "fixed"  ? Joint::Kind::kFixed
                                    : Joint::Kind::kSixAxis;
    const Element* destination = Child(element, "destination");
    const Named* const source = Find(robot, TextIn(element, "source", "name"), element);
    const Named* const to =
        destination == nullptr ? nullptr : Find(robot, Text(*destination, "name"), *destination);
    if (source == nullptr || (destination != nullptr && to == nullptr)) return;
    joint.source = source->body;
    if (to != nullptr) joint.destination = to->body;
    joint.X_WJ = source->X_WN;
    if (const Element* pose = Child(element, "pose"))
      joint.X_WJ = Flag(*pose, "global", false) ? PoseOf(*pose) : source->X_WN * PoseOf(*pose);
    if (joint.kind == Joint::Kind::kSixAxis) {
      joint.axes = ReadGenericAxes(element, *this);
    } else if (joint.kind != Joint::Kind::kFixed) {
      ReadMotor(element, joint);
    }
    const Joint added = joint;
    const std::size_t before = robot.joints.size();
    AddJoint(robot, std::move(joint), element);
    if (robot.joints.size() == before) return;
    if (added.is_driven) AddMotorValue(element, added, "", robot);
    for (const Joint& axis : added.axes) {
      const Element* kind = Child(element, axis.name.front() == 'r' ? "rotational" : "translational");
      const Element* one =
          kind == nullptr ? nullptr : Child(*kind, axis.name.substr(axis.name.size() - 1).c_str());
      if (axis.is_driven && one != nullptr) AddMotorValue(*one, axis, added.name, robot);
    }
  }

  /// Adds the motor value of the last added joint, or of its axis `joint` if `whole` names the joint.
  void AddMotorValue(const Element& element, const Joint& joint, const std::string& whole, Movable& robot) {
    const std::string type = Text(element, "type");
    MotorValue motor{.name = whole.empty() ? joint.name : whole + "_" + joint.name,
                     .joint = static_cast<int>(robot.joints.size()) - 1,
                     .axis = whole.empty() ? "" : joint.name,
                     .mode = "velocity",
                     .line = element.GetLineNum()};
    const double fastest = joint.max_velocity, most = joint.max_effort;
    std::optional<std::pair<double, double>> internal{{-fastest, fastest}};
    if (type == "force and velocity" || type == "force and angle") {
      MotorValue force = motor;
      force.name += "_force";
      force.mode = "limit";
      force.mapped = MappedOf(element, std::pair(0.0, most));
      robot.motors.push_back(std::move(force));
    }
    if (type == "force") {
      motor.mode = "effort";
      internal = {-most, most};
    } else if (type == "angular" || type == "positional" || type == "force and angle") {
      motor.mode = "direct";
      internal = joint.limit;
    }
    motor.mapped = MappedOf(element, internal);
    robot.motors.push_back(std::move(motor));
  }

  /// The point of an anchor. The anchor's object is only a marker, not a body.
  static Vector3 AnchorOf(const Element& element, const char* name, const Pose& X_WN) {
    const Element* anchor = Child(element, name);
    if (anchor == nullptr) return X_WN.p;
    Pose X_NA;
    ForEachChild(*anchor, [&X_NA](const Element& object) {
      if (IsObject(object.Name())) X_NA = PoseIn(object);
    });
    return Text(*anchor, "coordinateSystem") == "global" ? X_NA.p : (X_WN * X_NA).p;
  }

  void ReadMuscle(const Element& element, Movable& robot) {
    const Named* const source = Find(robot, TextIn(element, "source", "name"), element);
    const Named* const to = Find(robot, TextIn(element, "destination", "name"), element);
    if (source == nullptr || to == nullptr) return;
    Muscle muscle;
    muscle.name = Text(element, "name");
    muscle.line = element.GetLineNum();
    muscle.source = source->body;
    muscle.destination = to->body;
    muscle.p_W_source = AnchorOf(element, "srcAnchor", source->X_WN);
    muscle.p_W_destination = AnchorOf(element, "dstAnchor", to->X_WN);
    muscle.max_force_n = NumberIn(element, "force", "max", 0);
    if (const Element* length = Child(element, "lengthComponent")) {
      muscle.optimal_length_m = Number(*length, "optimalLength", 1);
      muscle.width = Number(*length, "w", 1);
      muscle.c = Number(*length, "c", 1);
      muscle.use_length = Flag(*length, "use", true);
    }
    if (const Element* velocity = Child(element, "velocityComponent")) {
      // Negative in YARS, where muscles shorten at negative speeds.
      muscle.max_velocity_m_s = std::abs(Number(*velocity, "maxVelocity", 1));
      muscle.eccentric = Number(*velocity, "N", 1.5);
      muscle.curvature = Number(*velocity, "K", 5);
      muscle.use_velocity = Flag(*velocity, "use", true);
    }
    if (muscle.source == muscle.destination) {
      Error(element, "the muscle '" + Printable(muscle.name) + "' joins one body with itself");
      return;
    }
    MotorValue motor{.name = muscle.name, .joint = -1, .mode = "pwm", .line = muscle.line};
    motor.muscle = static_cast<int>(robot.muscles.size());
    motor.mapped = MappedOf(element, std::pair(0.0, 1.0));
    robot.motors.push_back(std::move(motor));
    robot.muscles.push_back(std::move(muscle));
  }

  void ReadMotor(const Element& element, Joint& joint) {
    const std::string type = Text(element, "type");
    const bool is_active = Text(element, "mode") == "active";
    const bool to_position = type == "angular" || type == "positional" || type == "force and angle";
    // In YARS the motor turns the source, but the angle is that of the destination. A joint with the world
    // has only one body.
    joint.counts_source = joint.destination == Joint::kWorld || (is_active && !to_position);
    joint.is_wheel = is_active && type == "velocity";
    joint.max_effort = NumberIn(element, "force", "max", 0);
    joint.max_velocity = NumberIn(element, "velocity", "max", 0);
    joint.is_driven = is_active && joint.max_effort > 0 && joint.max_velocity > 0;
    if (is_active && !joint.is_driven)
      Warn(element, "the joint '" + Printable(joint.name) +
                        "' has no motor: its force and its velocity must be above 0");
    if (!is_active) joint.friction = Number(element, "friction", 0);
    const Element* deflection = Child(element, "deflection");
    if (deflection == nullptr) return;
    const double unit = joint.kind == Joint::Kind::kHinge ? kRadPerDeg : 1;
    double least = Number(*deflection, "min", 0) * unit, most = Number(*deflection, "max", 0) * unit;
    if (least > most) {
      Error(*deflection, "'min' of <deflection> must not lie above 'max'");
      return;
    }
    // Stops limit the destination's angle, regardless of which body the motor turns.
    if (is_active && !to_position && joint.destination != Joint::kWorld) {
      std::swap(least, most);
      least = -least;
      most = -most;
    }
    joint.limit = {least, most};
  }
};

}  // namespace

void ReadActuators(const Element& actuators, Movable& robot, const std::string& file,
                   Diagnostics& diagnostics) {
  PublicActuators(file, diagnostics).Read(actuators, robot);
}

}  // namespace coopdyn::rosiml
