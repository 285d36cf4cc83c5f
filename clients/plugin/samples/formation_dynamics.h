// SPDX-License-Identifier: MIT
// Keeps a formation around obstacles by attractor dynamics (Monteiro, Bicho); docs/teams.md has the
// equations. Same algorithm and numbers as clients/python/formation.py and clients/matlab/formation.m. Pure;
// SI units; angles in the robot's frame, left positive.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace coopdyn::formation {

constexpr double kRobotRadius = 0.18;       // m
constexpr double kTargetStrength = 1.2;     // rad/s
constexpr double kPlaceStrength = 2.5;      // rad/s, of a follower towards its place
constexpr double kObstacleStrength = 10.0;  // 1/s
constexpr double kObstacleDecay = 0.2;      // m
constexpr double kBias = 0.02;              // rad/s instead of noise
constexpr double kLeaderSpeed = 0.3;        // m/s
constexpr double kFollowerSpeed = 0.6;      // m/s
constexpr double kMaxTurn = 1.8;            // rad/s
constexpr double kTimeToTarget = 1.5;       // s
constexpr double kTimeToContact = 1.2;      // s
constexpr double kRelaxation = 8.0;         // 1/s, of the speed
constexpr double kAhead = 0.873;            // rad
constexpr double kReached = 0.4;            // m from the leader to the target
constexpr double kPull = 0.8;               // 1/s, speed per distance to the place
constexpr double kNear = 0.04;              // m: nearer to its place a robot is not pulled
constexpr double kCalm = 0.05;              // m/s: a slower wanted velocity turns the robot less
constexpr double kAway = 0.25;     // least share of the wanted speed while an obstacle turns the robot away
constexpr double kPatience = 0.3;  // m: the leader slows down when a robot is farther from its place
constexpr double kSlowest = 0.2;   // share of its speed, at twice that distance
constexpr double kPi = 3.14159265358979323846;

struct Velocity {
  double forward = 0, turn = 0;
};
/// Readings of the distance sensors, right to left.
struct Ranges {
  std::size_t count = 0;
  const double* distance = nullptr;
  const double* bearing = nullptr;
  const double* opening = nullptr;
};
/// A robot's place in the leader's frame.
struct Place {
  double x = 0, y = 0;
};
/// The leader as a follower sees it: position and orientation in the follower's frame.
struct Mate {
  double distance = 0, bearing = 0, turned = 0;
  double speed = 0, turn = 0;  // m/s, rad/s
};

/// The place of robot `number` in an inverted V or a triangle; 0 leads. Each row is `along` behind the
/// previous one and `across` farther to the left or right.
inline Place PlaceOf(int number, double along, double across) {
  const int row = (number + 1) / 2;
  return {-along * row, number % 2 == 1 ? across * row : -across * row};
}

/// The effect of obstacles on heading and speed.
struct Obstacles {
  double turn = 0, potential = 0, free = std::numeric_limits<double>::infinity();

  explicit Obstacles(const Ranges& seen) {
    for (std::size_t i = 0; i < seen.count; ++i) {
      const double d = seen.distance[i], psi = seen.bearing[i];
      if (std::isinf(d)) continue;
      const double weight = kObstacleStrength * std::exp(-d / kObstacleDecay);
      const double width = std::atan(std::tan(seen.opening[i] / 2) + kRobotRadius / (kRobotRadius + d));
      const double gauss = std::exp(-psi * psi / (2 * width * width));
      turn -= weight * psi * gauss;
      potential += weight * width * width * (gauss - std::exp(-0.5));
      if (std::abs(psi) <= kAhead) free = std::min(free, d);
    }
  }

  /// The speed `wanted`, reduced if something is near ahead.
  double Limit(double wanted) const {
    const double near = std::atan(8 * potential) / kPi;  // -1/2: nothing near ahead, 1/2: much
    return (0.5 - near) * wanted + (0.5 + near) * std::min(wanted, free / kTimeToContact);
  }
};

/// A robot's controller; its speed is its state.
struct Robot {
  double speed = 0;

  /// Drives to the target; `worst`: the greatest distance of a follower from its place, m.
  Velocity Lead(double target_distance, double target_bearing, double worst, const Ranges& seen, double dt) {
    if (target_distance < kReached) {
      speed = 0;
      return {};
    }
    const Obstacles obstacles(seen);
    const double turn = kTargetStrength * std::sin(target_bearing) + kBias + obstacles.turn;
    const double patience = std::clamp(2 - worst / kPatience, kSlowest, 1.0);
    const double by_target = std::min(patience * kLeaderSpeed, target_distance / kTimeToTarget) *
                             std::max(0.1, std::cos(target_bearing / 2));
    Relax(obstacles.Limit(by_target), dt);
    return {speed, std::clamp(turn, -kMaxTurn, kMaxTurn)};
  }

  /// Drives to `place`, which moves with the leader.
  Velocity Follow(const Mate& leader, const Place& place, const Ranges& seen, double dt) {
    const double c = std::cos(leader.turned), s = std::sin(leader.turned);
    const double along = leader.speed - leader.turn * place.y, across = leader.turn * place.x;
    const Place to = Error(leader, place);
    const double off = std::hypot(to.x, to.y), pull = off > kNear ? kPull * (1 - kNear / off) : 0;
    const double x = c * along - s * across + pull * to.x, y = s * along + c * across + pull * to.y;
    const double wish = std::hypot(x, y), bearing = std::atan2(y, x);
    const Obstacles obstacles(seen);
    const double turn = std::min(1.0, wish / kCalm) * (kPlaceStrength * std::sin(bearing) + obstacles.turn);
    Relax(obstacles.Limit(std::min(wish * std::max(kAway, std::cos(bearing)), kFollowerSpeed)), dt);
    return {speed, std::clamp(turn, -kMaxTurn, kMaxTurn)};
  }

  /// The vector from the follower to its place, in the follower's frame.
  static Place Error(const Mate& leader, const Place& place) {
    const double c = std::cos(leader.turned), s = std::sin(leader.turned);
    return {leader.distance * std::cos(leader.bearing) + c * place.x - s * place.y,
            leader.distance * std::sin(leader.bearing) + s * place.x + c * place.y};
  }

 private:
  void Relax(double wanted, double dt) { speed = wanted + (speed - wanted) * std::exp(-kRelaxation * dt); }
};

}  // namespace coopdyn::formation
