// SPDX-License-Identifier: MIT
// Moves an arm in every way and prints its readings; arm_program.py and arm_program.m are the same program.
#include <cstdio>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace {

void Show(const char* what, const std::vector<double>& values) {
  std::printf("%s", what);
  for (const double value : values) std::printf(" %.17g", value);
  std::printf("\n");
}

std::vector<double> Joined(std::vector<double> first, const std::vector<double>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

void Run() {
  auto sim = coopdyn::client::connect();
  auto robot = sim.robot("arm1");
  auto arm = robot.joints("arm");
  arm.set_positions({0, 0.4, 0, 0.4, 0, 0.4, 0});
  sim.step();
  double steps = 1;
  for (; !arm.arrived(); ++steps) sim.step();
  Show("arrived", Joined({steps}, arm.get().position));
  Show("target", arm.get_motion().target);
  arm.set_velocities({0.2, -0.1}, {1, 3});
  sim.step(50);
  Show("velocities", arm.get().velocity);
  arm.set_efforts({1.5}, "joint_7");
  sim.step(5);
  Show("efforts", arm.get({6, 7}).effort);
  std::printf("modes");
  for (const std::string& mode : arm.get_modes()) std::printf(" %s", mode.c_str());
  std::printf("\n");
  arm.hold();
  sim.step(30);
  Show("held", arm.get().position);
  arm.set_compliance({200}, {20}, {1}, 2);
  sim.step(100);
  const auto compliance = arm.get_compliance(2);
  Show("compliance", Joined(Joined(compliance.k, compliance.d), compliance.offset));
  Show("sagged", arm.get(2).position);
  for (int k = 0; k < 20; ++k) {
    arm.set_positions_direct({0.4 + 0.001 * k}, 4);
    sim.step();
  }
  Show("direct", Joined(arm.get_references(4), arm.get(4).position));
  const Eigen::Vector3d p = arm.forward({0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}).translation();
  Show("tool", {p.x(), p.y(), p.z()});
  std::printf("hash %s %lld\n", sim.hash().c_str(), static_cast<long long>(sim.steps()));
  sim.close();
}

}  // namespace

int main() try {
  Run();
  return 0;
} catch (const coopdyn::client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
