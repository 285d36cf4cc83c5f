// SPDX-License-Identifier: MIT
// Robots' modules on real boards with hand-made frames, without sockets.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "server/robot/robot_module.h"
#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {

inline constexpr int kMotors = 0, kDistance = 1, kTarget = 2, kPose = 3;

class RobotModuleTest : public testing::Test {
 protected:
  explicit RobotModuleTest(int robots = 2) : world_(robots) {
    for (int i = 0; i < robots; ++i) AddRobot(i);
  }

  void AddRobot(int index) {
    const RobotEntry& entry = world_.frames.Latest()->scene->robots[static_cast<std::size_t>(index)].entry;
    robots_.push_back(std::make_unique<RobotCore>(entry, services_, thread_.poster(), thread_.poster()));
    for (std::size_t m = 0; m < 4; ++m) modules_.push_back(std::make_unique<RobotModule>(*robots_.back(), m));
  }
  RobotModule& Module(int module, int robot = 0) {
    return *modules_[static_cast<std::size_t>(4 * robot + module)];
  }
  std::unique_ptr<FakeClient> Connect(int module, int robot = 0, bool trusted = true) {
    return std::make_unique<FakeClient>(Module(module, robot), ++last_client_, trusted);
  }
  void SetMode(Mode mode) { world_.board.SetMode(mode, 0); }

  ManualClock clock_;
  ImageBoard images_;
  NameTable names_;
  NetServices net_{NullLogger(), clock_};
  ConnectionRoster roster_;
  TokenGuard guard_{"secret", false};
  SmallWorld world_;
  FakeThread thread_;
  RobotServices services_{world_.board, world_.frames, world_.edits, images_, names_,
                          net_,         roster_,       guard_,       clock_,  "1.2.3"};
  std::vector<std::unique_ptr<RobotCore>> robots_;
  std::vector<std::unique_ptr<RobotModule>> modules_;
  ClientId last_client_ = 0;
};

}  // namespace coopdyn
