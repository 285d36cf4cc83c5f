// SPDX-License-Identifier: MIT
// The sensors as functions of (frame, robot, seed). Computed on reading; an unread sensor costs nothing. The
// frame keeps costly readings (sensing_cache.h). Any thread.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/state/frame.h"

namespace coopdyn {

/// The model of robot `robot` (index into the scene's robots).
inline const RobotModel& ModelOf(const Frame& frame, int robot) {
  return *frame.scene->robots[static_cast<std::size_t>(robot)].entry.model;
}

/// Appends the reading of a robot's sensor (index into RobotModel::sensors): the answer to the first
/// get-command of its module. Nothing if there is no such sensor.
void AppendReading(const Frame& frame, int robot, std::size_t sensor, std::vector<double>& data);

/// Fills `values` with the reading; for a contact sensor with its pressed zones; NaN where unknown.
void FillFixed(const Frame& frame, int robot, std::size_t sensor, std::span<double> values);

// The kinds of sensors. `number`: index among the robot's sensors of that kind, from 0. If the robot's model
// has fewer, the reading is empty.

/// Distance and bearing of a landmark or robot as seen by a robot.
struct Sighting {
  int index = 0;           // into scene->targets or scene->robots
  double distance_m = 0;   // from the robot's origin, in the plane
  double bearing_rad = 0;  // 0 ahead, left positive
};

/// One range per sector (right to left), m from the chassis surface; inf: nothing in range. Valid while the
/// frame lives.
std::span<const double> Distances(const Frame& frame, int robot, std::size_t number);
/// The ranges of all distance sensors of `robot`, concatenated.
std::span<const double> Distances(const Frame& frame, int robot);
/// Targets seen by `robot`, by increasing id.
std::vector<Sighting> SeenTargets(const Frame& frame, int robot, std::size_t number = 0);
/// Other robots seen by `robot`, by increasing id.
std::vector<Sighting> SeenRobots(const Frame& frame, int robot, std::size_t number = 0);

/// Velocities in the world frame.
struct Twist {
  Vector3 v_W, w_W;  // m/s, rad/s
};
/// The twist of R's origin, from the motion of the link that carries R.
Twist OriginTwist(const Frame& frame, int robot, const Pose& X_WR, int link = 0);
/// Ground truth of R's origin in the plane, in the world frame.
struct PlaneMotion {
  double x_m, y_m, heading_rad;
  double forward_m_s;  // along the heading
  double turn_rad_s;   // about the vertical
};
PlaneMotion MotionOf(const Frame& frame, int robot, int link = 0);
/// The frame R as link `link` carries it, in the world.
Pose CarriedFrame(const Frame& frame, int robot, int link);

/// The heading of R's x axis in the world, rad, 0 along the world's x, left positive, in (−π, π]; NaN if the
/// robot has no such compass.
double CompassHeading(const Frame& frame, int robot, std::size_t number = 0);

/// How far the load has moved the support from its place in the model, in R. NaN if the robot has no such
/// support.
struct SupportReading {
  double x_m = std::numeric_limits<double>::quiet_NaN(), y_m = x_m;
  double angle_rad = x_m;  // left positive
};
SupportReading Support(const Frame& frame, int robot, std::size_t number = 0);

/// The reading of an inertial measurement unit, in the sensor's frame S.
struct ImuReading {
  Quaternion q_WS = Quaternion::Identity();
  Vector3 turn_S = Vector3::Zero();          // rad/s
  Vector3 acceleration_S = Vector3::Zero();  // m/s², including gravity: +g upwards at rest
};
/// Nullopt if the robot has no such sensor; likewise below.
std::optional<ImuReading> Imu(const Frame& frame, int robot, std::size_t number = 0);

/// Force and torque through a joint, in the sensor's frame.
struct WrenchReading {
  Vector3 force_S = Vector3::Zero();   // N
  Vector3 torque_S = Vector3::Zero();  // N m, about the sensor's origin
};
std::optional<WrenchReading> Wrench(const Frame& frame, int robot, std::size_t number = 0);

/// A contact of the robot.
struct Touch {
  ContactEnd other;
  double force_n = 0;
  Vector3 p_R = Vector3::Zero();
  Vector3 normal_R = Vector3::Zero();  // towards the robot
};
/// Contacts with the shapes of a contact sensor, in the order of the frame's contacts.
std::vector<Touch> Touches(const Frame& frame, int robot, std::size_t number = 0);
/// For each zone of a bumper, 1 if it is pressed, else 0.
std::vector<double> PressedZones(const Frame& frame, int robot, std::size_t number = 0);

struct BatteryReading {
  double energy_j = std::numeric_limits<double>::quiet_NaN();
  double fraction = energy_j, power_w = energy_j;
};
BatteryReading Battery(const Frame& frame, int robot, std::size_t number = 0);

/// The robot's motion as measured by its wheel encoders, in R at the start.
struct OdometryReading {
  double x_m = std::numeric_limits<double>::quiet_NaN(), y_m = x_m, heading_rad = x_m;
  double forward_m_s = x_m, turn_rad_s = x_m;
};
OdometryReading Odometry(const Frame& frame, int robot, std::size_t number = 0);

/// One range per ray of a lidar (order: see LidarModel), m from the sensor: 0 if nearer than its minimum, inf
/// if nothing is in range. Rays hit collision shapes: the floor, objects, other robots, and links of its own
/// robot except the sensor's. Valid while the frame lives.
std::span<const double> Scan(const Frame& frame, int robot, std::size_t number = 0);
/// One range per beam of a sonar: to the nearest point in its cone, or on its rays. A cone detects the floor
/// only if the floor is perpendicular to a direction inside the cone; otherwise the echo is reflected away.
/// Valid while the frame lives.
std::span<const double> SonarRanges(const Frame& frame, int robot, std::size_t number = 0);
/// The output of each eye of an infrared range finder. Valid while the frame lives.
std::span<const double> InfraredValues(const Frame& frame, int robot, std::size_t number = 0);
/// The light that each eye of a light sensor receives.
std::vector<double> LightValues(const Frame& frame, int robot, std::size_t number = 0);

/// Appends the external values of a channel, with their noise.
void AppendChannelValues(const Frame& frame, int robot, std::size_t number, std::vector<double>& data);
/// The external values of channel `number`, with noise, before filters and limits.
std::vector<double> UnfilteredValues(const Frame& frame, int robot, std::size_t number);
/// Whether a trial must end: the robot has exploded, or a contact sensor that the channel names is pressed.
bool IsAborted(const Frame& frame, int robot, std::size_t number = 0);
/// The set-points of the robot's channels for these external values, one per motor. Channels without a motor
/// get kKeep.
std::vector<Setpoint> ChannelSetpoints(const Frame& frame, int robot, std::size_t number,
                                       std::span<const double> external);

/// A sensor's pose in the world.
Pose MountPose(const Frame& frame, int robot, const Mount& mount);
/// A link's angular velocity in the world, rad/s.
Vector3 LinkTurn(const Frame& frame, int robot, int link);

/// Other robots within the range of a neighbours module, by increasing id. Obstacles do not hide them.
std::vector<Sighting> Neighbours(const Frame& frame, int robot, std::size_t number = 0);

/// A broadcast that `robot` receives in this frame.
struct HeardMessage {
  int sender = 0;                         // index into scene->robots
  Sighting from;                          // where the sender is now; index is the sender
  const RobotMessage* message = nullptr;  // valid while the frame lives
};
/// The broadcasts that `robot` receives in this frame, by increasing id of the sender: those sent
/// NeighboursModel::delay_steps steps ago by robots that are now within message range, and not lost. Delay,
/// range and loss are those of the receiver's model. Loss is a function of (seed, sender, receiver, step).
std::vector<HeardMessage> HeardMessages(const Frame& frame, int robot, std::size_t number = 0);

/// Computes the distances of `robots` (indices into the scene's robots) now, in parallel; later Distances()
/// calls cost nothing. The values do not depend on the number of threads.
void PrepareDistances(const Frame& frame, std::span<const int> robots, WorkerPool& pool);

// For drawing.

/// A ray in the world, up to its hit; without a hit, up to the sensor's range.
struct RaySegment {
  Vector3 from_W, to_W;
  bool hit = false;
};
/// Rays of the robot's distance sensors, without noise.
std::vector<RaySegment> DistanceRays(const Frame& frame, int robot);
/// Rays of an infrared range finder, without noise, eye by eye.
std::vector<RaySegment> InfraredRays(const Frame& frame, int robot, std::size_t number = 0);
/// Rays of a lidar with the ranges of Scan(); a ray nearer than the minimum has no length.
std::vector<RaySegment> ScanRays(const Frame& frame, int robot, std::size_t number = 0);
/// The cone of a sonar's beam about S's x axis, up to the range of SonarRanges().
struct RangeCone {
  Pose X_WS;
  double half_angle_rad = 0, length_m = 0;  // along each ray
  bool hit = false;
};
/// Cones of beams without rays.
std::vector<RangeCone> SonarCones(const Frame& frame, int robot, std::size_t number = 0);

/// Rays of beams with rays, without noise, beam by beam.
std::vector<RaySegment> SonarRays(const Frame& frame, int robot, std::size_t number = 0);

}  // namespace coopdyn
