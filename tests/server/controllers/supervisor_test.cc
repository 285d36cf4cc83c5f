// SPDX-License-Identifier: MIT
// Supervisors in the host: their view, their actions and their checks. Hostile ones are in hostile_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/state/world_change.h"
#include "tests/server/controllers/plugins/deeds.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

double LoggedIn(const Supervision& supervision, const std::string& name) {
  const auto found = std::ranges::find(supervision.logs, name, &Supervision::Log::name);
  return found == supervision.logs.end() ? -1 : found->value;
}

std::string SupervisorCheckOf(const Swarm& swarm) {
  Driven driven(swarm);
  Diagnostics diagnostics;
  driven.host().Check(swarm.scenario(), diagnostics);
  return diagnostics.ToString();
}

TEST(SupervisorTest, SeesWhereAllRobotsAndTargetsAre) {
  Driven driven(Supervised(kWatches));
  driven.Start();
  const double x_m = RobotPose(*driven.frame(), 0).p.x();
  const Supervision first = driven.Steps(1).supervision[0];
  EXPECT_EQ(LoggedIn(first, "bodies"), 6);
  EXPECT_EQ(LoggedIn(first, "scores"), 0);
  EXPECT_EQ(LoggedIn(first, "x"), x_m);
  EXPECT_TRUE(first.moves.empty());
  EXPECT_FALSE(first.end);
}

TEST(SupervisorTest, DrivesNobody) {
  Swarm alone = Supervised(kWatches);
  alone.Supervise(".so");  // not a supervisor
  Driven with(Supervised(kWatches)), without(alone);
  with.Start();
  without.Start();
  EXPECT_TRUE(with.Steps(20).setpoints == without.Steps(20).setpoints);
}

TEST(SupervisorTest, MovesNameTheirThingsByTheIdsOfTheWorld) {
  Driven driven(Supervised(kMovesAll, 2));
  driven.Start();
  driven.Steps(2);
  const FramePtr seen = driven.frame();
  const Record& run = driven.Steps(1);
  ASSERT_EQ(run.supervision[2].moves.size(), 6u);
  const Supervision::Move& robot = run.supervision[2].moves[0];
  EXPECT_EQ(robot.id, WorldId::kRobots + 1);
  EXPECT_NEAR((robot.X_W.p - RobotPose(*seen, 0).p - Vector3(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(run.supervision[2].moves[5].X_W.p, Vector3(4, 1, 0));
  EXPECT_TRUE(run.supervision[1].moves.empty());
}

TEST(SupervisorTest, EndsTheRunWithAPrintableReason) {
  Driven driven(Supervised(kEndsRun, 3));
  driven.Start();
  const Record& run = driven.Steps(4);
  EXPECT_FALSE(run.supervision[2].end);
  EXPECT_EQ(run.supervision[3].end, "it is?enough");
}

TEST(SupervisorTest, GoesOnFromWhatWasSaved) {
  Driven expected(Supervised(kEndsRun, 9)), driven(Supervised(kEndsRun, 9));
  expected.Start();
  expected.Steps(5);
  ASSERT_TRUE(driven.Restore(expected.frame(), expected.host().Save()));
  EXPECT_TRUE(driven.Steps(5).supervision[4].end);
}

TEST(SupervisorTest, GoesOnWhenTheSceneIsEdited) {
  Driven driven(Supervised(kEndsRun, 9));
  driven.Start();
  driven.Steps(5);
  Swarm more = Supervised(kEndsRun, 9);
  more.Add(Sample("diffuse"));
  const FramePtr edited = more.Start();
  driven.host().Revise(edited);
  EXPECT_TRUE(driven.host().TakeStopped().empty());
  EXPECT_EQ(driven.host().Save().size() > 0, true);
  std::vector<Setpoint> setpoints(edited->channels.size());
  std::vector<SentMessage> messages;
  for (int i = 0; i < 4; ++i) {
    driven.host().Step(edited, setpoints, messages);
    EXPECT_FALSE(driven.host().TakeSupervision().end) << i;
  }
  driven.host().Step(edited, setpoints, messages);
  EXPECT_TRUE(driven.host().TakeSupervision().end);
}

TEST(SupervisorTest, StoppedFromOutsideDoesNothingMore) {
  Driven driven(Supervised(kWatches));
  driven.Start();
  driven.Steps(2);
  driven.host().Stop(kSupervisor, "as in the run");
  const std::vector<StoppedController> stopped = driven.host().TakeStopped();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped[0].robot, "supervisor overseer");
  EXPECT_TRUE(driven.Steps(1).supervision[2].empty());
  EXPECT_TRUE(driven.run().stopped.empty());
}

TEST(SupervisorTest, ARobotsLogsBearItsName) {
  Swarm swarm;
  swarm.Add(TestPlugin("logger")).Add(TestPlugin("logger"));
  for (const bool in_process : {false, true}) {
    Driven driven(swarm, TestOptions(in_process));
    driven.Start();
    const Supervision step = driven.Steps(3).supervision[2];
    ASSERT_EQ(step.logs.size(), 4u);
    EXPECT_EQ(step.logs[0].name, "robot1.steps");
    EXPECT_EQ(step.logs[0].value, 2);
    EXPECT_EQ(step.logs[3].name, "robot2.twice");
    EXPECT_EQ(step.logs[3].value, 4);
  }
}

TEST(SupervisorCheckTest, ARobotsControllerIsNoSupervisor) {
  EXPECT_THAT(
      SupervisorCheckOf(Swarm().Supervise(Sample("diffuse"))),
      HasSubstr("test.scenario:2: error: controller diffuse drives a robot and is no supervisor: write "
                "controller diffuse in a [ROBOT_n] or [SWARM_n]"));
}

TEST(SupervisorCheckTest, ASupervisorDrivesNoRobot) {
  EXPECT_THAT(
      SupervisorCheckOf(Swarm().Add(Sample("referee"))),
      HasSubstr("test.scenario:10: error: controller referee is a supervisor and drives no robot: write "
                "supervisor referee in [SIMULATION]"));
}

TEST(SupervisorCheckTest, ItsOptionsAreChecked) {
  EXPECT_THAT(
      SupervisorCheckOf(Swarm().Supervise(Sample("referee"), {{"round", 3}})),
      HasSubstr("test.scenario:2: error: controller referee has no option 'round'; did you mean 'rounds'?"));
  EXPECT_THAT(SupervisorCheckOf(Swarm().Supervise(Sample("referee"), {{"rounds", 0}})),
              HasSubstr("for example: supervisor referee rounds=5"));
}

TEST(SupervisorCheckTest, ABrokenOneIsAWarning) {
  EXPECT_THAT(SupervisorCheckOf(Swarm().Supervise(TestPlugin("wrong_version"))),
              HasSubstr("test.scenario:2: warning: controller wrong_version cannot be used: "));
  EXPECT_THAT(SupervisorCheckOf(Swarm().Supervise(TestPlugin("two_minds"))),
              HasSubstr("a supervisor has no robot, so it takes COOPDYN_WORLD alone"));
}

}  // namespace
}  // namespace coopdyn
