// SPDX-License-Identifier: MIT
// The template process from which controllers' processes are copied.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

/// The parent of a process; 0: there is no such process.
pid_t ParentOf(pid_t pid) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(stream, text);
  const std::size_t at = text.rfind(')');  // after the name
  return at == std::string::npos ? 0 : std::stoi(text.substr(at + 4));
}

Swarm Two() {
  Swarm swarm;
  return swarm.Add(Sample("diffuse")).Add(Sample("flock"));
}

TEST(LauncherTest, ResetsCopyOneTemplate) {
  Driven driven(Two());
  driven.Start();
  const pid_t first = driven.host().child_pid(), parent = ParentOf(first);
  EXPECT_EQ(ParentOf(parent), getpid());
  driven.Start();
  EXPECT_NE(driven.host().child_pid(), first);
  EXPECT_EQ(ParentOf(driven.host().child_pid()), parent);
  while (ParentOf(first) != 0) std::this_thread::yield();  // a reset does not wait for the process's end
}

TEST(LauncherTest, WithoutItsTemplateTheRunGoesOnAndAResetMakesANewOne) {
  Driven driven(Two()), untouched(Two());
  driven.Start();
  untouched.Start();
  const pid_t parent = ParentOf(driven.host().child_pid());
  kill(parent, SIGKILL);
  EXPECT_EQ(driven.Steps(10).setpoints, untouched.Steps(10).setpoints);
  driven.Start();
  untouched.Start();
  EXPECT_EQ(driven.Steps(10).setpoints, untouched.Steps(10).setpoints);
  EXPECT_NE(ParentOf(driven.host().child_pid()), parent);
  EXPECT_TRUE(driven.run().stopped.empty());
}

TEST(LauncherTest, WithoutBothTheControllersGoOnFromWhereTheyWere) {
  Driven driven(Two()), untouched(Two());
  driven.Start();
  untouched.Start();
  driven.Steps(3);
  const pid_t child = driven.host().child_pid();
  kill(ParentOf(child), SIGKILL);
  kill(child, SIGKILL);
  driven.Steps(5);
  untouched.Steps(8);
  EXPECT_EQ(driven.run().setpoints, untouched.run().setpoints);
  EXPECT_TRUE(driven.run().stopped.empty());
}

TEST(LauncherTest, TheTemplateEndsWithItsHost) {
  pid_t parent = 0;
  {
    Driven driven(Two());
    driven.Start();
    parent = ParentOf(driven.host().child_pid());
    ASSERT_GT(parent, 0);
  }
  EXPECT_EQ(ParentOf(parent), 0);
}

}  // namespace
}  // namespace coopdyn
