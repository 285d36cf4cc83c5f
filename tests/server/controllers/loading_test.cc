// SPDX-License-Identifier: MIT
// Shared objects that are no controllers: their robots stop with a clear text, the others drive.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

struct LoadingCase {
  const char* plugin;
  const char* why;  // part of the text
};

class LoadingTest : public testing::TestWithParam<LoadingCase> {};

TEST_P(LoadingTest, ItsRobotsStopAndTheOthersDrive) {
  Swarm swarm;
  swarm.Add(TestPlugin(GetParam().plugin)).Add(Sample("diffuse")).Add(TestPlugin(GetParam().plugin));
  ControllerOptions options = TestOptions();
  options.deadline = kNanosecondsPerSecond;
  Driven driven(swarm, options);
  driven.Start();
  driven.Steps(3);
  ASSERT_EQ(driven.run().stopped.size(), 2u);
  EXPECT_EQ(driven.run().stopped[0].robot, "robot1");
  EXPECT_EQ(driven.run().stopped[1].robot, "robot3");
  EXPECT_THAT(driven.run().stopped[0].why, HasSubstr(std::string("controller ") + GetParam().plugin + " "));
  EXPECT_THAT(driven.run().stopped[0].why, HasSubstr(GetParam().why));
  EXPECT_EQ(driven.run().setpoints[2][0], WheelSpeeds{});
  EXPECT_NE(driven.run().setpoints[2][1], WheelSpeeds{});
}

INSTANTIATE_TEST_SUITE_P(
    Plugins, LoadingTest,
    testing::Values(
        LoadingCase{"wrong_version", "built for version 77 of controller.h, this daemon has version 5"},
        LoadingCase{"no_entry", "does not export coopdyn_controller_entry()"},
        LoadingCase{"no_description", "describe() returned NULL"},
        LoadingCase{"huge_description", "state_size in describe() is 4000000000: at most 65536 bytes"},
        LoadingCase{"wild_description", "crashed (segmentation fault"},
        LoadingCase{"no_functions", "its function step is NULL"},
        LoadingCase{"crash_on_load", "while it was loaded"},
        LoadingCase{"hang_on_load", "did not return within 1 s while it was loaded"},
        LoadingCase{"throw_on_describe", "threw an exception (speechless)"},
        LoadingCase{"not_there", "cannot be loaded"}));

/// The reason why `controller` does not drive the only robot; empty if it does.
std::string WhyItStands(const std::string& controller, const ControllerOptions& options = TestOptions()) {
  Driven driven(Swarm().Add(controller), options);
  driven.Start();
  EXPECT_EQ(driven.run().stopped.size(), 1u);
  return driven.run().stopped.empty() ? "" : driven.run().stopped[0].why;
}

TEST(LoadingTest, ATextIsNoSharedObject) {
  const std::string file = testing::TempDir() + "text_controller_" + std::to_string(getpid()) + ".so";
  std::ofstream(file) << "forward 0.1\n";
  EXPECT_THAT(WhyItStands(file), HasSubstr("cannot be loaded"));
  std::remove(file.c_str());
}

TEST(LoadingTest, AProgramThatIsNotThereIsSaid) {
  ControllerOptions options = TestOptions();
  options.program = "/nowhere/coopdyn";
  EXPECT_THAT(WhyItStands(Sample("diffuse"), options), HasSubstr("/nowhere/coopdyn: No such file"));
}

TEST(LoadingTest, AProgramThatIsNoChildIsGivenUp) {
  ControllerOptions options = TestOptions();
  options.program = "/bin/false";
  EXPECT_THAT(WhyItStands(Sample("diffuse"), options),
              HasSubstr("could not run: its process cannot be started: /bin/false called exit(1)"));
}

TEST(LoadingTest, AProcessOfControllersStartsNoOther) {
  setenv("COOPDYN_CONTROLLER_CHILD", "1", 1);
  const std::string why = WhyItStands(Sample("diffuse"));
  unsetenv("COOPDYN_CONTROLLER_CHILD");
  EXPECT_THAT(why, HasSubstr("may not start another"));
}

TEST(LoadingTest, AControllerChangedOnDiskIsNotMixedWithTheOldOne) {
  const std::string file = testing::TempDir() + "changing_" + std::to_string(getpid()) + ".so";
  const auto copy = [&file](const std::string& from) {
    std::remove(file.c_str());  // the loaded object stays
    std::ofstream(file, std::ios::binary) << std::ifstream(from, std::ios::binary).rdbuf();
  };
  copy(Sample("diffuse"));
  Driven driven(Swarm().Add(file).Add(Sample("braitenberg")));
  driven.Start();
  driven.Steps(3);
  copy(Sample("flock"));
  kill(driven.host().child_pid(), SIGKILL);
  driven.Steps(3);
  ASSERT_EQ(driven.run().stopped.size(), 1u);
  EXPECT_THAT(driven.run().stopped[0].why, HasSubstr("was changed on disk"));
  EXPECT_NE(driven.run().setpoints[5][1], WheelSpeeds{});
  driven.Start();  // a reset loads the new one
  driven.Steps(1);
  EXPECT_FALSE(driven.run().messages.empty());
  std::remove(file.c_str());
}

}  // namespace
}  // namespace coopdyn
