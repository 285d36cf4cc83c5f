// SPDX-License-Identifier: MIT
// Draws a square in the air with a robot's arm: client_square [ROBOT]. Runs in lockstep and in real time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace client = coopdyn::client;

namespace {

constexpr double kSide_m = 0.2;
constexpr double kSide_s = 2;  // for each side

/// From 0 to 1 with minimum jerk.
double Smooth(double s) {
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

/// A point on the outline of the square in the plane x = 0, centred at 0.
double Distance(const Eigen::Vector3d& p) {
  const Eigen::Vector2d over = p.tail<2>().cwiseAbs().array() - kSide_m / 2;
  const double outside = over.cwiseMax(0).norm();
  return std::hypot(p.x(), outside > 0 ? outside : over.maxCoeff());
}

void Move(client::Simulation& sim, client::Joints& arm, const std::vector<double>& q) {
  arm.set_positions(q);
  do {
    sim.step();
  } while (!arm.arrived());
}

void Draw(const std::string& name) {
  client::Simulation sim = client::connect();
  client::Robot robot = sim.robot(name);
  client::Joints arm = robot.joints();
  // Bend the arm forward, so that the tool can move in all directions: 0.8 rad about each axis that points
  // left.
  std::vector<double> q;
  for (const client::ChainJoint& joint : arm.get_chain().joints())
    q.push_back(0.8 * std::round(joint.axis.y()));
  Move(sim, arm, q);
  Eigen::Isometry3d pose = arm.forward();
  const Eigen::Vector3d middle = pose.translation();

  // The path of the joints: one posture per step, each found near the previous one.
  const double dt = sim.dt(), half = kSide_m / 2;
  const auto steps = static_cast<int>(std::lround(kSide_s / dt));
  const Eigen::Vector3d corners[] = {{0, -half, -half}, {0, half, -half},  {0, half, half},
                                     {0, -half, half},  {0, -half, -half}, {0, half, -half}};
  std::vector<std::vector<double>> way;
  q = arm.get().position;
  for (int k = 0; k <= 4 * steps; ++k) {
    const int side = k / steps;
    const double s = Smooth(static_cast<double>(k % steps) / steps);
    pose.translation() = middle + (1 - s) * corners[side] + s * corners[side + 1];
    q = arm.inverse(pose, q);
    way.push_back(q);
  }

  Move(sim, arm, way[0]);
  double off = 0;
  const double began = sim.time();
  while (true) {
    const auto k = static_cast<std::size_t>(std::lround((sim.time() - began) / dt)) + 1;
    if (k >= way.size()) break;
    arm.set_positions_direct(way[k]);
    sim.step();
    const Eigen::Isometry3d reached = arm.forward(robot.sense().joints.at(arm.name()).position);
    off = std::max(off, Distance(reached.translation() - middle));
  }
  std::printf("a square of %g m in %.2f s, at most %.3f mm off\n", kSide_m, sim.time() - began, 1000 * off);
  sim.close();
}

}  // namespace

int main(int argc, char** argv) try {
  Draw(argc > 1 ? argv[1] : "robot1");
  return 0;
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
