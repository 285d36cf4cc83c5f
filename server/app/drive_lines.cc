// SPDX-License-Identifier: MIT
#include "server/app/drive_lines.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "server/app/model_text.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The calls of a sample program: a command before the steps, a reading after them.
struct Try {
  std::string part,
      part_call;        // variable for a device, and the call that makes it; empty: use the robot
  std::string command;  // a call without ';'; empty: no command
  std::string reading;  // an expression
  std::string yarp;     // a shell line
};

bool IsPlain(std::string_view name) {
  constexpr std::size_t kLongest = 60;
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-.:/").find(c) != std::string_view::npos;
  });
}

std::string Rounded3(double value) {
  return FormatNumber(std::round(value * 1e3) / 1e3 + 0.0);
}

/// A joint by its name, or by its number if the name is not plain.
std::string JointWord(const std::string& name, std::size_t number) {
  return IsPlain(name) ? "'" + name + "'" : std::to_string(number);
}

/// A reachable position of the joint away from its start.
double GoalOf(const JointModel& joint) {
  const double way = joint.slides() ? 0.05 : 0.3;
  const double up = std::min(joint.start + way, joint.upper), down = std::max(joint.start - way, joint.lower);
  return up - joint.start >= joint.start - down ? up : down;
}

/// `value` repeated `count` times in brackets, and for YARP: (1 2) VALUE VALUE.
std::pair<std::string, std::string> ForEach(std::size_t count, const std::string& value) {
  std::string list, numbers, values;
  for (std::size_t i = 1; i <= count; ++i) {
    list += (i == 1 ? "" : ", ") + value;
    numbers += (i == 1 ? "" : " ") + std::to_string(i);
    values += " " + value;
  }
  return {"[" + list + "]", "(" + numbers + ")" + values};
}

/// Turns the wheels of a Mecanum drive at constant speed.
Try TryWheels(const std::string& name, const ActuatorModel& wheels) {
  const auto [list, yarp] = ForEach(wheels.joints.size(), "2");
  return {"j", "joints('wheels')", "set_velocities(" + list + ")", "r.get_pose()",
          "echo 'set_velocities " + yarp + "' | yarp rpc /" + name + "/wheels"};
}

/// Lets all thrusters push with 1.1 times the weight, if they can.
std::optional<Try> TryHover(const std::string& name, const RobotModel& model,
                            const ActuatorModel& thrusters) {
  constexpr double kGravity_m_s2 = 9.81, kRises = 1.1;
  const std::size_t count = thrusters.joints.size();
  const double each_n = kRises * kGravity_m_s2 * MovingMass(model) / static_cast<double>(count);
  const auto can = [&](int j) {
    const JointModel& one = model.joints[static_cast<std::size_t>(j)];
    return one.kind == JointModel::Kind::kForce && one.max_effort >= each_n;
  };
  if (!std::ranges::all_of(thrusters.joints, can)) return std::nullopt;
  const auto [list, yarp] = ForEach(count, Rounded3(each_n));
  return Try{"t", "thrusters()", "set_thrusts(" + list + ")", "r.get_pose_3d()",
             "echo 'set_thrusts " + yarp + "' | yarp rpc /" + name + "/" + thrusters.module};
}

Try TryBoard(const std::string& name, const RobotModel& model, const ActuatorModel& board) {
  const JointModel& joint = model.joints[static_cast<std::size_t>(board.joints.front())];
  const std::string quoted = JointWord(joint.name, 1);
  const double goal = GoalOf(joint);
  const double yarp = joint.slides() ? goal : goal * 180 / std::numbers::pi;
  return {"j", "joints('" + board.module + "')", "set_positions(" + Rounded3(goal) + ", " + quoted + ")",
          "j.get(" + quoted + ").position",
          "echo 'set pos 0 " + Rounded3(yarp) + "' | yarp rpc /" + name + "/" + board.module + "/rpc:i"};
}

/// Drives the first muscle or thruster.
Try TryFirst(const std::string& name, const RobotModel& model, const ActuatorModel& actuator) {
  const JointModel& one = model.joints[static_cast<std::size_t>(actuator.joints.front())];
  const bool thrusts = actuator.is_thrusters();
  const std::string value = thrusts ? Rounded3(one.max_effort / 2) : "0.5", quoted = JointWord(one.name, 1);
  const std::string command = thrusts ? "set_thrusts" : "set_activations";
  return {thrusts ? "t" : "m", thrusts ? "thrusters()" : "muscles()",
          command + "(" + value + ", " + quoted + ")", "r.get_pose_3d()",
          "echo '" + command + " (1) " + value + "' | yarp rpc /" + name + "/" + actuator.module};
}

std::string CallOf(const SensorModel& sensor) {
  constexpr std::pair<std::string_view, const char*> kCalls[] = {
      {ImuModel::kType, "get_imu"},           {WrenchModel::kType, "get_wrench"},
      {LidarModel::kType, "get_scan"},        {ContactModel::kType, "get_contacts"},
      {SonarModel::kType, "get_sonar"},       {InfraredModel::kType, "get_infrared"},
      {LightModel::kType, "get_light"},       {BatteryModel::kType, "get_battery"},
      {OdometryModel::kType, "get_odometry"}, {CompassModel::kType, "get_compass"}};
  for (const auto& [type, call] : kCalls) {
    if (type == sensor.type()) return call + ("('" + sensor.name + "')");
  }
  return {};
}

Try TrySensor(const std::string& name, const RobotModel& model) {
  for (const SensorModel& sensor : model.sensors) {
    const std::string call = CallOf(sensor);
    if (!call.empty())
      return {"", "", "", "r." + call, "yarp read ... /" + name + "/" + sensor.name + "/state:o"};
  }
  return {"", "", "", "r.get_pose_3d()", "yarp read ... /" + name + "/pose/state:o"};
}

Try TryOf(const std::string& name, const RobotModel& model) {
  if (const ActuatorModel* drive = model.drive_actuator(); drive != nullptr && !drive->module.empty()) {
    return {"", "", "set_velocity(0.2, 0.3)", "r.get_pose()",
            "echo 'set_velocity 0.2 0.3' | yarp rpc /" + name + "/" + drive->module};
  }
  for (const ActuatorModel& one : model.actuators) {
    if (one.module.empty() || one.joints.empty()) continue;
    if (one.is_board() && one.module == "wheels") return TryWheels(name, one);
    if (one.is_thrusters()) {
      if (auto hover = TryHover(name, model, one)) return *std::move(hover);
    }
    if (one.is_board()) return TryBoard(name, model, one);
    if (one.is_muscles() || one.is_thrusters()) return TryFirst(name, model, one);
  }
  return TrySensor(name, model);
}

}  // namespace

std::string ShellWord(const std::string& text) {
  const bool plain = !text.empty() && std::ranges::all_of(text, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-./:+@%,=").find(c) != std::string_view::npos;
  });
  if (plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

DriveLines DriveLinesFor(const std::string& file, const std::string& options, const std::string& name,
                         const RobotModel* model, double step_s) {
  DriveLines lines;
  lines.serve = "coopdyn serve " + ShellWord(file) + options + "\n";
  lines.yarp = "yarp conf 127.0.0.1 10000\n";
  if (model == nullptr) {
    lines.python = "import coopdyn\nsim = coopdyn.connect(); sim.step(); print(sim.time); sim.close()\n";
    lines.matlab = "sim = coopdyn.connect(); sim.step(); disp(sim.time); sim.close();\n";
    lines.yarp += "yarp read ... /clock\n";
    return lines;
  }
  const Try attempt = TryOf(name, *model);
  const std::string part = attempt.part.empty() ? "" : attempt.part + " = r." + attempt.part_call;
  const std::string command =
      attempt.command.empty() ? "" : (attempt.part.empty() ? "r." : attempt.part + ".") + attempt.command;
  const auto line = [](const std::string& text, const char* end) { return text.empty() ? "" : text + end; };
  const std::string steps = std::to_string(std::max(1L, std::lround(1 / step_s)));
  const std::string robot = "sim = coopdyn.connect(); r = sim.robot('" + name + "')";
  lines.python = "import coopdyn\n" + robot + (part.empty() ? "" : "; " + part) + "\n" + line(command, "\n") +
                 "for k in range(" + steps + "): sim.step()\nprint(" + attempt.reading + "); sim.close()\n";
  lines.matlab = robot + ";" + (part.empty() ? "" : " " + part + ";") + "\n" + line(command, ";\n") +
                 "for k = 1:" + steps + ", sim.step(); end\ndisp(" + attempt.reading + "); sim.close();\n";
  lines.yarp += attempt.yarp + "\n";
  return lines;
}

}  // namespace coopdyn
