// SPDX-License-Identifier: MIT
// Lidars and infrared sensors against geometry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/sensing/readings.h"
#include "tests/server/sensing/mounted.h"

namespace coopdyn::range_sensors {
namespace {

using testing::Each;
using testing::ElementsAre;

LidarModel Fan(int columns, double half_rad, double max_range_m = 10) {
  LidarModel lidar;
  lidar.mount = OnTop();
  lidar.columns = columns;
  lidar.first_azimuth_rad = -half_rad;
  lidar.last_azimuth_rad = half_rad;
  lidar.max_range_m = max_range_m;
  return lidar;
}

double AzimuthOf(const LidarModel& lidar, std::size_t column) {
  return lidar.first_azimuth_rad + (lidar.last_azimuth_rad - lidar.first_azimuth_rad) *
                                       static_cast<double>(column) / (lidar.columns - 1);
}

std::vector<double> ScanOf(const Frame& frame, int robot = 0) {
  const std::span<const double> scan = Scan(frame, robot);
  return {scan.begin(), scan.end()};
}

// --- lidar

TEST(LidarTest, AWallsRangesAreItsDistanceOverTheCosine) {
  const LidarModel lidar = Fan(61, 1);
  const auto frame =
      SampleWorld().Robot(At(0, 0), With(lidar)).Object(Box{{1, 40, 2}}, Stands(3.5, 0, 1)).MakeFrame();
  const std::vector<double> scan = ScanOf(*frame);
  ASSERT_EQ(scan.size(), 61);
  for (std::size_t k = 0; k < scan.size(); ++k)
    EXPECT_NEAR(scan[k], 3 / std::cos(AzimuthOf(lidar, k)), 1e-9) << k;
}

TEST(LidarTest, RoundThingsAreMetInFront) {
  const Shape shapes[] = {Cylinder{0.3, 2}, Sphere{0.3}, Capsule{0.3, 1}};
  for (const Shape& shape : shapes) {
    const auto frame =
        SampleWorld().Robot(At(0, 0), With(Fan(3, 0.1))).Object(shape, Stands(2, 0, kEye_m)).MakeFrame();
    // |r d − m| = R in the plane through the centre.
    const double off_m = 2 * std::sin(0.1);
    const double beside_m = 2 * std::cos(0.1) - std::sqrt(0.09 - off_m * off_m);
    EXPECT_THAT(ScanOf(*frame),
                ElementsAre(testing::DoubleNear(beside_m, 1e-9), testing::DoubleNear(1.7, 1e-9),
                            testing::DoubleNear(beside_m, 1e-9)))
        << shape.index();
  }
}

TEST(LidarTest, ColumnsGoFromRightToLeftAndRowsFromTheLowest) {
  LidarModel lidar = Fan(3, M_PI / 2);
  lidar.rows = 2;
  lidar.first_elevation_rad = -0.3;
  lidar.last_elevation_rad = 0.3;
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), With(lidar))
                         .Object(Box{{10, 1, 0.4}}, Stands(0, -2.5, kEye_m - 0.62))  // low, on the right
                         .Object(Box{{10, 1, 0.4}}, Stands(0, 2.5, kEye_m + 0.62))   // high, on the left
                         .MakeFrame();
  const std::vector<double> scan = ScanOf(*frame);
  ASSERT_EQ(scan.size(), 6);
  const double floor_m = kEye_m / std::sin(0.3), thing_m = 2 / std::cos(0.3);
  EXPECT_NEAR(scan[1], floor_m, 1e-9);
  EXPECT_NEAR(scan[2], floor_m, 1e-9);
  EXPECT_LE(scan[0], floor_m + 1e-9);
  EXPECT_EQ(scan[3], kInf);
  EXPECT_EQ(scan[4], kInf);
  EXPECT_NEAR(scan[5], thing_m, 1e-9);
}

TEST(LidarTest, ALeaningRobotsScanMeetsTheFloor) {
  const auto frame =
      SampleWorld().Robot({{1, 2, 0}, FromRollPitchYaw(0, 0.2, 0.7)}, With(Fan(1, 0))).MakeFrame();
  // One column looks along the first azimuth. The eye is at R (0, 0, 0.5) and pitched down by 0.2.
  const double height_m = kEye_m * std::cos(0.2);
  EXPECT_NEAR(ScanOf(*frame)[0], height_m / std::sin(0.2), 1e-9);
}

TEST(LidarTest, NearerThanTheMinimumReads0AndBeyondTheMaximumInf) {
  LidarModel lidar = Fan(1, 0, 2);
  lidar.min_range_m = 0.5;
  const auto at = [&lidar](double wall_m) {
    return ScanOf(*SampleWorld()
                       .Robot(At(0, 0), With(lidar))
                       .Object(Box{{1, 1, 2}}, Stands(wall_m + 0.5, 0, 1))
                       .MakeFrame())[0];
  };
  EXPECT_EQ(at(0.49), 0);
  EXPECT_NEAR(at(0.51), 0.51, 1e-9);
  EXPECT_NEAR(at(1.99), 1.99, 1e-9);
  EXPECT_EQ(at(2.01), kInf);
}

TEST(LidarTest, OtherRobotsAndOnlyTheLinksThatMoveOfItsOwnAreSeen) {
  // Looks straight down on the robot's own left wheel, then on the chassis that carries it.
  LidarModel down = Fan(1, 0);
  down.mount = {0, {{0, 0.17, 0.45}, FromRollPitchYaw(0, M_PI / 2, 0)}};
  auto model = SampleRobot();
  model->AddSensor("down", down);
  model->AddSensor("ahead", Fan(1, 0));
  const auto frame =
      SampleWorld()
          .Robot(At(0, 0), model)
          .Robot({{1, 0, kEye_m - 0.15}, Quaternion::Identity()})  // its chassis at the eye's height
          .MakeFrame();
  EXPECT_NEAR(Scan(*frame, 0, 0)[0], 0.5 - 0.12, 1e-9);  // the wheel's top, through the chassis
  EXPECT_NEAR(Scan(*frame, 0, 1)[0], 1 - kSampleRadius_m, 1e-9);
}

TEST(LidarTest, WhatMovesIsSeenWhereItIs) {
  auto frame =
      SampleWorld().Robot(At(0, 0), With(Fan(1, 0))).Object(Sphere{0.2}, Stands(2, 0, kEye_m), 1).MakeFrame();
  EXPECT_NEAR(ScanOf(*frame)[0], 1.8, 1e-9);
  frame =
      SampleWorld().Robot(At(0, 0), With(Fan(1, 0))).Object(Sphere{0.2}, Stands(2, 0, kEye_m), 1).MakeFrame();
  frame->bodies[0].p_WB.x() = 4;
  EXPECT_NEAR(ScanOf(*frame)[0], 3.8, 1e-9);
}

/// A pyramid of 1 m with its tip up.
std::shared_ptr<const MeshData> Pyramid() {
  Vector3 middle;
  return std::make_shared<MeshData>(
      MakeMesh({{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}, {0, 0, 1}},
               {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}, middle));
}

TEST(LidarTest, AMeshIsMetAsAllItsTrianglesSay) {
  const auto pyramid = Pyramid();
  LidarModel lidar = Fan(41, 0.5);
  lidar.rows = 9;
  lidar.first_elevation_rad = -0.25;
  lidar.last_elevation_rad = 0.3;
  const Pose X_WG{{2.3, 0.2, 0.5}, FromRollPitchYaw(0.1, -0.2, 0.4)};
  const auto frame = SampleWorld().Robot(At(0, 0), With(lidar)).Object(Mesh{pyramid.get()}, X_WG).MakeFrame();
  const std::vector<double> scan = ScanOf(*frame);
  int hits = 0;
  for (int row = 0; row < lidar.rows; ++row) {
    const double elevation = -0.25 + 0.55 * row / (lidar.rows - 1);
    for (std::size_t column = 0; column < 41; ++column) {
      const double azimuth = AzimuthOf(lidar, column);
      const Vector3 d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                      std::sin(elevation));
      double expected = elevation < 0 ? kEye_m / -std::sin(elevation) : kInf;
      for (const auto& [a, b, c] : pyramid->triangles) {
        const auto& v = pyramid->vertices;
        // Möller and Trumbore, in the world.
        const Vector3 p = X_WG * v[a], e = X_WG * v[b] - p, f = X_WG * v[c] - p, q = d.cross(f);
        const double determinant = e.dot(q);
        if (std::abs(determinant) < 1e-12) continue;
        const Vector3 s = Vector3(0, 0, kEye_m) - p, r = s.cross(e);
        const double u = s.dot(q) / determinant, w = d.dot(r) / determinant, t = f.dot(r) / determinant;
        if (u < 0 || w < 0 || u + w > 1 || t < 0) continue;
        if (t < expected) ++hits;
        expected = std::min(expected, t);
      }
      const double range = scan[static_cast<std::size_t>(row) * 41 + column];
      if (expected <= lidar.max_range_m) {
        EXPECT_NEAR(range, expected, 1e-6) << row << " " << column;
      } else {
        EXPECT_EQ(range, kInf) << row << " " << column;
      }
    }
  }
  EXPECT_GT(hits, 80);
}

// --- noise

std::unique_ptr<Frame> NoisyWall(std::uint64_t step, const ValueNoise& noise, std::uint64_t seed = 7) {
  LidarModel lidar = Fan(200, 0.5);
  lidar.noise = noise;
  auto model = SampleRobot();
  model->AddSensor("one", lidar);
  model->AddSensor("two", lidar);
  auto frame = SampleWorld().Robot(At(0, 0), model).Object(Box{{1, 40, 2}}, Stands(3.5, 0, 1)).MakeFrame();
  frame->step = step;
  frame->seed = seed;
  return frame;
}

/// Reading minus true value.
std::vector<double> Errors(std::uint64_t step, const ValueNoise& noise, std::size_t number = 0,
                           std::uint64_t seed = 7) {
  const auto exact = NoisyWall(step, {}, seed), noisy = NoisyWall(step, noise, seed);
  const std::span<const double> truth = Scan(*exact, 0, number), read = Scan(*noisy, 0, number);
  std::vector<double> errors(read.begin(), read.end());
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] -= truth[i];
  return errors;
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// −1…1
double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0) /
         std::sqrt(std::inner_product(a.begin(), a.end(), a.begin(), 0.0) *
                   std::inner_product(b.begin(), b.end(), b.begin(), 0.0));
}

TEST(RangeNoiseTest, HasItsMeanAndDeviation) {
  ValueNoise noise;
  noise.stddev = 0.02;
  noise.bias_mean = 0.01;
  std::vector<double> errors;
  for (std::uint64_t step = 0; step < 50; ++step) {
    const std::vector<double> of_step = Errors(step, noise);
    errors.insert(errors.end(), of_step.begin(), of_step.end());
  }
  EXPECT_NEAR(Mean(errors), 0.01, 0.001);  // five standard errors of 10,000
  double squares = 0;
  for (const double e : errors) squares += (e - 0.01) * (e - 0.01);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(errors.size())), 0.02, 0.0007);
}

TEST(RangeNoiseTest, IsIndependentBetweenSensorsAndSteps) {
  ValueNoise noise;
  noise.stddev = 0.02;
  const std::vector<double> errors = Errors(1, noise);
  EXPECT_LT(std::abs(Correlation(errors, Errors(2, noise))), 0.3);  // four standard errors
  EXPECT_LT(std::abs(Correlation(errors, Errors(1, noise, 1))), 0.3);
  EXPECT_LT(std::abs(Correlation(errors, Errors(1, noise, 0, 8))), 0.3);
  EXPECT_NEAR(Correlation(errors, Errors(1, noise)), 1, 1e-12);
}

TEST(RangeNoiseTest, ABiasIsThatOfTheWholeSensorAndRun) {
  ValueNoise noise;
  noise.bias_stddev = 0.05;
  const std::vector<double> errors = Errors(1, noise);
  EXPECT_GT(std::abs(errors[0]), 1e-4);
  EXPECT_THAT(errors, Each(testing::DoubleNear(errors[0], 1e-12)));
  EXPECT_NEAR(Errors(99, noise)[5], errors[0], 1e-12);
  EXPECT_GT(std::abs(Errors(1, noise, 1)[0] - errors[0]), 1e-4);
  EXPECT_GT(std::abs(Errors(1, noise, 0, 8)[0] - errors[0]), 1e-4);
}

TEST(RangeNoiseTest, AResolutionRounds) {
  ValueNoise noise;
  noise.resolution = 0.05;
  const auto frame = NoisyWall(1, noise);
  for (const double range_m : Scan(*frame, 0)) EXPECT_NEAR(range_m / 0.05, std::round(range_m / 0.05), 1e-9);
}

TEST(RangeNoiseTest, ItDoesNotDependOnWhoReadsAndHowMany) {
  ValueNoise noise;
  noise.stddev = 0.02;
  const auto alone = NoisyWall(1, noise), crowded = NoisyWall(1, noise);
  const std::vector<double> expected = ScanOf(*alone);
  std::vector<std::vector<double>> read(4);
  {
    std::vector<std::jthread> readers;
    for (std::vector<double>& mine : read) {
      readers.emplace_back([&mine, &crowded] {
        Distances(*crowded, 0);
        Scan(*crowded, 0, 1);
        mine = ScanOf(*crowded);
      });
    }
  }
  EXPECT_THAT(read, Each(expected));
}

// --- infrared

InfraredModel Gp2d12() {
  // The data sheet's typical points: V = 33.6 / (d_cm + 4).
  InfraredModel infrared;
  infrared.eyes = {OnTop()};
  for (int d_cm = 10; d_cm <= 80; ++d_cm) infrared.curve.push_back({d_cm / 100.0, 33.6 / (d_cm + 4), 0});
  infrared.max_range_m = 0.8;
  infrared.dark = 0.25;
  return infrared;
}

double InfraredAt(double wall_m, const InfraredModel& infrared) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), With(infrared))
                         .Object(Box{{0.5, 1, 1}}, Stands(wall_m + 0.25, 0, 0.5))
                         .MakeFrame();
  return InfraredValues(*frame, 0)[0];
}

TEST(InfraredTest, PutsOutItsCurveAtTheDataSheetsPoints) {
  const std::pair<double, double> points[] = {{0.1, 2.40},  {0.2, 1.40},  {0.3, 0.988},
                                              {0.4, 0.764}, {0.6, 0.525}, {0.8, 0.40}};
  for (const auto& [wall_m, volts] : points) EXPECT_NEAR(InfraredAt(wall_m, Gp2d12()), volts, 1e-3) << wall_m;
  EXPECT_EQ(InfraredAt(0.81, Gp2d12()), 0.25);
}

TEST(InfraredTest, IsLinearBetweenTheRowsAndLevelBeyond) {
  InfraredModel infrared = Gp2d12();
  infrared.curve = {{0.2, 3, 0}, {0.4, 1, 0}};
  EXPECT_NEAR(InfraredAt(0.25, infrared), 2.5, 1e-9);
  EXPECT_NEAR(InfraredAt(0.1, infrared), 3, 1e-9);
  EXPECT_NEAR(InfraredAt(0.7, infrared), 1, 1e-9);
}

TEST(InfraredTest, TheNearestOfItsRaysCounts) {
  InfraredModel infrared = Gp2d12();
  const auto at = [](const InfraredModel& model) {
    const auto frame =
        SampleWorld()
            .Robot(At(0, 0), With(model))
            .Object(Cylinder{0.01, 1}, Stands(0.5 * std::cos(0.1), 0.5 * std::sin(0.1), kEye_m))
            .MakeFrame();
    return InfraredValues(*frame, 0)[0];
  };
  EXPECT_EQ(at(infrared), 0.25);
  infrared.opening_rad = 0.2;
  infrared.rays = 3;
  EXPECT_NEAR(at(infrared), 33.6 / (49 + 4), 1e-3);
}

}  // namespace
}  // namespace coopdyn::range_sensors
