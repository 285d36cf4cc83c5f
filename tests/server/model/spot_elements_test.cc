// SPDX-License-Identifier: MIT
// Our own elements for sonars and sensors of light.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/server/model/sensor_rig.h"

namespace coopdyn::sensor_rig {
namespace {

using ::testing::HasSubstr;

TEST(SensorElementsTest, BeamsOfASonarHaveTheCommonValuesOrTheirOwn) {
  const auto sonar = Described<SonarModel>(
      "<coopdyn:sonar max_range=\"3\" opening_deg=\"20\"><coopdyn:beam pose=\"0 0 0 0 0 0.5\"/><coopdyn:beam "
      "opening_deg=\"40\" min_range=\"0.1\" max_range=\"2\"/></coopdyn:sonar>");
  ASSERT_EQ(sonar.beams.size(), 2u);
  EXPECT_NEAR(sonar.beams[0].opening_rad, 20 * kPerDegree, 1e-12);
  EXPECT_NEAR(Heading(sonar.beams[0].mount.X_LS.q), 0.5, 1e-12);
  EXPECT_EQ(sonar.beams[1].max_range_m, 2);
  EXPECT_EQ(sonar.beams[0].rays, 0);
  const auto rays = Described<SonarModel>(
      "<coopdyn:sonar max_range=\"3\" rays=\"5\"><coopdyn:beam opening_deg=\"200\"/><coopdyn:beam "
      "opening_up_deg=\"10\"/></coopdyn:sonar>");
  EXPECT_EQ(rays.beams[0].rays, 5);
  EXPECT_NEAR(rays.beams[0].opening_up_rad, 200 * kPerDegree, 1e-12);
  EXPECT_NEAR(rays.beams[1].opening_rad, 30 * kPerDegree, 1e-12);
  EXPECT_NEAR(rays.beams[1].opening_up_rad, 10 * kPerDegree, 1e-12);
  const auto wrong = [](const std::string& attributes) {
    return WrongElement("sonar",
                        "<coopdyn:sonar max_range=\"1\"><coopdyn:beam " + attributes + "/></coopdyn:sonar>");
  };
  EXPECT_THAT(wrong("opening_deg=\"200\""), HasSubstr("a cone opens 170 degrees at most"));
  EXPECT_THAT(wrong("opening_up_deg=\"20\""), HasSubstr("opening_up_deg is that of rays"));
  EXPECT_THAT(WrongElement("sonar", "<coopdyn:sonar><coopdyn:beam/></coopdyn:sonar>"),
              HasSubstr("needs 'max_range' in m, here or in <coopdyn:sonar>"));
  EXPECT_THAT(WrongElement("sonar", "<coopdyn:sonar/>"), HasSubstr("write at least one <coopdyn:beam"));
}

TEST(SensorElementsTest, ThePresetGp2d12MeetsItsDataSheet) {
  const auto answer =
      ReadRig("<coopdyn:infrared preset=\"gp2d12\"><coopdyn:eye/></coopdyn:infrared>" + ModuleOf("infrared"));
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  const InfraredModel& infrared = *answer.robot->Find<InfraredModel>();
  const auto at = [&infrared](double distance_m) {
    for (const InfraredModel::Row& row : infrared.curve) {
      if (std::abs(row.distance_m - distance_m) < 1e-9) return row.value;
    }
    return -1.0;
  };
  EXPECT_NEAR(at(0.8), 0.4, 1e-9);
  EXPECT_NEAR(at(0.1), 2.4, 1e-9);
  EXPECT_NEAR(at(0.2), 1.4, 1e-9);
  EXPECT_LT(at(0.04), at(0.1));  // it folds
  EXPECT_NEAR(1 / answer.robot->sensors.at(0).timing.rate_hz, 0.0383, 1e-9);
  EXPECT_EQ(infrared.max_range_m, 0.8);
}

TEST(SensorElementsTest, ThePresetDm2y3a003k0fIsAWideBeamOfEightBits) {
  const auto answer = ReadRig("<coopdyn:infrared preset=\"dm2y3a003k0f\"><coopdyn:eye/></coopdyn:infrared>" +
                              ModuleOf("infrared"));
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  const InfraredModel& infrared = *answer.robot->Find<InfraredModel>();
  for (const InfraredModel::Row& row : infrared.curve) {
    EXPECT_GE(row.value, 0);
    EXPECT_LE(row.value, 255);
    if (row.distance_m >= 0.4) {
      EXPECT_NEAR(row.value, 102 / row.distance_m, 1e-9);
    }
  }
  EXPECT_EQ(infrared.rays, 5);
  EXPECT_NEAR(infrared.opening_rad, 25 * kPerDegree, 1e-12);
  EXPECT_EQ(infrared.max_range_m, 3);
  EXPECT_EQ(infrared.noise.resolution, 1);
}

TEST(SensorElementsTest, ACurveOfItsOwn) {
  const auto infrared = Described<InfraredModel>(
      "<coopdyn:infrared opening_deg=\"5\" rays=\"3\"><coopdyn:eye link=\"arm\"/><coopdyn:row "
      "distance=\"0.1\" value=\"3\" "
      "noise_stddev=\"0.1\"/><coopdyn:row distance=\"1\" value=\"1\"/></coopdyn:infrared>");
  ASSERT_EQ(infrared.curve.size(), 2u);
  EXPECT_EQ(infrared.curve[0].noise_stddev, 0.1);
  EXPECT_EQ(infrared.max_range_m, 1);
  EXPECT_EQ(infrared.dark, 1);
}

TEST(SensorElementsTest, WrongInfrareds) {
  const std::string eye = "<coopdyn:eye/>", row = "<coopdyn:row distance=\"0.1\" value=\"3\"/>";
  const auto wrong = [](const std::string& attributes, const std::string& inside) {
    return WrongElement("infrared", "<coopdyn:infrared " + attributes + ">" + inside + "</coopdyn:infrared>");
  };
  EXPECT_THAT(wrong("preset=\"gp2y\"", eye),
              HasSubstr("there is no preset 'gp2y': write gp2d12, dm2y3a003k0f"));
  EXPECT_THAT(wrong("", eye + row), HasSubstr("at least two <coopdyn:row"));
  EXPECT_THAT(wrong("", eye + row + row), HasSubstr("rows go by increasing 'distance'"));
  EXPECT_THAT(wrong("preset=\"gp2d12\"", eye + row), HasSubstr("keep one of them"));
  EXPECT_THAT(wrong("preset=\"gp2d12\"", ""), HasSubstr("write at least one <coopdyn:eye"));
  EXPECT_THAT(wrong("preset=\"gp2d12\" opening_deg=\"4\"", eye),
              HasSubstr("one ray cannot sample an opening"));
}

TEST(SensorElementsTest, AnEyeMaySeeAmbientLightAloneOrColours) {
  const auto light = Described<LightModel>(
      "<coopdyn:light><coopdyn:eye lamps=\"false\"/><coopdyn:eye color=\"1 0.5 0\"/></coopdyn:light>");
  ASSERT_EQ(light.eyes.size(), 2u);
  EXPECT_FALSE(light.eyes[0].sees_lamps);
  EXPECT_FALSE(light.eyes[0].color.has_value());
  EXPECT_EQ(light.eyes[1].color, Vector3(1, 0.5, 0));
  const auto wrong = [](const std::string& attributes) {
    return WrongElement("light", "<coopdyn:light><coopdyn:eye " + attributes + "/></coopdyn:light>");
  };
  EXPECT_THAT(wrong("color=\"0 0 0\""), HasSubstr("numbers from 0 on, not all 0"));
  EXPECT_THAT(wrong("color=\"1 -1 1\""), HasSubstr("numbers from 0 on, not all 0"));
  EXPECT_THAT(wrong("color=\"1 1 1\" lamps=\"false\""), HasSubstr("sees lamps alone"));
}

TEST(SensorElementsTest, EyesForLightSeeAConeOrAllRound) {
  const auto light = Described<LightModel>(
      "<coopdyn:light opening_deg=\"60\"><coopdyn:eye/><coopdyn:eye opening_deg=\"0\"/></coopdyn:light>");
  ASSERT_EQ(light.eyes.size(), 2u);
  EXPECT_NEAR(light.eyes[0].opening_rad, 60 * kPerDegree, 1e-12);
  EXPECT_EQ(light.eyes[1].opening_rad, 0);
  EXPECT_THAT(WrongElement("light", "<coopdyn:light/>"), HasSubstr("write at least one <coopdyn:eye"));
}

TEST(SensorElementsTest, ACamera) {
  const auto camera = Described<CameraModel>(
      "<coopdyn:camera width=\"64\" height=\"48\" fov_deg=\"90\" near=\"0.1\" far=\"20\" "
      "noise_stddev=\"0.02\" "
      "depth_noise_stddev=\"0.03\"/>");
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  EXPECT_NEAR(camera.focal_px(), 32, 1e-9);
  EXPECT_EQ(camera.noise.stddev, 0.02);
  EXPECT_EQ(camera.depth_noise.stddev, 0.03);
  EXPECT_THAT(WrongElement("camera", "<coopdyn:camera near=\"2\" far=\"1\"/>"),
              HasSubstr("needs 0 < near < far"));
  EXPECT_THAT(WrongElement("camera", "<coopdyn:camera width=\"5000\"/>"),
              HasSubstr("'width' must be a number from 1 to 4096"));
  EXPECT_THAT(WrongElement("camera", "<coopdyn:camera fov_deg=\"180\"/>"),
              HasSubstr("'fov_deg' must be a number from 1 to 175"));
}

}  // namespace
}  // namespace coopdyn::sensor_rig
