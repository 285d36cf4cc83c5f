// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "server/sensing/readings.h"
#include "tests/server/controllers/plugins/deeds.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string CheckOf(const Swarm& swarm) {
  Driven driven(swarm);
  Diagnostics diagnostics;
  driven.host().Check(swarm.scenario(), diagnostics);
  return diagnostics.ToString();
}

TEST(ControllerCheckTest, KnownOptionsInTheirRangeAreFine) {
  EXPECT_EQ(CheckOf(Swarm().Add(Sample("diffuse"), {{"speed", 0.2}, {"near", 0.3}}).Add("")), "");
}

TEST(ControllerCheckTest, AnUnknownOptionIsAnErrorAtItsLineWithTheOneMeant) {
  EXPECT_EQ(CheckOf(Swarm().Add("").Add(Sample("diffuse"), {{"sped", 0.2}})),
            "test.scenario:11: error: controller diffuse has no option 'sped'; did you mean 'speed'?\n");
}

TEST(ControllerCheckTest, AnOptionOutOfRangeIsAnErrorThatSaysTheRange) {
  EXPECT_EQ(CheckOf(Swarm().Add(Sample("diffuse"), {{"speed", -1}})),
            "test.scenario:10: error: controller diffuse: speed must be from 0 to 10, not -1; for example: "
            "controller diffuse speed=0.05 (of the walk, m/s)\n");
}

TEST(ControllerCheckTest, ABrokenControllerIsAWarning) {
  const std::string text = CheckOf(Swarm().Add(TestPlugin("wrong_version")));
  EXPECT_THAT(text, HasSubstr("test.scenario:10: warning: controller wrong_version cannot be used: "));
}

TEST(ControllerCheckTest, ConfigureUsesTheProcessOfTheCheck) {
  Swarm swarm;
  swarm.Add(Sample("diffuse"));
  Driven driven(swarm);
  Diagnostics diagnostics;
  driven.host().Check(swarm.scenario(), diagnostics);
  driven.Start();
  EXPECT_TRUE(driven.run().stopped.empty());
  EXPECT_NE(driven.Steps(1).setpoints[0][0], WheelSpeeds{});
}

TEST(ControllerCheckTest, ACheckOfAnotherScenarioLeavesTheRunAlone) {
  Swarm swarm;
  for (int i = 0; i < 10; ++i) swarm.Add(Sample("diffuse"));
  for (const bool in_process : {false, true}) {
    Driven expected(swarm, TestOptions(in_process)), driven(swarm, TestOptions(in_process));
    expected.Start();
    driven.Start();
    driven.Steps(10);
    Swarm other;
    other.Add(Sample("flock"));
    Diagnostics diagnostics;
    driven.host().Check(other.scenario(), diagnostics);
    EXPECT_TRUE(driven.Steps(10).setpoints == expected.Steps(20).setpoints) << in_process;
  }
}

TEST(ControllerHostTest, WithoutControllersThereIsNoProcess) {
  Driven driven(Swarm().Add("").Add(""));
  driven.Start();
  driven.Steps(2);
  EXPECT_EQ(driven.host().child_pid(), -1);
  EXPECT_EQ(driven.host().child_cpu_s(), 0);
}

TEST(ControllerHostTest, AnUnloadedRobotIsLeftAlone) {
  Driven driven(Swarm().Add(Sample("diffuse")).Add(Sample("diffuse")));
  driven.Start();
  driven.Steps(1);
  driven.host().Unload(0);
  driven.Steps(1);
  EXPECT_NE(driven.run().setpoints[0][0], (WheelSpeeds{0.25, 0.5}));
  EXPECT_EQ(driven.run().setpoints[1][0], (WheelSpeeds{0.25, 0.5}));
  EXPECT_NE(driven.run().setpoints[1][1], (WheelSpeeds{0.25, 0.5}));
}

TEST(ControllerHostTest, TheSlowestControllerIsNamedWithItsTime) {
  for (const bool in_process : {false, true}) {
    Driven driven(Swarm().Add(Sample("flock")).Add(Sample("flock")), TestOptions(in_process));
    driven.Start();
    EXPECT_EQ(driven.host().slowest().controller, "");
    driven.Steps(100);  // not every step is timed
    EXPECT_EQ(driven.host().slowest().controller, "flock");
    EXPECT_GT(driven.host().slowest().per_step, 0);
  }
}

TEST(ControllerHostTest, TimesAddUp) {
  Driven driven(Swarm().Add(Sample("diffuse")));
  driven.Start();
  driven.Steps(5);
  EXPECT_GT(driven.host().times().sense, 0);
  EXPECT_GT(driven.host().times().control, 0);
  EXPECT_EQ(driven.host().times().physics, 0);
}

/// The numbers that the controller `mirror` shows for option `what`, in the second robot's last of two steps.
std::vector<double> Shown(int what, bool in_process = false) {
  Swarm swarm;
  swarm.Mark(1.1, 0.7).Add(Sample("flock")).Add(TestPlugin("mirror"), {{"what", what}}).Add(Sample("flock"));
  Driven driven(swarm, TestOptions(in_process));
  driven.Start(9);
  driven.Steps(2);
  for (const SentMessage& sent : driven.run().messages) {
    if (sent.robot != 1 || sent.step != 2) continue;
    return {sent.message.values.begin(), sent.message.values.begin() + sent.message.count};
  }
  return {};
}

/// The frame at that step.
FramePtr ShownFrame() {
  Swarm swarm;
  swarm.Mark(1.1, 0.7).Add(Sample("flock")).Add(TestPlugin("mirror")).Add(Sample("flock"));
  Driven driven(swarm, TestOptions(true));
  driven.Start(9);
  driven.Steps(1);
  return driven.frame();
}

TEST(ControllerReadingsTest, PoseOfTheRobot) {
  const FramePtr frame = ShownFrame();
  const Pose X_WR = RobotPose(*frame, 1);
  EXPECT_THAT(Shown(0), ElementsAre(X_WR.p.x(), X_WR.p.y(), Heading(X_WR.q), 0, 0));
}

TEST(ControllerReadingsTest, Distances) {
  const FramePtr frame = ShownFrame();
  std::vector<double> expected;
  for (const double distance : Distances(*frame, 1)) expected.push_back(std::min(distance, 99.0));
  EXPECT_EQ(Shown(1), expected);
  EXPECT_LT(*std::min_element(expected.begin(), expected.end()), 1) << "a neighbour is in range";
}

TEST(ControllerReadingsTest, Targets) {
  const std::vector<Sighting> seen = SeenTargets(*ShownFrame(), 1);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_THAT(Shown(2), ElementsAre(1, 1, seen[0].distance_m, seen[0].bearing_rad, 1, 0));
}

TEST(ControllerReadingsTest, NeighboursById) {
  const std::vector<Sighting> seen = Neighbours(*ShownFrame(), 1);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_THAT(Shown(3), ElementsAre(2, 1, seen[0].distance_m, seen[0].bearing_rad, 3, seen[1].distance_m,
                                    seen[1].bearing_rad));
}

TEST(ControllerReadingsTest, MessagesOfTheStepBefore) {
  const FramePtr frame = ShownFrame();
  const std::vector<HeardMessage> heard = HeardMessages(*frame, 1);
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_THAT(Shown(4), ElementsAre(2, 1, heard[0].from.distance_m, 1, heard[0].message->values[0]));
}

TEST(ControllerReadingsTest, TheRobot) {
  EXPECT_THAT(Shown(5),
              ElementsAre(2, 6, 0.085, 0.03, 0.14, 10, DiscModel()->sectors()[1].bearing_rad + 0.7, 0.5));
}

TEST(ControllerReadingsTest, TimeAndSeed) {
  EXPECT_THAT(Shown(6), ElementsAre(9, 1, 0.01, 0.01));
}

TEST(ControllerReadingsTest, Compass) {
  EXPECT_THAT(Shown(7), ElementsAre(Heading(RobotPose(*ShownFrame(), 1).q)));
}

TEST(ControllerReadingsTest, Channels) {
  const FramePtr frame = ShownFrame();
  const auto channels = ChannelsOf(*frame, 1);
  ASSERT_EQ(channels.size(), 2u);
  ASSERT_GT(channels[1].velocity, channels[0].velocity);
  ASSERT_TRUE(std::isnan(channels[0].effort));
  EXPECT_THAT(Shown(8), ElementsAre(2, channels[0].position, channels[0].velocity, -1, channels[1].position,
                                    channels[1].velocity, -1));
}

TEST(ControllerReadingsTest, WhatTheChannelsAre) {
  EXPECT_THAT(Shown(9), ElementsAre(2, 1, 1, 10, 1, 1, 10, 1 << COOPDYN_OFF | 1 << COOPDYN_VELOCITY));
}

TEST(ControllerReadingsTest, TheSameInProcess) {
  for (int what = 0; what <= 10; ++what) EXPECT_EQ(Shown(what), Shown(what, true)) << what;
}

Record RunOf(const Swarm& swarm, bool in_process = true, int steps = 20) {
  Driven driven(swarm, TestOptions(in_process));
  driven.Start();
  return driven.Steps(steps);
}

Record RunSetpoints(SetpointDeed deed) {
  return RunOf(Swarm().Add(TestPlugin("setpoints"), {{"deed", deed}}));
}

TEST(ControllerSetpointsTest, ReachTheWheelsAsForwardAndTurnDo) {
  const Record by_forward = RunOf(Swarm().Add(TestPlugin("mirror"))), by_setpoints = RunSetpoints(kByForward);
  EXPECT_NE(by_setpoints.setpoints.back()[0], WheelSpeeds{});
  EXPECT_TRUE(by_setpoints.setpoints == by_forward.setpoints);
}

TEST(ControllerSetpointsTest, BeyondTheLimitBothWheelsAreScaledAlike) {
  const WheelSpeeds wheels = RunSetpoints(kTooFast).setpoints.back()[0];
  double factor = 1;
  EXPECT_EQ(wheels, WheelsFor(*DiscModel()->drive(), 3, 0.3, factor));
  EXPECT_EQ(wheels[1], 10);
}

TEST(ControllerSetpointsTest, AChannelThatIsOffIsAtRest) {
  const Record record = RunSetpoints(kOnlyOne);
  EXPECT_EQ(record.setpoints.back()[0], (WheelSpeeds{0, 1}));
  EXPECT_TRUE(record.stopped.empty());
}

TEST(ControllerSetpointsTest, WhatCannotBeCarriedOutStopsTheRobot) {
  const std::pair<SetpointDeed, const char*> cases[] = {
      {kNoSuchMode, "mode 9 for motors/right"},
      {kModeNotTaken, "mode effort for motors/right, which takes: off, velocity"},
      {kReferenceNotANumber, "reference = nan for motors/left"},
      {kOtherPointer, "changed a pointer of its command"},
      {kWritePastSetpoints, "segmentation fault"}};
  for (const auto& [deed, why] : cases) {
    for (const bool in_process : {false, true}) {
      if (in_process && deed == kWritePastSetpoints) continue;
      Swarm swarm;
      swarm.Add(TestPlugin("setpoints"), {{"deed", deed}}).Add(TestPlugin("setpoints"));
      const Record record = RunOf(swarm, in_process);
      ASSERT_EQ(record.stopped.size(), 1u) << why;
      EXPECT_EQ(record.stopped[0].robot, "robot1");
      EXPECT_THAT(record.stopped[0].why, HasSubstr(why));
      EXPECT_EQ(record.setpoints.back()[0], WheelSpeeds{});
      EXPECT_NE(record.setpoints.back()[1], WheelSpeeds{});
    }
  }
}

/// A disc with four wheels. The first two form a drive unless `module` is empty.
std::shared_ptr<RobotModel> FourWheels(const std::string& module) {
  auto model = DiscModel();
  model->joints = {{.name = "a"}, {.name = "b"}, {.name = "c"}, {.name = "d"}};
  model->actuators.front().module = module;
  model->actuators.push_back({"rear", {2, 3}, model->actuators.front().kind});
  return model;
}

TEST(ControllerSetpointsTest, CommandChannelsOfAllModules) {
  for (const char* module : {"", "motors"}) {
    const bool at_rest = *module == '\0';
    Swarm swarm(FourWheels(module));
    swarm.Add(TestPlugin("setpoints"), {{"deed", kOnlyOne}}).Add(TestPlugin("setpoints"));
    Driven driven(swarm);
    driven.Start();
    driven.Step();
    const std::vector<WheelSpeeds>& wheels = driven.run().setpoints.back();  // of robot 1, then of robot 2
    ASSERT_EQ(wheels.size(), 4u);
    EXPECT_EQ(wheels[0], (WheelSpeeds{0, at_rest ? 0.0 : 1.0}));
    EXPECT_EQ(wheels[1], WheelSpeeds{});
    EXPECT_EQ(wheels[3] == WheelSpeeds{}, at_rest);
    EXPECT_EQ(driven.run().stopped.size(), at_rest ? 2u : 0u) << "a joint without a module takes no command";
  }
}

TEST(ControllerSetpointsTest, ForwardAndTurnNeedADrive) {
  Swarm swarm(FourWheels(""));
  swarm.Add(Sample("diffuse"));
  const Record record = RunOf(swarm);
  ASSERT_EQ(record.stopped.size(), 1u);
  EXPECT_THAT(record.stopped[0].why, HasSubstr("a disc has no two-wheel drive"));
  EXPECT_THAT(CheckOf(swarm), HasSubstr("test.scenario:10: error: controller diffuse "));
}

TEST(ControllerSetpointsTest, ARobotWithoutChannelsCannotBeDriven) {
  const auto model = DiscModel();
  model->actuators.clear();
  Swarm swarm(model);
  swarm.Add(TestPlugin("setpoints")).Add(Sample("diffuse"));
  Driven driven(swarm);
  driven.Start();
  ASSERT_EQ(driven.run().stopped.size(), 2u);
  for (const StoppedController& stopped : driven.run().stopped)
    EXPECT_THAT(stopped.why, HasSubstr("no channels"));
}

Swarm SwarmToSave() {
  Swarm swarm;
  for (int i = 0; i < 12; ++i) swarm.Add(Sample(i % 2 == 0 ? "diffuse" : "attractor"));
  swarm.Add(TestPlugin("setpoints"));
  return swarm.Mark(3, 1).Add(TestPlugin("hostile"), {{"deed", kNotANumber}}).Add("");
}

TEST(ControllerStateTest, ARestoredRunGoesOnAsIfNothingHadHappened) {
  for (const bool in_process : {false, true}) {
    Driven first(SwarmToSave(), TestOptions(in_process));
    first.Start();
    first.Steps(20);
    const FramePtr frame = first.frame();
    const std::vector<std::byte> saved = first.host().Save();
    first.Steps(30);

    Driven second(SwarmToSave(), TestOptions(!in_process));
    ASSERT_TRUE(second.Restore(frame, saved));
    second.Steps(30);
    for (std::size_t i = 0; i < 30; ++i) {
      EXPECT_EQ(second.run().setpoints[i], first.run().setpoints[20 + i]) << "step " << i;
    }
    // The controller was stopped before, which a restored host must know.
    ASSERT_EQ(second.run().stopped.size(), 1u);
    EXPECT_EQ(second.run().stopped[0].robot, "robot14");
    EXPECT_EQ(second.run().stopped[0].why, first.run().stopped.at(0).why);
    EXPECT_EQ(second.host().Save(), first.host().Save());
  }
}

TEST(ControllerStateTest, WhatBelongsToAnotherSceneIsRefused) {
  Driven one(SwarmToSave(), TestOptions(true));
  one.Start();
  const std::vector<std::byte> saved = one.host().Save();
  Driven other(Swarm().Add(Sample("diffuse")), TestOptions(true));
  other.Start();
  EXPECT_FALSE(other.Restore(other.frame(), saved));
  for (std::size_t size = 0; size < saved.size(); size += 7) {
    EXPECT_FALSE(one.Restore(one.frame(), std::span(saved).first(size)));
  }
  EXPECT_NE(other.Steps(1).setpoints[0][0], WheelSpeeds{});
}

}  // namespace
}  // namespace coopdyn
