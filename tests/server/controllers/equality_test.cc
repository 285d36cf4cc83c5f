// SPDX-License-Identifier: MIT
// The child and in-process controllers give the same commands, for any number of threads.
#include <gtest/gtest.h>

#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

/// All samples together, and a robot driven by clients.
Swarm MixedSwarm(int robots) {
  const std::vector<std::string> samples = {"diffuse", "braitenberg", "aggregate", "flock", "attractor"};
  Swarm swarm;
  swarm.Add("").Mark(3, 1);
  for (int i = 0; i < robots; ++i) swarm.Add(Sample(samples[static_cast<std::size_t>(i) % samples.size()]));
  return swarm.Add(TestPlugin("setpoints"));
}

void ExpectSame(const Record& one, const Record& other) {
  EXPECT_TRUE(one.setpoints == other.setpoints);
  ASSERT_EQ(one.messages.size(), other.messages.size());
  for (std::size_t i = 0; i < one.messages.size(); ++i) {
    EXPECT_EQ(one.messages[i].robot, other.messages[i].robot);
    EXPECT_EQ(one.messages[i].step, other.messages[i].step);
    EXPECT_EQ(one.messages[i].message.count, other.messages[i].message.count);
    EXPECT_EQ(one.messages[i].message.values, other.messages[i].message.values);
  }
}

Record RunMixed(bool in_process, int threads, std::uint64_t seed = 1) {
  Driven driven(MixedSwarm(99), TestOptions(in_process, threads));
  driven.Start(seed);
  EXPECT_TRUE(driven.run().stopped.empty());
  return driven.Steps(60);
}

TEST(ControllerEqualityTest, ChildAndInProcessGiveTheSameCommands) {
  const Record in_process = RunMixed(true, 1);
  EXPECT_FALSE(in_process.messages.empty());
  ExpectSame(RunMixed(false, 1), in_process);
}

TEST(ControllerEqualityTest, ThreadsDoNotMatter) {
  const Record one = RunMixed(false, 1);
  ExpectSame(RunMixed(false, 2), one);
  ExpectSame(RunMixed(false, 4), one);
  ExpectSame(RunMixed(true, 4), one);
}

TEST(ControllerEqualityTest, TheSeedMatters) {
  EXPECT_NE(RunMixed(true, 1, 1).setpoints, RunMixed(true, 1, 2).setpoints);
}

TEST(ControllerEqualityTest, ConfigureStartsAfresh) {
  Driven driven(MixedSwarm(20));
  driven.Start(5);
  const Record first = driven.Steps(30);
  driven.Start(5);
  const Record both = driven.Steps(30);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(both.setpoints[i], both.setpoints[30 + i]);
}

TEST(ControllerEqualityTest, ARobotWithoutControllerKeepsItsSetPoint) {
  for (const auto& setpoints : RunMixed(false, 1).setpoints)
    EXPECT_EQ(setpoints[0], (WheelSpeeds{0.25, 0.5}));
}

}  // namespace
}  // namespace coopdyn
