// SPDX-License-Identifier: MIT
// The child never outlives the daemon, whatever it is doing.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "tests/server/controllers/plugins/deeds.h"
#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

/// Forks a process that runs controllers, reports the child's pid and continues to step; kills the process,
/// and waits for the child's end. False: the child still exists after a long time.
bool ChildEndsWithItsParent(int deed) {
  std::array<int, 2> pipe_fds{};
  if (pipe(pipe_fds.data()) != 0) return false;
  const pid_t parent = fork();
  if (parent == 0) {
    ControllerOptions options = TestOptions();
    options.deadline = 0;  // none
    Driven driven(Swarm().Add(TestPlugin("hostile"), {{"deed", deed}, {"at", 0}}), options);
    driven.Start();
    const pid_t child = driven.host().child_pid();
    if (write(pipe_fds[1], &child, sizeof(child)) != sizeof(child)) _exit(1);
    driven.Steps(1);  // with kSpin it does not return
    for (;;) pause();
  }
  pid_t child = -1;
  EXPECT_EQ(read(pipe_fds[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
  const int watched = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  EXPECT_GE(watched, 0) << "it is gone before its parent";
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd poll_for{watched, POLLIN, 0};
  constexpr int kLong_ms = 60'000;
  const bool ended = poll(&poll_for, 1, kLong_ms) == 1;
  if (!ended) kill(child, SIGKILL);
  close(watched);
  close(pipe_fds[0]);
  close(pipe_fds[1]);
  return ended;
}

TEST(OrphanTest, AnIdleChildEndsWithItsParent) {
  EXPECT_TRUE(ChildEndsWithItsParent(kNone));
}

TEST(OrphanTest, AChildThatHangsEndsWithItsParent) {
  EXPECT_TRUE(ChildEndsWithItsParent(kSpin));
}

}  // namespace
}  // namespace coopdyn
