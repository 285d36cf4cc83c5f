// SPDX-License-Identifier: MIT
// The command tables of the sensors of robots from files.
#include <utility>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/spec_parts.h"

namespace coopdyn {

CommandTable ImuTable() {
  return CommandTable(
      "imu",
      {Reading(
          command::kGetImu, "get_imu",
          "Returns how the sensor is turned in the world, its turn rates and its acceleration, in "
          "its own frame: at rest and level 9.81 along z.",
          {Value("qw"), Value("qx"), Value("qy"), Value("qz"), Value("wx", "rad/s"), Value("wy", "rad/s"),
           Value("wz", "rad/s"), Value("ax", "m/s2"), Value("ay", "m/s2"), Value("az", "m/s2")})});
}

CommandTable WrenchTable() {
  return CommandTable("wrench", {Reading(command::kGetWrench, "get_wrench",
                                         "Returns force and torque through the joint, in the sensor's frame.",
                                         {Value("fx", "N"), Value("fy", "N"), Value("fz", "N"),
                                          Value("tx", "N m"), Value("ty", "N m"), Value("tz", "N m")})});
}

CommandTable LidarTable() {
  CommandSpec geometry = Reading(
      command::kGetScanGeometry, "get_scan_geometry",
      "Returns the angles and limits of the rays. A ray of column c and row r points to azimuth first + c "
      "increment, left positive, and elevation low + r step, up positive.",
      {Value("first", "rad"), Value("increment", "rad"), Value("min_range", "m"), Value("max_range", "m"),
       Value("rows"), Value("columns"), Value("low", "rad"), Value("step", "rad")});
  return CommandTable("lidar",
                      {Reading(command::kGetScan, "get_scan",
                               "Returns one range per ray, right to left, row by row from the lowest; "
                               "inf = nothing in range, 0 = nearer than the minimum.",
                               {Repeated("range", "m")}),
                       std::move(geometry)});
}

CommandTable ContactTable() {
  CommandSpec contacts =
      Reading(command::kGetContacts, "get_contacts",
              "Returns what touches the sensor: for each contact the force, the point and the direction in "
              "which it pushes, in the robot's frame.",
              {Repeated("force", "N"), Repeated("x", "m"), Repeated("y", "m"), Repeated("z", "m"),
               Repeated("nx"), Repeated("ny"), Repeated("nz")});
  contacts.reply_params = {Repeated("id")};
  contacts.reply_text = "the names of what touches it, in the same order, separated by spaces";
  return CommandTable("contact",
                      {std::move(contacts), Reading(command::kGetBumper, "get_bumper",
                                                    "Returns 1 for each zone of the bumper that is "
                                                    "pressed, else 0, right to left.",
                                                    {Repeated("pressed")})});
}

CommandTable SonarTable() {
  return CommandTable("sonar", {Reading(command::kGetSonar, "get_sonar",
                                        "Returns for each sonar the range of the nearest thing in its cone; "
                                        "inf = nothing in range, 0 = nearer than the minimum.",
                                        {Repeated("range", "m")})});
}

CommandTable InfraredTable() {
  return CommandTable("infrared", {Reading(command::kGetInfrared, "get_infrared",
                                           "Returns what each infrared sensor puts out, by its curve.",
                                           {Repeated("value")})});
}

CommandTable LightTable() {
  return CommandTable("light", {Reading(command::kGetLight, "get_light",
                                        "Returns how much light each sensor sees.", {Repeated("light")})});
}

CommandTable CameraTable() {
  CommandSpec image{
      .id = command::kGetImage,
      .name = "get_image",
      .help = "Returns a picture; its bytes are in params, four to a number, the first the lowest.",
      .params = {{.name = "format",
                  .unit = "",
                  .optional = true,
                  .enums = {{"rgb", 0}, {"jpeg", 1}, {"depth", 2}, {"segmentation", 3}}}},
      .reply_params = {Value("width"), Value("height"), Value("bytes"), Repeated("word")},
      .reply_text = "of a segmentation: the names of what is seen, as `NUMBER=NAME`",
      .example = "get_image jpeg",
      .no_push =
          "get_image is not pushed; ask for each picture with get_image, or read "
          "/camera.mjpg by HTTP"};
  return CommandTable(
      "camera", {Reading(command::kGetCamera, "get_camera",
                         "Returns the size of the picture in pixels, focal lengths and middle in pixels, the "
                         "nearest and the furthest that it sees, and its rate; 0: each step.",
                         {Value("width"), Value("height"), Value("fx"), Value("fy"), Value("cx"), Value("cy"),
                          Value("near", "m"), Value("far", "m"), Value("rate", "Hz")}),
                 std::move(image)});
}

CommandTable BatteryTable() {
  return CommandTable("battery", {Reading(command::kGetBattery, "get_battery",
                                          "Returns what is left of the battery and what is drawn from it.",
                                          {Value("energy", "J"), Value("fraction"), Value("power", "W")})});
}

CommandTable OdometryTable() {
  return CommandTable(
      "odometry",
      {Reading(
          command::kGetOdometry, "get_odometry",
          "Returns where the wheels' encoders say that the robot is and how it moves: 0 0 0 at the start, "
          "x ahead.",
          {Value("x", "m"), Value("y", "m"), Value("heading", "rad"), Value("forward", "m/s"),
           Value("turn", "rad/s")})});
}

CommandTable ChannelTable() {
  CommandSpec values =
      Reading(command::kGetValues, "get_values",
              "Returns the values of the channel, mapped as its model says.", {Repeated("value")});
  values.reply_text = "`aborted` if the try is to end or the run has ended, else empty";
  CommandSpec motors{.id = command::kSetMotors,
                     .name = "set_motors",
                     .help =
                         "Sets all motors of the channel, mapped; answered after the steps of one "
                         "exchange, or after as many as said, with the values.",
                     .params = {StepsParam()},
                     .data = {Repeated("motor")},
                     .reply_params = StepReplyParams(),
                     .reply_data = {Repeated("value")},
                     .reply_text = "`aborted` if the try is to end or the run has ended, else empty",
                     .example = "set_motors 0.5 0.5"};
  CommandSpec channel = Reading(
      command::kGetChannel, "get_channel",
      "Returns for each motor, then each value, the internal and the external range, inf = not mapped, "
      "1 if it is for the experimenter alone, and the number of its link.",
      {Repeated("internal_min"), Repeated("internal_max"), Repeated("external_min"), Repeated("external_max"),
       Repeated("auxiliary"), Repeated("link")});
  channel.reply_params = {Value("motors"), Value("values"), Value("steps"), Value("links")};
  channel.reply_text = "the names, in the same order, separated by spaces";
  channel.no_push = "get_channel never changes: ask for it once";
  return CommandTable("channel", {std::move(values), std::move(motors), std::move(channel)});
}

}  // namespace coopdyn
