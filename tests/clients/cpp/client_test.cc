// SPDX-License-Identifier: MIT
// The C++ client against the scripted and the real daemon.
#include "clients/cpp/coopdyn_client.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

std::ptrdiff_t OpenFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

int RunProgram(const std::string& program, const std::string& server, const std::string& arguments = "") {
  setenv("COOPDYN_SERVER", server.c_str(), 1);
  const int status = std::system((program + " " + arguments).c_str());
  unsetenv("COOPDYN_SERVER");
  return status;
}

TEST(RunningTwice, TheSameClientNameTakesOverAndTheOldOneIsTold) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto old_sim = connect(daemon.server());
  auto old_robot = old_sim.robot(1);
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  robot.set_velocity(0.1, 0);
  sim.step();
  old_robot.set_velocity(0.5, 0);
  const Error error = ErrorOf([&] { old_sim.step(); });
  EXPECT_EQ(error.code(), 6) << error.text();
  EXPECT_TRUE(Says(error, "taken over")) << error.text();
  EXPECT_EQ(error.name(), "owned");
  EXPECT_EQ(ErrorOf([&] { old_robot.set_velocity(0.5, 0); }).code(), 6);
  old_sim.close();
  sim.step();
  EXPECT_EQ(robot.get_pose().forward, 0.1);
}

TEST(Beside, RobotsThatTakeNoPartSetOffNoStepOfTheirOwn) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  std::vector<Robot> robots;
  for (int i = 1; i <= 3; ++i) robots.push_back(sim.robot(i));
  for (const std::vector<std::string>& names :
       {{"robot1"}, {"robot1", "robot3"}, std::vector<std::string>{"robot2"}}) {
    sim.set_participants(names);
    sim.step();  // a command that came after the last step may have run already
    std::vector<Pose> poses;
    for (Robot& robot : robots) poses.push_back(robot.get_pose());
    // Lockstep does not wait for the others: their commands run some steps later on a busy machine.
    for (std::size_t moved = 0, i = 0; i < 20 || moved < robots.size(); ++i) {
      const auto before = sim.steps();
      for (Robot& robot : robots) robot.set_velocity(0.2, 0.05);
      sim.step();
      ASSERT_EQ(sim.steps(), before + 1);
      if (moved == robots.size()) continue;
      const Pose pose = robots[moved].get_pose();
      if (std::hypot(pose.x - poses[moved].x, pose.y - poses[moved].y) > 0.01) ++moved;
    }
  }
}

TEST(RunningTwice, AnotherClientIsToldWhoOwnsTheRobot) {
  const auto daemon = ServerProcess::Fake({});
  auto sim = connect(daemon.server(), {.name = "ana"});
  auto robot = sim.robot("robot1");
  auto other = connect(daemon.server(), {.name = "ben"});
  const Error error = ErrorOf([&] { other.robot("robot1"); });
  EXPECT_EQ(error.code(), 6);
  EXPECT_TRUE(Says(error, "ana")) << error.text();
}

TEST(RunningTwice, DroppedObjectsCloseTheirSockets) {
  const auto daemon = ServerProcess::Fake({});
  const std::ptrdiff_t before = OpenFiles();
  {
    auto robot = connect(daemon.server()).robot(1);
    robot.get_pose();
    robot.sense();
    robot.subscribe("pose");
    EXPECT_GE(OpenFiles(), before + 4);
  }
  EXPECT_EQ(OpenFiles(), before);
}

TEST(Interrupted, AfterATimeoutTheNextReplyIsTheRightOne) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "2"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  robot.set_velocity(0.1, 0);
  const Error error = ErrorOf([&] { sim.step(1, 0.1); });
  EXPECT_EQ(error.code(), 11);
  EXPECT_TRUE(Says(error, "robot2 (no client)")) << error.text();
  EXPECT_EQ(robot.get_wheels().left_speed, 0);
  auto other = sim.robot(2);
  for (int k = 0; k < 3; ++k) {
    robot.set_velocity(0.3, 0);
    other.set_velocity(0.4, 0);
    sim.step(1, 60);
  }
  EXPECT_EQ(robot.get_pose().forward, 0.3);
  EXPECT_EQ(other.get_pose().forward, 0.4);
}

TEST(Killed, AProgramThatIsKilledStopsItsRobotInRealTime) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "realtime"});
  const pid_t program = fork();
  if (program == 0) {
    auto sim = connect(daemon.server());
    auto robot = sim.robot(1);
    while (true) {
      robot.set_velocity(0.2, 0);
      sim.step();
    }
  }
  Options options;
  options.watch = true;
  auto sim = connect(daemon.server(), options);
  auto robot = sim.robot(1);
  constexpr int kMostSteps = 6000;
  const auto comes = [&](auto condition) {
    for (int k = 0; k < kMostSteps; ++k) {
      if (condition(std::abs(robot.get_wheels().left_speed))) return true;
      sim.step();
    }
    return false;
  };
  EXPECT_TRUE(comes([](double speed) { return speed > 1; }));
  kill(program, SIGKILL);
  waitpid(program, nullptr, 0);
  EXPECT_TRUE(comes([](double speed) { return speed < 1e-3; }));
}

TEST(Interrupted, OneRefusedRobotOfFiveNeverHangsTheLoop) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "5"});
  auto sim = connect(daemon.server());
  std::vector<Robot> robots;
  for (int i = 1; i <= 5; ++i) robots.push_back(sim.robot(i));
  for (const std::string refused : {"robot3", "robot1", "", "robot5", ""}) {
    sim.call("/simulation", "load_scenario", {}, {}, "!refuse=" + refused);
    for (std::size_t i = 0; i < 5; ++i) robots[i].set_velocity(0.125 * static_cast<double>(i), 0);
    const Error error = ErrorOf([&] { sim.step(1, 60); });
    EXPECT_EQ(error.code(), refused.empty() ? 0 : 4) << error.text();
  }
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(robots[i].get_pose().forward, 0.125 * static_cast<double>(i));
}

TEST(Interrupted, RepliesThatComeByteByByteAreWhole) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--dribble"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  for (int k = 0; k < 3; ++k) {
    const Reading s = robot.sense("red");
    EXPECT_EQ(s.step, k);
    EXPECT_EQ(s.distances.size(), 11u);
    robot.set_velocity(0.1, 0);
    sim.step();
  }
}

TEST(Connecting, GivesUpWithCauseAndCure) {
  const Error refused = ErrorOf([] { connect("127.0.0.1:1"); });
  EXPECT_EQ(refused.code(), Error::kNoConnection);
  EXPECT_TRUE(Says(refused, "coopdyn serve")) << refused.text();
  const auto silent = ServerProcess::Fake({"--silent"});
  const Error unanswered = ErrorOf([&] { connect(silent.server(), {.timeout = 0.2}); });
  EXPECT_EQ(unanswered.code(), 11);
  EXPECT_TRUE(Says(unanswered, "coopdyn status")) << unanswered.text();
  const auto another = ServerProcess::Fake({"--says", "SSH-2.0"});
  EXPECT_TRUE(Says(ErrorOf([&] { connect(another.server()); }), "not a coopdyn daemon"));
  EXPECT_FALSE(doctor(another.server()));
  const auto newer = ServerProcess::Fake({"--protocol", "2"});
  EXPECT_TRUE(Says(ErrorOf([&] { connect(newer.server()); }), "protocol 2"));
  EXPECT_EQ(ErrorOf([] { connect("host:port"); }).code(), 4);
}

TEST(Connecting, UnknownNamesAreAnsweredWithThoseThereAre) {
  const auto daemon = ServerProcess::Fake({"--robots", "2"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  EXPECT_TRUE(Says(ErrorOf([&] { sim.robot("robbot"); }), "robot1, robot2"));
  EXPECT_TRUE(Says(ErrorOf([&] { sim.call("/robot1/pose", "set_velocity"); }), "get_pose"));
  EXPECT_EQ(ErrorOf([&] { robot.sense("blue"); }).code(), 10);
  EXPECT_EQ(ErrorOf([&] { robot.set_velocity(NAN, 0); }).code(), 4);
  sim.close();
  EXPECT_TRUE(Says(ErrorOf([&] { sim.step(); }), "closed"));
}

TEST(Stepping, WatchingClaimsNothing) {
  const auto daemon = ServerProcess::Fake({});
  auto watch = connect(daemon.server(), {.watch = true});
  auto seen = watch.robot(1);
  watch.step();
  EXPECT_EQ(seen.sense().distances.size(), 11u);
  EXPECT_EQ(ErrorOf([&] { seen.set_velocity(0, 0); }).code(), 5);
  auto other = connect(daemon.server(), {.name = "ben"});
  EXPECT_EQ(ErrorOf([&] { other.robot(1); }).code(), 0);
}

TEST(WrongNames, AreError10WithTheHintOfTheDaemon) {
  const auto daemon = ServerProcess::Real("classroom", {});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  for (const auto& [error, hint] : std::vector<std::pair<Error, std::string>>{
           {ErrorOf([&] { sim.describe("/robot9/motors"); }), "did you mean /robot1/motors"},
           {ErrorOf([&] { sim.call("/robot1/moters", "stop"); }), "did you mean /robot1/motors"},
           {ErrorOf([&] { robot.subscribe("distanc"); }), "did you mean /robot1/distance"},
           {ErrorOf([&] { sim.robot("robot9"); }), "there are: robot1"}}) {
    EXPECT_EQ(error.code(), 10) << error.text();
    EXPECT_EQ(error.name(), "no_such_name");
    EXPECT_TRUE(Says(error, hint)) << error.text();
  }
  robot.set_velocity(0.1, 0);  // the sim stays usable
  sim.step(1, 60);
}

TEST(Waiting, NextWithNobodySteppingSaysOnceWhomFor) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  auto robot = connect(daemon.server()).robot(1);
  robot.subscribe("pose");
  testing::internal::CaptureStderr();
  const Error error = ErrorOf([&] { robot.next("pose", 2.5); });
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(error.code(), 11);
  EXPECT_TRUE(Says(error, "robot2 (no client)")) << error.text();
  EXPECT_EQ(said.find("coopdyn: waiting for robot1"), 0u) << said;
  EXPECT_EQ(said.rfind("coopdyn: "), 0u) << said;
}

TEST(Waiting, OfManyRobotsFourAreNamed) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  const Error error = ErrorOf([&] { sim.step(1, 0.2); });
  EXPECT_EQ(error.code(), 11);
  EXPECT_TRUE(Says(error, " s and 1 more")) << error.text();
  EXPECT_FALSE(Says(error, "robot5")) << error.text();
}

TEST(Connecting, TheModulesOfSomethingElseAreAnError) {
  const auto other = ServerProcess::Fake({"--says", "220 ftp"});
  const Error error = ErrorOf([&] { Address(other.server(), "", "", 3).Modules(); });
  EXPECT_EQ(error.code(), Error::kNoConnection);
  EXPECT_TRUE(Says(error, "not a coopdyn daemon (it said '220 ftp')")) << error.text();
}

TEST(Stepping, AModeSwitchedBySomebodyElseNeitherHangsNorSpins) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "realtime"});
  auto sim = connect(daemon.server());
  auto teacher = connect(daemon.server(), {.name = "teacher"});
  auto robot = sim.robot(1);
  for (const std::string mode : {"lockstep", "realtime", "free", "lockstep"}) {
    teacher.set_mode(mode);
    std::int64_t last = -1;
    for (int k = 0; k < 4; ++k) {
      robot.set_velocity(0.1, 0);
      sim.step(1, 60);
      EXPECT_GT(sim.steps(), last);
      last = sim.steps();
    }
    EXPECT_EQ(sim.mode(), mode);
  }
}

TEST(Stepping, FiveRobotsDoNotDeadlockAndRepeatThemselves) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  std::vector<Robot> robots;
  for (int i = 1; i <= 5; ++i) robots.push_back(sim.robot(i));
  std::vector<std::string> hashes;
  for (int run = 0; run < 2; ++run) {
    sim.reset(7);
    for (int k = 0; k < 60; ++k) {
      for (Robot& r : robots) r.set_velocity(0.2, r.get_target("red").bearing);
      sim.step(1, 60);
    }
    EXPECT_EQ(sim.steps(), 60);
    hashes.push_back(sim.hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

constexpr const char* kLaunched =
    "[SIMULATION]\nmode lockstep\n[ROBOT_1]\ntype coopbot\nname ana\nposition 0 0\n";

TEST(Launch, ADaemonOfOnesOwnTakesATextAndSettings) {
  LaunchOptions options;
  options.set = {{"ROBOT_1.position", "1 2"}, {"SCORE_1.kind", "distance"}};
  options.seed = 7;
  options.options = {"--no-http"};
  auto sim = launch(kLaunched, options);
  auto robot = sim.robot("ana");
  EXPECT_EQ(robot.get_pose().x, 1);
  EXPECT_EQ(sim.scores(), (std::map<std::string, double>{{"distance", 0}}));
  robot.set_velocity(0.2, 0);
  sim.step(10);
  EXPECT_EQ(sim.steps(), 10);
}

TEST(Launch, ItEndsWithCloseAndWithTheSim) {
  const auto children = [] {  // running or not waited for
    return ::waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD ? 0 : 1;
  };
  auto sim = launch(kLaunched);
  EXPECT_EQ(children(), 1);
  sim.close();
  EXPECT_EQ(children(), 0);
  { const auto other = launch(kLaunched); }
  EXPECT_EQ(children(), 0);
}

TEST(Launch, WhatIsWrongIsTold) {
  const auto said = [](const std::string& scenario, const std::string& program = "") {
    LaunchOptions options;
    options.program = program;
    try {
      launch(scenario, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(said("[ROBOT_1]\ntype cooopbot\nposition 0 0\n").find("did you mean 'coopbot'?"),
            std::string::npos);
  EXPECT_NE(said("clasroom").find("there is no such scenario"), std::string::npos);
  EXPECT_NE(said("classroom", "/nowhere/coopdyn").find("/nowhere/coopdyn cannot be started"),
            std::string::npos);
}

TEST(Everything, EveryCallWorks) {
  const auto daemon = ServerProcess::Real(
      "formation",
      {"--mode", "realtime", "--set", "SCORE_1.kind=distance", "--set", "SCORE_2.kind=collisions"});
  auto sim = connect(daemon.server());
  auto r = sim.robot("/robot1");
  EXPECT_EQ(sim.mode(), "realtime");
  EXPECT_EQ(sim.dt(), 0.01);
  EXPECT_EQ(sim.robots().size(), 5u);
  r.set_velocity(0.2, 0.1);
  const std::int64_t first = sim.steps();
  sim.step(2);
  EXPECT_GE(sim.steps(), first + 2);
  r.set_wheel_speeds(1, 1);
  sim.pause();
  EXPECT_EQ(sim.status()["state"].text(), "paused");
  const Reading s = r.sense("red");
  EXPECT_EQ(s.distances, r.get_distances());
  EXPECT_EQ(s.target->distance, r.get_target("red").distance);
  EXPECT_EQ(s.pose->x, r.get_pose().x);
  EXPECT_EQ(s.wheels->left_speed, r.get_wheels().left_speed);
  sim.run();
  r.stop();
  EXPECT_EQ(r.get_geometry().bearing.size(), 11u);
  EXPECT_EQ(r.get_targets().at(0).colour, "red");
  EXPECT_GT(r.get_target(1).distance, 0);
  EXPECT_EQ(r.get_robots().at(0).name, "robot2");
  EXPECT_GT(r.get_limits().track, 0.1);
  EXPECT_NEAR(std::hypot(r.get_pose_3d().qw, r.get_pose_3d().qz), 1, 0.01);
  r.subscribe("pose", 2);
  const Update u = r.next("", 60), v = r.next("pose", 60);
  EXPECT_EQ(v.step - u.step, 2);
  EXPECT_EQ(v.value.size(), 5u);
  sim.set_speed(2);
  sim.set_step(0.02);
  EXPECT_EQ(sim.dt(), 0.02);
  sim.stop_all();
  sim.set_mode("lockstep");
  sim.set_participants({"robot1"});
  EXPECT_EQ(sim.waiting().at(0).robot, "robot1");
  sim.step(1, 60);
  sim.reset();
  EXPECT_EQ(sim.status()["step"].number(), 0);
  EXPECT_EQ(sim.hash().size(), 16u);
  EXPECT_EQ(sim.scores(), (std::map<std::string, double>{{"distance", 0}, {"collisions", 0}}));
  sim.reload();
  EXPECT_EQ(sim.describe("/robot1/motors")["protocol"].number(), 1);
  EXPECT_GE(sim.modules().size(), 21u);
  EXPECT_EQ(sim.call("/robot1/pose", "ping", {1}, {2.5}).data, std::vector<double>{2.5});
  EXPECT_EQ(r.call("motors", "get_limits").data.size(), 3u);
  const std::string file = testing::TempDir() + "client_snapshot.png";
  sim.snapshot(file, {.w = 160, .h = 120, .eye = {0, -5, 4}, .look = {0, 0, 0}});
  std::string head(4, ' ');
  std::ifstream(file, std::ios::binary).read(head.data(), 4);
  EXPECT_EQ(head, "\x89PNG");
  std::filesystem::remove(file);
  sim.load_scenario("classroom");
  EXPECT_EQ(sim.robots(), std::vector<std::string>{"robot1"});
  EXPECT_TRUE(doctor(daemon.server()));
}

TEST(Programs, HelloReachesTheTargetInLockstep) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "lockstep"});
  EXPECT_EQ(RunProgram(CLIENT_HELLO, daemon.server()), 0);
  EXPECT_LT(connect(daemon.server(), {.watch = true}).robot(1).get_target("red").distance, 0.45);
}

/// Runs a program in real time on an open floor. 1 if robot1 has passed the target; its later position
/// depends on the machine.
double ReachedInRealTime(const std::string& program, const std::string& arguments = "") {
  const auto daemon =
      ServerProcess::Real("classroom", {"--mode", "realtime", "--speed", "2", "--set", "SCORE_1.kind=reach",
                                        "--set", "SCORE_1.target=red", "--set", "SCORE_1.within=0.41"});
  EXPECT_EQ(RunProgram(program, daemon.server(), arguments), 0);
  return connect(daemon.server(), {.watch = true}).scores().at("reach");
}

TEST(Programs, HelloReachesTheTargetInRealTime) {
  EXPECT_EQ(ReachedInRealTime(CLIENT_HELLO), 1);
}

TEST(Programs, AttractorReachesTheTargetInLockstep) {
  const auto daemon = ServerProcess::Real("box_maze", {"--mode", "lockstep"});
  EXPECT_EQ(RunProgram(CLIENT_ATTRACTOR, daemon.server()), 0);
}

TEST(Programs, TransportCarriesBothBarsInLockstep) {
  const auto daemon = ServerProcess::Real("transport", {"--mode", "lockstep"});
  EXPECT_EQ(RunProgram(CLIENT_TRANSPORT, daemon.server()), 0);
}

TEST(Programs, FormationReachesTheTargetInLockstep) {
  for (const char* scenario : {"formation", "triangle"}) {
    const auto daemon = ServerProcess::Real(scenario, {"--mode", "lockstep"});
    EXPECT_EQ(RunProgram(CLIENT_FORMATION, daemon.server()), 0) << scenario;
  }
}

TEST(Programs, AttractorReachesTheTargetInRealTime) {
  EXPECT_EQ(ReachedInRealTime(CLIENT_ATTRACTOR, "robot1"), 1);
}

}  // namespace
}  // namespace coopdyn::client
