// SPDX-License-Identifier: MIT
// The modules of robots. What sensors read is computed by server/sensing: noise is Gaussian with the model's
// standard deviation, a function of (seed, sensor, step), so that reading twice gives the same. Ranges and
// distances in m, angles in rad, 0 ahead, left positive, in (−π, π]. Constant; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/devices/device.h"
#include "server/model/robot_model.h"
#include "server/sensing/readings.h"

namespace coopdyn {

/// Appends what is seen to the reply of a get-command: id, word, distance and bearing.
void AddSighting(Message& reply, std::uint32_t id, const std::string& word, const Sighting& sighting);
void AddRobot(Message& reply, const Frame& frame, const Sighting& sighting);

/// A module whose only reading is its sensor's, e.g. /R/compass; those with more commands derive from it.
class SensorDevice : public Device {
 public:
  /// Reads model.sensors[sensor]. `table` outlives it.
  SensorDevice(const CommandTable& table, const RobotModel& model, std::size_t sensor)
      : Device(table), sensor_(sensor), number_(model.NumberOf(sensor)) {}

  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const final;
  const Frame& Shown(const Frame& frame, int robot) const final { return SampleOf(frame, robot, sensor_); }

 protected:
  /// Index into the model's sensors.
  std::size_t sensor() const { return sensor_; }
  /// Which of its kind the sensor is.
  std::size_t number() const { return number_; }

 private:
  const std::size_t sensor_, number_;
};

/// /R/distance: the ranges of the sectors, right to left, from the chassis surface; inf = nothing in range.
/// Of the rays that sample a sector the smallest counts. Noise of the ranges.
class DistanceDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/target: distance in the plane from the robot's origin, and bearing, of targets and of other robots.
/// Range, hiding and noise of both as the model says; get_target: error 10 if no such target is seen.
class TargetDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;

 private:
  Message ReadTarget(const Message& request, const Frame& frame, int robot) const;
};

/// /R/pose: where the robot is and how it moves: ground truth in the world frame W, of frame R. get_pose: x,
/// y, heading, forward speed along the heading (m/s), turn rate about the vertical (rad/s). get_pose_3d:
/// position, quaternion w x y z, velocity of R's origin (m/s), angular velocity (rad/s). No noise.
class PoseDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/neighbours: where the robots nearby are, and short broadcasts to them. Distances between the robots'
/// centres in the plane; seen and heard through obstacles. Noise, loss and delay are the model's.
class NeighboursDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  std::optional<RobotMessage> Broadcast(const Message& request) const override;
};

/// /R/lidar: ranges along rays.
class LidarDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/contact: what touches some shapes of the robot.
class ContactDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/camera: its pictures are drawn when they are asked for.
class CameraDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  std::optional<ImageRequest> Picture(const Message& request, const FramePtr& frame,
                                      int robot) const override;
};

/// /R/channel: all motors and values of the robot that its model maps, in one exchange.
class ChannelDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  bool is_actuator() const override { return true; }
  bool drives_all() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  std::optional<Actuation> Actuate(const Message& request, const Frame& frame, int robot) const override;
  std::string StepNote(const Frame& frame, int robot) const override;
};

/// /R/joints: a control board, a group of joints that are driven one by one.
class JointsDevice final : public Device {
 public:
  /// Of model.actuators[actuator]. `table` and `model` outlive it.
  JointsDevice(const CommandTable& table, const RobotModel& model, std::size_t actuator);

  bool is_actuator() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<Actuation> Actuate(const Message& request, const Frame& frame, int robot) const override;
  std::optional<edit::TuneJoints> Tune(const Message& request) const override;
  std::optional<Message> Refuse(const Message& request) const override;

 private:
  std::span<const ChannelState> Channels(const Frame& frame, int robot) const;
  const JointControl& Control(const Frame& frame, int robot, std::size_t joint) const;
  /// What the encoder says.
  double Measured(const Frame& frame, int robot, std::size_t joint) const;
  Message ReadChain() const;

  const RobotModel& model_;
  const ActuatorModel& actuator_;
  const BoardModel& board_;
  std::size_t first_channel_ = 0, first_control_ = 0;  // among the robot's
};

/// /R/muscles and /R/thrusters: actuators that take one number each, an activation, a force or a torque.
class ActuatorsDevice final : public Device {
 public:
  /// `table` and `model` outlive it.
  ActuatorsDevice(const CommandTable& table, const RobotModel& model, const ActuatorModel& actuator)
      : Device(table), model_(model), actuator_(actuator), first_channel_(model.FirstChannel(actuator)) {}

  bool is_actuator() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<Actuation> Actuate(const Message& request, const Frame& frame, int robot) const override;
  std::optional<Message> Refuse(const Message& request) const override;

 private:
  const JointModel& JointOf(std::size_t index) const {
    return model_.joints[static_cast<std::size_t>(actuator_.joints[index])];
  }
  /// Those that the params name; `why` says what is wrong with them.
  std::vector<std::size_t> Chosen(const Message& request, std::string& why) const;
  void Append(const Frame& frame, int robot, std::size_t index, std::vector<double>& data) const;

  const RobotModel& model_;
  const ActuatorModel& actuator_;
  const std::size_t first_channel_;  // among the robot's
};

class MotorsDevice final : public Device {
 public:
  /// `table` outlives it.
  /// `first_channel`: of the left wheel among the robot's; the right one follows.
  MotorsDevice(const CommandTable& table, const DriveModel& drive, std::size_t first_channel)
      : Device(table), drive_(drive), first_channel_(first_channel) {}

  bool is_actuator() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<Actuation> Actuate(const Message& request, const Frame& frame, int robot) const override;

 private:
  const DriveModel drive_;
  const std::size_t first_channel_;
};

}  // namespace coopdyn
