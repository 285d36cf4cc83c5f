// SPDX-License-Identifier: MIT
#include "server/host/crowd.h"

#include <gtest/gtest.h>

#include <vector>

namespace coopdyn {
namespace {

TEST(Crowd, WhenItIsFullTheOldestLeavesOfWhoHasTheMost) {
  Crowd crowd(4, 4);
  std::vector<std::string> left;
  const auto come = [&](const std::string& who, const std::string& which) {
    return crowd.Enter(who, [&left, which] { left.push_back(which); });
  };
  come("ana", "ana 1");
  for (const char* which : {"bad 1", "bad 2", "bad 3"}) come("bad", which);
  come("ben", "ben 1");
  come("bad", "bad 4");
  EXPECT_EQ(left, (std::vector<std::string>{"bad 1", "bad 2"}));
  EXPECT_EQ(crowd.size(), 4);
}

TEST(Crowd, OneNameHasItsShareAlsoWhileThereIsRoom) {
  Crowd crowd(100, 2);
  int left = 0;
  for (int i = 0; i < 5; ++i) crowd.Enter("ana", [&left] { ++left; });
  EXPECT_EQ(left, 3);
  EXPECT_EQ(crowd.size(), 2);
}

TEST(Crowd, WhoHasLeftDoesNotCount) {
  Crowd crowd(2, 2);
  int left = 0;
  for (int i = 0; i < 10; ++i) crowd.Leave(crowd.Enter("ana", [&left] { ++left; }));
  const Crowd::Ticket last = crowd.Enter("ana", [&left] { ++left; });
  EXPECT_EQ(left, 0);
  EXPECT_TRUE(crowd.contains(last));
  crowd.Clear();
  EXPECT_EQ(left, 1);
  EXPECT_FALSE(crowd.contains(last));
  crowd.Leave(last);
  EXPECT_EQ(crowd.size(), 0);
}

}  // namespace
}  // namespace coopdyn
