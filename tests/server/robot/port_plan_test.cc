// SPDX-License-Identifier: MIT
#include "server/robot/port_plan.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(PortPlanTest, PortsFollowOneAnother) {
  PortPlan plan(10002);
  EXPECT_EQ(plan.Take(), 10002);
  EXPECT_EQ(plan.Take(), 10003);
  EXPECT_EQ(plan.Take(), 10004);
}

TEST(PortPlanTest, LaterOnesGetTheLowestFreePort) {
  PortPlan plan(10002);
  for (int i = 0; i < 5; ++i) plan.Take();
  plan.Release(10005);
  plan.Release(10003);
  EXPECT_EQ(plan.Take(), 10003);
  EXPECT_EQ(plan.Take(), 10005);
  EXPECT_EQ(plan.Take(), 10007);
}

TEST(PortPlanTest, ReservedAndForeignPortsAreLeftOut) {
  PortPlan plan(10002, [](int port) { return port == 10003; });
  plan.Reserve(10002);
  plan.Reserve(0);
  EXPECT_EQ(plan.Take(), 10004);
}

TEST(PortPlanTest, ForeignPortIsTakenWhenItBecomesFree) {
  bool foreign = true;
  PortPlan plan(10002, [&](int port) { return foreign && port == 10002; });
  EXPECT_EQ(plan.Take(), 10003);
  foreign = false;
  EXPECT_EQ(plan.Take(), 10002);
}

TEST(PortPlanTest, ZeroMeansAnyFreePort) {
  PortPlan plan(0);
  EXPECT_TRUE(plan.any_port());
  EXPECT_EQ(plan.Take(), 0);
  EXPECT_EQ(plan.Take(), 0);
}

TEST(PortPlanTest, AnyFreePortsFollowTheOneThatTheSystemChose) {
  PortPlan plan(0, [](int port) { return port == 40002; });
  EXPECT_EQ(plan.Take(), 0);
  plan.NoteAny(40000);
  EXPECT_EQ(plan.Take(), 40001);
  EXPECT_EQ(plan.Take(), 40003);
  plan.NoteAny(65534);
  EXPECT_EQ(plan.Take(), 65535);
  EXPECT_EQ(plan.Take(), 0) << "it chooses again";
}

TEST(PortPlanTest, AtTheEndNoneIsLeft) {
  PortPlan plan(65535);
  EXPECT_EQ(plan.Take(), 65535);
  EXPECT_EQ(plan.Take(), 0);
  plan.Release(65535);
  EXPECT_EQ(plan.Take(), 65535);
}

}  // namespace
}  // namespace coopdyn
