// SPDX-License-Identifier: MIT
// The limits of joints in models made for other programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two boxes and a joint 'j' with a <limit>.
ForeignAnswer ReadLimited(const std::string& limit) {
  return ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0 0.4 0 0 0", kSdfBox) +
                 "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis>"
                 "<xyz>0 0 1</xyz><limit>" +
                 limit + "</limit></axis></joint>");
}

TEST(ForeignLimitTest, AMotorOfManyRoundsHasTheMostAndIsSaid) {
  const auto [fast, said] = ReadLimited("<effort>50000</effort><velocity>50000</velocity>");
  ASSERT_NE(fast, nullptr) << said;
  EXPECT_EQ(fast->actuators.size(), 1u) << said;
  EXPECT_EQ(fast->joints[0].max_velocity, 1e4);
  EXPECT_THAT(said, HasSubstr("<velocity> of joint 'j' is 50000: its motor has 10000 at most"));
  EXPECT_THAT(ReadLimited("<effort>0</effort><velocity>1</velocity>").messages,
              HasSubstr("<effort> of joint 'j' is 0: it has no motor and moves freely"));
}

TEST(ForeignLimitTest, AMotorWithoutALimitHasTheMostAndIsSaid) {
  for (const std::string limit : {"1e15", "1e16", "1e308", "inf", "+INF"}) {
    const auto [robot, said] =
        ReadLimited("<effort>" + limit + "</effort><velocity>" + limit + "</velocity>");
    ASSERT_NE(robot, nullptr) << said;
    EXPECT_EQ(robot->actuators.size(), 1u) << limit;
    EXPECT_EQ(robot->joints[0].max_effort, 1e6) << limit;
    EXPECT_EQ(robot->joints[0].max_velocity, 1e4) << limit;
    EXPECT_THAT(said, HasSubstr("<effort> of joint 'j' is no limit: its motor has 1000000 at most"));
    EXPECT_THAT(said, HasSubstr("<velocity> of joint 'j' is no limit: its motor has 10000 at most"));
  }
  const auto urdf = ReadUrdf(
      "<link name=\"base\"/><link name=\"arm\"/>"
      "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/>"
      "<limit effort=\"inf\" velocity=\"1e16\"/></joint>\n");
  ASSERT_NE(urdf.robot, nullptr) << urdf.messages;
  EXPECT_EQ(urdf.robot->actuators.size(), 1u) << urdf.messages;
}

TEST(ForeignLimitTest, OneLimitOfAMotorIsEnoughForIt) {
  for (const std::string other : {"", "<velocity>-1</velocity>"}) {
    const auto [robot, said] = ReadLimited("<effort>10</effort>" + other);
    ASSERT_NE(robot, nullptr) << said;
    EXPECT_EQ(robot->actuators.size(), 1u) << said;
    EXPECT_EQ(robot->joints[0].max_effort, 10);
    EXPECT_EQ(robot->joints[0].max_velocity, 1e4);
    EXPECT_THAT(said, HasSubstr("<velocity> of joint 'j' is no limit: its motor has 10000 at most"));
  }
}

TEST(ForeignLimitTest, NegativeLimitsGiveNoMotorAndAreSaid) {
  const auto [robot, said] = ReadLimited("<effort>-1</effort><velocity>-1</velocity>");
  ASSERT_NE(robot, nullptr) << said;
  EXPECT_TRUE(robot->actuators.empty());
  EXPECT_THAT(said, HasSubstr("<effort> and <velocity> of joint 'j' are negative and give it no motor: write "
                              "the most that its motor has"));
  EXPECT_THAT(ReadLimited("<lower>-1</lower>").messages, Not(HasSubstr("no motor")));
}

TEST(ForeignLimitTest, AStopWithoutEndIsNone) {
  for (const std::string far : {"1e16", "1e308", "inf"}) {
    const auto [robot, said] = ReadLimited("<lower>-" + far + "</lower><upper>" + far +
                                           "</upper><effort>1</effort><velocity>1</velocity>");
    ASSERT_NE(robot, nullptr) << said;
    EXPECT_EQ(robot->joints[0].lower, -JointModel::kInfinity);
    EXPECT_EQ(robot->joints[0].upper, JointModel::kInfinity);
    const auto beyond = ReadLimited("<lower>" + far + "</lower><upper>" + far + "</upper>");
    ASSERT_NE(beyond.robot, nullptr) << beyond.messages;
    EXPECT_EQ(beyond.robot->joints[0].start, 0);
    EXPECT_THAT(beyond.messages,
                HasSubstr("stops of joint 'j' leave out all that is near 0: it has no stops"));
  }
  EXPECT_THAT(ReadLimited("<lower>nan</lower>").messages,
              HasSubstr("error: <lower> needs finite numbers, not 'nan'"));
}

TEST(ForeignLimitTest, ADamperAboveTheMostHasTheMostAndIsSaid) {
  const std::string parts =
      SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0 0.4 0 0 0", kSdfBox) +
      "<joint name=\"j\" type=\"prismatic\"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>"
      "<dynamics><damping>1e11</damping></dynamics></axis></joint>";
  const auto [robot, said] = ReadSdf(parts);
  ASSERT_NE(robot, nullptr) << said;
  EXPECT_EQ(robot->joints[0].damping, 1e9);
  EXPECT_THAT(said, HasSubstr("<damping> of joint 'j' must be a number from 0 to 1e9: it is 1e9"));
}

}  // namespace
}  // namespace coopdyn
