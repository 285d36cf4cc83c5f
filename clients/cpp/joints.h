// SPDX-License-Identifier: MIT
// Groups of joints that are driven together, such as an arm.
//
//   auto arm = r.joints("arm");
//   arm.set_positions({0.5, -0.3, 0, 1.2, 0, 0.4, 0});   // rad, or m of a slider: a smooth move
//   while (!arm.arrived()) sim.step();
//   arm.set_positions({0.5}, "elbow");                   // one joint, by its name or its number from 1
//   const Eigen::Isometry3d pose = arm.forward();        // the tool's pose in the robot's frame R
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/chain.h"
#include "clients/cpp/parts.h"

namespace coopdyn::client {

/// Position [rad, m] and velocity of each joint, and its motor's effort [N m, N; nan before the first step].
struct JointReading {
  std::vector<double> position, velocity, effort;
};
/// Limits of each joint: position [rad, m; inf = none], velocity and effort [N m, N].
struct JointLimits {
  std::vector<double> lower, upper, velocity, effort;
};
/// Stiffness k [N m/rad; inf = a servo], damping d [N m s/rad] and offset [N m] of each joint.
struct Compliance {
  std::vector<double> k, d, offset;
};
/// Speed [rad/s] and acceleration [rad/s2] with which each joint moves to a position.
struct Profile {
  std::vector<double> speed, acceleration;
};
/// Gains of each joint's servo: p [1/s], i [1/s2], d.
struct Gains {
  std::vector<double> p, i, d;
};
/// Whether each joint has completed its motion, and its target [rad, m].
struct Motion {
  std::vector<bool> arrived;
  std::vector<double> target;
};

/// Rotor position [rad] and velocity [rad/s] of each joint's drive train, on the joint side, the motor's
/// current [A] and the energy drawn [J]; nan without a drive train.
struct DriveTrains {
  std::vector<double> rotor_position, rotor_velocity, current, energy;
};

using WhichJoints = Which;

/// Made by Robot::joints(). Commands accept one value per named joint (none named: all), or one value for all
/// of them. Like set_velocity, they are sent with the next sim.step() in lockstep, and immediately in real
/// time. Each command switches its joints to the corresponding mode.
class Joints : public Parts {
 public:
  /// Moves joints smoothly to positions [rad, m], within their profile of speed and acceleration.
  void set_positions(const std::vector<double>& positions, const WhichJoints& joints = {});
  /// Sets positions for the end of the step [rad, m], for your own trajectories.
  void set_positions_direct(const std::vector<double>& positions, const WhichJoints& joints = {});
  /// Velocities [rad/s, m/s].
  void set_velocities(const std::vector<double>& velocities, const WhichJoints& joints = {});
  /// Efforts of the motors [N m, N].
  void set_efforts(const std::vector<double>& efforts, const WhichJoints& joints = {});
  /// Duties of the motors of drive trains, -1 to 1: the sign is the direction, 0 short-circuits the motor.
  void set_pwm(const std::vector<double>& duties, const WhichJoints& joints = {});
  /// Sets control modes: "idle", "position", "direct", "velocity", "effort" or, with a drive train, "pwm".
  /// Each joint stays where it is (idle and effort: without effort; pwm: braked) until its next command.
  void set_modes(const std::vector<std::string>& modes, const WhichJoints& joints = {});
  /// Holds joints at their present positions.
  void hold(const WhichJoints& joints = {});

  /// Turns joints into springs in the modes "position" and "direct": effort = k (reference - position) - d
  /// velocity + offset; k [N m/rad], d [N m s/rad], offset [N m]. k = inf: a servo again.
  void set_compliance(const std::vector<double>& k, const std::vector<double>& d = {0},
                      const std::vector<double>& offset = {0}, const WhichJoints& joints = {});
  /// Sets speed [rad/s, m/s] and acceleration [rad/s2, m/s2] of the moves of set_positions.
  void set_profile(const std::vector<double>& speed, const std::vector<double>& acceleration,
                   const WhichJoints& joints = {});
  /// Gains of the position servos: reference velocity = p error + i integral of it (docs/physics.md).
  void set_gains(const std::vector<double>& p, const std::vector<double>& i = {0},
                 const std::vector<double>& d = {0}, const WhichJoints& joints = {});

  JointReading get(const WhichJoints& joints = {});
  /// The same words as for set_modes.
  std::vector<std::string> get_modes(const WhichJoints& joints = {});
  Compliance get_compliance(const WhichJoints& joints = {});
  Profile get_profile(const WhichJoints& joints = {});
  Gains get_gains(const WhichJoints& joints = {});
  JointLimits get_limits(const WhichJoints& joints = {});
  Motion get_motion(const WhichJoints& joints = {});
  /// True if the joints have reached the targets of set_positions; false until a step has run since.
  bool arrived(const WhichJoints& joints = {});
  /// The active references: position, velocity, effort or duty, by mode.
  std::vector<double> get_references(const WhichJoints& joints = {});
  DriveTrains get_drive_trains(const WhichJoints& joints = {});

  /// The chain from the robot's frame R to the tool. Error 5 if the joints branch.
  const Chain& get_chain();
  /// The tool's pose in the robot's frame R, with all joints of the group at q; without q, at their present
  /// positions.
  Eigen::Isometry3d forward();
  Eigen::Isometry3d forward(const std::vector<double>& q);
  /// Positions of all joints, within their limits, that bring the tool to a pose in R, or only to a position
  /// [m]; near q0 if possible (default: the present positions). Throws Error 4 if none are found.
  std::vector<double> inverse(const Eigen::Isometry3d& pose, const std::vector<double>& q0 = {});
  std::vector<double> inverse(const Eigen::Vector3d& position, const std::vector<double>& q0 = {});

 private:
  friend class Robot;
  Joints(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);

  void Tune(std::int32_t command, const std::vector<const std::vector<double>*>& columns,
            const WhichJoints& joints);
  /// Returns q; if empty, the present positions.
  std::vector<double> Posture(const std::vector<double>& q);
  /// The elements of q that belong to the chain's joints, in the chain's order.
  std::vector<double> OfChain(const std::vector<double>& q);
  template <class Target>
  std::vector<double> Inverse(const Target& target, const std::vector<double>& q0);

  std::optional<Chain> chain_;
  std::vector<std::size_t> chain_joints_;  // their indices in the group
};

}  // namespace coopdyn::client
