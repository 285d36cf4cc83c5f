// SPDX-License-Identifier: MIT
// Loaded controllers that exchange the values of their robot's channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/channel_model.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A disc whose wheels are motors from -1 to 1, and whose values are the wheels' speeds from 0 to 1. An
/// exchange lasts two steps.
std::shared_ptr<RobotModel> ChannelDisc() {
  auto model = DiscModel();
  ChannelModel channel;
  channel.steps = 2;
  const ValueMap motor{-10, 10, -1, 1}, value{-10, 10, 0, 1};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string joint = model->joints[i].name;
    channel.motors.push_back({.name = joint,
                              .joint = joint,
                              .mode = ControlMode::kVelocity,
                              .map = motor,
                              .noise = {},
                              .channel = i});
    channel.values.push_back({.name = "speed",
                              .quantity = ChannelModel::Quantity::kVelocity,
                              .of = joint,
                              .auxiliary = i == 1,
                              .mount = {},
                              .map = value,
                              .noise = {},
                              .filter = {},
                              .source = i});
  }
  model->AddSensor("channel", channel);
  return model;
}

class ControllerMappedTest : public testing::TestWithParam<bool> {
 protected:
  static Swarm OneRobot(std::vector<std::pair<std::string, double>> options) {
    Swarm swarm(ChannelDisc());
    swarm.Add(TestPlugin("mapped"), std::move(options));
    return swarm;
  }
  static std::vector<double> Said(const SentMessage& sent) {
    return {sent.message.values.begin(), sent.message.values.begin() + sent.message.count};
  }
  static double LeftWheel(const Record& run, std::size_t step) { return run.setpoints[step][0][0]; }
};

TEST_P(ControllerMappedTest, ItGetsTheChannelAndItsValuesOnceInAnExchange) {
  Driven driven(OneRobot({{"gain", 0.25}}), TestOptions(GetParam()));
  driven.Start();
  const Record& run = driven.Steps(4);
  ASSERT_THAT(run.stopped, IsEmpty());
  ASSERT_THAT(run.messages, SizeIs(2));
  const double exchange_s = 2 * ToSeconds(kDefaultStep);
  EXPECT_THAT(Said(run.messages[0]), ElementsAre(2, 2, 10, 1, exchange_s, 0.5, 0.5, 0.25));
  // The wheels turn at 2.5 of 10 rad/s.
  EXPECT_THAT(Said(run.messages[1]), ElementsAre(2, 2, 10, 1, exchange_s, 0.625, 0.625, 0.25));
}

TEST_P(ControllerMappedTest, ItsMotorsStayUntilTheNextExchangeAndAreCut) {
  Driven driven(OneRobot({{"gain", 0.4}}), TestOptions(GetParam()));
  driven.Start();
  const Record& run = driven.Steps(6);
  std::vector<double> left;
  for (std::size_t i = 0; i < run.setpoints.size(); ++i) left.push_back(LeftWheel(run, i));
  EXPECT_THAT(left, ElementsAre(4, 4, 8, 8, 10, 10));
}

TEST_P(ControllerMappedTest, WhatIsSavedWithinAnExchangeGoesOnAlike) {
  Driven driven(OneRobot({{"gain", 0.1}}), TestOptions(GetParam()));
  driven.Start();
  driven.Steps(3);
  const FramePtr frame = driven.frame();
  const std::vector<std::byte> saved = driven.host().Save();
  driven.Steps(2);
  Driven other(OneRobot({{"gain", 0.1}}), TestOptions(GetParam()));
  ASSERT_TRUE(other.Restore(frame, saved));
  const Record& run = other.Steps(2);
  EXPECT_DOUBLE_EQ(LeftWheel(run, 0), 2);
  EXPECT_DOUBLE_EQ(LeftWheel(run, 1), 3);
  EXPECT_EQ(run.setpoints[1], driven.run().setpoints[4]);
}

TEST_P(ControllerMappedTest, NanStopsIt) {
  Driven driven(OneRobot({{"nan", 2}, {"gain", 0.1}}), TestOptions(GetParam()));
  driven.Start();
  const Record& run = driven.Steps(4);
  ASSERT_THAT(run.stopped, SizeIs(1));
  EXPECT_THAT(run.stopped[0].why, HasSubstr("returned motors[1] = nan: it must be a finite number"));
  EXPECT_EQ(LeftWheel(run, 3), 0);
}

TEST_P(ControllerMappedTest, ItMayEndTheRun) {
  Driven driven(OneRobot({{"end", 2}}), TestOptions(GetParam()));
  driven.Start();
  const Record& run = driven.Steps(4);
  EXPECT_FALSE(run.supervision[1].end);
  EXPECT_EQ(run.supervision[2].end, "controller mapped of robot1 ends the run");
  EXPECT_FALSE(run.supervision[3].end);
}

TEST_P(ControllerMappedTest, ARobotWithoutAChannelIsSaidToHaveNone) {
  Swarm swarm;
  swarm.Add(TestPlugin("mapped"));
  SteadyClock clock;
  WorkerPool pool(1);
  ControllerHost host(TestOptions(GetParam()), clock, NullLogger(), pool);
  Diagnostics diagnostics;
  host.Check(swarm.scenario(), diagnostics);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("a disc has no channel"));
}

INSTANTIATE_TEST_SUITE_P(Both, ControllerMappedTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "in_process" : "in_a_child"; });

}  // namespace
}  // namespace coopdyn
