// SPDX-License-Identifier: MIT
#include "server/web/sensor_message.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::sensor_message {
namespace {

std::uint32_t U32(const std::string& bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

double Coordinate(const std::string& bytes, std::size_t index) {
  return std::bit_cast<float>(U32(bytes, 16 + 4 * index));
}

constexpr std::size_t kTriangles = 4, kLines = 8, kDots = 12;

TEST(SensorMessageTest, ARayIsALineToADotWhereItMeetsAWall) {
  SampleWorld world;
  world.Robot(At(0, 0), SampleRobot(1)).Object(Box{{0.2, 4, 2}}, {{2.1, 0, 1}, Quaternion::Identity()});
  const std::string bytes = SensorMessage(*world.MakeFrame());
  EXPECT_EQ(bytes.front(), kSensorMessageType);
  EXPECT_EQ(U32(bytes, kTriangles), 0U);
  ASSERT_EQ(U32(bytes, kLines), 1U);
  ASSERT_EQ(U32(bytes, kDots), 1U);
  EXPECT_NEAR(Coordinate(bytes, 0), kSampleRadius_m, 1e-6);
  for (const std::size_t vertex : {1, 2}) EXPECT_NEAR(Coordinate(bytes, 3 * vertex), 2, 1e-6);
  EXPECT_EQ(bytes.size(), 16U + 3 * (12 + 4));
}

TEST(SensorMessageTest, ARayThatMeetsNothingIsALineAsLongAsItsRange) {
  SampleWorld world;
  world.Robot(At(0, 0), SampleRobot(1));
  const std::string bytes = SensorMessage(*world.MakeFrame());
  ASSERT_EQ(U32(bytes, kLines), 1U);
  EXPECT_EQ(U32(bytes, kDots), 0U);
  EXPECT_NEAR(Coordinate(bytes, 3), kSampleRadius_m + kSampleRange_m, 1e-6);
}

TEST(SensorMessageTest, OfTooManySensorsThoseOfEachNthRobotAreShown) {
  SampleWorld world;
  for (int i = 0; i < 4; ++i) world.Robot(At(10 * i, 0), SampleRobot(1));
  const auto frame = world.MakeFrame();  // 12 vertices at most
  EXPECT_EQ(U32(SensorMessage(*frame, 13), kLines), 4U);
  const std::string bytes = SensorMessage(*frame, 6);
  ASSERT_EQ(U32(bytes, kLines), 2U);
  EXPECT_NEAR(Coordinate(bytes, 6), 30 + kSampleRadius_m, 1e-5);
}

TEST(SensorMessageTest, ColoursFollowThePlaces) {
  SampleWorld world;
  world.Robot(At(0, 0), SampleRobot(1));
  const std::string bytes = SensorMessage(*world.MakeFrame());
  ASSERT_EQ(bytes.size(), 16U + 2 * (12 + 4));
  EXPECT_EQ(bytes.substr(40, 4), bytes.substr(44, 4));
  EXPECT_EQ(static_cast<unsigned char>(bytes[41]), 153);  // 0.6 of green
  EXPECT_EQ(static_cast<unsigned char>(bytes[43]), 77);   // 0.3 of opacity
}

}  // namespace
}  // namespace coopdyn::sensor_message
