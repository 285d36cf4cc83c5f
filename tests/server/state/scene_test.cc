// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "server/state/scene.h"

namespace coopdyn {
namespace {

RobotEntry Robot(const std::string& name, std::size_t links) {
  auto model = std::make_shared<RobotModel>();
  model->links.resize(links);
  RobotEntry entry;
  entry.name = name;
  entry.model = model;
  return entry;
}

std::shared_ptr<const Scenario> TestScenario() {
  auto scenario = std::make_shared<Scenario>();
  scenario->floor.friction = 0.7;
  scenario->objects = {{"WALL_1", Box{Vector3(1, 1, 1)}, {}, 0, {}, 1, {}},
                       {"BALL_1", Sphere{0.1}, {}, 2, {}, 1, {}},
                       {"WALL_2", Box{Vector3(1, 1, 1)}, {}, 0, {}, 1, {}},
                       {"BALL_2", Sphere{0.1}, {}, 2, {}, 1, {}}};
  scenario->targets.resize(2);
  scenario->robots = {Robot("ana", 3), Robot("bob", 4)};
  return scenario;
}

TEST(Scene, BodiesAreDynamicObjectsInFileOrderThenTheRobotsLinks) {
  const auto scene = MakeScene(TestScenario());
  EXPECT_EQ(scene->floor.friction, 0.7);
  ASSERT_EQ(scene->objects.size(), 4u);
  EXPECT_EQ(scene->objects[0].body, -1);
  EXPECT_EQ(scene->objects[1].body, 0);
  EXPECT_EQ(scene->objects[2].body, -1);
  EXPECT_EQ(scene->objects[3].body, 1);
  EXPECT_EQ(scene->robots[0].first_body, 2);
  EXPECT_EQ(scene->robots[0].body_count, 3);
  EXPECT_EQ(scene->robots[1].first_body, 5);
  EXPECT_EQ(scene->robots[1].body_count, 4);
  EXPECT_EQ(scene->body_ids.size(), 9u);
}

TEST(Scene, IdsStartAtOneInFileOrder) {
  const auto scene = MakeScene(TestScenario());
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(scene->objects[i].id.value, i + 1);
  for (std::uint32_t i = 0; i < 2; ++i) EXPECT_EQ(scene->targets[i].id.value, i + 1);
  for (std::uint32_t i = 0; i < 2; ++i) EXPECT_EQ(scene->robots[i].id.value, i + 1);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(scene->body_ids[i].value, i + 1);
  EXPECT_EQ(scene->robots[1].entry.id, scene->robots[1].id);
}

/// A robot with an arm of three joints, a drive that no module commands, and a robot without either.
std::shared_ptr<const Scenario> ActuatorScenario() {
  auto scenario = std::make_shared<Scenario>();
  scenario->robots = {Robot("ana", 1), Robot("bob", 1), Robot("eve", 1)};
  auto model = std::make_shared<RobotModel>(*scenario->robots[1].model);
  model->actuators = {{"arm", {4, 3, 2}, {}}, {"", {0, 1}, DriveModel{}}};
  scenario->robots[1].model = scenario->robots[2].model = model;
  return scenario;
}

TEST(Scene, ChannelsAreTheJointsOfEachActuatorRobotByRobot) {
  const auto scene = MakeScene(ActuatorScenario());
  ASSERT_EQ(scene->channels.size(), 10u);
  EXPECT_EQ(scene->robots[0].channel_count, 0);
  EXPECT_EQ(scene->robots[2].first_channel, 5);
  EXPECT_EQ(scene->robots[2].channel_count, 5);
  const std::vector<int> joints = {4, 3, 2, 0, 1};
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(scene->channels[i].robot, i < 5 ? 1 : 2);
    EXPECT_EQ(scene->channels[i].joint, joints[i % 5]);
  }
}

TEST(Scene, ARobotWithoutActuatorsHasOneWithoutChannels) {
  const auto scene = MakeScene(ActuatorScenario());
  ASSERT_EQ(scene->actuators.size(), 5u);
  EXPECT_EQ(scene->robots[0].actuator_count, 1);
  EXPECT_EQ(scene->actuators[0].channel_count, 0);
  EXPECT_EQ(scene->FindDrive(0), -1);
}

TEST(Scene, FindsActuatorsByTheirModule) {
  const auto scene = MakeScene(ActuatorScenario());
  EXPECT_EQ(scene->FindActuator(2, "arm"), 3);
  EXPECT_EQ(scene->actuators[3].first_channel, 5);
  EXPECT_EQ(scene->FindActuator(2, "motors"), -1);
  EXPECT_EQ(scene->FindActuator(2, ""), -1);
}

TEST(Scene, FindsRobotsByName) {
  const auto scene = MakeScene(TestScenario());
  EXPECT_EQ(scene->FindRobot("ana"), 0);
  EXPECT_EQ(scene->FindRobot("bob"), 1);
  EXPECT_EQ(scene->FindRobot("bo"), -1);
}

}  // namespace
}  // namespace coopdyn
