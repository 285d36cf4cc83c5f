// SPDX-License-Identifier: MIT
// The two-wheel drive of a robot that is one body (fidelity rolling and planar): what its wheels can do, and
// the closed form of its motion while it stands upright and touches nothing else. It then moves along the
// exact arc of its wheels' speeds, as fast as motors and grip let it get there. Pure functions; any thread.
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

// A robot this near to rest upright on its floor is put there exactly.
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

/// What the wheels of a robot of one body can do.
struct OneBodyDrive {
  /// It can stand upright by itself (planar: always does), so that the closed form may hold.
  bool stands = false;
  double mass_kg = 0;
  Vector3 p_RB = Vector3::Zero();  // centre of mass
  WheelPair wheels;
  std::size_t first_channel = 0;    // of the robot's: left wheel, right wheel
  std::array<double, 2> drive_n{};  // the most that each wheel pushes along its rolling direction
  double sideways_n = 0;            // the most that both wheels hold against sideways forces
  double yaw_inertia_kg_m2 = 0;     // about the middle of the axle
  bool stalls = false;  // the motors give in before the wheels slip: a held robot's wheels stand still
  // Beyond these accelerations it slides sideways or lifts a wheel.
  double max_along_m_s2 = 0, max_across_m_s2 = 0;

  /// The wheels' channels among those of the robot: left, right.
  template <typename State>
  std::span<State> ChannelsOf(std::span<State> robot) const {
    return robot.subspan(first_channel, 2);
  }
  /// How fast they are to turn.
  WheelSpeeds SpeedsOf(std::span<const ChannelState> robot) const {
    return {robot[first_channel].setpoint.reference, robot[first_channel + 1].setpoint.reference};
  }
};

/// The wheels of `model` as fidelity rolling and planar need them; else why they do not fit.
std::optional<WheelPair> FindWheels(const RobotModel& model, std::string& why);

/// Which wheel of the drive `collision` of link `link` is the tread of: 0 left, 1 right; -1: it is none.
int WheelOf(const RobotModel& model, int link, const LinkShape& collision);
/// The drive of `robot`, which has its body and parts. @pre its model has a drive, whose wheels are `wheels`.
OneBodyDrive MakeDrive(const Mechanism& robot, const WheelPair& wheels, double floor_friction,
                       const Vector3& g_W);

/// Speeds of one substep.
struct DrivePlan {
  bool closed = false;  // the closed form holds, as far as this robot's own state says
  double forward_m_s = 0;
  double turn_rad_s = 0;
  WheelSpeeds wheels_rad_s{};  // as turned
};

/// True if the body is upright at height `rest_z_m` (of its centre of mass), within the tolerances above.
bool StandsUpright(const BodyState& body, double rest_z_m);

/// What the drive does in the next `dt_s`. `closed` is false if the robot is not upright at rest, or if its
/// acceleration would make it slide sideways or tip.
DrivePlan PlanDrive(const OneBodyDrive& drive, const BodyState& body, double rest_z_m,
                    const WheelSpeeds& setpoint_rad_s, double dt_s);

/// How fast the wheels have turned with `body`, which ODE has moved.
WheelSpeeds TurnedWheels(const OneBodyDrive& drive, const BodyState& body, const WheelSpeeds& setpoint_rad_s);

/// Moves `body` by `plan`. @pre plan.closed.
void Advance(const OneBodyDrive& drive, const DrivePlan& plan, double rest_z_m, double dt_s, BodyState& body);

}  // namespace coopdyn
