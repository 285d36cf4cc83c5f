// SPDX-License-Identifier: MIT
// The messages to a program when another client resets the world or loads a scenario, and when it never
// steps.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

constexpr const char* kReset = "the world was reset: run your program again, or catch this to start over";

/// The text of the WorldReset of a call, or its other result.
std::string ResetOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const WorldReset& e) {
    EXPECT_EQ(e.code(), 5);
    EXPECT_EQ(e.name(), "reset");
    return e.text();
  } catch (const Error& e) {
    return "another error: " + e.text();
  }
  return "no error";
}

void DriveSteps(Simulation& sim, Robot& robot, int steps) {
  for (int k = 0; k < steps; ++k) {
    robot.set_velocity(0.1, 0);
    sim.step(1, 60);
  }
}

TEST(WorldReset, BetweenTwoStepsIsToldOnceByTheNextStep) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto robot = sim.robot(1);
  DriveSteps(sim, robot, 3);
  other.reset();
  EXPECT_EQ(ResetOf([&] { DriveSteps(sim, robot, 1); }), kReset);
  DriveSteps(sim, robot, 3);
  EXPECT_EQ(robot.get_pose().forward, 0.1);
}

TEST(WorldReset, IsToldByEveryReading) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto robot = sim.robot(1);
  robot.sense();
  for (const std::function<void()>& reading : std::vector<std::function<void()>>{
           [&] { robot.get_pose(); }, [&] { robot.get_wheels(); }, [&] { robot.sense(), robot.sense(); }}) {
    DriveSteps(sim, robot, 3);
    other.reset();
    robot.set_velocity(0.5, 0);
    EXPECT_EQ(ResetOf(reading), kReset);
    sim.step(1, 60);  // without the old command
    EXPECT_EQ(robot.get_pose().forward, 0);
  }
}

TEST(WorldReset, IsToldByACommandInRealTime) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "realtime"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto robot = sim.robot(1);
  DriveSteps(sim, robot, 5);
  other.pause();
  other.reset();
  EXPECT_EQ(ResetOf([&] { robot.set_velocity(0.1, 0); }), kReset);
  robot.set_velocity(0.1, 0);
  other.run();
  DriveSteps(sim, robot, 2);
}

TEST(WorldReset, IsToldToATeam) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep", "--robots", "2"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto team = sim.team();
  const std::vector<double> v = {0.1, 0};
  for (const bool reads : {false, true}) {
    for (int k = 0; k < 3; ++k) team.step(v, 60);
    other.reset();
    EXPECT_EQ(ResetOf([&] { reads ? team.read() : team.step(v, 60); }), kReset);
  }
  EXPECT_EQ(team.step(v, 60).step, 1);
}

TEST(WorldReset, OfOurOwnIsNoErrorNorIsOneForWhoOnlyWatches) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server()), watch = connect(daemon.server(), {.watch = true});
  auto robot = sim.robot(1), seen = watch.robot(1);
  for (const std::function<void()>& anew :
       std::vector<std::function<void()>>{[&] { sim.reset(); }, [&] { sim.reset(7); }, [&] { sim.reload(); },
                                          [&] { sim.call("/simulation", "reset"); }}) {
    DriveSteps(sim, robot, 3);
    EXPECT_GT(seen.get_pose().x, 0);
    anew();
    EXPECT_EQ(robot.get_pose().x, 0);
    EXPECT_EQ(seen.get_pose().x, 0);
  }
}

TEST(WorldReset, AStepThatWaitsIsEndedByItAndByALoad) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  for (const bool loads : {false, true}) {
    auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
    sim.robot("robot1");
    std::thread somebody([&] {
      while (other.waiting().empty() || other.waiting()[0].robot == "robot1") {
      }
      if (loads) {
        other.load_scenario("classroom");
      } else {
        other.reset();
      }
    });
    const std::string said = ResetOf([&] { sim.step(1, 60); });
    somebody.join();
    EXPECT_EQ(said, loads
                        ? "scenario classroom was loaded: run your program again, or catch this to start over"
                        : kReset);
  }
}

TEST(WorldReset, BetweenTwoStepsIsToldWhileTheNextStepWaitsForOthers) {
  const auto daemon = ServerProcess::Real("classroom", {"--mode", "lockstep"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto robot = sim.robot("robot1");
  DriveSteps(sim, robot, 2);
  other.load_scenario("formation");
  EXPECT_EQ(ResetOf([&] { DriveSteps(sim, robot, 1); }),
            "scenario formation was loaded: run your program again, or catch this to start over");
}

TEST(WorldReset, ALoadWithoutTheRobotSaysWhichIsMissing) {
  const auto daemon = ServerProcess::Real("formation", {"--mode", "lockstep"});
  auto sim = connect(daemon.server()), other = connect(daemon.server(), {.name = "other"});
  auto first = sim.robot("robot1"), second = sim.robot("robot2");
  sim.set_participants({"robot1", "robot2"});
  second.get_pose();
  sim.step(1, 60);
  other.load_scenario("classroom");
  EXPECT_EQ(ResetOf([&] { second.get_pose(); }),
            "scenario classroom was loaded, which has no robot2; there are: robot1. Run your program again "
            "with these");
  for (const std::function<void()>& call : std::vector<std::function<void()>>{
           [&] { second.get_pose(); }, [&] { second.sense(); }, [&] { second.set_velocity(0, 0); }}) {
    const Error error = ErrorOf(call);
    EXPECT_EQ(error.code(), 10) << error.text();
    EXPECT_TRUE(Says(error, "the scenario that was loaded has no robot2; there are: robot1")) << error.text();
  }
  DriveSteps(sim, first, 2);
}

TEST(Unstepped, ALoopThatNeverStepsIsToldSoOnce) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  testing::internal::CaptureStderr();
  for (int k = 0; k < 1000; ++k) robot.set_velocity(0.1, 0);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "coopdyn: 200 commands to robot1 without a step, nothing moves: write sim.step() at the end of "
            "your loop\n");
}

TEST(Unstepped, ALoopThatStepsIsNot) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  testing::internal::CaptureStderr();
  for (int k = 0; k < 500; ++k) {
    robot.set_velocity(0.1, 0);
    if (k % 100 == 99) sim.step(1, 60);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Arguments, TwoSpeedsMayBeOneRow) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  auto robot = sim.robot(1);
  robot.set_velocity({0.2, 0.5});
  sim.step(1, 60);
  EXPECT_EQ(robot.get_pose().forward, 0.2);
  EXPECT_EQ(robot.get_pose().turn, 0.5);
  const std::vector<double> wheels = {2, 2};
  robot.set_wheel_speeds(wheels);
  sim.step(1, 60);
  EXPECT_NEAR(robot.get_pose().forward, 0.15, 1e-12);
  EXPECT_TRUE(Says(ErrorOf([&] { robot.set_velocity({0.2}); }), "write r.set_velocity(0.2, 0.5)"));
  EXPECT_TRUE(Says(ErrorOf([&] { robot.set_wheel_speeds({1, 2, 3}); }), "write r.set_wheel_speeds(2, 3)"));
}

TEST(Arguments, APortAloneIsOneOfThisMachine) {
  const auto daemon = ServerProcess::Fake({});
  const std::string port = daemon.server().substr(daemon.server().find(':') + 1);
  EXPECT_EQ(connect(port).robots().size(), 1u);
  EXPECT_TRUE(Says(ErrorOf([&] { connect("70000"); }), "a port of this machine"));
}

}  // namespace
}  // namespace coopdyn::client
