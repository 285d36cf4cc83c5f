// SPDX-License-Identifier: MIT
// The commands of control boards: groups of joints.
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/spec_parts.h"

namespace coopdyn {

namespace {

/// The joints that a command applies to: the module's ids, from 1; none means all.
ValueSpec JointParam() {
  ValueSpec joint = Repeated("joint");
  joint.min = 1;
  return joint;
}

ValueSpec ModeValue() {
  ValueSpec mode = Repeated("mode");
  mode.enums = {{"idle", 0}, {"position", 1}, {"direct", 2}, {"velocity", 3}, {"effort", 4}, {"pwm", 5}};
  return mode;
}

/// Repeated values; inf means "none".
ValueSpec AnyNumber(std::string name, std::string unit) {
  ValueSpec value = Repeated(std::move(name), std::move(unit));
  value.any_number = true;
  return value;
}

/// A command that takes effect with a step; its reply is that of every actuator command.
CommandSpec Command(std::int32_t id, std::string name, std::string help, std::vector<ValueSpec> data,
                    std::string example) {
  return {.id = id,
          .name = std::move(name),
          .help = std::move(help),
          .params = {JointParam()},
          .data = std::move(data),
          .reply_params = StepReplyParams(),
          .reply_data = StepReplyData(),
          .reply_text = "`limited to …` if it was beyond the limits",
          .example = std::move(example)};
}

/// A command that changes how joints are driven; takes effect between two steps.
CommandSpec Tuning(std::int32_t id, std::string name, std::string help, std::vector<ValueSpec> data,
                   std::string example) {
  return {.id = id,
          .name = std::move(name),
          .help = std::move(help),
          .params = {JointParam()},
          .data = std::move(data),
          .example = std::move(example)};
}

CommandSpec OfJoints(CommandSpec reading) {
  reading.params = {JointParam()};
  return reading;
}

}  // namespace

CommandTable JointsTable() {
  std::vector<CommandSpec> own = {
      OfJoints(
          Reading(command::kGetJoints, "get_joints",
                  "Returns where each joint is, how fast, and the effort of its motor.",
                  {Repeated("position", "rad"), Repeated("velocity", "rad/s"), Repeated("effort", "N m")})),
      Command(command::kSetPositions, "set_positions",
              "Moves joints to positions, within their profile of speed and acceleration.",
              {Repeated("position", "rad")}, "set_positions (1 3) 0.5 0.2"),
      Command(command::kSetPositionsDirect, "set_positions_direct",
              "Sets where joints are to be at the end of the step.", {Repeated("position", "rad")},
              "set_positions_direct (1) 0.5"),
      Command(command::kSetVelocities, "set_velocities", "Sets the velocities of joints.",
              {Repeated("velocity", "rad/s")}, "set_velocities (1) 0.2"),
      Command(command::kSetEfforts, "set_efforts", "Sets the efforts of the motors.",
              {Repeated("effort", "N m")}, "set_efforts (1) 1.5"),
      Command(command::kSetPwm, "set_pwm",
              "Sets the duties of the motors of drive trains, from -1 to 1; 0 brakes.", {Repeated("duty")},
              "set_pwm (1) 0.5"),
      OfJoints(
          Reading(command::kGetDriveTrains, "get_drive_trains",
                  "Returns the drive trains of joints: where the rotor is, as the joint counts, how fast, "
                  "the motor's current and the energy that it has drawn; nan without one.",
                  {AnyNumber("rotor_position", "rad"), AnyNumber("rotor_velocity", "rad/s"),
                   AnyNumber("current", "A"), AnyNumber("energy", "J")})),
      Command(command::kSetModes, "set_modes",
              "Sets how joints are driven; each stays where it is until its next command.", {ModeValue()},
              "set_modes (1) effort"),
      OfJoints(Reading(command::kGetModes, "get_modes", "Returns how joints are driven.", {})),
      Tuning(command::kSetCompliance, "set_compliance",
             "Makes joints springs and dampers at their position: effort = k (reference - position) - d "
             "velocity + "
             "offset; k inf makes it a servo again.",
             {AnyNumber("k", "N m/rad"), Repeated("d", "N m s/rad"), Repeated("offset", "N m")},
             "set_compliance (1) 50 2 0"),
      OfJoints(Reading(command::kGetCompliance, "get_compliance",
                       "Returns stiffness, damping and offset of joints.",
                       {Repeated("k", "N m/rad"), Repeated("d", "N m s/rad"), Repeated("offset", "N m")})),
      Tuning(command::kSetProfile, "set_profile", "Sets how fast joints move to positions.",
             {Repeated("speed", "rad/s"), Repeated("acceleration", "rad/s2")}, "set_profile (1) 0.5 2"),
      OfJoints(Reading(command::kGetProfile, "get_profile", "Returns how fast joints move to positions.",
                       {Repeated("speed", "rad/s"), Repeated("acceleration", "rad/s2")})),
      Tuning(command::kSetGains, "set_gains", "Sets the gains of the servos: velocity per position error.",
             {Repeated("p", "1/s"), Repeated("i", "1/s2"), Repeated("d")}, "set_gains (1) 100 0 0"),
      OfJoints(Reading(command::kGetGains, "get_gains", "Returns the gains of the servos.",
                       {Repeated("p", "1/s"), Repeated("i", "1/s2"), Repeated("d")})),
      OfJoints(Reading(command::kGetJointLimits, "get_limits", "Returns the limits of joints; inf = none.",
                       {Repeated("lower", "rad"), Repeated("upper", "rad"), Repeated("velocity", "rad/s"),
                        Repeated("effort", "N m")})),
      OfJoints(Reading(command::kGetMotion, "get_motion",
                       "Returns which joints have ended their motion (1) and where each one goes.",
                       {Repeated("target", "rad")})),
      OfJoints(Reading(
          command::kGetReferences, "get_references",
          "Returns the reference in force of each joint: position, velocity, effort or duty by its mode.",
          {Repeated("reference")})),
      Command(command::kHold, "hold", "Holds joints where they are.", {}, "hold (1)"),
      Reading(command::kGetChain, "get_chain",
              "Returns the chain of joints from base to tool in R, all joints at 0: for each a point of its "
              "axis and "
              "the axis; then the tool's pose.",
              {Repeated("value")}),
      OfJoints(Reading(
          command::kGetBoard, "get_board", "Returns all that the other readings tell of joints, in one.",
          {Repeated("position", "rad"), Repeated("velocity", "rad/s"), Repeated("effort", "N m"),
           Repeated("target", "rad"), Repeated("reference"), Repeated("lower", "rad"),
           Repeated("upper", "rad"), Repeated("max_velocity", "rad/s"), Repeated("max_effort", "N m"),
           Repeated("k", "N m/rad"), Repeated("d", "N m s/rad"), Repeated("offset", "N m"),
           Repeated("speed", "rad/s"), Repeated("acceleration", "rad/s2"), Repeated("p", "1/s"),
           Repeated("i", "1/s2"), Repeated("gain_d"), Repeated("resolution", "rad")})),
  };
  for (CommandSpec& spec : own) {
    if (spec.id == command::kGetModes) spec.reply_params = {ModeValue()};
    if (spec.id == command::kGetMotion) spec.reply_params = {Repeated("arrived")};
    if (spec.id == command::kGetBoard) {
      ValueSpec kind = Repeated("kind");
      kind.enums = {{"turns", 0}, {"slides", 1}};
      spec.reply_params = {std::move(kind), ModeValue(), Repeated("arrived")};
    }
    if (spec.id == command::kGetJointLimits || spec.id == command::kGetBoard)
      spec.reply_text = "the joints' names, separated by spaces";
    if (spec.id == command::kGetChain) {
      spec.reply_params = {Repeated("joint"), Repeated("kind")};
      spec.reply_text = "the tool's name";
    }
    if (spec.id == command::kSetModes || spec.id == command::kHold) spec.reply_text.clear();
  }
  return CommandTable("joints", std::move(own));
}

}  // namespace coopdyn
