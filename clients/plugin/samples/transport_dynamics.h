// SPDX-License-Identifier: MIT
// A leader and its helper carry a bar together by attractor dynamics (Bicho, Louro, Soares, Erlhagen);
// docs/teams.md has the equations. Same algorithm and numbers as clients/python/transport.py and
// clients/matlab/transport.m. Pure; SI units; angles in the robot's frame, left positive.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace coopdyn::transport {

constexpr double kRobotRadius = 0.18;    // m
constexpr double kTeamDistance = 1.2;    // m, from leader to helper
constexpr double kTargetStrength = 0.9;  // rad/s
constexpr double kBarStrength = 2.5;     // rad/s, of the helper towards the bar's direction
constexpr double kLeaderObstacle = 6.0;  // 1/s
constexpr double kLeaderDecay = 0.45;    // m; the leader keeps room for the bar behind it
constexpr double kHelperObstacle = 4.0;  // 1/s
constexpr double kHelperDecay = 0.2;     // m
constexpr double kBias = 0.02;           // rad/s instead of noise
constexpr double kLeaderSpeed = 0.3;     // m/s
constexpr double kHelperSpeed = 0.5;     // m/s
constexpr double kLeaderTurn = 0.8;      // rad/s
constexpr double kHelperTurn = 1.8;      // rad/s
constexpr double kTimeToTarget = 1.5;    // s
constexpr double kTimeToContact = 1.6;   // s
constexpr double kRelaxation = 2.0;      // 1/s of the leader's speed
constexpr double kAhead = 0.873;         // rad
constexpr double kReached = 0.4;         // m from the leader to the target
constexpr double kFold = 1.3;            // rad: beyond it a robot turns back towards the bar
constexpr double kFoldStrength = 4.0;    // 1/s
constexpr double kFollow = 12.0;         // 1/s, speed per displacement of the load along the bar
constexpr double kFollowIntegral = 8.0;  // 1/s²
constexpr double kAcross = 5.0;          // rad/s per m of the load across the bar
constexpr double kSlack = 0.055;         // m: the leader stops when the load lags this far behind
constexpr double kEase = 0.03;           // m: the leader slows down from kSlack - kEase on
constexpr double kMateWidth = 0.35;      // rad: ranges within this angle of the mate's bearing are the mate
constexpr double kMateNear = 0.25;       // m: unless they are this much nearer than the mate
constexpr double kPi = 3.14159265358979323846;

struct Velocity {
  double forward = 0, turn = 0;
};
/// The load's displacement at the support.
struct Load {
  double x = 0, y = 0, angle = 0;

  double along() const { return x * std::cos(angle) + y * std::sin(angle); }
  double across() const { return y * std::cos(angle) - x * std::sin(angle); }
};
/// Readings of the distance sensors, right to left.
struct Ranges {
  std::size_t count = 0;
  const double* distance = nullptr;
  const double* bearing = nullptr;
  const double* opening = nullptr;
};

inline double Wrap(double angle) {
  return std::remainder(angle, 2 * kPi);
}

/// The effect of obstacles on heading and speed, without the mate at bearing `mate`.
struct Obstacles {
  double turn = 0, potential = 0, free = std::numeric_limits<double>::infinity();

  Obstacles(const Ranges& seen, double strength, double decay, double mate) {
    for (std::size_t i = 0; i < seen.count; ++i) {
      const double d = seen.distance[i], psi = seen.bearing[i];
      if (std::isinf(d)) continue;
      const bool is_mate =
          std::abs(Wrap(psi - mate)) < kMateWidth && d > kTeamDistance - 2 * kRobotRadius - kMateNear;
      if (is_mate) continue;
      const double weight = strength * std::exp(-d / decay);
      const double width = std::atan(std::tan(seen.opening[i] / 2) + kRobotRadius / (kRobotRadius + d));
      const double gauss = std::exp(-psi * psi / (2 * width * width));
      turn -= weight * psi * gauss;
      potential += weight * width * width * (gauss - std::exp(-0.5));
      if (std::abs(psi) <= kAhead) free = std::min(free, d);
    }
  }
};

/// A turn rate back towards the bar if the heading is too far from it.
inline double Unfold(double angle) {
  return std::abs(angle) <= kFold ? 0 : kFoldStrength * (angle - std::copysign(kFold, angle));
}

/// Drives to the target past obstacles, as fast as the load follows.
struct Leader {
  double speed = 0;  // its state

  Velocity Step(double target_distance, double target_bearing, const Ranges& seen, const Load& load,
                double dt) {
    if (target_distance < kReached) {
      speed = 0;
      return {};
    }
    const Obstacles obstacles(seen, kLeaderObstacle, kLeaderDecay, load.angle + kPi);
    const double turn = std::clamp(kTargetStrength * std::sin(target_bearing) + kBias + obstacles.turn,
                                   -kLeaderTurn, kLeaderTurn);
    const double near = std::atan(8 * obstacles.potential) / kPi;  // -1/2: nothing near ahead, 1/2: much
    const double by_target =
        std::min(kLeaderSpeed, target_distance / kTimeToTarget) * std::max(0.1, std::cos(target_bearing / 2));
    const double by_obstacles = std::min(kLeaderSpeed, obstacles.free / kTimeToContact);
    const double by_load = std::clamp((kSlack + load.along()) / kEase, 0.0, 1.0);
    const double wanted =
        by_load * ((0.5 - near) * by_target + (0.5 + near) * std::min(by_target, by_obstacles));
    speed = wanted + (speed - wanted) * std::exp(-kRelaxation * dt);
    return {speed * std::min(1.0, by_load), turn + Unfold(load.angle)};
  }
};

/// Follows the load: turns its heading along the bar and drives so that the load returns to the middle of the
/// support.
struct Helper {
  double speed = 0;  // its state: the leader's estimated speed along the bar

  Velocity Step(const Ranges& seen, const Load& load, double dt) {
    const Obstacles obstacles(seen, kHelperObstacle, kHelperDecay, load.angle);
    const double turn = std::clamp(
        kBarStrength * std::sin(load.angle) + kAcross * load.across() + obstacles.turn + Unfold(load.angle),
        -kHelperTurn, kHelperTurn);
    speed = std::clamp(speed + kFollowIntegral * load.along() * dt, -kHelperSpeed, kHelperSpeed);
    const double wanted = (speed + kFollow * load.along()) / std::max(0.5, std::cos(load.angle));
    return {std::clamp(wanted, -kHelperSpeed, kHelperSpeed), turn};
  }
};

}  // namespace coopdyn::transport
