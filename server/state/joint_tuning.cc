// SPDX-License-Identifier: MIT
#include "server/state/joint_tuning.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "protocol/command_ids.h"

namespace coopdyn {

namespace {

constexpr double kLargest = 1e9;

bool IsWithin(double value, double least) {
  return value >= least && value <= kLargest;
}

/// Changes one joint by its values. Returns an error text.
std::string Tune(std::int32_t command, const double* values, const JointModel& joint, JointControl& control) {
  const std::string of = " of joint " + joint.name;
  switch (command) {
    case command::kSetCompliance:
      if (!IsWithin(values[0], 0) && !std::isinf(values[0])) {
        return fmt::format("the stiffness{} is {:.6g}: write 0 to 1e9, or inf for a servo", of, values[0]);
      }
      if (!IsWithin(values[1], 0)) {
        return fmt::format("the damping{} is {:.6g}: write 0 to 1e9", of, values[1]);
      }
      if (!(std::abs(values[2]) <= kLargest)) {
        return fmt::format("the offset{} is {:.6g}: write -1e9 to 1e9", of, values[2]);
      }
      if (values[0] < 0) return fmt::format("the stiffness{} is -inf: write 0 to 1e9, or inf", of);
      control.stiffness = values[0];
      control.damping = values[1];
      control.offset = values[2];
      return {};
    case command::kSetProfile: {
      const double fastest = joint.max_velocity;
      if (!(values[0] > 0) || values[0] > fastest) {
        return fmt::format("the speed{} is {:.6g}: write a number above 0, at most its limit {:.6g}", of,
                           values[0], fastest);
      }
      if (!(values[1] > 0) || values[1] > kLargest) {
        return fmt::format("the acceleration{} is {:.6g}: write a number above 0, at most 1e9", of,
                           values[1]);
      }
      control.speed = values[0];
      control.acceleration = values[1];
      return {};
    }
    default:
      for (int i = 0; i < 3; ++i) {
        if (!IsWithin(values[i], 0)) {
          return fmt::format("the gain {}{} is {:.6g}: write 0 to 1e9", "pid"[i], of, values[i]);
        }
      }
      control.p = values[0];
      control.i = values[1];
      control.d = values[2];
      control.integral = 0;
      return {};
  }
}

}  // namespace

bool IsTuning(std::int32_t command) {
  return command == command::kSetCompliance || command == command::kSetProfile ||
         command == command::kSetGains;
}

std::size_t ValuesPerJoint(std::int32_t command) {
  return command == command::kSetProfile ? 2 : IsTuning(command) ? 3 : 1;
}

std::vector<std::size_t> JointsOf(const std::vector<std::int32_t>& ids, std::size_t count, std::string& why,
                                  const char* what) {
  std::vector<std::size_t> joints(ids.empty() ? count : ids.size());
  std::iota(joints.begin(), joints.end(), std::size_t{0});
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool is_joint = ids[i] >= 1 && static_cast<std::size_t>(ids[i]) <= count;
    if (!is_joint) {
      why = fmt::format("there is no {0} {1}: this module has {0}s 1 to {2}", what, ids[i], count);
      return {};
    }
    if (std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(i), ids[i]) !=
        ids.begin() + static_cast<std::ptrdiff_t>(i)) {
      why = fmt::format("{0} {1} is named twice: name each {0} once", what, ids[i]);
      return {};
    }
    joints[i] = static_cast<std::size_t>(ids[i]) - 1;
  }
  return joints;
}

std::string TuneControls(const edit::TuneJoints& tuning, const Scene& scene,
                         std::vector<JointControl>& controls) {
  const std::string path = "/" + tuning.robot + "/" + tuning.module;
  const int robot = scene.FindRobot(tuning.robot);
  const int actuator = robot < 0 ? -1 : scene.FindActuator(robot, tuning.module);
  if (actuator < 0) return "there is no module " + path;
  const SceneActuator& of = scene.actuators[static_cast<std::size_t>(actuator)];
  std::string why;
  const std::vector<std::size_t> joints =
      JointsOf(tuning.joints, static_cast<std::size_t>(of.channel_count), why);
  if (!why.empty()) return why;
  const std::size_t each = ValuesPerJoint(tuning.command);
  if (tuning.values.size() != each * joints.size()) {
    return fmt::format("{} values for {} joints: each takes {}", tuning.values.size(), joints.size(), each);
  }
  std::vector<JointControl> tuned = controls;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Channel& channel = scene.channels[static_cast<std::size_t>(of.first_channel) + joints[i]];
    if (channel.control < 0) return path + " is no control board";
    const RobotModel& model = *scene.robots[static_cast<std::size_t>(robot)].entry.model;
    why = Tune(tuning.command, tuning.values.data() + i * each,
               model.joints[static_cast<std::size_t>(channel.joint)],
               tuned[static_cast<std::size_t>(channel.control)]);
    if (!why.empty()) return why;
  }
  controls = std::move(tuned);
  return {};
}

}  // namespace coopdyn
