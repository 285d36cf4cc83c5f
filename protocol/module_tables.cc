// SPDX-License-Identifier: MIT
#include "protocol/module_tables.h"

#include <utility>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"

namespace coopdyn {
namespace {

ValueSpec Value(std::string name, std::string unit = "") {
  return {.name = std::move(name), .unit = std::move(unit)};
}

ValueSpec Repeated(std::string name, std::string unit = "") {
  return {.name = std::move(name), .unit = std::move(unit), .repeated = true};
}

/// An actuator command: optional `steps`, answered with the mode and the attached readings.
CommandSpec Actuator(std::int32_t id, std::string name, std::string help, std::vector<ValueSpec> data,
                     std::string example) {
  return {.id = id,
          .name = std::move(name),
          .help = std::move(help),
          .params = {StepsParam()},
          .data = std::move(data),
          .reply_params = StepReplyParams(),
          .reply_data = StepReplyData(),
          .reply_text = "`limited to …` if it was scaled",
          .example = std::move(example)};
}

/// A command that takes nothing and answers with `data`.
CommandSpec Reading(std::int32_t id, std::string name, std::string help, std::vector<ValueSpec> data) {
  std::string example = name;
  return {.id = id,
          .name = std::move(name),
          .help = std::move(help),
          .reply_data = std::move(data),
          .example = std::move(example)};
}

/// A command that takes nothing and answers with time and step only.
CommandSpec Order(std::int32_t id, std::string name, std::string help) {
  return Reading(id, std::move(name), std::move(help), {});
}

}  // namespace

CommandTable MotorsTable() {
  std::vector<CommandSpec> own = {
      Actuator(command::kSetWheelSpeeds, "set_wheel_speeds", "Sets the speeds of the two wheels.",
               {Value("left", "rad/s"), Value("right", "rad/s")}, "set_wheel_speeds 2 2"),
      Actuator(command::kSetVelocity, "set_velocity", "Sets forward speed and turn rate (left is positive).",
               {Value("linear", "m/s"), Value("angular", "rad/s")}, "set_velocity 0.2 0.5"),
      Reading(command::kGetWheels, "get_wheels", "Tells angle and speed of the wheels.",
              {Value("left_angle", "rad"), Value("right_angle", "rad"), Value("left_speed", "rad/s"),
               Value("right_speed", "rad/s")}),
      Reading(command::kGetLimits, "get_limits",
              "Tells the limit of the wheel speeds and the sizes of the drive.",
              {Value("max_wheel_speed", "rad/s"), Value("wheel_radius", "m"), Value("track", "m")}),
      Actuator(command::kStop, "stop", "Stops both wheels.", {}, "stop"),
  };
  own.back().reply_text.clear();
  return CommandTable("motors", std::move(own));
}

CommandTable DistanceTable() {
  return CommandTable(
      "distance",
      {
          Reading(command::kGetDistances, "get_distances",
                  "Tells one range per sensor, right to left, from the surface of the chassis; inf = nothing "
                  "in range.",
                  {Repeated("range", "m")}),
          Reading(command::kGetGeometry, "get_geometry",
                  "Tells of each sensor, right to left, where it looks, how wide and how far.",
                  {Repeated("bearing", "rad"), Repeated("opening", "rad"), Repeated("max_range", "m")}),
      });
}

CommandTable TargetTable() {
  CommandSpec targets =
      Reading(command::kGetTargets, "get_targets", "Tells distance and bearing of every target.",
              {Repeated("distance", "m"), Repeated("bearing", "rad")});
  targets.reply_params = {Repeated("id")};
  targets.reply_text = "their colours, in the same order, separated by spaces";
  CommandSpec target{.id = command::kGetTarget,
                     .name = "get_target",
                     .help = "Tells distance and bearing of one target, or of the nearest of a colour.",
                     .text = TextUse::kOrNumber,
                     .text_name = "COLOUR",
                     .params = {{.name = "id", .unit = "", .min = 1}},
                     .reply_data = {Value("distance", "m"), Value("bearing", "rad")},
                     .example = "get_target red"};
  CommandSpec robots =
      Reading(command::kGetRobots, "get_robots", "Tells distance and bearing of every other robot.",
              {Repeated("distance", "m"), Repeated("bearing", "rad")});
  robots.reply_params = {Repeated("id")};
  robots.reply_text = "their names, likewise";
  return CommandTable("target", {std::move(targets), std::move(target), std::move(robots)});
}

CommandTable PoseTable() {
  return CommandTable(
      "pose",
      {
          Reading(command::kGetPose, "get_pose",
                  "Tells where the robot is and how it moves, in the world frame.",
                  {Value("x", "m"), Value("y", "m"), Value("heading", "rad"), Value("forward", "m/s"),
                   Value("turn", "rad/s")}),
          Reading(command::kGetPose3d, "get_pose_3d",
                  "Tells position, quaternion and both velocities, in the world frame (ground truth).",
                  {Value("x", "m"), Value("y", "m"), Value("z", "m"), Value("qw"), Value("qx"), Value("qy"),
                   Value("qz"), Value("vx", "m/s"), Value("vy", "m/s"), Value("vz", "m/s"),
                   Value("wx", "rad/s"), Value("wy", "rad/s"), Value("wz", "rad/s")}),
      });
}

CommandTable NeighboursTable() {
  CommandSpec neighbours =
      Reading(command::kGetNeighbours, "get_neighbours",
              "Tells distance and bearing of every robot within range, obstacles or not.",
              {Repeated("distance", "m"), Repeated("bearing", "rad")});
  neighbours.reply_params = {Repeated("id")};
  neighbours.reply_text = "their names, in the same order, separated by spaces";
  CommandSpec send{.id = command::kSendMessage,
                   .name = "send_message",
                   .help = "Broadcasts one to eight numbers in the next step; the last one before it counts.",
                   .data = {Value("value1")},
                   .example = "send_message 1 0.5"};
  for (int i = 2; i <= 8; ++i) {
    send.data.push_back({.name = "value" + std::to_string(i), .unit = "", .optional = true});
  }
  CommandSpec messages =
      Reading(command::kGetMessages, "get_messages",
              "Tells what is heard now, per message: distance m, bearing rad of the sender, "
              "then the numbers it sent.",
              {Repeated("value")});
  messages.reply_params = {Repeated("sender"), Repeated("count")};
  CommandSpec link =
      Reading(command::kGetLink, "get_link",
              "Tells how far this robot sees others and is heard, which part of the messages is "
              "lost, and how late they come.",
              {Value("range", "m"), Value("message_range", "m"), Value("loss"), Value("delay", "s")});
  return CommandTable("neighbours",
                      {std::move(neighbours), std::move(send), std::move(messages), std::move(link)});
}

CommandTable SimulationTable() {
  CommandSpec status = Order(command::kGetStatus, "get_status", "Tells the state of the whole simulation.");
  status.reply_text = "JSON";
  status.params = {{.name = "first", .unit = "", .optional = true, .min = 1},
                   {.name = "count", .unit = "", .optional = true, .min = 0}};
  return CommandTable(
      "simulation",
      {
          std::move(status),
          Order(command::kRun, "run", "Lets time go on."),
          Order(command::kPause, "pause", "Holds time."),
          {.id = command::kStep,
           .name = "step",
           .help = "Allows so many more steps while paused, and is answered after the last of them.",
           .params = {{.name = "steps", .unit = "", .min = 1}},
           .example = "step 10"},
          {.id = command::kReset,
           .name = "reset",
           .help = "Starts again at step 0; with a new seed if one is given.",
           .params = {{.name = "seed", .unit = "", .optional = true}},
           .example = "reset 7"},
          {.id = command::kSetMode,
           .name = "set_mode",
           .help = "Chooses the time mode.",
           .params = {{.name = "mode", .unit = "", .enums = ModeWords()}},
           .example = "set_mode lockstep"},
          {.id = command::kSetStep,
           .name = "set_step",
           .help = "Sets the length of a step, 0.0005 to 0.1 s.",
           .data = {Value("step", "s")},
           .example = "set_step 0.01"},
          {.id = command::kSetSpeed,
           .name = "set_speed",
           .help = "Sets how fast time goes against the wall clock; 0 or less = no limit.",
           .data = {Value("factor")},
           .example = "set_speed 2"},
          {.id = command::kLoadScenario,
           .name = "load_scenario",
           .help = "Loads a scenario: a name on the search path, or the text of the file.",
           .text = TextUse::kRest,
           .text_name = "SCENARIO",
           .example = "load_scenario corridor"},
          Order(command::kQuit, "quit", "Ends the daemon."),
          Order(command::kStopAll, "stop_all", "Stops every robot."),
          {.id = command::kSetParticipants,
           .name = "set_participants",
           .help = "Chooses the robots that lockstep waits for; without names, as the scenario says.",
           .text = TextUse::kRest,
           .text_name = "ROBOT…",
           .example = "set_participants robot1 robot2",
           .text_optional = true},
          Order(command::kReload, "reload", "Loads the same scenario file again from disk."),
          {.id = command::kReleaseRobot,
           .name = "release_robot",
           .help = "Closes the owner's connection to a robot, or unloads its controller. In text also "
                   "`release ROBOT`.",
           .text = TextUse::kRest,
           .text_name = "ROBOT",
           .example = "release_robot robot1",
           .alias = "release"},
      });
}

CommandTable SwarmTable() {
  const auto team = [](std::int32_t id, std::string name, std::string help) {
    CommandSpec spec = Order(id, std::move(name), std::move(help));
    spec.reply_params = {Repeated("id")};
    spec.reply_text = "the names of the team, separated by spaces";
    return spec;
  };
  CommandSpec claim =
      team(command::kClaim, "claim",
           "Takes robots or whole swarms with all their actuators, or none; without names all "
           "that nobody drives.");
  CommandSpec release =
      team(command::kRelease, "release", "Gives robots or whole swarms of this team up; without names all.");
  for (CommandSpec* spec : {&claim, &release}) {
    spec->text = TextUse::kRest;
    spec->text_name = "NAME…";
    spec->text_optional = true;
  }
  claim.example = "claim robot1 robot2";
  release.example = "release robot2";
  const ValueSpec robot{.name = "robot", .unit = "", .repeated = true, .min = 1};
  const std::vector<ValueSpec> table_shape = {
      {.name = "mode", .unit = "", .enums = ModeWords()}, Value("rows"), Value("columns")};
  return CommandTable(
      "swarm",
      {
          std::move(claim),
          std::move(release),
          {.id = command::kStepAll,
           .name = "step_all",
           .help =
               "Sets the speeds of robots of the team (none named: all; others are claimed), or with wheels "
               "left and right rad/s; without data keeps them; answered after the next step.",
           .text = TextUse::kFirst,
           .text_name = "velocities or wheels",
           .params = {robot},
           .data = {Repeated("linear", "m/s"), Repeated("angular", "rad/s")},
           .reply_params = table_shape,
           .reply_data = {Repeated("reading")},
           .reply_text = "`limited N robots` if some were scaled; who was taken from the team",
           .example = "step_all (1 2) 0.2 0.5 0.1 0"},
          {.id = command::kSelectReadings,
           .name = "select_readings",
           .help =
               "Chooses the columns of step_all and read_all among pose, distances, targets, neighbours (so "
               "many nearest, else 8) and wheels; without words pose distances.",
           .text = TextUse::kRest,
           .text_name = "READING…",
           .params = {{.name = "nearest", .unit = "", .optional = true, .min = 1}},
           .reply_params = {Repeated("columns")},
           .reply_text = "the names of the readings, separated by spaces",
           .example = "select_readings pose distances",
           .text_optional = true},
          {.id = command::kReadAll,
           .name = "read_all",
           .help = "Tells the same as step_all, at once, of the team or of any robots.",
           .params = {robot},
           .reply_params = table_shape,
           .reply_data = {Repeated("reading")},
           .example = "read_all 1 2"},
          team(command::kGetTeam, "get_team", "Tells which robots this connection owns."),
          Order(command::kStopTeam, "stop_team", "Stops all robots of the team."),
      });
}

std::vector<CommandTable> AllModuleTables() {
  std::vector<CommandTable> tables;
  tables.push_back(MotorsTable());
  tables.push_back(DistanceTable());
  tables.push_back(TargetTable());
  tables.push_back(PoseTable());
  tables.push_back(NeighboursTable());
  tables.push_back(SimulationTable());
  tables.push_back(SwarmTable());
  return tables;
}

}  // namespace coopdyn
