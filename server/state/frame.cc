// SPDX-License-Identifier: MIT
#include "server/state/frame.h"

#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

Pose BodyPose(const Frame& frame, int body) {
  const BodyState& state = frame.bodies[static_cast<std::size_t>(body)];
  return {state.p_WB, state.orientation()};
}

}  // namespace

double StartOf(const Scene& scene, std::size_t channel) {
  const Channel& of = scene.channels[channel];
  const RobotModel& model = *scene.robots[static_cast<std::size_t>(of.robot)].entry.model;
  const JointModel& joint = model.joints[static_cast<std::size_t>(of.joint)];
  return joint.muscle ? (joint.muscle->p_to_R - joint.muscle->p_from_R).norm() : joint.start;
}

std::vector<JointControl> StartControls(const Scene& scene) {
  std::vector<JointControl> controls(static_cast<std::size_t>(scene.control_count));
  for (const Channel& channel : scene.channels) {
    if (channel.control < 0) continue;
    const RobotModel& model = *scene.robots[static_cast<std::size_t>(channel.robot)].entry.model;
    const double fastest = model.joints[static_cast<std::size_t>(channel.joint)].max_velocity;
    JointControl& control = controls[static_cast<std::size_t>(channel.control)];
    control.speed = fastest / 2;
    control.acceleration = 2 * fastest;  // reaches that speed in 0.25 s
  }
  return controls;
}

std::vector<DriveTrainState> StartDriveTrains(const Scene& scene) {
  std::vector<DriveTrainState> trains(static_cast<std::size_t>(scene.drive_train_count));
  for (std::size_t i = 0; i < scene.channels.size() && !trains.empty(); ++i) {
    const int train = scene.channels[i].drive_train;
    if (train >= 0) trains[static_cast<std::size_t>(train)].rotor_rad = StartOf(scene, i);
  }
  return trains;
}

const DriveTrainState* DriveTrainOf(const Frame& frame, int index, int joint) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  for (int i = robot.first_channel; i < robot.first_channel + robot.channel_count; ++i) {
    const Channel& channel = frame.scene->channels[static_cast<std::size_t>(i)];
    if (channel.joint != joint || channel.drive_train < 0) continue;
    const auto train = static_cast<std::size_t>(channel.drive_train);
    return train < frame.drive_trains.size() ? &frame.drive_trains[train] : nullptr;
  }
  return nullptr;
}

Pose LinkPose(const Frame& frame, int index, int link) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const RobotModel& model = *robot.entry.model;
  const LinkModel& link_model = model.links[static_cast<std::size_t>(link)];
  if (robot.one_body()) {
    const Pose X_WR = RobotPose(frame, index);
    for (int i = robot.first_channel; i < robot.first_channel + robot.channel_count; ++i) {
      const Channel& channel = frame.scene->channels[static_cast<std::size_t>(i)];
      const JointModel& joint = model.joints[static_cast<std::size_t>(channel.joint)];
      const double angle_rad = frame.channels[static_cast<std::size_t>(i)].position;
      if (joint.child != link || !(std::abs(angle_rad) > 0)) continue;
      const Quaternion turn = portable::AngleAxis(angle_rad, joint.axis_R.normalized());
      return X_WR * Pose{joint.p_RJ - turn * joint.p_RJ, turn} * link_model.X_RL;
    }
    return X_WR * link_model.X_RL;
  }
  return BodyPose(frame, robot.first_body + link) * link_model.X_LI.Inverse();
}

std::span<const ChannelState> ChannelsOf(const Frame& frame, int index) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  return std::span(frame.channels)
      .subspan(static_cast<std::size_t>(robot.first_channel), static_cast<std::size_t>(robot.channel_count));
}

std::span<const double> MeasuredOf(const Frame& frame, int index, std::size_t sensor) {
  if (frame.measured.empty()) return {};
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const RobotModel& model = *robot.entry.model;
  return std::span(frame.measured)
      .subspan(static_cast<std::size_t>(robot.first_measured) + model.FirstMeasured(sensor),
               MeasuredCount(model.sensors[sensor].kind));
}

namespace {

/// The sample that the sensor shows; null: the frame itself.
const FramePtr* FindSample(const Frame& frame, int index, std::size_t sensor) {
  const std::vector<int>& clocks = frame.scene->robots[static_cast<std::size_t>(index)].clocks;
  if (clocks.empty() || clocks[sensor] < 0 || frame.samples.empty()) return nullptr;
  return &frame.samples[static_cast<std::size_t>(clocks[sensor])].front();
}

}  // namespace

const Frame& SampleOf(const Frame& frame, int index, std::size_t sensor) {
  const FramePtr* const sample = FindSample(frame, index, sensor);
  return sample == nullptr ? frame : **sample;
}

FramePtr SampleOf(const FramePtr& frame, int index, std::size_t sensor) {
  const FramePtr* const sample = FindSample(*frame, index, sensor);
  return sample == nullptr ? frame : *sample;
}

bool IsFrozen(const Frame& frame, int index) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  return frame.bodies[static_cast<std::size_t>(robot.first_body)].frozen();
}

std::vector<std::string> FrozenNames(const Frame& frame) {
  std::vector<std::string> names;
  for (const SceneObject& object : frame.scene->objects) {
    const bool dynamic = object.body >= 0;
    if (dynamic && frame.bodies[static_cast<std::size_t>(object.body)].frozen()) {
      names.push_back(object.object.name);
    }
  }
  for (std::size_t i = 0; i < frame.scene->robots.size(); ++i) {
    if (IsFrozen(frame, static_cast<int>(i))) names.push_back(frame.scene->robots[i].entry.name);
  }
  return names;
}

Pose RobotPose(const Frame& frame, int index) {
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(index)];
  const BodyState& body = frame.bodies[static_cast<std::size_t>(robot.first_body)];
  const Quaternion q = body.orientation();
  return {body.p_WB + q * robot.X_BR.p, robot.axes_of_R ? q : q * robot.X_BR.q};
}

Pose ObjectPose(const Frame& frame, const SceneObject& object) {
  return object.body < 0 ? object.object.X_WO : BodyPose(frame, object.body);
}

}  // namespace coopdyn
