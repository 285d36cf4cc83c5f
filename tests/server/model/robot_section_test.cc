// SPDX-License-Identifier: MIT
// [ROBOT_n] and [SWARM_n].
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/model/scenario.h"
#include "server/model/swarm.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kPlaced = "[ROBOT_1]\ntype single\nposition 1 2\n";
const std::string kSwarm = "[SWARM_1]\ntype coopbot\nname ant\ncount 40\n";

/// The messages for a robot with one more line, its fourth.
std::string With(const std::string& line) {
  return Read(kPlaced + line + "\n").messages;
}

TEST(RobotTest, Defaults) {
  const RobotEntry robot = Good(kPlaced)->robots.at(0);
  EXPECT_EQ(robot.name, "robot1");
  EXPECT_EQ(robot.X_WR.p, Vector3(1, 2, 0));
  EXPECT_TRUE(robot.sync);
  EXPECT_TRUE(robot.sockets);
  EXPECT_FALSE(robot.deadline_s);
  EXPECT_FALSE(robot.on_disconnect);
  EXPECT_TRUE(robot.participates());
}

TEST(RobotTest, AllWords) {
  const RobotEntry robot =
      Good(kPlaced +
           "name /ana-1\norientation 90deg\ncolor green\nsync no\nwaits_for motors\n"
           "deadline 500ms\non_deadline drop\non_disconnect stop\nfidelity full\nsockets no\n")
          ->robots.at(0);
  EXPECT_EQ(robot.name, "ana-1");
  EXPECT_NEAR(Heading(robot.X_WR.q), std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(robot.color, *NamedColor("green"));
  EXPECT_FALSE(robot.sync);
  EXPECT_FALSE(robot.participates());
  EXPECT_THAT(robot.waits_for, ::testing::ElementsAre("motors"));
  EXPECT_EQ(robot.deadline_s, 0.5);
  EXPECT_EQ(robot.on_deadline, LossPolicy::kDrop);
  EXPECT_EQ(robot.on_disconnect, LossPolicy::kStop);
  EXPECT_FALSE(robot.sockets);
}

TEST(RobotTest, NamesAreChecked) {
  for (const char* name : {"1robot", "my robot", "rob%t", "_x", "\xC3\xA9t", "a/b"}) {
    EXPECT_THAT(With(std::string("name ") + name), HasSubstr(":4: error:")) << name;
  }
  EXPECT_THAT(With("name " + std::string(64, 'a')), HasSubstr("at most 63"));
  EXPECT_EQ(With("name " + std::string(63, 'a')), "");
}

TEST(RobotTest, NamesOfGlobalModulesAreReserved) {
  for (const char* name : {"simulation", "/world", "Swarm", "playback", "recorder"}) {
    EXPECT_THAT(With(std::string("name ") + name), HasSubstr("is the name of a module of the simulator"))
        << name;
  }
}

TEST(RobotTest, TwoOfOneNameAreAnError) {
  EXPECT_EQ(
      Read(kPlaced + "name a\n[ROBOT_2]\ntype single\nposition 5 5\nname a\n").messages,
      "test.scenario:8: error: there are two robots 'a' (the first in line 4): give one another name\n");
}

TEST(RobotTest, UnknownTypeIsGuessed) {
  EXPECT_THAT(Read("[ROBOT_1]\ntype coopbto\nposition 0 0\n").messages,
              HasSubstr(":2: error: unknown robot type 'coopbto'; did you mean 'coopbot'?"));
}

TEST(RobotTest, PositionIsOnTheFloor) {
  EXPECT_THAT(Read("[ROBOT_1]\ntype single\nposition 0 0 -0.1\n").messages, HasSubstr("write z = 0"));
  EXPECT_THAT(Read("[ROBOT_1]\ntype single\n").messages, HasSubstr(":1: error: [ROBOT_1] needs 'position'"));
}

TEST(RobotTest, BesideTheFloorDrawsAWarning) {
  EXPECT_THAT(Read("[ROBOT_1]\ntype single\nposition 11 0\n").messages,
              HasSubstr("warning: 'robot1' stands beside"));
}

TEST(RobotTest, WaitsForNamesActuatorModules) {
  EXPECT_THAT(With("waits_for motors, distance"),
              HasSubstr("'distance' is no actuator module of coopbot: it has motors"));
  EXPECT_THAT(With("waits_for none"), HasSubstr("write 'waits_for motors', or 'sync no'"));
  EXPECT_THAT(With("waits_for motors motors"), HasSubstr("'motors' is named twice"));
}

TEST(RobotTest, LockstepAwaitsWhatWaitsForLists) {
  EXPECT_THAT(Good(kPlaced)->robots.at(0).awaited_modules(), ::testing::ElementsAre("motors"));
  RobotEntry robot = Good(kPlaced + "waits_for motors\n")->robots.at(0);
  EXPECT_THAT(robot.awaited_modules(), ::testing::ElementsAre("motors"));
  robot.waits_for = {"arm"};
  EXPECT_THAT(robot.awaited_modules(), ::testing::IsEmpty());
  EXPECT_FALSE(robot.participates());
}

TEST(RobotTest, DeadlineIsAboveZero) {
  EXPECT_THAT(With("deadline 0"), HasSubstr(":4: error: 'deadline' must be at least"));
  EXPECT_THAT(With("deadline -1"), HasSubstr(":4: error: 'deadline' must be at least"));
}

TEST(RobotTest, PoliciesAreChecked) {
  EXPECT_THAT(With("deadline 1\non_deadline wait"), HasSubstr("'on_deadline' cannot be 'wait'"));
  EXPECT_THAT(With("on_disconnect dorp"), HasSubstr("did you mean 'drop'?"));
  EXPECT_THAT(With("on_deadline hold"), HasSubstr("warning: 'on_deadline' has no effect without 'deadline'"));
}

TEST(RobotTest, AWatchdogIsATimeOrOff) {
  EXPECT_EQ(Good(kPlaced)->robots.at(0).watchdog_s, std::nullopt);
  EXPECT_EQ(Good(kPlaced + "watchdog 500ms\n")->robots.at(0).watchdog_s, 0.5);
  EXPECT_EQ(Good(kPlaced + "watchdog Off\n")->robots.at(0).watchdog_s, 0.0);
  EXPECT_EQ(Good("[SIMULATION]\nwatchdog 2\n")->simulation.watchdog_s, 2.0);
  const auto swarm = Good("[SWARM_1]\ntype coopbot\ncount 2\nwatchdog 1s\n");
  EXPECT_EQ(swarm->robots.at(1).watchdog_s, 1.0);
  EXPECT_THAT(With("watchdog never"), HasSubstr(":4: error: 'watchdog' says how long"));
  EXPECT_THAT(With("watchdog 0"), HasSubstr(":4: error: 'watchdog' must be at least"));
  EXPECT_THAT(With("watchdog 2s\non_disconnect hold"),
              HasSubstr("warning: 'watchdog' has no effect with 'on_disconnect hold'"));
}

TEST(RobotTest, FidelityIsOneOfThree) {
  EXPECT_EQ(Good(kPlaced)->robots.at(0).fidelity, Fidelity::kFull);
  EXPECT_EQ(Good(kPlaced + "fidelity Rolling")->robots.at(0).fidelity, Fidelity::kRolling);
  EXPECT_EQ(Good(kPlaced + "fidelity planar")->robots.at(0).fidelity, Fidelity::kPlanar);
  EXPECT_EQ(Good(kSwarm + "fidelity rolling")->robots.at(39).fidelity, Fidelity::kRolling);
  EXPECT_THAT(With("fidelity roling"),
              HasSubstr(":4: error: 'fidelity' cannot be 'roling'; did you mean 'rolling'?"));
}

TEST(RobotTest, YesAndNo) {
  EXPECT_FALSE(Good(kPlaced + "sockets off")->robots.at(0).sockets);
  EXPECT_THAT(With("sockets maybe"), HasSubstr("must be yes or no, not 'maybe'"));
}

TEST(RobotTest, BrokenModelIsReportedOnce) {
  const TempFolder folder;
  folder.Write("robots/bad/model.sdf", "<sdf version=\"1.9\">\n<model name=\"bad\">\n</sdf>\n");
  RobotLibrary library(SearchPath{{folder.path()}});
  Diagnostics diagnostics;
  ReadScenario("[ROBOT_1]\ntype bad\nposition 0 0\n[ROBOT_2]\ntype bad\nposition 1 1\n", "x", library, false,
               diagnostics);
  EXPECT_EQ(diagnostics.errors(), 1);
  EXPECT_THAT(folder.Strip(diagnostics.ToString()), HasSubstr("robots/bad/model.sdf:"));
}

TEST(SwarmTest, NamesAndDefaults) {
  const auto scenario = Good(kSwarm);
  ASSERT_EQ(scenario->robots.size(), 40u);
  EXPECT_EQ(scenario->robots[0].name, "ant_1");
  EXPECT_EQ(scenario->robots[39].name, "ant_40");
  EXPECT_EQ(scenario->robots[39].id, RobotId{40});
  EXPECT_FALSE(scenario->robots[0].sockets);
  const auto nameless = Good("[SWARM_2]\ntype coopbot\ncount 2\n");
  EXPECT_EQ(nameless->robots.at(1).name, "swarm2_2");
}

TEST(SwarmTest, ScenarioSaysWhereTheyStand) {
  const auto scenario = Good(kSwarm + kPlaced + "[SWARM_7]\ntype coopbot\nname bee\ncount 3\n");
  ASSERT_EQ(scenario->swarms.size(), 2u);
  EXPECT_EQ(scenario->swarms[0].name, "ant");
  EXPECT_EQ(scenario->swarms[0].first, 0u);
  EXPECT_EQ(scenario->swarms[0].count, 40u);
  EXPECT_EQ(scenario->swarms[1].name, "bee");
  EXPECT_EQ(scenario->swarms[1].section, "swarm7");
  EXPECT_EQ(scenario->swarms[1].first, 41u);
  EXPECT_EQ(scenario->robots[41].name, "bee_1");
}

TEST(SwarmTest, NameIsNoRobotsName) {
  EXPECT_THAT(Read(kPlaced + "name Ant\n" + kSwarm).messages,
              HasSubstr(":7: error: a robot is called 'ant' too (in line 4): give the swarm another name"));
}

TEST(SwarmTest, IsAlsoCalledByItsSectionSoNobodyElseMayBe) {
  const std::string section = "[SWARM_1]\ntype coopbot\ncount 2\nname bee\n";
  EXPECT_THAT(Read(kPlaced + "name Swarm1\n" + section).messages,
              HasSubstr(":5: error: a robot is called 'swarm1' too (in line 4): this section"));
  EXPECT_THAT(Read(section + "[SWARM_2]\ntype coopbot\ncount 2\nname swarm1\n").messages,
              HasSubstr(":8: error: another swarm is called 'swarm1' too (in line 1): give the swarm"));
}

TEST(SwarmTest, TwoOfOneNameAreOneError) {
  EXPECT_EQ(
      Read(kSwarm + "[SWARM_2]\ntype coopbot\nname Ant\ncount 40\n").messages,
      "test.scenario:7: error: another swarm is called 'Ant' too (in line 3): give the swarm another name\n");
}

TEST(SwarmTest, NameIsNoneOfAnotherSwarmsRobots) {
  EXPECT_THAT(
      Read("[SWARM_1]\ntype coopbot\ncount 2\nname bee_2\n[SWARM_2]\ntype coopbot\ncount 2\nname bee\n")
          .messages,
      HasSubstr(":8: error: a swarm is called 'bee_2' too (in line 4): give one another name"));
}

TEST(SwarmTest, OrderIsThatOfTheFile) {
  const auto scenario = Good(kSwarm + kPlaced);
  EXPECT_EQ(scenario->robots.at(0).name, "ant_1");
  EXPECT_EQ(scenario->robots.at(40).name, "robot1");
  EXPECT_EQ(scenario->robots.at(40).id, RobotId{41});
}

TEST(SwarmTest, SamePlacesForTheSameSeedOnly) {
  const auto a = Good(kSwarm), b = Good(kSwarm), c = Good(kSwarm + "seed 2\n");
  EXPECT_EQ(a->robots[7].X_WR.p, b->robots[7].X_WR.p);
  EXPECT_EQ(a->robots[7].X_WR.q.coeffs(), b->robots[7].X_WR.q.coeffs());
  EXPECT_NE(a->robots[7].X_WR.p, c->robots[7].X_WR.p);
  EXPECT_NE(a->robots[7].X_WR.p, Good("[SIMULATION]\nseed 2\n" + kSwarm)->robots[7].X_WR.p);
}

TEST(SwarmTest, SeedOfTheRunReplacesTheScenarios) {
  const auto with_seed = [](const std::string& text, std::uint64_t seed) {
    Diagnostics diagnostics;
    return ReadScenario(text, "test.scenario", ShippedRobots(), false, diagnostics, seed);
  };
  const auto scenario = with_seed("[SIMULATION]\nseed 5\n" + kSwarm, 2);
  EXPECT_EQ(scenario->simulation.seed, 2u);
  EXPECT_EQ(scenario->robots[7].X_WR.p, Good(kSwarm + "seed 2\n")->robots[7].X_WR.p);
  // The swarm's own seed fixes the positions.
  EXPECT_EQ(with_seed(kSwarm + "seed 2\n", 9)->robots[7].X_WR.p, scenario->robots[7].X_WR.p);
}

TEST(SwarmTest, PlacesAreClearOfObjectsRobotsAndOneAnother) {
  const auto scenario =
      Good("[FLOOR]\nsize 8 8\n[WALL]\ntype box\nsize 4 0.2 1\nposition 0 0\norientation 30deg\n" +
           std::string("[PILLAR]\ntype cylinder\nsize 1 1 1\nposition 2 2\n[ROBOT_1]\ntype single\n") +
           "position -2 -2\n" + kSwarm + "spacing 0.6\n");
  ASSERT_EQ(scenario->robots.size(), 41u);
  for (std::size_t i = 0; i < 41; ++i) {
    const Vector3& p = scenario->robots[i].X_WR.p;
    EXPECT_LE(std::abs(p.x()), 4 - 0.18);
    EXPECT_LE(std::abs(p.y()), 4 - 0.18);
    for (const WorldObject& object : scenario->objects)
      EXPECT_GT(DistanceToShadow(object, p.x(), p.y()), 0.18);
    for (std::size_t j = 0; j < i; ++j) {
      const double least = j == 0 ? 0.36 : 0.6;
      EXPECT_GE((p - scenario->robots[j].X_WR.p).norm(), least) << i << " " << j;
    }
  }
}

TEST(SwarmTest, AreaBoundsThePlaces) {
  const auto scenario = Good("[SWARM]\ntype single\nname a\ncount 10\narea 5 -5 4 2\n");
  for (const RobotEntry& robot : scenario->robots) {
    EXPECT_LE(std::abs(robot.X_WR.p.x() - 5), 2 - 0.18);
    EXPECT_LE(std::abs(robot.X_WR.p.y() + 5), 1 - 0.18);
  }
}

TEST(SwarmTest, TooManyForTheAreaIsAnError) {
  EXPECT_THAT(Read("[SWARM]\ntype single\nname a\ncount 500\narea 0 0 3 3\n").messages,
              HasSubstr(" of 500 robots fit into the area of 3 x 3 m, 0.45 m apart"));
  EXPECT_THAT(Read("[SWARM]\ntype single\nname a\ncount 1\narea 0 0 0.1 0.1\n").messages,
              HasSubstr("only 0 of 1 robots fit"));
}

TEST(SwarmTest, MistakesAreErrors) {
  EXPECT_THAT(Read("[SWARM]\ntype single\n").messages, HasSubstr("[SWARM] needs 'count'"));
  EXPECT_THAT(Read(kSwarm + "spacing 0.2\n").messages,
              HasSubstr("at least 0.36 m, the diameter of a coopbot"));
  EXPECT_THAT(Read(kSwarm + "area 0 0 -1 1\n").messages, HasSubstr("must be above 0"));
  EXPECT_THAT(Read("[SWARM]\ntype single\nname a\ncount 1000000000\n").messages,
              HasSubstr("from 1 to 100000"));
  EXPECT_THAT(Read("[SWARM]\ntype team2\nname a\ncount 2\n").messages, HasSubstr("write 'type single'"));
  EXPECT_THAT(Read("[SWARM]\ntype single\nname 1a\ncount 20\n").messages,
              HasSubstr(":3: error: a robot's name"));
}

const std::string kTeam = "[ROBOT_1]\ntype team2\nname carrier\nposition 1 2\norientation 90deg\n";

TEST(TeamTest, IsTwoTransportersWithABarOnTheirSupports) {
  const auto scenario = Good(kTeam);
  ASSERT_EQ(scenario->robots.size(), 2u);
  EXPECT_EQ(scenario->robots[0].name, "carrier_leader");
  EXPECT_EQ(scenario->robots[1].name, "carrier_helper");
  for (const RobotEntry& robot : scenario->robots) EXPECT_EQ(robot.model->type, "transporter");
  EXPECT_LT((scenario->robots[1].X_WR.p - Vector3(1, 0.8, 0)).norm(), 1e-9);
  ASSERT_EQ(scenario->objects.size(), 1u);
  const WorldObject& bar = scenario->objects[0];
  EXPECT_EQ(bar.name, "carrier_bar");
  EXPECT_EQ(bar.shape, Shape(Box{Vector3(1.5, 0.05, 0.05)}));
  EXPECT_EQ(bar.mass_kg, 1);
  EXPECT_LT((bar.X_WO.p - Vector3(1, 1.4, 0.325)).norm(), 1e-9);
  EXPECT_NEAR(Heading(bar.X_WO.q), std::numbers::pi / 2, 1e-12);
}

TEST(TeamTest, TheScenarioSaysLengthSectionMassAndColourOfTheBar) {
  const auto scenario = Good(kTeam + "bar 2 4cm 6cm\nbar_mass 800g\nbar_color red\n");
  const WorldObject& bar = scenario->objects.at(0);
  EXPECT_EQ(bar.shape, Shape(Box{Vector3(2, 0.04, 0.06)}));
  EXPECT_EQ(bar.mass_kg, 0.8);
  EXPECT_EQ(bar.color, *NamedColor("red"));
  EXPECT_NEAR(scenario->robots[1].X_WR.p.y(), 2 - 1.7, 1e-9);
  EXPECT_NEAR(bar.X_WO.p.z(), 0.33, 1e-9);
}

TEST(TeamTest, ABarThatTheSupportsCannotHoldIsAnError) {
  EXPECT_THAT(Read(kTeam + "bar 0.5 0.05 0.05\n").messages, HasSubstr(":6: error: the length of the bar"));
  EXPECT_THAT(Read(kTeam + "bar 1.5 0.06 0.05\n").messages, HasSubstr("for example: bar 1.5 0.05 0.05"));
  EXPECT_THAT(Read(kTeam + "bar 1.5 0.05 0.02\n").messages, HasSubstr("the height of the bar"));
  EXPECT_THAT(Read(kTeam + "bar_mass 50\n").messages, HasSubstr(":6: error:"));
  EXPECT_THAT(Read(kPlaced + "bar 1.5 0.05 0.05\n").messages, HasSubstr(":4: error:"));
}

TEST(TeamTest, NothingElseHasTheBarsName) {
  const std::string box = "[CARRIER_BAR]\ntype box\nsize 1 1 1\nposition 4 4\n";
  EXPECT_THAT(Read(kTeam + box).messages, HasSubstr("is the name of a team's bar and of a thing"));
  EXPECT_THAT(Read(box + kTeam).messages, HasSubstr("is the name of a team's bar and of a thing"));
}

TEST(SwarmTest, BridgesAreNoObstacles) {
  EXPECT_EQ(
      Read("[FLOOR]\nsize 2 2\n[ROOF]\ntype box\nsize 2 2 0.1\nposition 0 0 1\n[SWARM]\ntype single\nname a\n"
           "count 3\n")
          .messages,
      "");
}

TEST(SummaryTest, OneLine) {
  EXPECT_EQ(Summary(*Good(kPlaced + "[TARGET]\nred 1 1\n[B]\ntype box\nsize 1 1 1\nposition 5 5\nmass 1\n"
                                    "[SIMULATION]\nmode lockstep\nstep 0.02\n")),
            "1 robot (coopbot), 1 object (0 static), 1 target, floor 20 x 20 m, lockstep 20 ms");
}

TEST(SummaryTest, SwarmsAndHowTheyAreSimulated) {
  EXPECT_EQ(
      Summary(*Good(kSwarm + "fidelity rolling\n")),
      "40 robots in swarm ant (coopbot, rolling), no objects, no targets, floor 20 x 20 m, realtime 10 ms");
  EXPECT_EQ(
      Summary(*Good("[FLOOR]\nsize 30 30\n" + kSwarm + "fidelity planar\n[SWARM_2]\ntype minibot\ncount 2\n" +
                    kPlaced)),
      "43 robots in 2 swarms (41 coopbot and 2 minibot, 40 planar), no objects, no targets, floor 30 x 30 m, "
      "realtime 10 ms");
}

}  // namespace
}  // namespace coopdyn
