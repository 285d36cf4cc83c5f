// SPDX-License-Identifier: MIT
// Groups of joints that are driven together, as an arm.
//
//   auto arm = r.joints("arm");
//   arm.set_positions({0.5, -0.3, 0, 1.2, 0, 0.4, 0});   // rad, or m of a slider: a smooth move
//   while (!arm.arrived()) sim.step();
//   arm.set_positions({0.5}, "elbow");                   // one joint, by its name or its number from 1
//   const Eigen::Isometry3d pose = arm.forward();        // where the tool is, in the robot's frame R
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

/// Where each joint is [rad, m], how fast, and the effort of its motor [N m, N; nan before the first step].
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
/// Speed [rad/s] and acceleration [rad/s2] of each joint on its way to a position.
struct Profile {
  std::vector<double> speed, acceleration;
};
/// Gains of each joint's servo: p [1/s], i [1/s2], d.
struct Gains {
  std::vector<double> p, i, d;
};
/// Whether each joint has ended its motion, and where it goes [rad, m].
struct Motion {
  std::vector<bool> arrived;
  std::vector<double> target;
};

/// Where the rotor of each joint's drive train is, as the joint counts [rad], how fast [rad/s], the motor's
/// current [A] and the energy that it has drawn [J]; nan without a drive train.
struct DriveTrains {
  std::vector<double> rotor_position, rotor_velocity, current, energy;
};

using WhichJoints = Which;

/// Made by Robot::joints(). Commands take a value for each joint that is named (none: for all), or one value
/// for all of them. As set_velocity, they go with the next sim.step() in lockstep, and at once in real time.
/// Each puts its joints into its mode.
class Joints : public Parts {
 public:
  /// Moves joints smoothly to positions [rad, m], within their profile of speed and acceleration.
  void set_positions(const std::vector<double>& positions, const WhichJoints& joints = {});
  /// Where joints are to be at the end of the step [rad, m]: for trajectories of one's own.
  void set_positions_direct(const std::vector<double>& positions, const WhichJoints& joints = {});
  /// Velocities [rad/s, m/s].
  void set_velocities(const std::vector<double>& velocities, const WhichJoints& joints = {});
  /// Efforts of the motors [N m, N].
  void set_efforts(const std::vector<double>& efforts, const WhichJoints& joints = {});
  /// Duties of the motors of drive trains, -1 to 1: the sign is the direction, 0 short-circuits the motor.
  void set_pwm(const std::vector<double>& duties, const WhichJoints& joints = {});
  /// How joints are driven: "idle", "position", "direct", "velocity", "effort" or, of a drive train, "pwm".
  /// Each keeps still where it is (idle and effort: without effort; pwm: braked) until its next command.
  void set_modes(const std::vector<std::string>& modes, const WhichJoints& joints = {});
  /// Holds joints where they are.
  void hold(const WhichJoints& joints = {});

  /// Makes joints springs in the modes "position" and "direct": effort = k (reference - position) - d
  /// velocity
  /// + offset; k [N m/rad], d [N m s/rad], offset [N m]. k = inf: a servo again.
  void set_compliance(const std::vector<double>& k, const std::vector<double>& d = {0},
                      const std::vector<double>& offset = {0}, const WhichJoints& joints = {});
  /// How fast set_positions moves joints: speed [rad/s, m/s] and acceleration [rad/s2, m/s2].
  void set_profile(const std::vector<double>& speed, const std::vector<double>& acceleration,
                   const WhichJoints& joints = {});
  /// Gains of the position servos: reference velocity = p error + i integral of it (docs/physics.md).
  void set_gains(const std::vector<double>& p, const std::vector<double>& i = {0},
                 const std::vector<double>& d = {0}, const WhichJoints& joints = {});

  JointReading get(const WhichJoints& joints = {});
  /// Words as of set_modes.
  std::vector<std::string> get_modes(const WhichJoints& joints = {});
  Compliance get_compliance(const WhichJoints& joints = {});
  Profile get_profile(const WhichJoints& joints = {});
  Gains get_gains(const WhichJoints& joints = {});
  JointLimits get_limits(const WhichJoints& joints = {});
  Motion get_motion(const WhichJoints& joints = {});
  /// True if joints are where set_positions sent them; false until a step has run since.
  bool arrived(const WhichJoints& joints = {});
  /// The reference in force: position, velocity, effort or duty by the mode.
  std::vector<double> get_references(const WhichJoints& joints = {});
  DriveTrains get_drive_trains(const WhichJoints& joints = {});

  /// The chain from the robot's frame R to the tool. Error 5 if the joints branch.
  const Chain& get_chain();
  /// The pose of the tool in the robot's frame R, with all joints of the group at q; without q where they
  /// are.
  Eigen::Isometry3d forward();
  Eigen::Isometry3d forward(const std::vector<double>& q);
  /// Positions of all joints within their limits that bring the tool to this pose in R, or to this position
  /// only [m], near q0 if it can be; without q0 near where they are. Throws Error 4 if there are none.
  std::vector<double> inverse(const Eigen::Isometry3d& pose, const std::vector<double>& q0 = {});
  std::vector<double> inverse(const Eigen::Vector3d& position, const std::vector<double>& q0 = {});

 private:
  friend class Robot;
  Joints(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);

  void Tune(std::int32_t command, const std::vector<const std::vector<double>*>& columns,
            const WhichJoints& joints);
  /// q, or where the joints are if it is empty.
  std::vector<double> Posture(const std::vector<double>& q);
  /// The values of q of the chain's joints, in its order.
  std::vector<double> OfChain(const std::vector<double>& q);
  template <class Target>
  std::vector<double> Inverse(const Target& target, const std::vector<double>& q0);

  std::optional<Chain> chain_;
  std::vector<std::size_t> chain_joints_;  // indices of the chain's joints
};

}  // namespace coopdyn::client
