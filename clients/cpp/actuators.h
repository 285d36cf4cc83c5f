// SPDX-License-Identifier: MIT
// Muscles and thrusters of a robot, and its channel. In lockstep, commands are sent with the next sim.step();
// in real time, immediately. Each command holds until the next.
//
//   auto m = r.muscles();
//   m.set_activations({0.2});               // all muscles: fraction of their force, 0 to 1
//   m.set_activations({0.8}, "biceps");     // one muscle, by its name or its number from 1
//   auto t = r.thrusters();
//   t.set_thrusts({2, 0.1});                // N; N m for thrusters that turn their link
//   sim.step();
//   const double force = m.get("biceps").force[0];
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clients/cpp/parts.h"

namespace coopdyn::client {

/// Activation (0 to 1), force [N], length [m] and lengthening velocity [m/s] of each muscle, and the
/// force-length and force-velocity factors.
struct MuscleReading {
  std::vector<double> activation, force, length, velocity, length_factor, velocity_factor;
};
/// For each muscle: maximal force [N], the length at which it occurs [m], and the velocity at which the force
/// vanishes [m/s].
struct MuscleLimits {
  std::vector<double> max_force, optimal_length, max_velocity;
};
/// Force or torque of each thruster on its link [N, N m], and the link's velocity along or about the thrust
/// direction [m/s, rad/s].
struct ThrusterReading {
  std::vector<double> thrust, velocity;
};
/// Maximal force or torque of each thruster, in both directions [N, N m].
struct ThrusterLimits {
  std::vector<double> max_thrust;
};
/// A motor or value of a channel. Maps internal_min..internal_max in the robot [SI units] to
/// external_min..external_max here; inf = not mapped. `auxiliary`: only for the experimenter.
struct Mapped {
  std::string name;
  double internal_min = 0, internal_max = 0, external_min = 0, external_max = 0;
  bool auxiliary = false;
};

/// Made by Robot::muscles().
class Muscles : public Parts {
 public:
  /// Sets fractions of the muscles' force, 0 to 1: one value per named muscle (none named: all), or one for
  /// all of them.
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
  /// Sets forces [N] and torques [N m]: one value per named thruster (none named: all), or one for all of
  /// them.
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
  /// Steps of one exchange: sim.step(c.steps()).
  int steps() const { return steps_; }
  /// Sets motors in external units. Motors that are not named keep their values.
  void set(const std::vector<double>& values, const Which& motors = {});
  /// Values in external units; a name returns all values of that name.
  std::vector<double> get(const Which& values = {});
  /// True if the trial must end: a contact that the model declares as terminating is pressed.
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
