// SPDX-License-Identifier: MIT
// A world after an insertion or removal continues bit for bit like one that was built with the new scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "tests/server/physics/simulation_scene.h"

namespace coopdyn {
namespace {

constexpr int kStepsAfter = 120;

/// Indices in a frame that a copy of the scene omits.
struct Left {
  std::size_t object = ~std::size_t{0};
  std::size_t robot = ~std::size_t{0};
};

/// `frame` without one of its things, in a scene without it.
std::shared_ptr<Frame> Without(const Frame& frame, const Left& left) {
  const Scene& before = *frame.scene;
  auto scene = std::make_shared<Scene>();
  scene->scenario = before.scenario;
  scene->floor = before.floor;
  auto now = std::make_shared<Frame>();
  now->step = frame.step;
  now->time = frame.time;
  now->step_length = frame.step_length;
  now->seed = frame.seed;
  now->solver_seed = frame.solver_seed;
  const auto keep = [&](int first, int count) {
    const int place = static_cast<int>(now->bodies.size());
    for (int i = first; i < first + count; ++i) {
      now->bodies.push_back(frame.bodies[static_cast<std::size_t>(i)]);
      scene->body_ids.push_back(before.body_ids[static_cast<std::size_t>(i)]);
    }
    return place;
  };
  for (std::size_t i = 0; i < before.objects.size(); ++i) {
    if (i == left.object) continue;
    SceneObject object = before.objects[i];
    if (object.body >= 0) object.body = keep(object.body, 1);
    scene->objects.push_back(std::move(object));
  }
  for (std::size_t i = 0; i < before.robots.size(); ++i) {
    if (i == left.robot) continue;
    SceneRobot robot = before.robots[i];
    robot.first_body = keep(robot.first_body, robot.body_count);
    for (const ChannelState& channel : ChannelsOf(frame, static_cast<int>(i)))
      now->channels.push_back(channel);
    AddRobot(*scene, std::move(robot));
  }
  now->commanded.resize(scene->actuators.size());
  now->scene = std::move(scene);
  return now;
}

SavedState StateOf(std::shared_ptr<const Frame> frame) {
  SavedState state;
  state.frame = std::move(frame);
  return state;
}

/// The steps of a world that was built for the scene of `frame`.
std::vector<std::uint64_t> Fresh(const std::shared_ptr<const Frame>& frame, StepHelpers helpers) {
  SteppedSimulation fresh(frame->scene, 1, helpers);
  EXPECT_EQ(fresh->Restore(StateOf(frame), 1), "");
  return WholeHashes(fresh, kStepsAfter);
}

struct RebuildCase {
  Left left;
  int threads = 1;
};
std::ostream& operator<<(std::ostream& out, const RebuildCase& what) {
  return out << "object " << static_cast<int>(what.left.object) << " robot "
             << static_cast<int>(what.left.robot) << " threads " << what.threads;
}

class RebuildTest : public testing::TestWithParam<RebuildCase> {
 protected:
  WorkerPool pool_{GetParam().threads};
  const std::shared_ptr<const Scene> scene_ =
      SimulationScene({Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar});
  SteppedSimulation simulation_{scene_, 1, {&pool_, nullptr}};
};

TEST_P(RebuildTest, AWorldWithOneThingLessGoesOnAsOneThatWasBuiltSo) {
  simulation_.Steps(60);
  const auto less = Without(*simulation_->frame(), GetParam().left);
  EXPECT_EQ(simulation_->Restore(StateOf(less), 1), "");
  EXPECT_EQ(WholeHashes(simulation_, kStepsAfter), Fresh(less, {&pool_, nullptr}));
}

TEST_P(RebuildTest, AndWithThatThingAgain) {
  simulation_.Steps(60);
  const SavedState whole = simulation_->Save();
  EXPECT_EQ(simulation_->Restore(StateOf(Without(*whole.frame, GetParam().left)), 1), "");
  simulation_.Steps(10);
  EXPECT_EQ(simulation_->Restore(whole, 1), "");
  EXPECT_EQ(WholeHashes(simulation_, kStepsAfter), Fresh(whole.frame, {&pool_, nullptr}));
}

TEST_P(RebuildTest, AResetBringsTheScenarioBack) {
  const auto expected = WholeHashes(simulation_, kStepsAfter);
  const auto less = Without(*simulation_->frame(), GetParam().left);
  EXPECT_EQ(simulation_->Restore(StateOf(less), 1), "");
  simulation_.Steps(10);
  simulation_->Restart(1, 2);
  EXPECT_EQ(simulation_->frame()->scene, scene_);
  EXPECT_EQ(WholeHashes(simulation_, kStepsAfter), expected);
}

constexpr std::size_t kNone = ~std::size_t{0};
INSTANTIATE_TEST_SUITE_P(Things, RebuildTest,
                         testing::Values(RebuildCase{{0, kNone}}, RebuildCase{{1, kNone}},
                                         RebuildCase{{3, kNone}, 2}, RebuildCase{{kNone, 0}},
                                         RebuildCase{{kNone, 7}, 2}, RebuildCase{{kNone, 22}}));

TEST(RebuildOnceTest, TheLastRobotOfItsKindTakesItsBodiesAlong) {
  // Only robot 0 has several bodies.
  const auto scene =
      SimulationScene({Fidelity::kFull, Fidelity::kRolling, Fidelity::kRolling, Fidelity::kPlanar}, 4);
  SteppedSimulation simulation(scene);
  simulation.Steps(20);
  const SavedState whole = simulation->Save();
  const auto less = Without(*whole.frame, {kNone, 0});
  EXPECT_EQ(simulation->Restore(StateOf(less), 1), "");
  EXPECT_EQ(WholeHashes(simulation, kStepsAfter), Fresh(less, {}));
  EXPECT_EQ(simulation->Restore(whole, 1), "");
  EXPECT_EQ(WholeHashes(simulation, kStepsAfter), Fresh(whole.frame, {}));
}

TEST(RebuildOnceTest, WhatStandsFarFromTheChangeDoesNotNotice) {
  const auto scene = SimulationScene({Fidelity::kRolling}, 2);
  SteppedSimulation one(scene), other(scene);
  one.Steps(30);
  other.Steps(30);
  EXPECT_EQ(other->Restore(StateOf(Without(*other->frame(), {2, kNone})), 1), "");
  one.Steps(100);
  other.Steps(100);
  for (int robot = 0; robot < 5; ++robot) {
    EXPECT_EQ(RobotPose(*one->frame(), robot).p, RobotPose(*other->frame(), robot).p);
  }
}

}  // namespace
}  // namespace coopdyn
