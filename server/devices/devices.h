// SPDX-License-Identifier: MIT
// The modules of robots. server/sensing computes the readings; noise is Gaussian with the model's standard
// deviation, as a function of (seed, sensor, step): reading twice gives the same value. Ranges and distances
// in m, angles in rad, 0 ahead, left positive, in (−π, π]. Constant; any thread.
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

/// Appends a sighting to the reply of a get-command: id, word, distance and bearing.
void AddSighting(Message& reply, std::uint32_t id, const std::string& word, const Sighting& sighting);
void AddRobot(Message& reply, const Frame& frame, const Sighting& sighting);

/// A module whose only reading is its sensor's, e.g. /R/compass. Modules with more commands derive from it.
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
  /// The sensor's index among those of its kind.
  std::size_t number() const { return number_; }

 private:
  const std::size_t sensor_, number_;
};

/// /R/distance: the ranges of the sectors, right to left, from the chassis surface; inf: nothing in range. A
/// sector's range is the smallest of its rays. Noise is added to the ranges.
class DistanceDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/target: distance in the plane from the robot's origin, and bearing, of targets and of other robots. The
/// model defines range, occlusion and noise. get_target: error 10 if no such target is seen.
class TargetDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;

 private:
  Message ReadTarget(const Message& request, const Frame& frame, int robot) const;
};

/// /R/pose: ground truth of the robot's pose and motion: of frame R, in the world frame W. get_pose: x, y,
/// heading, forward speed along the heading (m/s), turn rate about the vertical (rad/s). get_pose_3d:
/// position, quaternion w x y z, velocity of R's origin (m/s), angular velocity (rad/s). No noise.
class PoseDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/neighbours: positions of nearby robots, and short broadcasts to them. Distances are between the robots'
/// centres in the plane; obstacles do not matter. The model defines noise, loss and delay.
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

/// /R/contact: contacts of some of the robot's shapes.
class ContactDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  Message Read(const Message& request, const Frame& frame, int robot) const override;
};

/// /R/camera: draws its pictures on request.
class CameraDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  std::optional<ImageRequest> Picture(const Message& request, const FramePtr& frame,
                                      int robot) const override;
};

/// /R/channel: all motors and values that the robot's model maps, in one exchange.
class ChannelDevice final : public SensorDevice {
 public:
  using SensorDevice::SensorDevice;
  bool is_actuator() const override { return true; }
  bool drives_all() const override { return true; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  std::optional<Actuation> Actuate(const Message& request, const Frame& frame, int robot) const override;
  std::string StepNote(const Frame& frame, int robot) const override;
};

/// /R/joints: a control board, a group of individually driven joints.
class JointsDevice final : public Device {
 public:
  /// For model.actuators[actuator]. `table` and `model` outlive it.
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
  /// The encoder's reading.
  double Measured(const Frame& frame, int robot, std::size_t joint) const;
  Message ReadChain() const;

  const RobotModel& model_;
  const ActuatorModel& actuator_;
  const BoardModel& board_;
  std::size_t first_channel_ = 0, first_control_ = 0;  // among the robot's channels and controls
};

/// /R/muscles and /R/thrusters: actuators with one input each, an activation, a force or a torque.
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
  /// The actuators that the request's params name; `why` is set if the params are not valid.
  std::vector<std::size_t> Chosen(const Message& request, std::string& why) const;
  void Append(const Frame& frame, int robot, std::size_t index, std::vector<double>& data) const;

  const RobotModel& model_;
  const ActuatorModel& actuator_;
  const std::size_t first_channel_;  // among the robot's channels
};

class MotorsDevice final : public Device {
 public:
  /// `table` outlives it. `first_channel`: the left wheel's among the robot's; the right wheel's follows.
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
