// SPDX-License-Identifier: MIT
#include "server/model/sensor_text.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

std::map<std::string, std::string> WordsOf(const std::string& type) {
  Diagnostics diagnostics;
  const auto robot = ShippedRobots().Get(type, {}, diagnostics);
  EXPECT_NE(robot, nullptr) << diagnostics.ToString();
  std::map<std::string, std::string> words;
  if (robot == nullptr) return words;
  for (const SensorModel& sensor : robot->sensors) words[sensor.name] = Describe(sensor, *robot);
  return words;
}

TEST(SensorTextTest, ASensorHasItsRangeAndRate) {
  auto turtle = WordsOf("turtle");
  EXPECT_EQ(turtle["lidar"], "360 rays, 0.12 to 3.5 m, on chassis, 5 Hz");
  EXPECT_EQ(turtle["camera"], "320 x 240, 58 degrees wide, 0.05 to 8 m, on chassis, 30 Hz");
  EXPECT_EQ(turtle["contact"], "1 shape, 3 zones");
  EXPECT_EQ(turtle["battery"], "117000 J");
  EXPECT_EQ(turtle["pose"], "");
}

TEST(SensorTextTest, AWrenchSaysWhatHangsOnItsJoint) {
  EXPECT_EQ(WordsOf("lwa")["wrench"], "at joint_7, on which 0.3 kg hang");
}

}  // namespace
}  // namespace coopdyn
