// SPDX-License-Identifier: MIT
// The sensors as functions of (frame, robot, seed). Computed when they are read; a sensor that nobody reads
// costs nothing. The frame keeps costly readings (sensing_cache.h). Any thread.
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

/// The model of robot `robot` (index into the scene).
inline const RobotModel& ModelOf(const Frame& frame, int robot) {
  return *frame.scene->robots[static_cast<std::size_t>(robot)].entry.model;
}

/// Appends the reading of a robot's sensor (index into RobotModel::sensors): what the first get-command of
/// its module answers. Nothing if there is no such sensor.
void AppendReading(const Frame& frame, int robot, std::size_t sensor, std::vector<double>& data);

/// The names of the values of a reading of a fixed length (FixedCount()) with units, e.g. ax_m_s2; counted
/// from 1 where a sensor has many alike: range1_m.
std::vector<std::string> FixedNames(const SensorKind& kind);
/// Writes as many values: the reading; of a contact sensor which zones are pressed; nan if that is unknown.
void FillFixed(const Frame& frame, int robot, std::size_t sensor, std::span<double> values);

// The kinds of sensors. `number`: which one of its kind, counted from 0; if the robot's model has fewer the
// reading is empty.

/// Distance and bearing of a landmark as a robot sees it.
struct Sighting {
  int index = 0;           // into scene->targets or scene->robots
  double distance_m = 0;   // from the robot's origin, in the plane
  double bearing_rad = 0;  // 0 ahead, left positive
};

/// One range per sector (right to left), m from the chassis surface, inf = nothing in range. Valid as long as
/// the frame lives.
std::span<const double> Distances(const Frame& frame, int robot, std::size_t number);
/// The ranges of all distance sensors of `robot`, one after the other.
std::span<const double> Distances(const Frame& frame, int robot);
/// Targets seen by `robot`, by increasing id.
std::vector<Sighting> SeenTargets(const Frame& frame, int robot, std::size_t number = 0);
/// Other robots seen by `robot`, by increasing id.
std::vector<Sighting> SeenRobots(const Frame& frame, int robot, std::size_t number = 0);

/// Velocities in the world.
struct Twist {
  Vector3 v_W, w_W;  // m/s, rad/s
};
/// The twist of R's origin: that of the centre of mass of the link that carries R, moved there by its
/// rotation.
Twist OriginTwist(const Frame& frame, int robot, const Pose& X_WR, int link = 0);
/// Ground truth in the plane, in the world: of the origin of R, which a link carries.
struct PlaneMotion {
  double x_m, y_m, heading_rad;
  double forward_m_s;  // along the heading
  double turn_rad_s;   // about the vertical
};
PlaneMotion MotionOf(const Frame& frame, int robot, int link = 0);
/// The frame R as a link carries it, in the world.
Pose CarriedFrame(const Frame& frame, int robot, int link);

/// The heading of R's x axis in the world, rad, 0 along the world's x, left positive, in (−π, π]; nan if the
/// robot has no such compass.
double CompassHeading(const Frame& frame, int robot, std::size_t number = 0);

/// How far the load has moved the support, in R: 0 where the model is written. nan: the robot has no such
/// support.
struct SupportReading {
  double x_m = std::numeric_limits<double>::quiet_NaN(), y_m = x_m;
  double angle_rad = x_m;  // left positive
};
SupportReading Support(const Frame& frame, int robot, std::size_t number = 0);

/// What an inertial measurement unit reads, in its own frame.
struct ImuReading {
  Quaternion q_WS = Quaternion::Identity();
  Vector3 turn_S = Vector3::Zero();          // rad/s
  Vector3 acceleration_S = Vector3::Zero();  // m/s², with gravity: +g upwards at rest
};
/// Nothing if the robot has no such sensor; likewise below.
std::optional<ImuReading> Imu(const Frame& frame, int robot, std::size_t number = 0);

/// Force and torque through a joint, in the sensor's frame.
struct WrenchReading {
  Vector3 force_S = Vector3::Zero();   // N
  Vector3 torque_S = Vector3::Zero();  // N m, about the sensor's origin
};
std::optional<WrenchReading> Wrench(const Frame& frame, int robot, std::size_t number = 0);

/// Something that touches the robot.
struct Touch {
  ContactEnd other;
  double force_n = 0;
  Vector3 p_R = Vector3::Zero();
  Vector3 normal_R = Vector3::Zero();  // towards the robot
};
/// What touches the shapes of a contact sensor, in the order of the frame's contacts.
std::vector<Touch> Touches(const Frame& frame, int robot, std::size_t number = 0);
/// Of each zone of a bumper whether it is pressed: 1 or 0.
std::vector<double> PressedZones(const Frame& frame, int robot, std::size_t number = 0);

struct BatteryReading {
  double energy_j = std::numeric_limits<double>::quiet_NaN();
  double fraction = energy_j, power_w = energy_j;
};
BatteryReading Battery(const Frame& frame, int robot, std::size_t number = 0);

/// Where the wheels' encoders say that the robot is: in R as it started.
struct OdometryReading {
  double x_m = std::numeric_limits<double>::quiet_NaN(), y_m = x_m, heading_rad = x_m;
  double forward_m_s = x_m, turn_rad_s = x_m;
};
OdometryReading Odometry(const Frame& frame, int robot, std::size_t number = 0);

/// One range per ray of a lidar (LidarModel has their order), m from the sensor: 0 nearer than its minimum,
/// inf = nothing in range. It sees collision shapes: the floor, objects, other robots, and of its own the
/// links but the one that carries it. Valid as long as the frame lives.
std::span<const double> Scan(const Frame& frame, int robot, std::size_t number = 0);
/// The same of each beam of a sonar: of the nearest point in its cone, or on its rays. A cone sees the floor
/// only where that is perpendicular to a ray in the cone, since it throws all others away from the sensor.
std::span<const double> SonarRanges(const Frame& frame, int robot, std::size_t number = 0);
/// What each eye of an infrared range finder puts out. Valid as long as the frame lives.
std::span<const double> InfraredValues(const Frame& frame, int robot, std::size_t number = 0);
/// How much light each eye of a light sensor sees.
std::vector<double> LightValues(const Frame& frame, int robot, std::size_t number = 0);

/// Appends the external values of a channel, with their noise.
void AppendChannelValues(const Frame& frame, int robot, std::size_t number, std::vector<double>& data);
/// The external values of channel `number`, with noise, neither filtered nor cut.
std::vector<double> UnfilteredValues(const Frame& frame, int robot, std::size_t number);
/// Whether a try is to end: the robot has exploded, or a contact sensor that the channel names is pressed.
bool IsAborted(const Frame& frame, int robot, std::size_t number = 0);
/// The set-points of the robot's channels for these external values, one for each motor; what no motor has
/// keeps what it does.
std::vector<Setpoint> ChannelSetpoints(const Frame& frame, int robot, std::size_t number,
                                       std::span<const double> external);

/// The pose of a sensor in the world.
Pose MountPose(const Frame& frame, int robot, const Mount& mount);
/// The angular velocity of a link in the world, rad/s.
Vector3 LinkTurn(const Frame& frame, int robot, int link);

/// Others within the range of a neighbours module, by increasing id. Seen through obstacles.
std::vector<Sighting> Neighbours(const Frame& frame, int robot, std::size_t number = 0);

/// A broadcast that `robot` hears in this frame.
struct HeardMessage {
  int sender = 0;                         // index into scene->robots
  Sighting from;                          // where the sender is now; index = sender
  const RobotMessage* message = nullptr;  // lives as long as the frame
};
/// What `robot` hears in this frame, by increasing id of the sender: messages that were sent
/// NeighboursModel::delay_steps steps before this one, from within the message range as the robots stand in
/// this frame, and not lost; delay, range and loss are those of the receiver's model. Loss is a function of
/// (seed, sender, receiver, step).
std::vector<HeardMessage> HeardMessages(const Frame& frame, int robot, std::size_t number = 0);

/// Computes the distances of `robots` (indices into the scene) now, in parallel; Distances() then costs
/// nothing. The values do not depend on the number of threads.
void PrepareDistances(const Frame& frame, std::span<const int> robots, WorkerPool& pool);

// For drawing.

/// Where a ray starts and ends in the world; without a hit it ends at the sensor's range.
struct RaySegment {
  Vector3 from_W, to_W;
  bool hit = false;
};
/// Those of robot's distance sensors, without noise.
std::vector<RaySegment> DistanceRays(const Frame& frame, int robot);
/// Those of an infrared range finder, without noise, eye by eye.
std::vector<RaySegment> InfraredRays(const Frame& frame, int robot, std::size_t number = 0);
/// Those of a lidar as Scan() has them; what is nearer than its minimum is a ray without length.
std::vector<RaySegment> ScanRays(const Frame& frame, int robot, std::size_t number = 0);
/// The cone of a sonar's beam about S's x axis, up to what SonarRanges() says.
struct RangeCone {
  Pose X_WS;
  double half_angle_rad = 0, length_m = 0;  // along each ray
  bool hit = false;
};
/// Of its beams without rays.
std::vector<RangeCone> SonarCones(const Frame& frame, int robot, std::size_t number = 0);

/// Of those with rays, without noise, beam by beam.
std::vector<RaySegment> SonarRays(const Frame& frame, int robot, std::size_t number = 0);

}  // namespace coopdyn
