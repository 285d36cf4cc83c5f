// SPDX-License-Identifier: MIT
#include "server/naming/name_table.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(NameTable, AnOwnNameReplacesAnExternalOneButNotAnOwnOne) {
  NameTable table;
  ASSERT_EQ(table.Register("/robot2/motors", "tcp", "10.0.0.9", 17001, "").refused, "");
  EXPECT_TRUE(table.AddOwn("/robot2/motors", 10005, nullptr));
  EXPECT_FALSE(table.AddOwn("/robot2/motors", 10006, nullptr));
  EXPECT_EQ(table.Find("/robot2/motors")->port, 10005);
  table.RemoveOwn("/robot2/motors");
  EXPECT_FALSE(table.Find("/robot2/motors"));
}

TEST(NameTable, GivesFreePortsOfItsRangeOnly) {
  NameTable table;
  table.SetExternalPorts(12000, 12001);
  EXPECT_EQ(table.Register("/a", "", "", 0, "127.0.0.1").entry.port, 12000);
  EXPECT_EQ(table.Register("/b", "", "", 0, "127.0.0.1").entry.port, 12001);
  EXPECT_EQ(table.Register("/c", "", "", 0, "127.0.0.1").refused, "no free port");
  EXPECT_TRUE(table.IsExternalPort(12001));
  table.Unregister("/b");
  EXPECT_FALSE(table.IsExternalPort(12001));
  EXPECT_EQ(table.Register("/c", "", "", 0, "127.0.0.1").entry.port, 12001);
}

TEST(NameTable, IsBounded) {
  NameTable table;
  for (std::size_t i = 0; i < NameTable::kMaxExternal; ++i) {
    ASSERT_EQ(table.Register("/x" + std::to_string(i), "tcp", "10.0.0.9", 5, "").refused, "");
  }
  EXPECT_EQ(table.Register("/more", "tcp", "10.0.0.9", 5, "").refused, "too many names");
  for (std::size_t i = 0; i < NameTable::kMaxProperties; ++i) {
    ASSERT_EQ(table.SetProperty("/x1", std::to_string(i), "v").refused, "");
  }
  EXPECT_NE(table.SetProperty("/x1", "more", "v").refused, "");
  EXPECT_TRUE(table.AddOwn("/robot1/motors", 10002, nullptr));  // the daemon's always fit
}

TEST(NameTable, KnowsTheNearestName) {
  NameTable table;
  table.AddOwn("/robot1/motors", 10002, nullptr);
  table.AddOwn("/robot2/motors", 10003, nullptr);
  EXPECT_EQ(table.Nearest("/robot2/motor"), "/robot2/motors");
  EXPECT_EQ(table.Nearest("robot1"), "/robot1/motors");
  EXPECT_EQ(table.Nearest("/camera"), "");
}

}  // namespace
}  // namespace coopdyn
