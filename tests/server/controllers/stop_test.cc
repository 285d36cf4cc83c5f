// SPDX-License-Identifier: MIT
// Robots whose controller is removed or stopped from outside, as when a run is repeated, and the effect on a
// saved state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr WheelSpeeds kStands{0, 0};
constexpr WheelSpeeds kByOthers{0.25, 0.5};  // what Driven::Step() offers

/// robot1 and robot3 have a controller, robot2 and robot4 have none.
Swarm Mixed() {
  Swarm swarm;
  swarm.Add(Sample("diffuse")).Add("").Add(Sample("flock")).Add("");
  return swarm;
}

class StopTest : public testing::TestWithParam<bool> {
 protected:
  StopTest() : driven_(Mixed(), TestOptions(GetParam())), untouched_(Mixed(), TestOptions(GetParam())) {
    driven_.Start();
    untouched_.Start();
    driven_.Steps(5);
    untouched_.Steps(5);
  }
  ControllerHost& host() { return driven_.host(); }
  const std::vector<WheelSpeeds>& last() const { return driven_.run().setpoints.back(); }

  Driven driven_, untouched_;
};

TEST_P(StopTest, AStoppedRobotStandsAndSendsNothing) {
  host().Stop(2, "controller flock crashed (abort)");
  const std::size_t sent = driven_.run().messages.size();
  driven_.Steps(3);
  EXPECT_EQ(last()[2], kStands);
  for (std::size_t i = sent; i < driven_.run().messages.size(); ++i) {
    EXPECT_NE(driven_.run().messages[i].robot, 2u);
  }
  EXPECT_EQ(last()[1], kByOthers);
}

TEST_P(StopTest, TheOthersGoOnAsIfNothingHadHappened) {
  host().Stop(2, "controller flock crashed (abort)");
  driven_.Steps(10);
  untouched_.Steps(10);
  for (std::size_t step = 0; step < 15; ++step) {  // diffuse ignores messages
    EXPECT_EQ(driven_.run().setpoints[step][0], untouched_.run().setpoints[step][0]) << step;
  }
}

TEST_P(StopTest, ItIsToldOnceWithItsReason) {
  host().Stop(2, "controller flock crashed (abort)");
  host().Stop(2, "another reason");
  const std::vector<StoppedController> stopped = host().TakeStopped();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0].robot, "robot3");
  EXPECT_EQ(stopped[0].why, "controller flock crashed (abort)");
  EXPECT_TRUE(host().TakeStopped().empty());
}

TEST_P(StopTest, RobotsWithoutControllerCannotBeStopped) {
  host().Stop(1, "why");
  host().Stop(7, "why");
  host().Stop(-1, "why");
  EXPECT_TRUE(host().TakeStopped().empty());
  driven_.Steps(1);
  EXPECT_EQ(last()[1], kByOthers);
}

TEST_P(StopTest, UnloadedRobotsAreListedInTheScenesOrder) {
  EXPECT_THAT(host().Unloaded(), IsEmpty());
  host().Unload(2);
  host().Unload(0);
  host().Unload(0);
  EXPECT_THAT(host().Unloaded(), ElementsAre(0, 2));
}

TEST_P(StopTest, AStoppedRobotCanBeUnloadedButNotTheOtherWayRound) {
  host().Stop(0, "it was so");
  host().Unload(0);
  host().Unload(2);
  host().Stop(2, "too late");
  EXPECT_THAT(host().Unloaded(), ElementsAre(0, 2));
  driven_.Steps(1);
  EXPECT_THAT(last(), ElementsAre(kByOthers, kByOthers, kByOthers, kByOthers));
}

TEST_P(StopTest, BothAreSavedAndRestored) {
  host().Stop(0, "controller diffuse did what it must not");
  host().Unload(2);
  driven_.Steps(2);
  host().TakeStopped();
  const std::vector<std::byte> saved = host().Save();

  Driven other(Mixed(), TestOptions(GetParam()));
  ASSERT_TRUE(other.Restore(driven_.frame(), saved));
  EXPECT_THAT(other.host().Unloaded(), ElementsAre(2));
  EXPECT_EQ(other.host().Save(), saved);
  const std::vector<StoppedController> stopped = other.host().TakeStopped();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0].robot, "robot1");
  EXPECT_EQ(stopped[0].why, "controller diffuse did what it must not");
  other.Steps(2);
  EXPECT_THAT(other.run().setpoints.back(), ElementsAre(kStands, kByOthers, kByOthers, kByOthers));
}

TEST_P(StopTest, RestoredIntoTheSameHostTheyDriveAgain) {
  const FramePtr frame = driven_.frame();
  const std::vector<std::byte> saved = host().Save();
  untouched_.Steps(10);
  host().Stop(0, "why");
  host().Unload(2);
  driven_.Steps(3);
  ASSERT_TRUE(driven_.Restore(frame, saved));
  EXPECT_TRUE(host().TakeStopped().empty());
  EXPECT_THAT(host().Unloaded(), IsEmpty());
  driven_.Steps(10);
  for (std::size_t step = 0; step < 10; ++step) {
    EXPECT_EQ(driven_.run().setpoints[8 + step], untouched_.run().setpoints[5 + step]) << step;
  }
}

TEST_P(StopTest, AResetForgetsBoth) {
  host().Stop(0, "why");
  host().Unload(2);
  driven_.Start();
  EXPECT_TRUE(driven_.run().stopped.empty());
  EXPECT_THAT(host().Unloaded(), IsEmpty());
  driven_.Steps(5);
  for (std::size_t step = 0; step < 5; ++step) {
    EXPECT_EQ(driven_.run().setpoints[5 + step], untouched_.run().setpoints[step]) << step;
  }
}

TEST_P(StopTest, AStoppedRobotStaysSoWhenTheChildIsLost) {
  if (GetParam()) return;  // there is no child
  host().Stop(0, "why");
  host().TakeStopped();
  ASSERT_GT(host().child_pid(), 0);
  kill(host().child_pid(), SIGKILL);
  driven_.Steps(3);
  untouched_.Steps(3);
  EXPECT_EQ(last()[0], kStands);
  EXPECT_NE(last()[2], kStands);
  EXPECT_TRUE(driven_.run().stopped.empty());
}

INSTANTIATE_TEST_SUITE_P(Backends, StopTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "InProcess" : "Child"; });

}  // namespace
}  // namespace coopdyn
