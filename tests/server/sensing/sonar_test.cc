// SPDX-License-Identifier: MIT
// Sonars, as cones and as rays, against geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/sensing/readings.h"
#include "tests/server/sensing/mounted.h"

namespace coopdyn::range_sensors {
namespace {

SonarModel Sonar(double opening_rad, double max_range_m = 5) {
  SonarModel sonar;
  sonar.beams.push_back({OnTop(), opening_rad, 0.1, max_range_m});
  return sonar;
}

TEST(SonarTest, AWallAtASlantIsHeardAtItsNearestPointInTheCone) {
  // The face x = 3 of a wall, seen 0.4 rad to the left with an opening of 0.3: nearest at 0.25 rad.
  SonarModel sonar = Sonar(0.3);
  sonar.beams[0].mount = OnTop(FromRollPitchYaw(0, 0, 0.4));
  const auto frame =
      SampleWorld().Robot(At(0, 0), With(sonar)).Object(Box{{1, 40, 2}}, Stands(3.5, 0, 1)).MakeFrame();
  EXPECT_NEAR(SonarRanges(*frame, 0)[0], 3 / std::cos(0.25), 1e-3);
}

TEST(SonarTest, AThingBesideTheAxisIsHeardInAWideConeOnly) {
  const auto at = [](double opening_rad) {
    const auto frame = SampleWorld()
                           .Robot(At(0, 0), With(Sonar(opening_rad)))
                           .Object(Sphere{0.1}, Stands(2 * std::cos(0.3), 2 * std::sin(0.3), kEye_m))
                           .MakeFrame();
    return SonarRanges(*frame, 0)[0];
  };
  EXPECT_NEAR(at(0.8), 1.9, 1e-3);
  EXPECT_EQ(at(0.4), kInf);
}

TEST(SonarTest, AMeshIsHeardAtItsTip) {
  const auto pyramid = Pyramid();
  // The cone lies on its side, with its tip towards the robot.
  const Pose X_WG{{3, 0, kEye_m}, FromRollPitchYaw(0, -M_PI / 2, 0)};
  const auto frame =
      SampleWorld().Robot(At(0, 0), With(Sonar(0.2))).Object(Mesh{pyramid.get()}, X_WG).MakeFrame();
  EXPECT_NEAR(SonarRanges(*frame, 0)[0], 2.5, 1e-3);
}

TEST(SonarTest, TheFloorIsHeardStraightBelowOnly) {
  const auto at = [](double pitch_rad, double opening_rad) {
    SonarModel sonar = Sonar(opening_rad);
    sonar.beams[0].mount = {0, {{1, 0, 0.45}, FromRollPitchYaw(0, pitch_rad, 0)}};  // beside the robot
    return SonarRanges(*SampleWorld().Robot(At(0, 0), With(sonar)).MakeFrame(), 0)[0];
  };
  EXPECT_NEAR(at(M_PI / 2, 0.2), kEye_m, 1e-3);
  EXPECT_NEAR(at(M_PI / 2 - 0.3, 0.8), kEye_m, 1e-3);
  EXPECT_EQ(at(M_PI / 4, 0.5), kInf);  // deflected
}

TEST(SonarTest, OtherRobotsAreHeardItsOwnChassisIsNot) {
  auto model = With(Sonar(1.2));
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), model)
                         .Robot({{1.5, 0, kEye_m - 0.15}, Quaternion::Identity()})
                         .MakeFrame();
  EXPECT_NEAR(SonarRanges(*frame, 0)[0], 1.5 - kSampleRadius_m, 1e-3);
  EXPECT_EQ(SonarRanges(*SampleWorld().Robot(At(0, 0), model).MakeFrame(), 0)[0], kInf);
}

SonarModel Rays(int rays, double opening_rad, double up_rad) {
  SonarModel sonar = Sonar(opening_rad);
  sonar.beams[0].rays = rays;
  sonar.beams[0].opening_up_rad = up_rad;
  return sonar;
}

TEST(SonarTest, OneOfFiveRaysIsInTheMiddleAndFourAreOnTheRim) {
  const SonarModel::Beam beam = Rays(5, 0.6, 0.2).beams[0];
  const double a = 0.3, b = 0.1;
  const Vector3 rays[] = {{1, 0, 0},
                          {std::cos(a), std::sin(a), 0},
                          {std::cos(b), 0, std::sin(b)},
                          {std::cos(a), -std::sin(a), 0},
                          {std::cos(b), 0, -std::sin(b)}};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR((beam.Direction(i) - rays[i]).norm(), 0, 1e-12) << i;
  EXPECT_EQ(Rays(1, 0.6, 0.2).beams[0].Direction(0), Vector3::UnitX());
  EXPECT_NEAR((Rays(3, 0.6, 0.2).beams[0].Direction(2) - rays[3]).norm(), 0, 1e-12);
}

TEST(SonarTest, RaysSeeWhatLiesOnThemAndNothingBetween) {
  const auto reads = [](const SonarModel& sonar, double angle_rad) {
    const auto frame =
        SampleWorld()
            .Robot(At(0, 0), With(sonar))
            .Object(Cylinder{0.05, 1}, Stands(2 * std::cos(angle_rad), 2 * std::sin(angle_rad), 0.5))
            .MakeFrame();
    return SonarRanges(*frame, 0)[0];
  };
  const SonarModel rays = Rays(5, 0.6, 0.2);
  for (const double angle_rad : {-0.3, 0.0, 0.3}) EXPECT_NEAR(reads(rays, angle_rad), 1.95, 1e-9);
  EXPECT_EQ(reads(rays, 0.15), kInf);
  EXPECT_LT(reads(Sonar(0.6), 0.15), 2);  // the cone detects it
}

TEST(SonarTest, ARayMeetsTheFloor) {
  // The lowest ray descends by 0.4 rad from 0.5 m above the floor.
  const auto frame = SampleWorld().Robot(At(0, 0), With(Rays(5, 0.8, 0.8))).MakeFrame();
  EXPECT_NEAR(SonarRanges(*frame, 0)[0], 0.5 / std::sin(0.4), 1e-9);
  const std::vector<RaySegment> rays = SonarRays(*frame, 0);
  ASSERT_EQ(rays.size(), 5u);
  EXPECT_TRUE(rays[4].hit);
  EXPECT_NEAR(rays[4].to_W.z(), 0, 1e-9);
  EXPECT_FALSE(rays[0].hit);
  EXPECT_TRUE(SonarCones(*frame, 0).empty());
}

TEST(SonarTest, NearerThanTheMinimumReads0) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), With(Sonar(0.2)))
                         .Object(Box{{0.1, 1, 1}}, Stands(0.13, 0, kEye_m + 0.2))
                         .MakeFrame();
  EXPECT_EQ(SonarRanges(*frame, 0)[0], 0);
}

}  // namespace
}  // namespace coopdyn::range_sensors
