// SPDX-License-Identifier: MIT
// The two-wheel drive of a robot that is one body (fidelity rolling and planar): the limits of its wheels,
// and the closed form of its motion while it stands upright and touches nothing else. It then moves along the
// exact arc of its wheels' speeds, which change as fast as motors and grip allow. Pure functions; any thread.
// Only server/physics includes this file.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "server/model/drive.h"
#include "server/physics/closed_forms.h"
#include "server/state/frame.h"

namespace coopdyn {

struct Mechanism;

// A robot this near to standing upright at rest on its floor is placed there exactly.
inline constexpr double kRestHeight_m = 2e-5;
inline constexpr double kRestTilt_rad = 2e-4;
inline constexpr double kRestSink_m_s = 2e-3;
inline constexpr double kRestTurn_rad_s = 2e-2;

/// The two wheels of a drive, equal and opposite each other.
struct WheelPair {
  double radius_m = 0;
  double half_track_m = 0;           // from R's z axis to the middle of each tread
  std::array<double, 2> friction{};  // of the treads: left, right
};

/// The wheels of a one-body robot and their limits.
struct OneBodyDrive {
  /// The robot can stand upright on its wheels and casters (planar: always), so the closed form may apply.
  bool stands = false;
  double mass_kg = 0;
  Vector3 p_RB = Vector3::Zero();  // centre of mass
  WheelPair wheels;
  std::size_t first_channel = 0;    // of the robot's: left wheel, right wheel
  std::array<double, 2> drive_n{};  // greatest force of each wheel along its rolling direction
  double sideways_n = 0;            // greatest sideways force of both wheels together
  double yaw_inertia_kg_m2 = 0;     // about the middle of the axle
  bool stalls = false;  // the motors stall before the wheels slip: a held robot's wheels stand still
  // Beyond these accelerations it slides sideways or lifts a wheel.
  double max_along_m_s2 = 0, max_across_m_s2 = 0;

  /// The wheels' channels among those of the robot: left, right.
  template <typename State>
  std::span<State> ChannelsOf(std::span<State> robot) const {
    return robot.subspan(first_channel, 2);
  }
  /// The wheels' set-points, rad/s.
  WheelSpeeds SpeedsOf(std::span<const ChannelState> robot) const {
    return {robot[first_channel].setpoint.reference, robot[first_channel + 1].setpoint.reference};
  }
};

/// Returns the wheels of `model` as fidelity rolling and planar need them; else nullopt, and in `why` the
/// reason.
std::optional<WheelPair> FindWheels(const RobotModel& model, std::string& why);

/// The wheel of the drive whose tread is `collision` of link `link`: 0 left, 1 right; -1: neither.
int WheelOf(const RobotModel& model, int link, const LinkShape& collision);
/// Makes the drive of `robot`, whose body and parts are set.
/// @pre its model has a drive, whose wheels are `wheels`.
OneBodyDrive MakeDrive(const Mechanism& robot, const WheelPair& wheels, double floor_friction,
                       const Vector3& g_W);

/// Speeds of one substep.
struct DrivePlan {
  bool closed = false;  // the closed form applies, as far as the robot's own state is concerned
  double forward_m_s = 0;
  double turn_rad_s = 0;
  WheelSpeeds wheels_rad_s{};  // as they turn
};

/// True if the body is upright at height `rest_z_m` (of its centre of mass), within the tolerances above.
bool StandsUpright(const BodyState& body, double rest_z_m);

/// Plans the drive's motion in the next `dt_s`. `closed` is false if the robot is not upright at rest, or if
/// its acceleration would make it slide sideways or tip.
DrivePlan PlanDrive(const OneBodyDrive& drive, const BodyState& body, double rest_z_m,
                    const WheelSpeeds& setpoint_rad_s, double dt_s);

/// The wheels' rates after a solver has moved `body`.
WheelSpeeds WheelRates(const OneBodyDrive& drive, const BodyState& body, const WheelSpeeds& setpoint_rad_s);

/// Moves `body` by `plan`. @pre plan.closed.
void Advance(const OneBodyDrive& drive, const DrivePlan& plan, double rest_z_m, double dt_s, BodyState& body);

}  // namespace coopdyn
