// SPDX-License-Identifier: MIT
#include "server/controllers/same_core.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <thread>

namespace coopdyn {
namespace {

/// The cores allowed for a thread or process `id`.
cpu_set_t CoresOf(pid_t id) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  EXPECT_EQ(sched_getaffinity(id, sizeof(cores), &cores), 0);
  return cores;
}

bool Same(const cpu_set_t& a, const cpu_set_t& b) {
  return CPU_EQUAL(&a, &b);
}

constexpr Nanoseconds kMs = 1'000'000;

class SameCoreTest : public ::testing::Test {
 protected:
  SameCoreTest() {
    if (other_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (;;) ::pause();
  }
  ~SameCoreTest() override {
    ::kill(other_, SIGKILL);
    ::waitpid(other_, nullptr, 0);
  }
  bool BothAreHeld() const {
    const cpu_set_t ours = CoresOf(0);
    return CPU_COUNT(&ours) == 1 && Same(ours, CoresOf(other_));
  }

  const cpu_set_t all_ = CoresOf(0);
  const pid_t other_ = ::fork();
};

TEST_F(SameCoreTest, ATurnHoldsBothOnOneCore) {
  SameCore core(other_);
  core.Take();
  EXPECT_TRUE(BothAreHeld());
}

TEST_F(SameCoreTest, TheOtherHasTheCallersPriority) {
  ::setpgid(other_, other_);
  std::thread([this] {
    const int urgent = getpriority(PRIO_PROCESS, 0) + 1;  // lower values need privileges
    ASSERT_EQ(setpriority(PRIO_PROCESS, 0, urgent), 0);
    SameCore core(other_);
    core.Take();
    EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(other_)), urgent);
  }).join();
}

TEST_F(SameCoreTest, ManyTurnsHoldBothOnOneCore) {
  SameCore core(other_);
  for (int turn = 0; turn < 1000; ++turn) {
    core.Take();
    ASSERT_TRUE(BothAreHeld()) << turn;
  }
}

TEST_F(SameCoreTest, TheCoreIsTakenAnewOnceInAWhileAndNotWithEachTurn) {
  SameCore core(other_);
  core.Take();
  sched_setaffinity(0, sizeof(all_), &all_);
  int turns = 1;
  for (; turns < 100 && !BothAreHeld(); ++turns) core.Take();
  EXPECT_EQ(turns, CPU_COUNT(&all_) == 1 ? 1 : 33);
}

TEST_F(SameCoreTest, AfterLeavingTheCallerMayGoWhereItCould) {
  SameCore core(other_);
  core.Take();
  core.Take();
  core.Leave();
  EXPECT_TRUE(Same(CoresOf(0), all_));
}

TEST_F(SameCoreTest, ItsEndIsLeaving) {
  {
    SameCore core(other_);
    core.Take();
  }
  EXPECT_TRUE(Same(CoresOf(0), all_));
}

TEST_F(SameCoreTest, FreeingLetsBothGo) {
  SameCore core(other_);
  core.Take();
  core.Free();
  EXPECT_TRUE(Same(CoresOf(0), all_));
  EXPECT_TRUE(Same(CoresOf(other_), all_));
  core.Take();
  EXPECT_TRUE(BothAreHeld());
}

TEST_F(SameCoreTest, WhenAnotherThreadTakesATurnTheFirstIsLetGo) {
  SameCore core(other_);
  core.Take();
  const pid_t first = ::gettid();
  std::thread([&] {
    sched_setaffinity(0, sizeof(all_), &all_);  // a thread inherits its creator's cores
    core.Take();
    EXPECT_TRUE(BothAreHeld());
    EXPECT_TRUE(Same(CoresOf(first), all_));
    core.Leave();
    EXPECT_TRUE(Same(CoresOf(0), all_));
  }).join();
}

TEST_F(SameCoreTest, TheyYieldTheCoreFromTheSecondTurnOn) {
  SameCore core(other_);
  core.Take();
  EXPECT_FALSE(core.Yields(0));
  for (int turn = 1; turn < 100; ++turn) {
    core.Take();
    EXPECT_TRUE(core.Yields(0)) << turn;
  }
}

TEST_F(SameCoreTest, AfterLeavingTheyDoNotYieldInTheFirstTurn) {
  SameCore core(other_);
  core.Take();
  core.Take();
  core.Leave();
  EXPECT_FALSE(core.Yields(0));
  core.Take();
  EXPECT_FALSE(core.Yields(0));
  core.Take();
  EXPECT_TRUE(core.Yields(0));
}

TEST_F(SameCoreTest, AShortTurnIsFollowedByMore) {
  SameCore core(other_);
  core.Take();
  core.Take();
  core.NoteTurn(1000 * kMs, 1000 * kMs + 900'000);
  EXPECT_TRUE(core.Yields(1001 * kMs));
}

TEST_F(SameCoreTest, ALongTurnIsFollowedByAPause) {
  SameCore core(other_);
  core.Take();
  core.Take();
  core.NoteTurn(1000 * kMs, 1004 * kMs);
  EXPECT_FALSE(core.Yields(1013 * kMs));
  EXPECT_TRUE(core.Yields(1014 * kMs));
}

TEST_F(SameCoreTest, ThePausesGrowToASecondWhereEachTurnIsLong) {
  SameCore core(other_);
  core.Take();
  core.Take();
  Nanoseconds now = 1000 * kMs;
  Nanoseconds pause = 0;
  for (int turn = 0; turn < 20; ++turn) {
    core.NoteTurn(now, now + 4 * kMs);
    const Nanoseconds from = now + 4 * kMs;
    for (now = from; !core.Yields(now);) now += kMs;
    EXPECT_GE(now - from, pause) << turn;
    pause = now - from;
  }
  EXPECT_EQ(pause, 1000 * kMs);
}

TEST_F(SameCoreTest, AfterManyShortTurnsAPauseIsShortAgain) {
  SameCore core(other_);
  core.Take();
  core.Take();
  core.NoteTurn(1000 * kMs, 1004 * kMs);
  core.NoteTurn(1014 * kMs, 1018 * kMs);
  EXPECT_FALSE(core.Yields(1037 * kMs));
  core.NoteTurn(2000 * kMs, 2004 * kMs);
  EXPECT_TRUE(core.Yields(2014 * kMs));
}

}  // namespace
}  // namespace coopdyn
