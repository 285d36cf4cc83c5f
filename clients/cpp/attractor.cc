// SPDX-License-Identifier: MIT
// Drives robots to the red target past obstacles: client_attractor [robot1 robot2 ...]
//
// The heading is a dynamical system (Schoener, Dose, Engels; Bicho): the target's bearing attracts it, and
// every distance sensor that sees something near repels it,
//
//   dphi/dt = -l_tar sin(phi - psi_tar) + sum_i l_i (phi - psi_i) exp(-(phi - psi_i)^2 / (2 s_i^2)),
//   l_i = b1 exp(-d_i / b2),   s_i = atan(tan(opening_i / 2) + R / (R + d_i)),
//
// and the speed relaxes to the value that the target or the obstacles allow, weighted by the repulsion's
// potential at the present heading. Angles are relative to the robot, so phi = 0. All three languages use the
// same algorithm and numbers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

constexpr double kRobotRadius_m = 0.18;
constexpr double kTargetStrength = 1.6;     // rad/s
constexpr double kObstacleStrength = 10.0;  // b1, 1/s
constexpr double kObstacleDecay_m = 0.3;    // b2
constexpr double kBias = 0.02;  // rad/s, instead of noise: turns off a heading exactly between left and right
constexpr double kMaxSpeed = 0.5;         // m/s
constexpr double kMaxTurn = 1.8;          // rad/s
constexpr double kTimeToTarget_s = 1.5;   // limits the speed by the target's distance
constexpr double kTimeToContact_s = 1.2;  // limits the speed by the distance of obstacles ahead
constexpr double kAhead_rad = 50 * std::numbers::pi / 180;  // sensors within this bearing are ahead
constexpr double kRelaxation = 8.0;                         // 1/s, of the speed
constexpr double kReached_m = 0.4;                          // from the axle's midpoint to the target
constexpr double kReachedByMany_m = 0.9;                    // if several robots share it
constexpr double kTimeLimit_s = 180.0;                      // simulated

struct Velocity {
  double forward, turn;
};

/// The state of one robot's controller: its speed.
class Attractor {
 public:
  explicit Attractor(client::Geometry geometry) : geometry_(std::move(geometry)) {}

  /// Speed [m/s] and turn rate [rad/s] for the next `dt` [s].
  Velocity Command(const client::Target& target, const std::vector<double>& distances, double dt) {
    double turn = kTargetStrength * std::sin(target.bearing) + kBias;
    double potential = 0, free = HUGE_VAL;
    for (std::size_t i = 0; i < std::min(distances.size(), geometry_.bearing.size()); ++i) {
      const double d = distances[i], psi = geometry_.bearing[i];
      if (std::isinf(d)) continue;
      const double strength = kObstacleStrength * std::exp(-d / kObstacleDecay_m);
      const double width =
          std::atan(std::tan(geometry_.opening[i] / 2) + kRobotRadius_m / (kRobotRadius_m + d));
      const double gauss = std::exp(-psi * psi / (2 * width * width));
      turn -= strength * psi * gauss;
      potential += strength * width * width * (gauss - std::exp(-0.5));
      if (std::abs(psi) <= kAhead_rad) free = std::min(free, d);
    }
    turn = std::clamp(turn, -kMaxTurn, kMaxTurn);
    const double near = std::atan(8 * potential) / std::numbers::pi;  // -1/2: nothing near ahead, 1/2: much
    const double by_target =
        std::min(kMaxSpeed, target.distance / kTimeToTarget_s) * std::max(0.1, std::cos(target.bearing / 2));
    const double by_obstacles = std::min(kMaxSpeed, free / kTimeToContact_s);
    const double wanted = (0.5 - near) * by_target + (0.5 + near) * std::min(by_target, by_obstacles);
    speed_ = wanted + (speed_ - wanted) * std::exp(-kRelaxation * dt);
    return {speed_, turn};
  }

 private:
  client::Geometry geometry_;
  double speed_ = 0;
};

int Run(const std::vector<std::string>& names) {
  const double reached_at = names.size() == 1 ? kReached_m : kReachedByMany_m;
  client::Simulation sim = client::connect();
  struct Driven {
    client::Robot robot;
    Attractor controller;
    bool driving = true;
  };
  std::vector<Driven> all;
  for (const std::string& name : names) {
    client::Robot robot = sim.robot(name);
    Attractor controller(robot.get_geometry());
    all.push_back({std::move(robot), std::move(controller)});
  }
  const double dt = sim.dt(), start = sim.time();
  std::size_t left = all.size();
  while (left > 0 && sim.time() - start < kTimeLimit_s) {
    for (Driven& d : all) {
      if (!d.driving) continue;
      const client::Reading s = d.robot.sense("red");
      if (s.target->distance < reached_at) {
        d.robot.stop();
        d.driving = false;
        --left;
        std::printf("%s reached the target: %.2f %.2f at t = %.2f s\n", d.robot.name().c_str(), s.pose->x,
                    s.pose->y, s.time);
      } else {
        const Velocity v = d.controller.Command(*s.target, s.distances, dt);
        d.robot.set_velocity(v.forward, v.turn);
      }
    }
    sim.step();
  }
  for (const Driven& d : all) {
    if (d.driving) std::printf("%s did not reach the target in %g s\n", d.robot.name().c_str(), kTimeLimit_s);
  }
  sim.close();
  return left > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> names(argv + 1, argv + argc);
  if (names.empty()) names = {"robot1"};
  return Run(names);
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
