// SPDX-License-Identifier: MIT
// Follows the wall on the right using a lidar: client_wall [robot1 [SECONDS]]
//
// Scenario `wall`. Two rays see the wall: b to the right, and a, turned ahead by the angle theta. They yield
// the robot's heading relative to the wall, its distance from the wall (or from the nearest thing on the
// right), and this distance after l more metres,
//
//   alpha = atan2(a cos(theta) - b, a sin(theta)),   d = b cos(alpha),   d_ahead = d + l sin(alpha).
//
// The turn rate controls d_ahead to the desired distance; near things ahead make the robot slow down and turn
// left. All three languages use the same algorithm and numbers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

constexpr double kWallDistance_m = 0.5;  // from the lidar
constexpr double kSide_rad = 1.5707963;  // bearing of b, to the right
constexpr double kAheadBy_rad = 0.7;     // theta
constexpr double kLookAhead_m = 0.5;     // l
constexpr double kGain = 4.0;            // rad/s/m
constexpr double kSpeed = 0.2;           // m/s
constexpr double kMaxTurn = 1.0;         // rad/s
constexpr double kMaxSine = 0.25;        // of alpha
constexpr double kRight_rad = 1.05;      // to either side of b: the search for the wall
constexpr double kFree_m = 0.7;          // the robot turns if something ahead is nearer
constexpr double kCone_rad = 0.35;       // to either side of ahead
constexpr double kSeen_m = 2.0;          // longer ranges are clamped to this

struct Command {
  double speed, turn, distance;
};

/// The magnitude of an angle, without whole turns.
double Off(double angle) {
  return std::abs(std::remainder(angle, 2 * std::numbers::pi));
}

/// The range of the ray nearest to a bearing, in the middle row.
double Ray(const client::Scan& scan, double bearing) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < scan.azimuth.size(); ++k) {
    if (Off(scan.azimuth[k] - bearing) < Off(scan.azimuth[nearest] - bearing)) nearest = k;
  }
  return std::min(kSeen_m, scan.at(scan.elevation.size() / 2, nearest));
}

/// The shortest range of the rays within `cone` of a bearing, in the middle row.
double Nearest(const client::Scan& scan, double bearing, double cone) {
  double range = kSeen_m;
  for (std::size_t k = 0; k < scan.azimuth.size(); ++k) {
    if (Off(scan.azimuth[k] - bearing) <= cone)
      range = std::min(range, scan.at(scan.elevation.size() / 2, k));
  }
  return range;
}

Command Follow(const client::Scan& scan) {
  const double a = Ray(scan, kAheadBy_rad - kSide_rad), b = Ray(scan, -kSide_rad);
  const double alpha = std::atan2(a * std::cos(kAheadBy_rad) - b, a * std::sin(kAheadBy_rad));
  const double distance = std::min(b * std::cos(alpha), Nearest(scan, -kSide_rad, kRight_rad));
  const double free = Nearest(scan, 0, kCone_rad);
  const double ahead = distance + kLookAhead_m * std::clamp(std::sin(alpha), -kMaxSine, kMaxSine);
  const double turn = kGain * (kWallDistance_m - ahead);
  if (free < kFree_m) return {kSpeed * std::max(0.0, free / kFree_m - 0.4), kMaxTurn, distance};
  return {kSpeed, std::clamp(turn, -kMaxTurn, kMaxTurn), distance};
}

void Run(const std::string& name, double duration) {
  client::Simulation sim = client::connect();
  client::Robot r = sim.robot(name);
  const double start = sim.time();
  client::Reading s = r.sense();
  int near = 0, steps = 0;
  double least = HUGE_VAL;
  while (s.time - start < duration) {
    const Command c = Follow(s.scan.value());
    r.set_velocity(c.speed, c.turn);
    ++steps;
    if (std::abs(c.distance - kWallDistance_m) < 0.1) ++near;
    for (const double range : s.scan->ranges) least = std::min(least, range);
    sim.step();
    s = r.sense();
  }
  std::printf("%s kept the wall within 0.1 m of %g m for %.0f %% of the time, and %.3f m from everything\n",
              name.c_str(), kWallDistance_m, 100.0 * near / steps, least);
  sim.close();
}

}  // namespace

int main(int argc, char** argv) try {
  Run(argc > 1 ? argv[1] : "robot1", argc > 2 ? std::stod(argv[2]) : 60);
  return 0;
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
