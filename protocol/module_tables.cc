// SPDX-License-Identifier: MIT
#include "protocol/module_tables.h"

#include <algorithm>
#include <utility>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/spec_parts.h"

namespace coopdyn {
namespace {

/// An actuator command: optional `steps`; the reply carries the mode and the attached readings.
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

}  // namespace

CommandTable MotorsTable() {
  std::vector<CommandSpec> own = {
      Actuator(command::kSetWheelSpeeds, "set_wheel_speeds", "Sets the speeds of the two wheels.",
               {Value("left", "rad/s"), Value("right", "rad/s")}, "set_wheel_speeds 2 2"),
      Actuator(command::kSetVelocity, "set_velocity", "Sets forward speed and turn rate (left is positive).",
               {Value("linear", "m/s"), Value("angular", "rad/s")}, "set_velocity 0.2 0.5"),
      Reading(command::kGetWheels, "get_wheels", "Returns angle and speed of the wheels.",
              {Value("left_angle", "rad"), Value("right_angle", "rad"), Value("left_speed", "rad/s"),
               Value("right_speed", "rad/s")}),
      Reading(command::kGetLimits, "get_limits",
              "Returns the limit of the wheel speeds and the dimensions of the drive.",
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
                  "Returns one range per sensor, right to left, from the surface of the chassis; inf = "
                  "nothing in range.",
                  {Repeated("range", "m")}),
          Reading(command::kGetGeometry, "get_geometry",
                  "Returns for each sensor, right to left, its direction, its opening and its range.",
                  {Repeated("bearing", "rad"), Repeated("opening", "rad"), Repeated("max_range", "m")}),
      });
}

CommandTable TargetTable() {
  CommandSpec targets =
      Reading(command::kGetTargets, "get_targets", "Returns distance and bearing of every target.",
              {Repeated("distance", "m"), Repeated("bearing", "rad")});
  targets.reply_params = {Repeated("id")};
  targets.reply_text = "their colours, in the same order, separated by spaces";
  CommandSpec target{.id = command::kGetTarget,
                     .name = "get_target",
                     .help = "Returns distance and bearing of one target, or of the nearest of a colour.",
                     .text = TextUse::kOrNumber,
                     .text_name = "COLOUR",
                     .params = {{.name = "id", .unit = "", .min = 1}},
                     .reply_data = {Value("distance", "m"), Value("bearing", "rad")},
                     .example = "get_target red"};
  CommandSpec robots =
      Reading(command::kGetRobots, "get_robots", "Returns distance and bearing of every other robot.",
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
                  "Returns where the robot is and how it moves, in the world frame.",
                  {Value("x", "m"), Value("y", "m"), Value("heading", "rad"), Value("forward", "m/s"),
                   Value("turn", "rad/s")}),
          Reading(command::kGetPose3d, "get_pose_3d",
                  "Returns position, quaternion and both velocities, in the world frame (ground truth).",
                  {Value("x", "m"), Value("y", "m"), Value("z", "m"), Value("qw"), Value("qx"), Value("qy"),
                   Value("qz"), Value("vx", "m/s"), Value("vy", "m/s"), Value("vz", "m/s"),
                   Value("wx", "rad/s"), Value("wy", "rad/s"), Value("wz", "rad/s")}),
      });
}

CommandTable NeighboursTable() {
  CommandSpec neighbours =
      Reading(command::kGetNeighbours, "get_neighbours",
              "Returns distance and bearing of every robot within range, also behind obstacles.",
              {Repeated("distance", "m"), Repeated("bearing", "rad")});
  neighbours.reply_params = {Repeated("id")};
  neighbours.reply_text = "their names, in the same order, separated by spaces";
  CommandSpec send{.id = command::kSendMessage,
                   .name = "send_message",
                   .help =
                       "Broadcasts one to eight numbers in the next step. A later message before that step "
                       "replaces this one.",
                   .data = {Value("value1")},
                   .example = "send_message 1 0.5"};
  for (int i = 2; i <= 8; ++i) {
    send.data.push_back({.name = "value" + std::to_string(i), .unit = "", .optional = true});
  }
  CommandSpec messages = Reading(command::kGetMessages, "get_messages",
                                 "Returns the messages heard in this step, each as distance m and bearing "
                                 "rad of the sender, then its numbers.",
                                 {Repeated("value")});
  messages.reply_params = {Repeated("sender"), Repeated("count")};
  CommandSpec link =
      Reading(command::kGetLink, "get_link",
              "Returns how far this robot sees others and is heard, which part of the messages is lost, and "
              "their delay.",
              {Value("range", "m"), Value("message_range", "m"), Value("loss"), Value("delay", "s")});
  return CommandTable("neighbours",
                      {std::move(neighbours), std::move(send), std::move(messages), std::move(link)});
}

CommandTable CompassTable() {
  return CommandTable(
      "compass", {Reading(command::kGetCompass, "get_compass",
                          "Returns where the robot's front points in the world: 0 along x, left positive.",
                          {Value("heading", "rad")})});
}

CommandTable SupportTable() {
  return CommandTable(
      "support", {Reading(command::kGetSupport, "get_support",
                          "Returns how far the load has moved the support that carries it, in the robot's "
                          "frame: 0 0 0 in its middle.",
                          {Value("x", "m"), Value("y", "m"), Value("angle", "rad")})});
}

const std::vector<CommandTable>& AllModuleTables() {
  static const std::vector<CommandTable> tables = {
      MotorsTable(),   JointsTable(),     MusclesTable(), ThrustersTable(),  DistanceTable(), TargetTable(),
      PoseTable(),     NeighboursTable(), CompassTable(), SupportTable(),    ImuTable(),      WrenchTable(),
      LidarTable(),    ContactTable(),    SonarTable(),   InfraredTable(),   LightTable(),    CameraTable(),
      BatteryTable(),  OdometryTable(),   ChannelTable(), SimulationTable(), WorldTable(),    SwarmTable(),
      RecorderTable(), PlaybackTable()};
  return tables;
}

const CommandTable* FindModuleTable(std::string_view name) {
  const std::vector<CommandTable>& tables = AllModuleTables();
  const auto found = std::ranges::find(tables, name, &CommandTable::module);
  return found == tables.end() ? nullptr : &*found;
}

}  // namespace coopdyn
