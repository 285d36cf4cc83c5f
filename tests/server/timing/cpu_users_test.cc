// SPDX-License-Identifier: MIT
#include "server/timing/overload_watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "tests/server/timing/milliseconds.h"

namespace coopdyn {
namespace {

constexpr Nanoseconds kTick = 10 * kMs;

TEST(CpuUsers, AStatFileHasIdNameAndCpuTime) {
  const auto user = ParseProcessStat(
      "4711 (python3) S 1 4711 4711 0 -1 4194304 900 0 0 0 250 50 7 8 20 0 1 0 1000 1 2\n", kTick);
  ASSERT_TRUE(user);
  EXPECT_EQ(user->id, 4711);
  EXPECT_EQ(user->name, "python3");
  EXPECT_EQ(user->cpu, 3000 * kMs);
}

TEST(CpuUsers, NamesMayHaveAnythingInThem) {
  const auto user = ParseProcessStat("12 (a) b (\x1b[31m) R 1 1 1 0 -1 0 0 0 0 0 1 2 0 0 20\n", kTick);
  ASSERT_TRUE(user);
  EXPECT_EQ(user->name, "a) b (?[31m");
  EXPECT_EQ(user->cpu, 30 * kMs);
}

TEST(CpuUsers, WhatIsNoStatFileIsNobody) {
  for (const char* text : {"", "4711", "4711 (python3", ") 12 (", "x (y) S 1"}) {
    EXPECT_FALSE(ParseProcessStat(text, kTick)) << text;
  }
}

TEST(CpuUsers, CoresAreBusyWithAllButIdlingAndWaiting) {
  EXPECT_EQ(ParseBusyTime("cpu  100 20 30 9999 888 4 5 6 0 0\ncpu0 1 2 3\n", kTick), 1650 * kMs);
  EXPECT_EQ(ParseBusyTime("", kTick), 0);
  EXPECT_EQ(ParseBusyTime("intr 1 2", kTick), 0);
}

TEST(CpuUsers, SharesAreByNameMostFirst) {
  const std::vector<CpuUser> before{{1, "python3", 100 * kMs}, {2, "firefox", 0}, {3, "sh", 500 * kMs}};
  const std::vector<CpuUser> after{
      {1, "python3", 600 * kMs}, {2, "firefox", 300 * kMs}, {3, "sh", 500 * kMs}, {4, "python3", 250 * kMs}};
  const std::vector<CpuShare> shares = SharesOf(before, after, 1000 * kMs);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_EQ(shares[0].name, "python3");
  EXPECT_EQ(shares[0].count, 2);
  EXPECT_DOUBLE_EQ(shares[0].cores, 0.75);
  EXPECT_EQ(shares[1].name, "firefox");
}

TEST(CpuUsers, ProcFindsThisProcessOnlyByItsThreads) {
  const CpuUse use = ReadCpuUse();
  const auto is = [](std::int64_t id) { return [id](const CpuUser& user) { return user.id == id; }; };
  EXPECT_TRUE(std::any_of(use.threads.begin(), use.threads.end(), is(::getpid())));
  EXPECT_FALSE(std::any_of(use.others.begin(), use.others.end(), is(::getpid())));
  EXPECT_GT(use.busy, 0);
}

}  // namespace
}  // namespace coopdyn
