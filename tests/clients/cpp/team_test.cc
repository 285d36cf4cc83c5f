// SPDX-License-Identifier: MIT
// Teams of the C++ client against the scripted and the real daemon.
#include "clients/cpp/team.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

std::vector<double> Row(const Rows& rows, std::size_t i) {
  return {rows[i].begin(), rows[i].end()};
}

TEST(TeamRows, AreTheReadingsAfterTheStep) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "3"});
  auto sim = connect(daemon.server());
  auto team = sim.team(std::vector<std::string>{"robot1", "robot3"});
  auto second = sim.robot("robot2");
  EXPECT_EQ(team.names(), (std::vector<std::string>{"robot1", "robot3"}));
  EXPECT_EQ(team.ids(), (std::vector<std::int32_t>{1, 3}));
  second.set_velocity(0.5, 0);
  const TeamReading s = team.step(std::array{1.0, 0.0, 2.0, 0.0}, 60);
  EXPECT_EQ(s.step, 1);
  EXPECT_EQ(s.time, 0.01);
  EXPECT_EQ(s.pose.size(), 2u);
  EXPECT_EQ(Row(s.pose, 1), (std::vector<double>{0.02, 2, 0}));
  EXPECT_EQ(s.distances.columns(), 11u);
  EXPECT_EQ(s.distances[0][5], 3.99);
  EXPECT_EQ(second.get_pose().forward, 0.5);
  EXPECT_TRUE(Says(ErrorOf([&] { s.targets[0]; }), "not chosen"));
  EXPECT_TRUE(Says(ErrorOf([&] { s.pose[2]; }), "no row 2 of 2"));
  team.select({"targets", "wheels"});
  const TeamReading t = team.read();
  EXPECT_EQ(t.targets.columns(), 4u);
  EXPECT_EQ(t.wheels[1][2], 2.0);
  EXPECT_EQ(t.pose.size(), 0u);
}

TEST(TeamRows, StayAsTheyWereAndTheirMemoryIsUsedAgain) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "2"});
  auto team = connect(daemon.server()).team();
  const TeamReading first = team.step(std::array{1.0, 0.0});
  const TeamReading copy = first;
  std::vector<const double*> places;
  for (int k = 0; k < 8; ++k) places.push_back(team.step().values->data());
  EXPECT_EQ(first.pose[0][0], 0.01);
  EXPECT_EQ(copy.pose[0].data(), first.pose[0].data());
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  EXPECT_LE(places.size(), 4u);
}

TEST(TeamSpeeds, AreCheckedBeforeAnythingIsWritten) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "3"});
  auto sim = connect(daemon.server());
  auto team = sim.team();
  const std::vector<double> four = {1, 2, 3, 4};
  EXPECT_TRUE(Says(ErrorOf([&] { team.step(four); }), "3 V has 4 numbers, the team has 3 robots"));
  std::vector<double> bad = {1, 2, 3, NAN, 5, 6};
  EXPECT_TRUE(Says(ErrorOf([&] { team.step(bad); }), "4 row 1 of V (robot2) must be finite, not 3, nan"));
  EXPECT_TRUE(Says(ErrorOf([&] { team.step_wheels({}); }), "3 W has 0 numbers"));
  EXPECT_TRUE(
      Says(ErrorOf([&] { team.select({"poses"}); }), "4 there is no reading poses; there are: pose, "));
  EXPECT_TRUE(Says(ErrorOf([&] { sim.team(std::vector<std::string>{}); }), "sim.team()"));
  EXPECT_EQ(team.step(std::array{1.0, 0.0}, 60).step, 1);
}

TEST(TeamInterrupted, AfterATimeoutTheNextReplyIsTheRightOne) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "3"});
  auto sim = connect(daemon.server());
  auto team = sim.team(std::vector<std::string>{"robot1", "robot2"});
  const std::array v = {0.25, 0.0};
  EXPECT_TRUE(Says(ErrorOf([&] { team.step(v, 0.1); }), "robot3 (no client)"));
  auto third = sim.robot("robot3");
  for (int k = 0; k < 3; ++k) {
    const TeamReading s = team.step(v, 60);
    EXPECT_EQ(s.step, sim.steps());
  }
  sim.call("/simulation", "load_scenario", {}, {}, "!refuse=robot2");
  EXPECT_TRUE(Says(ErrorOf([&] { team.step(v, 60); }), "4 team of 2 robots: robot2 is refused"));
  sim.call("/simulation", "load_scenario", {}, {}, "!refuse=");
  for (int k = 0; k < 3; ++k) {
    const TeamReading s = team.step(v, 60);
    EXPECT_EQ(s.step, sim.steps());
  }
}

TEST(TeamInterrupted, RepliesThatComeByteByByteAreWhole) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "2", "--dribble"});
  auto team = connect(daemon.server()).team();
  for (int k = 1; k <= 3; ++k) EXPECT_EQ(team.step().step, k);
}

TEST(TeamRunningTwice, TheSameClientNameTakesOver) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "3"});
  auto old_sim = connect(daemon.server());
  auto old = old_sim.team();
  old.step(std::array{0.5, 0.0});
  auto sim = connect(daemon.server());
  auto team = sim.team("robot2");
  EXPECT_EQ(team.n(), 1u);
  EXPECT_TRUE(Says(ErrorOf([&] { old.step(); }), "sim.team() takes it again"));
  EXPECT_EQ(ErrorOf([&] { old.read(); }).code(), 6);
  old.close();
  auto rest = sim.team();
  EXPECT_EQ(rest.names(), (std::vector<std::string>{"robot1", "robot3"}));
  EXPECT_EQ(team.step({}, 60).step, 2);
  EXPECT_EQ(rest.step({}, 60).step, 3);
  rest.close();
  EXPECT_TRUE(Says(ErrorOf([&] { rest.step(); }), "5 team of 2 robots was given up"));
  auto other = connect(daemon.server(), {.name = "ben"});
  EXPECT_TRUE(
      Says(ErrorOf([&] { other.team("robot2"); }), "6 team robot2 cannot be driven: robot2 is owned by"));
  EXPECT_EQ(other.team().n(), 2u);
}

TEST(TeamWithSingleRobots, AStepOfTheSimIsOneOfTheTeam) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "3"});
  auto sim = connect(daemon.server());
  auto team = sim.team(std::vector<std::string>{"robot1", "robot2"});
  auto third = sim.robot("robot3");
  team.step(std::array{0.25, 0.0}, 60);
  third.set_velocity(0.5, 0);
  sim.step(1, 60);
  sim.step(3, 60);
  EXPECT_EQ(sim.steps(), 5);
  EXPECT_DOUBLE_EQ(team.read().pose[1][0], 5 * 0.0025);
  EXPECT_EQ(third.get_pose().forward, 0.5);
  auto member = sim.robot("robot1");
  EXPECT_EQ(member.get_distances().size(), 11u);
  EXPECT_TRUE(Says(ErrorOf([&] { member.set_velocity(1, 0); }), "robot1 is driven by its team"));
  EXPECT_TRUE(Says(ErrorOf([&] { member.get_neighbours(); }), "robot1 has no module neighbours"));
  EXPECT_EQ(ErrorOf([&] { member.send_message({}); }).code(), 3);
}

TEST(TeamOfTheDaemon, OneThatLostAllItsRobotsTakesNoneFromItsSuccessor) {
  const auto daemon = ServerProcess::Real("swarm100", {"--no-http", "--no-render"});
  auto others = connect(daemon.server(), {.name = "C"});
  auto sim = connect(daemon.server(), {.name = "A"});
  auto first = sim.team("mini");
  first.step({}, 60);
  others.load_scenario("classroom");
  others.load_scenario("swarm100");
  EXPECT_TRUE(Says(ErrorOf([&] { first.step({}, 60); }), "5 scenario swarm100 was loaded"));
  auto second = sim.team("swarm1");
  second.step({}, 60);
  EXPECT_TRUE(
      Says(ErrorOf([&] { sim.team("mini_1"); }), "6 robot mini_1 belongs to your team swarm1: drive"));
  others.pause();
  EXPECT_EQ(ErrorOf([&] { second.step({}, 0.1); }).code(), 11);
  others.run();
  EXPECT_EQ(second.read().pose.size(), 100u);
  EXPECT_EQ(sim.team("swarm1").step({}, 60).pose.size(), 100u);
}

TEST(TeamOfTheDaemon, AfterALoadItIsAtOnceWhomItMeansNow) {
  const auto daemon = ServerProcess::Real("swarm100", {"--no-http", "--no-render"});
  auto sim = connect(daemon.server());
  auto old = sim.team("mini");
  old.step({}, 60);
  sim.load_scenario("swarm100");
  auto team = sim.team("swarm1");  // the old team loses its robots to it
  EXPECT_EQ(team.n(), 100u);
  sim.load_scenario("swarm100");
  auto again = sim.team("swarm1");
  EXPECT_EQ(again.names().size(), 100u);
  EXPECT_EQ(again.step(std::vector<double>(2 * again.n(), 0.1), 60).pose.size(), 100u);
}

TEST(TeamOfTheDaemon, OneRowForAllGoesOnWithTheRestWhenARobotIsTakenAway) {
  const auto daemon = ServerProcess::Real("swarm100", {"--no-http", "--no-render", "--mode", "realtime"});
  auto sim = connect(daemon.server(), {.name = "A"});
  auto team = sim.team("swarm1");
  const std::array all = {0.1, 0.0};
  team.step(all, 60);
  auto other = connect(daemon.server(), {.name = "B"});
  const auto take = [&](const std::string& robot) {
    other.call("/simulation", "release_robot", {}, {}, robot);
    other.robot(robot).set_velocity(0, 0.5);
  };
  take("mini_5");
  EXPECT_EQ(team.step(all, 60).pose.size(), 99u);
  take("mini_7");
  const std::vector<double> each(2 * 99, 0.1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_TRUE(
        Says(ErrorOf([&] { team.step(each, 60); }), "3 team swarm1 has lost mini_7: V must have 98 rows"));
  }
  EXPECT_EQ(team.step(std::vector<double>(2 * 98, 0.1), 60).pose.size(), 98u);
}

TEST(TeamOfTheDaemon, RowsAreWhatTheRobotsSay) {
  const auto daemon = ServerProcess::Real("swarm100", {"--no-http", "--no-render"});
  auto sim = connect(daemon.server());
  auto team = sim.team("swarm1");
  ASSERT_EQ(team.n(), 100u);
  team.select({"pose", "distances", "wheels", "neighbours", "compass"}, 2);
  TeamReading s;
  for (int k = 0; k < 20; ++k) s = team.step(std::array{0.1, 0.2}, 60);
  EXPECT_EQ(s.step, 20);
  EXPECT_EQ(s.neighbours.columns(), 6u);
  for (const std::size_t i : {0u, 57u, 99u}) {
    auto r = sim.robot(team.names()[i]);
    const Pose pose = r.get_pose();
    EXPECT_EQ(Row(s.pose, i), (std::vector<double>{pose.x, pose.y, pose.heading}));
    EXPECT_EQ(Row(s.distances, i), r.get_distances());
    EXPECT_EQ(s.wheels[i][2], r.get_wheels().left_speed);
    EXPECT_EQ(s.compass[i][0], pose.heading);
    EXPECT_EQ(r.get_compass(), pose.heading);
    EXPECT_EQ(r.sense().compass, pose.heading);
    const std::vector<OtherRobot> others = r.get_neighbours();
    const auto nearest = std::min_element(
        others.begin(), others.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    EXPECT_EQ(s.neighbours[i][0], nearest == others.end() ? 0 : nearest->id);
  }
  sim.robot(team.names()[0]).send_message({1, 2});
  sim.step(2, 60);
  EXPECT_EQ(team.read().step, 22);
  sim.close();
}

}  // namespace
}  // namespace coopdyn::client
