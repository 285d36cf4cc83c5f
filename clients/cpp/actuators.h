// SPDX-License-Identifier: MIT
// Muscles and thrusters of a robot, and its channel. Commands go with the next sim.step() in lockstep, and at
// once in real time; each stays until the next.
//
//   auto m = r.muscles();
//   m.set_activations({0.2});               // of all: the part of their force that they give, 0 to 1
//   m.set_activations({0.8}, "biceps");     // one muscle, by its name or its number from 1
//   auto t = r.thrusters();
//   t.set_thrusts({2, 0.1});                // N, or N m of those that turn their link
//   sim.step();
//   const double force = m.get("biceps").force[0];
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clients/cpp/parts.h"

namespace coopdyn::client {

/// What each muscle is told (0 to 1), how it pulls [N], how long it is [m], how fast it grows longer [m/s],
/// and the factors of length and velocity of its force.
struct MuscleReading {
  std::vector<double> activation, force, length, velocity, length_factor, velocity_factor;
};
/// Of each muscle: its greatest force [N], at the length [m], and the velocity [m/s] at which it no longer
/// pulls.
struct MuscleLimits {
  std::vector<double> max_force, optimal_length, max_velocity;
};
/// How each thruster pushes or turns its link [N, N m], and how fast that moves along or about its direction
/// [m/s, rad/s].
struct ThrusterReading {
  std::vector<double> thrust, velocity;
};
/// The greatest force or torque of each thruster, either way [N, N m].
struct ThrusterLimits {
  std::vector<double> max_thrust;
};
/// A motor or value of a channel: its range in the robot [SI units], internal_min to internal_max, is
/// external_min to external_max here; inf = not mapped. `auxiliary`: for the experimenter alone.
struct Mapped {
  std::string name;
  double internal_min = 0, internal_max = 0, external_min = 0, external_max = 0;
  bool auxiliary = false;
};

/// Made by Robot::muscles().
class Muscles : public Parts {
 public:
  /// How much of their force muscles give, 0 to 1: a value for each that is named (none: for all), or one.
  void set_activations(const std::vector<double>& activations, const Which& muscles = {});
  MuscleReading get(const Which& muscles = {});
  MuscleLimits get_limits();

 private:
  friend class Robot;
  Muscles(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);
};

/// Made by Robot::thrusters().
class Thrusters : public Parts {
 public:
  /// Forces [N] and torques [N m]: a value for each that is named (none: for all), or one for all of them.
  void set_thrusts(const std::vector<double>& thrusts, const Which& thrusters = {});
  ThrusterReading get(const Which& thrusters = {});
  ThrusterLimits get_limits();

 private:
  friend class Robot;
  Thrusters(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);
};

/// All motors and values that a robot's model maps (docs/yars.md), in one exchange. Made by Robot::channel().
class Channel {
 public:
  const std::vector<Mapped>& motors() const { return motors_; }
  const std::vector<Mapped>& values() const { return values_; }
  /// Of one exchange: sim.step(c.steps()).
  int steps() const { return steps_; }
  /// Sets motors, mapped. Those that are not named stay as they were set.
  void set(const std::vector<double>& values, const Which& motors = {});
  /// The values, mapped; of all that are called alike.
  std::vector<double> get(const Which& values = {});
  /// Whether the try is to end: a contact that the model says to end it is pressed.
  bool aborted();

 private:
  friend class Robot;
  explicit Channel(std::shared_ptr<RobotLink> link);
  std::vector<std::int32_t> Ids(const Which& which, const std::vector<Mapped>& mapped, const char* one) const;

  std::shared_ptr<RobotLink> link_;
  std::vector<Mapped> motors_, values_;
  int steps_ = 1;
  std::vector<double> sent_;
};

}  // namespace coopdyn::client
