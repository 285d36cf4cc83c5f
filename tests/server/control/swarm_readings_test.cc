// SPDX-License-Identifier: MIT
// The readings of a team: select_readings, read_all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "server/devices/device.h"
#include "server/sensing/readings.h"
#include "tests/server/control/swarm_fixture.h"
#include "tests/server/model/sensor_of.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(SwarmModuleTest, DistancesArePaddedToTheRobotWithTheMost) {
  Ask("claim");
  EXPECT_THAT(Ask("select_readings distances").params, ElementsAre(3));
  const Message reply = Ask("read_all");
  EXPECT_THAT(reply.params, ElementsAre(1, 4, 3));
  EXPECT_TRUE(std::isinf(reply.data[0]));
  EXPECT_TRUE(std::isnan(reply.data[9 + 1]));  // loner has one sensor
  EXPECT_TRUE(std::isnan(reply.data[9 + 2]));
  const FramePtr frame = world_.frames.Latest();
  EXPECT_EQ(reply.data[9], Distances(*frame, 3)[0]);
}

TEST_F(SwarmModuleTest, ReadingsAreThoseOfTheRobotsOwnModulesInTheChosenOrder) {
  Ask("claim");
  Ask("step_all wheels 1 2 1 2 1 2 1 2");
  const Message chosen = Ask("select_readings wheels targets pose");
  EXPECT_EQ(chosen.text, "wheels targets pose");
  EXPECT_THAT(chosen.params, ElementsAre(4, 6, 3));
  const Message reply = Ask("read_all 2");
  EXPECT_THAT(reply.params, ElementsAre(1, 1, 13));
  const FramePtr frame = world_.frames.Latest();
  std::vector<double> expected;
  for (const char* type : {"motors", "target", "pose"}) {
    const auto device = MakeDevice(*frame->scene->robots[1].entry.model, type);
    device->AppendFirstReading(*frame, 1, expected);
  }
  expected.resize(13);  // of the pose x, y, heading
  EXPECT_EQ(std::vector<double>(reply.data.begin(), reply.data.end() - 2), expected);
}

TEST_F(SwarmModuleTest, TargetsThatAreNotSeenAreInfNan) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(1));
  auto blind = std::make_shared<RobotModel>(*scenario->robots[0].model);
  SensorOf<TargetModel>(*blind).max_range_m = 3.5;
  scenario->robots[0].model = blind;
  Load(scenario);
  Ask("select_readings targets");
  const Message reply = Ask("read_all 1");
  EXPECT_NEAR(reply.data[0], 3, 1e-12);
  EXPECT_NEAR(reply.data[1], 0, 1e-12);
  EXPECT_TRUE(std::isinf(reply.data[2]));
  EXPECT_TRUE(std::isnan(reply.data[3]));
}

TEST_F(SwarmModuleTest, ASensorsModuleIsNamedByItsName) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(2));
  auto model = std::make_shared<RobotModel>(*scenario->robots[1].model);
  model->AddSensor("left_imu", ImuModel());
  model->AddSensor("bumper", ContactModel());
  scenario->robots[1].model = model;
  Load(scenario);
  const Message chosen = Ask("select_readings bumper left_imu compass");
  EXPECT_EQ(chosen.text, "bumper left_imu compass");
  EXPECT_THAT(chosen.params, ElementsAre(1, 10, 1));
  const Message reply = Ask("read_all 1 2");
  EXPECT_TRUE(std::isnan(reply.data[0]));  // ant_1 has none
  EXPECT_TRUE(std::isnan(reply.data[10]));
  EXPECT_EQ(reply.data[12], 0);
  EXPECT_NEAR(reply.data[12 + 10], 9.81, 1e-9);
}

TEST_F(SwarmModuleTest, AModuleThatNoRobotHasIsToldWithTheNearest) {
  auto scenario = std::make_shared<Scenario>(*AntScenario(1));
  auto model = std::make_shared<RobotModel>(*scenario->robots[0].model);
  model->AddSensor("left_imu", ImuModel());
  scenario->robots[0].model = model;
  Load(scenario);
  const Message refused = Ask("select_readings left_inu");
  EXPECT_NE(refused.error, 0);
  EXPECT_THAT(refused.text, HasSubstr("did you mean 'left_imu'"));
}

TEST_F(SwarmModuleTest, NeighboursComeNearestFirstTiesByIdAndArePadded) {
  EXPECT_THAT(Ask("select_readings (3) neighbours").params, ElementsAre(9));
  const Message reply = Ask("read_all 2");
  ASSERT_EQ(reply.data.size(), 11u);
  EXPECT_EQ(reply.data[0], 1);  // ant_1 and ant_3 are 10 m away
  EXPECT_NEAR(reply.data[1], 10, 1e-12);
  EXPECT_NEAR(reply.data[2], -M_PI / 2, 1e-12);
  EXPECT_EQ(reply.data[3], 3);
  EXPECT_EQ(reply.data[6], 0);
  EXPECT_TRUE(std::isinf(reply.data[7]));
  EXPECT_TRUE(std::isnan(reply.data[8]));
  Ask("select_readings (1) neighbours");
  EXPECT_EQ(Ask("read_all 2").data[0], 1);
  EXPECT_THAT(Ask("select_readings neighbours").params, ElementsAre(24));
}

TEST_F(SwarmModuleTest, CompassIsNanForARobotWithoutOne) {
  EXPECT_THAT(Ask("select_readings compass pose").params, ElementsAre(1, 3));
  const Message reply = Ask("read_all 1 4");
  EXPECT_EQ(reply.data[0], reply.data[3]);
  EXPECT_TRUE(std::isnan(reply.data[4]));
}

TEST_F(SwarmModuleTest, SelectReadingsRefusesUnknownWordsAndTooManyNeighbours) {
  const Message refusal = Ask("select_readings pose distancess");
  EXPECT_EQ(refusal.error, 2);
  EXPECT_THAT(refusal.text, HasSubstr("did you mean 'distances'?"));
  EXPECT_EQ(Ask("select_readings pose pose").error, 2);
  EXPECT_EQ(Ask("select_readings (2000000000) neighbours").error, 4);
  EXPECT_THAT(Ask("select_readings").params, ElementsAre(3, 0));
  EXPECT_EQ(client_->received.back().text, "pose distances");
}

TEST_F(SwarmModuleTest, ReadAllReadsAnyRobotAndClaimsNone) {
  world_.board.Claim(slot("ant_1"), ana_);
  const Message reply = Ask("read_all 4 1");
  EXPECT_THAT(reply.params, ElementsAre(1, 2, 6));
  EXPECT_NEAR(reply.data[1], 30, 1e-12);
  EXPECT_THAT(Ask("get_team").params, IsEmpty());
  EXPECT_EQ(Ask("read_all").error, 5);
  EXPECT_EQ(Ask("read_all 1 1").error, 2);
}

TEST_F(SwarmModuleTest, AReplyThatWouldBeTooLargeIsRefusedBeforeAnythingHappens) {
  Load(AntScenario(400));
  Ask("claim ant");
  EXPECT_EQ(Ask("select_readings (10000) neighbours").error, 0);
  EXPECT_EQ(Ask("read_all").error, 8);
  EXPECT_EQ(Ask("step_all").error, 8);
  EXPECT_EQ(Ask("read_all 1 2 3").error, 0);
}

}  // namespace
}  // namespace coopdyn
