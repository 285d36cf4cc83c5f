// SPDX-License-Identifier: MIT
#include "server/naming/name_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>

namespace coopdyn {
namespace {

TEST(NameTable, AnOwnNameReplacesAnExternalOneButNotAnOwnOne) {
  NameTable table;
  ASSERT_EQ(table.Register("/robot2/motors", "tcp", "10.0.0.9", 17001, {""}).refused, "");
  EXPECT_TRUE(table.AddOwn("/robot2/motors", 10005, nullptr));
  EXPECT_FALSE(table.AddOwn("/robot2/motors", 10006, nullptr));
  EXPECT_EQ(table.Find("/robot2/motors")->port, 10005);
  table.RemoveOwn("/robot2/motors");
  EXPECT_FALSE(table.Find("/robot2/motors"));
}

TEST(NameTable, GivesFreePortsOfItsRangeOnly) {
  NameTable table;
  table.SetExternalPorts(12000, 12001);
  EXPECT_EQ(table.Register("/a", "", "", 0, {"127.0.0.1"}).entry.port, 12000);
  EXPECT_EQ(table.Register("/b", "", "", 0, {"127.0.0.1"}).entry.port, 12001);
  EXPECT_EQ(table.Register("/c", "", "", 0, {"127.0.0.1"}).refused, "no free port");
  EXPECT_TRUE(table.IsExternalPort(12001));
  table.Unregister("/b", {});
  EXPECT_FALSE(table.IsExternalPort(12001));
  EXPECT_EQ(table.Register("/c", "", "", 0, {"127.0.0.1"}).entry.port, 12001);
}

/// CPU time, s, of 2,000 requests for a port with `own` names.
double AskingTime_s(int names) {
  NameTable table;
  for (int i = 0; i < names; ++i) table.AddOwn("/robot" + std::to_string(i) + "/motors", 10002 + i, nullptr);
  table.Register("/a", "tcp", "10.0.0.9", 5, {""});
  const std::clock_t begin = std::clock();
  for (int port = 10000; port < 12000; ++port) EXPECT_FALSE(table.IsExternalPort(port));
  return static_cast<double>(std::clock() - begin + 1) / CLOCKS_PER_SEC;
}

TEST(NameTable, ManyOwnNamesDoNotSlowTheQuestionForAPort) {
  EXPECT_LT(AskingTime_s(20'000), 20 * AskingTime_s(20));
}

TEST(NameTable, APortIsForeignAsLongAsAnExternalNameHasIt) {
  NameTable table;
  table.Register("/a", "tcp", "10.0.0.9", 17001, {""});
  table.Register("/b", "tcp", "10.0.0.9", 17001, {""});
  table.Unregister("/a", {});
  EXPECT_TRUE(table.IsExternalPort(17001));
  table.AddOwn("/b", 10002, nullptr);
  EXPECT_FALSE(table.IsExternalPort(17001));
}

TEST(NameTable, GivesNoPortThatAnotherProgramHolds) {
  NameTable table;
  table.SetExternalPorts(12000, 12002, [](int port) { return port == 12001; });
  EXPECT_EQ(table.Register("/a", "", "", 0, {"127.0.0.1"}).entry.port, 12001);
  EXPECT_EQ(table.Register("/b", "", "", 0, {"127.0.0.1"}).refused, "no free port");
}

TEST(NameTable, IsBounded) {
  NameTable table;
  for (std::size_t i = 0; i < NameTable::kMaxExternal; ++i) {
    ASSERT_EQ(table.Register("/x" + std::to_string(i), "tcp", "10.0.0.9", 5, {""}).refused, "");
  }
  EXPECT_EQ(table.Register("/more", "tcp", "10.0.0.9", 5, {""}).refused, "too many names");
  for (std::size_t i = 0; i < NameTable::kMaxProperties; ++i) {
    ASSERT_EQ(table.SetProperty("/x1", std::to_string(i), "v", {}).refused, "");
  }
  EXPECT_NE(table.SetProperty("/x1", "more", "v", {}).refused, "");
  EXPECT_TRUE(table.AddOwn("/robot1/motors", 10002, nullptr));  // the daemon's own names are always accepted
}

TEST(NameTable, KnowsTheNearestName) {
  NameTable table;
  table.AddOwn("/robot1/motors", 10002, nullptr);
  table.AddOwn("/robot2/motors", 10003, nullptr);
  EXPECT_EQ(table.Nearest("/robot2/motor"), "/robot2/motors");
  EXPECT_EQ(table.Nearest("robot1"), "/robot1/motors");
  EXPECT_EQ(table.Nearest("/camera"), "");
}

const NameAsker kAna{"10.0.0.7", 0}, kBen{"10.0.0.8", 0}, kHere{"127.0.0.1", 0};

TEST(NameTableStrangers, RegisterTheirOwnAddressAlone) {
  NameTable table;
  for (const char* const address :
       {"127.0.0.1", "localhost", "::1", "0.0.0.0", "10.0.0.8", "10.0.0.70", "ana.example"}) {
    EXPECT_THAT(table.Register("/evil", "tcp", address, 5, kAna).refused,
                testing::HasSubstr("its own address alone: write 10.0.0.7"))
        << address;
  }
  EXPECT_EQ(table.Register("/a", "tcp", "10.0.0.7", 5, kAna).refused, "");
  EXPECT_EQ(table.Register("/b", "", "", 0, kAna).entry.ip, "10.0.0.7");
  EXPECT_EQ(table.Register("/c", "tcp", "10.0.0.8", 5, kHere).refused, "");
}

TEST(NameTableStrangers, OnlyItsRegistrarAndThisMachineChangeAName) {
  NameTable table;
  ASSERT_EQ(table.Register("/ana", "tcp", "", 5, kAna).refused, "");
  EXPECT_NE(table.Unregister("/ana", kBen).refused, "");
  EXPECT_NE(table.SetProperty("/ana", "k", "v", kBen).refused, "");
  EXPECT_NE(table.Register("/ana", "tcp", "", 6, kBen).refused, "");
  EXPECT_TRUE(table.Find("/ana"));
  EXPECT_EQ(table.SetProperty("/ana", "k", "v", kAna).refused, "");
  EXPECT_EQ(table.SetProperty("/ana", "k", "w", kHere).refused, "");
  EXPECT_EQ(table.Unregister("/ana", kAna).refused, "");
  ASSERT_EQ(table.Register("/here", "tcp", "", 5, kHere).refused, "");
  EXPECT_NE(table.Unregister("/here", kAna).refused, "");
}

TEST(NameTableStrangers, OneAddressCannotTakeAllNames) {
  NameTable table;
  for (std::size_t i = 0; i < NameTable::kMaxOfAddress; ++i) {
    ASSERT_EQ(table.Register("/a" + std::to_string(i), "tcp", "", 5, kAna).refused, "");
  }
  EXPECT_NE(table.Register("/a", "tcp", "", 5, kAna).refused, "");
  EXPECT_EQ(table.Register("/b", "tcp", "", 5, kBen).refused, "");
}

TEST(NameTableStrangers, PropertiesAreBoundedInBytes) {
  NameTable table;
  ASSERT_EQ(table.Register("/a", "tcp", "", 5, kAna).refused, "");
  EXPECT_NE(table.SetProperty("/a", "k", std::string(2000, 'v'), kAna).refused, "");
  EXPECT_NE(table.SetProperty("/a", std::string(200, 'k'), "v", kAna).refused, "");
  const std::string value(NameTable::kMaxValueBytes, 'v');
  std::size_t bytes = 0;
  bool refused = false;
  for (int name = 0; name < 1000 && !refused; ++name) {
    const std::string path = "/p" + std::to_string(name);
    refused = !table.Register(path, "tcp", "", 5, kAna).refused.empty();
    for (std::size_t i = 0; i < NameTable::kMaxProperties && !refused; ++i) {
      refused = !table.SetProperty(path, std::to_string(i), value, kAna).refused.empty();
      if (!refused) bytes += value.size();
    }
  }
  EXPECT_TRUE(refused);
  EXPECT_LE(bytes, NameTable::kMaxBytesOfAddress);
}

TEST(NameTableStrangers, AllAddressesTogetherAreBoundedInBytes) {
  NameTable table;
  const std::string value(NameTable::kMaxValueBytes, 'v');
  std::size_t bytes = 0;
  for (int address = 0; address < 8; ++address) {
    const NameAsker asker{"10.0.1." + std::to_string(address), 0};
    for (int name = 0; name < 40; ++name) {
      const std::string path = "/p" + std::to_string(address) + "_" + std::to_string(name);
      table.Register(path, "tcp", "", 5, asker);
      for (std::size_t i = 0; i < NameTable::kMaxProperties; ++i) {
        // A refused name has no properties.
        if (!table.SetProperty(path, std::to_string(i), value, asker).entry.name.empty()) {
          bytes += value.size();
        }
      }
    }
  }
  EXPECT_LE(bytes, NameTable::kMaxExternalBytes);
  EXPECT_GT(bytes, NameTable::kMaxExternalBytes / 2);
}

TEST(NameTableStrangers, AnUnusedNameIsForgottenAfterADay) {
  NameTable table;
  table.AddOwn("/robot1/motors", 10002, nullptr);
  table.Forget(0);
  ASSERT_EQ(table.Register("/a", "tcp", "", 5, kAna).refused, "");
  ASSERT_EQ(table.Register("/b", "tcp", "", 6, kAna).refused, "");
  const Nanoseconds day = NameTable::kForgottenAfter;
  table.Touch("/b", day / 2);
  table.Forget(day - 1);
  EXPECT_TRUE(table.Find("/a"));
  table.Forget(day);
  EXPECT_FALSE(table.Find("/a"));
  EXPECT_TRUE(table.Find("/b"));
  table.Forget(day + day / 2);
  EXPECT_FALSE(table.Find("/b"));
  EXPECT_TRUE(table.Find("/robot1/motors"));
}

}  // namespace
}  // namespace coopdyn
