// SPDX-License-Identifier: MIT
// Robots keep a formation round obstacles on the way to the red target: client_formation [robot1 robot2 ...]
//
// The first robot leads. Five keep an inverted V, three a triangle; near obstacles they break the formation
// and restore it behind them. docs/teams.md has the equations (Monteiro, Bicho), formation_dynamics.h the
// algorithm and its numbers, which are the same in all languages.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "clients/plugin/samples/formation_dynamics.h"

namespace {

namespace client = coopdyn::client;
namespace formation = coopdyn::formation;

constexpr double kVAlong = 1.0, kVAcross = 1.0;                 // m, of the inverted V
constexpr double kTriangleAlong = 1.04, kTriangleAcross = 0.6;  // m, of three robots
constexpr double kClosed = 0.1;         // m, largest distance of a robot from its place at the end
constexpr double kTimeLimit_s = 240.0;  // simulated

formation::Ranges RangesOf(const std::vector<double>& distances, const client::Geometry& geometry) {
  return {std::min(distances.size(), geometry.bearing.size()), distances.data(), geometry.bearing.data(),
          geometry.opening.data()};
}

/// The leader as seen from a follower; `told`: the leader's command.
formation::Mate Seen(const client::Pose& leader, const client::Pose& own, const formation::Velocity& told) {
  const double x = leader.x - own.x, y = leader.y - own.y;
  return {std::hypot(x, y), std::atan2(y, x) - own.heading, leader.heading - own.heading, told.forward,
          told.turn};
}

struct Member {
  client::Robot robot;
  client::Geometry geometry;
  formation::Place place;
  formation::Robot controller;
};

int Run(std::vector<std::string> names) {
  client::Simulation sim = client::connect();
  if (names.empty()) names = sim.robots();
  const bool triangle = names.size() == 3;
  std::vector<Member> members;
  for (const std::string& name : names) {
    client::Robot robot = sim.robot(name);
    client::Geometry geometry = robot.get_geometry();
    const formation::Place place =
        formation::PlaceOf(static_cast<int>(members.size()), triangle ? kTriangleAlong : kVAlong,
                           triangle ? kTriangleAcross : kVAcross);
    members.push_back({std::move(robot), std::move(geometry), place, {}});
  }
  const double dt = sim.dt(), start = sim.time();
  formation::Velocity told;  // the leader's command
  while (sim.time() - start < kTimeLimit_s) {
    std::vector<client::Reading> seen;
    for (Member& member : members) seen.push_back(member.robot.sense("red"));
    const client::Pose leader = *seen[0].pose;
    double worst = 0;
    for (std::size_t i = 1; i < members.size(); ++i) {
      const formation::Place off =
          formation::Robot::Error(Seen(leader, *seen[i].pose, told), members[i].place);
      worst = std::max(worst, std::hypot(off.x, off.y));
    }
    if (seen[0].target->distance < formation::kReached && worst < kClosed) {
      std::printf("the formation reached the target, %.1f cm off, at t = %.2f s\n", 100 * worst,
                  seen[0].time);
      sim.close();
      return 0;
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
      Member& member = members[i];
      const formation::Ranges ranges = RangesOf(seen[i].distances, member.geometry);
      formation::Velocity v;
      if (i == 0) {
        v = told =
            member.controller.Lead(seen[0].target->distance, seen[0].target->bearing, worst, ranges, dt);
      } else {
        v = member.controller.Follow(Seen(leader, *seen[i].pose, told), member.place, ranges, dt);
      }
      member.robot.set_velocity(v.forward, v.turn);
    }
    sim.step();
  }
  std::printf("the formation did not reach the target in %g s\n", kTimeLimit_s);
  sim.close();
  return 1;
}

}  // namespace

int main(int argc, char** argv) try { return Run({argv + 1, argv + argc}); } catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
