// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance_m = 1e-9;  // required: 1 mm
constexpr int kRight = 0, kAhead = 1, kLeft = 2;

double Ahead(const SampleWorld& world) {
  return Distances(*world.MakeFrame(), 0)[kAhead];
}

// One robot at the origin that looks along x.
SampleWorld Lone() {
  return SampleWorld().Robot(At(0, 0));
}

TEST(DistanceTest, NothingInRangeIsInfinite) {
  const auto frame = Lone().MakeFrame();
  for (const double range : Distances(*frame, 0)) EXPECT_EQ(range, kInfinity);
}

TEST(DistanceTest, ABoxAheadIsMeasuredFromTheChassisSurface) {
  EXPECT_NEAR(Ahead(Lone().Object(Box{{1, 1, 1}}, {{2.5, 0, 0.5}, Quaternion::Identity()})),
              2 - kSampleRadius_m, kTolerance_m);
}

TEST(DistanceTest, ATurnedBoxShowsItsCorner) {
  const Pose turned{{2, 0, 0.5}, FromRollPitchYaw(0, 0, std::numbers::pi / 4)};
  EXPECT_NEAR(Ahead(Lone().Object(Box{{1, 1, 1}}, turned)), 2 - std::numbers::sqrt2 / 2 - kSampleRadius_m,
              kTolerance_m);
}

TEST(DistanceTest, ACylinderOffTheAxisOfTheRay) {
  const Pose X_WO{{2, 0.3, 0.5}, Quaternion::Identity()};
  EXPECT_NEAR(Ahead(Lone().Object(Cylinder{0.5, 1}, X_WO)), 2 - 0.4 - kSampleRadius_m, kTolerance_m);
}

TEST(DistanceTest, ASphereIsCutAtTheSensorsHeight) {
  const Pose X_WO{{2, 0, 0.5}, Quaternion::Identity()};
  const double dz = 0.5 - kSampleSensor_m;
  EXPECT_NEAR(Ahead(Lone().Object(Sphere{0.5}, X_WO)), 2 - std::sqrt(0.25 - dz * dz) - kSampleRadius_m,
              kTolerance_m);
}

TEST(DistanceTest, AnotherRobotIsSeenByItsChassis) {
  EXPECT_NEAR(Ahead(Lone().Robot(At(1.5, 0, 1.0))), 1.5 - 2 * kSampleRadius_m, kTolerance_m);
}

TEST(DistanceTest, ADynamicObjectIsSeenWhereItsBodyIs) {
  auto frame = Lone().Object(Box{{1, 1, 1}}, {{9, 0, 0.5}, Quaternion::Identity()}, 5).MakeFrame();
  frame->bodies[0].p_WB.x() = 2.5;
  EXPECT_NEAR(Distances(*frame, 0)[kAhead], 2 - kSampleRadius_m, kTolerance_m);
}

TEST(DistanceTest, AWallAtTheRightAppearsInTheFirstSensor) {
  const auto frame = Lone().Object(Box{{10, 0.1, 1}}, {{0, -1.05, 0.5}, Quaternion::Identity()}).MakeFrame();
  const auto ranges = Distances(*frame, 0);
  EXPECT_NEAR(ranges[kRight], 1 - kSampleRadius_m, kTolerance_m);
  EXPECT_EQ(ranges[kAhead], kInfinity);
  EXPECT_EQ(ranges[kLeft], kInfinity);
}

TEST(DistanceTest, TheRobotsPoseTurnsItsSensors) {
  const auto frame = SampleWorld()
                         .Robot(At(1, 2, std::numbers::pi / 2))
                         .Object(Box{{1, 1, 1}}, {{1, 4.5, 0.5}, Quaternion::Identity()})
                         .MakeFrame();
  EXPECT_NEAR(Distances(*frame, 0)[kAhead], 2 - kSampleRadius_m, kTolerance_m);
}

TEST(DistanceTest, BeyondTheRangeIsInfinite) {
  const double just_out_m = kSampleRange_m + kSampleRadius_m + 0.001 + 0.5;
  EXPECT_EQ(Ahead(Lone().Object(Box{{1, 1, 1}}, {{just_out_m, 0, 0.5}, Quaternion::Identity()})), kInfinity);
  EXPECT_NEAR(Ahead(Lone().Object(Box{{1, 1, 1}}, {{just_out_m - 0.002, 0, 0.5}, Quaternion::Identity()})),
              kSampleRange_m - 0.001, kTolerance_m);
}

TEST(DistanceTest, TouchingIsZero) {
  EXPECT_EQ(Ahead(Lone().Object(Box{{1, 1, 1}}, {{kSampleRadius_m + 0.45, 0, 0.5}, Quaternion::Identity()})),
            0);
}

TEST(DistanceTest, ThingsLowerThanTheSensorAreNotSeen) {
  EXPECT_EQ(Ahead(Lone().Object(Box{{1, 1, 0.1}}, {{2, 0, 0.05}, Quaternion::Identity()})), kInfinity);
}

TEST(DistanceTest, TargetsAreNotFelt) {
  EXPECT_EQ(Ahead(Lone().Mark(1, 0, kSampleSensor_m)), kInfinity);
}

TEST(DistanceTest, ATiltedRobotSeesTheFloor) {
  // Nose down by 0.2 rad about the axle's middle.
  const auto frame = SampleWorld().Robot({{0, 0, 0.1}, FromRollPitchYaw(0, 0.2, 0)}).MakeFrame();
  const double sensor_z_m = 0.1 + kSampleSensor_m * std::cos(0.2) - kSampleRadius_m * std::sin(0.2);
  EXPECT_NEAR(Distances(*frame, 0)[kAhead], sensor_z_m / std::sin(0.2), kTolerance_m);
}

TEST(DistanceTest, TheSmallestRayOfASectorCounts) {
  auto model = SampleRobot(1);
  SectorModel& sensor = SensorOf<DistanceModel>(*model).sectors[0];
  sensor.opening_rad = 0.4;
  sensor.rays = 5;
  // A thin post on the leftmost ray, and a wall farther ahead.
  const double angle = 0.2;
  const Vector3 origin(kSampleRadius_m, 0, 0);
  const Vector3 post = origin + 1.0 * Vector3(std::cos(angle), std::sin(angle), 0) + Vector3(0, 0, 0.5);
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), model)
                         .Object(Box{{0.1, 10, 1}}, {{3, 0, 0.5}, Quaternion::Identity()})
                         .Object(Cylinder{0.02, 1}, {post, Quaternion::Identity()})
                         .MakeFrame();
  EXPECT_NEAR(Distances(*frame, 0)[0], 0.98, kTolerance_m);
}

TEST(DistanceTest, TheRaysForDrawingEndWhereTheReadingsSay) {
  const auto frame = Lone().Object(Box{{1, 1, 1}}, {{2.5, 0, 0.5}, Quaternion::Identity()}).MakeFrame();
  const auto rays = DistanceRays(*frame, 0);
  ASSERT_EQ(rays.size(), 3U);
  EXPECT_TRUE(rays[kAhead].hit);
  EXPECT_NEAR(rays[kAhead].from_W.x(), kSampleRadius_m, kTolerance_m);
  EXPECT_NEAR(rays[kAhead].to_W.x(), 2, kTolerance_m);
  EXPECT_FALSE(rays[kLeft].hit);
  EXPECT_NEAR(rays[kLeft].to_W.y(), kSampleRadius_m + kSampleRange_m, kTolerance_m);
}

}  // namespace
}  // namespace coopdyn
