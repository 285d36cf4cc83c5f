// SPDX-License-Identifier: MIT
// The list of a robot's sensors: the compass, and several sensors of one kind.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

constexpr double kPi = std::numbers::pi;

std::shared_ptr<RobotModel> WithCompasses(std::vector<double> stddevs_rad) {
  auto model = SampleRobot();
  for (const double stddev_rad : stddevs_rad) model->AddSensor("compass", CompassModel{stddev_rad});
  return model;
}

TEST(CompassTest, TellsTheHeadingOfTheFrontInTheWorld) {
  const auto model = WithCompasses({0});
  for (const double heading_rad : {0.0, 0.5 * kPi, -0.5 * kPi, 3.1, -3.1, kPi}) {
    const auto frame = SampleWorld().Robot(At(1, 2, heading_rad), model).MakeFrame();
    EXPECT_NEAR(std::remainder(CompassHeading(*frame, 0) - heading_rad, 2 * kPi), 0, 1e-12);
    EXPECT_GT(CompassHeading(*frame, 0), -kPi);
    EXPECT_LE(CompassHeading(*frame, 0), kPi);
  }
}

TEST(CompassTest, IsNanWithoutOne) {
  const auto frame = SampleWorld().Robot(At(0, 0)).Robot(At(1, 0), WithCompasses({0})).MakeFrame();
  EXPECT_TRUE(std::isnan(CompassHeading(*frame, 0)));
  EXPECT_FALSE(std::isnan(CompassHeading(*frame, 1)));
  EXPECT_TRUE(std::isnan(CompassHeading(*frame, 1, 1)));
}

TEST(CompassTest, NoiseHasTheModelsDeviationAndIsIndependentBetweenSensorsAndSteps) {
  const auto model = WithCompasses({0.1, 0.3});
  const auto frame = SampleWorld().Robot(At(0, 0, kPi), model).MakeFrame();
  constexpr int kSteps = 4000;
  double mean[2] = {0, 0}, square[2] = {0, 0}, both = 0, next = 0, last = 0;
  for (int step = 0; step < kSteps; ++step) {
    frame->step = static_cast<std::uint64_t>(step);
    double error[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const double heading_rad = CompassHeading(*frame, 0, i);
      ASSERT_GT(heading_rad, -kPi);
      ASSERT_LE(heading_rad, kPi);
      error[i] = std::remainder(heading_rad - kPi, 2 * kPi);
      mean[i] += error[i] / kSteps;
      square[i] += error[i] * error[i] / kSteps;
    }
    both += error[0] / 0.1 * error[1] / 0.3 / kSteps;
    next += error[0] / 0.1 * last / 0.1 / kSteps;
    last = error[0];
  }
  EXPECT_NEAR(mean[0], 0, 4 * 0.1 / std::sqrt(kSteps));
  EXPECT_NEAR(mean[1], 0, 4 * 0.3 / std::sqrt(kSteps));
  EXPECT_NEAR(std::sqrt(square[0]), 0.1, 0.005);
  EXPECT_NEAR(std::sqrt(square[1]), 0.3, 0.015);
  EXPECT_NEAR(both, 0, 4 / std::sqrt(kSteps));
  EXPECT_NEAR(next, 0, 4 / std::sqrt(kSteps));
}

TEST(CompassTest, NoiseIsTheSameHoweverOftenItIsReadAndOtherForAnotherSeed) {
  const auto frame = SampleWorld().Robot(At(0, 0), WithCompasses({0.1})).MakeFrame();
  const double first = CompassHeading(*frame, 0);
  Distances(*frame, 0);
  EXPECT_EQ(CompassHeading(*frame, 0), first);
  frame->seed = 8;
  EXPECT_NE(CompassHeading(*frame, 0), first);
}

/// A sensor that looks towards `bearing_rad`.
DistanceModel Side(double bearing_rad, double noise_stddev_m) {
  SectorModel sector;
  sector.bearing_rad = bearing_rad;
  sector.X_RS.q = FromRollPitchYaw(0, 0, bearing_rad);
  sector.X_RS.p = sector.X_RS.q * Vector3(kSampleRadius_m, 0, 0) + Vector3(0, 0, kSampleSensor_m);
  sector.max_range_m = 4;
  sector.noise_stddev_m = noise_stddev_m;
  return {{sector}};
}

std::unique_ptr<Frame> BetweenWalls(double noise_stddev_m) {
  auto model = SampleRobot(0);
  model->AddSensor("left", Side(kPi / 2, noise_stddev_m));
  model->AddSensor("right", Side(-kPi / 2, noise_stddev_m));
  const auto wall = [](double y) { return Pose{{0, y, 0.5}, Quaternion::Identity()}; };
  return SampleWorld()
      .Robot(At(5, 0))
      .Robot(At(0, 0), model)
      .Object(Box{{9, 0.2, 1}}, wall(1.3))
      .Object(Box{{9, 0.2, 1}}, wall(-2.3))
      .MakeFrame();
}

TEST(SensorsTest, DistanceSensorsOfOneRobotAreReadSinglyAndTogether) {
  const auto frame = BetweenWalls(0);
  ASSERT_EQ(Distances(*frame, 1).size(), 2u);
  EXPECT_NEAR(Distances(*frame, 1, 0)[0], 1, 1e-9);
  EXPECT_NEAR(Distances(*frame, 1, 1)[0], 2, 1e-9);
  EXPECT_EQ(Distances(*frame, 1)[0], Distances(*frame, 1, 0)[0]);
  EXPECT_EQ(Distances(*frame, 1)[1], Distances(*frame, 1, 1)[0]);
  EXPECT_TRUE(Distances(*frame, 1, 2).empty());
  EXPECT_EQ(Distances(*frame, 0).size(), 3u);
  EXPECT_EQ(DistanceRays(*frame, 1).size(), 2u);
}

TEST(SensorsTest, NoiseOfTwoDistanceSensorsDiffers) {
  const auto frame = BetweenWalls(0.01);
  const double left = Distances(*frame, 1, 0)[0] - 1, right = Distances(*frame, 1, 1)[0] - 2;
  EXPECT_NE(left, right);
  EXPECT_NE(left, 0);
  EXPECT_NE(right, 0);
}

TEST(SensorsTest, TwoTargetSensorsHaveTheirOwnRangeAndNoise) {
  auto model = SampleRobot();
  SensorOf<TargetModel>(*model).distance_noise_stddev_m = 0.1;
  model->AddSensor("second", TargetModel{.distance_noise_stddev_m = 0.1});
  model->AddSensor("short", TargetModel{.max_range_m = 1});
  const auto frame = SampleWorld().Robot(At(0, 0), model).Mark(2, 0).MakeFrame();
  ASSERT_EQ(SeenTargets(*frame, 0).size(), 1u);
  ASSERT_EQ(SeenTargets(*frame, 0, 1).size(), 1u);
  EXPECT_NE(SeenTargets(*frame, 0)[0].distance_m, SeenTargets(*frame, 0, 1)[0].distance_m);
  EXPECT_TRUE(SeenTargets(*frame, 0, 2).empty());
  EXPECT_TRUE(SeenTargets(*frame, 0, 3).empty());
}

/// A robot whose second link, 0.3 m above the floor, carries a load.
std::shared_ptr<RobotModel> WithSupport(const SupportModel& support) {
  auto model = SampleRobot();
  LinkModel cradle;
  cradle.name = support.link;
  cradle.mass_kg = 1;
  cradle.X_RL.p = Vector3(0.1, 0, 0.3);
  model->links = {model->links.front(), cradle};
  model->AddSensor("support", support);
  return model;
}

/// A frame in which the robot is at (1, 2) with heading 0.5 and its load is displaced by (0.02, -0.03) and
/// 0.4 rad in the robot's frame.
std::shared_ptr<Frame> MovedLoad(const SupportModel& support) {
  const auto frame = SampleWorld().Robot(At(1, 2, 0.5), WithSupport(support)).MakeFrame();
  auto moved = std::make_shared<Frame>();
  moved->seed = frame->seed;
  moved->scene = frame->scene;
  moved->bodies = frame->bodies;
  const SceneRobot& robot = moved->scene->robots[0];
  BodyState& cradle = moved->bodies[static_cast<std::size_t>(robot.first_body) + 1];
  const Pose X_WL = RobotPose(*moved, 0) * Pose{Vector3(0.12, -0.03, 0.3), FromRollPitchYaw(0, 0, 0.4)};
  cradle.p_WB = X_WL.p;
  cradle.q_WB = {X_WL.q.w(), X_WL.q.x(), X_WL.q.y(), X_WL.q.z()};
  return moved;
}

TEST(SupportTest, TellsHowFarTheLoadHasMovedItInTheRobotsFrame) {
  const SupportReading reading = Support(*MovedLoad({.link = "cradle"}), 0);
  EXPECT_NEAR(reading.x_m, 0.02, 1e-9);
  EXPECT_NEAR(reading.y_m, -0.03, 1e-9);
  EXPECT_NEAR(reading.angle_rad, 0.4, 1e-9);
}

TEST(SupportTest, IsZeroWhereTheModelIsWritten) {
  const auto frame = SampleWorld().Robot(At(1, 2, 0.5), WithSupport({.link = "cradle"})).MakeFrame();
  const SupportReading reading = Support(*frame, 0);
  EXPECT_NEAR(reading.x_m, 0, 1e-12);
  EXPECT_NEAR(reading.y_m, 0, 1e-12);
  EXPECT_NEAR(reading.angle_rad, 0, 1e-12);
}

TEST(SupportTest, IsNanWithoutOne) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  EXPECT_TRUE(std::isnan(Support(*frame, 0).x_m));
  EXPECT_TRUE(std::isnan(Support(*frame, 0).angle_rad));
}

TEST(SupportTest, NoiseHasTheModelsDeviation) {
  const auto frame = MovedLoad({.link = "cradle", .noise_stddev_m = 0.001, .angle_noise_stddev_rad = 0.01});
  double x2 = 0, angle2 = 0;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    frame->step = static_cast<std::uint64_t>(i);
    const SupportReading reading = Support(*frame, 0);
    x2 += std::pow(reading.x_m - 0.02, 2) / kSamples;
    angle2 += std::pow(reading.angle_rad - 0.4, 2) / kSamples;
  }
  EXPECT_NEAR(std::sqrt(x2), 0.001, 1e-4);
  EXPECT_NEAR(std::sqrt(angle2), 0.01, 1e-3);
}

TEST(SensorsTest, AppendReadingReadsAnyOfThem) {
  auto model = WithCompasses({0});
  model->AddSensor("pose", PoseModel());
  SensorOf<NeighboursModel>(*model).range_m = 3;
  const auto frame = SampleWorld().Robot(At(0, 0, 0.5), model).Robot(At(2, 0), model).Mark(0, 4).MakeFrame();
  std::vector<std::size_t> sizes;
  for (std::size_t i = 0; i <= model->sensors.size(); ++i) {
    std::vector<double> data{99};
    AppendReading(*frame, 0, i, data);
    EXPECT_EQ(data[0], 99);
    sizes.push_back(data.size() - 1);
    if (i < model->sensors.size() && std::holds_alternative<CompassModel>(model->sensors[i].kind)) {
      EXPECT_NEAR(data[1], 0.5, 1e-12);
    }
  }
  EXPECT_EQ(sizes, (std::vector<std::size_t>{3, 2, 5, 2, 1, 0}));
}

template <std::size_t... I>
std::vector<SensorKind> OneOfEach(std::index_sequence<I...> /*of*/) {
  return {SensorKind(std::in_place_index<I>)...};
}

TEST(SensorsTest, EachFixedValueHasAName) {
  std::vector<SensorKind> kinds = OneOfEach(std::make_index_sequence<std::variant_size_v<SensorKind>>());
  LidarModel lidar;
  lidar.columns = 5;
  lidar.rows = 2;
  ContactModel bumper;
  bumper.zones.resize(3);
  SonarModel sonar;
  sonar.beams.resize(2);
  InfraredModel infrared;
  infrared.eyes.resize(4);
  LightModel light;
  light.eyes.resize(2);
  kinds.insert(kinds.end(),
               {DistanceModel{std::vector<SectorModel>(3)}, lidar, bumper, sonar, infrared, light});
  for (const SensorKind& kind : kinds) EXPECT_EQ(FixedNames(kind).size(), FixedCount(kind)) << kind.index();
}

}  // namespace
}  // namespace coopdyn
