// SPDX-License-Identifier: MIT
// /swarm on the real boards, with steps that run as soon as all participants are ready; no sockets, no
// physics.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/control/swarm_module.h"
#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {

/// ant_1 to ant_`ants` (neighbours within 11 m), then loner with one distance sensor, 10 m apart in y.
inline std::shared_ptr<Scenario> AntScenario(int ants) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(ants + 1));
  auto ant = std::make_shared<RobotModel>(*SmallModel("ant"));
  SensorOf<CompassModel>(*ant);
  SensorOf<NeighboursModel>(*ant) = {.range_m = 11, .message_range_m = 11};
  auto loner = std::make_shared<RobotModel>(*SmallModel("loner"));
  SensorOf<DistanceModel>(*loner).sectors.resize(1);
  for (int i = 0; i < ants; ++i) {
    RobotEntry& entry = scenario->robots[static_cast<std::size_t>(i)];
    entry.name = "ant_" + std::to_string(i + 1);
    entry.model = ant;
  }
  scenario->robots.back().name = "loner";
  scenario->robots.back().model = loner;
  SwarmEntry swarm;
  swarm.name = "ant";
  swarm.section = "swarm1";
  swarm.count = static_cast<std::size_t>(ants);
  scenario->swarms.push_back(swarm);
  return scenario;
}

class SwarmModuleTest : public testing::Test {
 protected:
  SwarmModuleTest() {
    Load(AntScenario(3));
    Start(false);
  }
  ~SwarmModuleTest() override {
    client_.reset();
    module_.reset();
  }

  void Load(std::shared_ptr<const Scenario> scenario, StepEnd end = StepEnd::kLoad) {
    world_.Load(std::move(scenario), Mode::kLockstep, end);
  }
  void Start(bool token_required) {
    client_.reset();
    module_.reset();
    guard_.emplace("secret", token_required);
    module_.emplace(GlobalServices{world_.board, world_.frames, edits_, roster_, *guard_, clock_, "1.2.3"}, 1,
                    thread_.poster());
    client_.emplace(*module_, 1);
    world_.StepInline();
  }

  Message Ask(const std::string& line) { return client_->Ask(line); }
  void Name(const std::string& name) { EXPECT_EQ(Ask("hello " + name).error, 0); }
  std::vector<double> LastSetpoints(int robot) {
    const WheelSpeeds setpoint = SetpointOf(*world_.frames.Latest(), robot);
    return {setpoint[0], setpoint[1]};
  }
  SlotId slot(const std::string& robot) { return world_.board.FindSlot(robot); }

  SmallWorld world_;
  Doorbell bell_;
  EditQueue edits_{bell_};
  ManualClock clock_;
  ConnectionRoster roster_;
  std::optional<TokenGuard> guard_;
  FakeThread thread_;
  std::optional<SwarmModule> module_;
  std::optional<FakeClient> client_;
  const Client ana_{100, "ana", "127.0.0.1:100"};
  const StepDone nobody_ = [](const StepResult&) {};
};

}  // namespace coopdyn
