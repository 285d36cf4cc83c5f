// SPDX-License-Identifier: MIT
#include "server/state/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

struct Moments {
  double mean = 0, stddev = 0;
};

Moments MomentsOf(const std::vector<double>& values) {
  Moments m;
  for (const double v : values) m.mean += v / static_cast<double>(values.size());
  for (const double v : values) m.stddev += (v - m.mean) * (v - m.mean) / static_cast<double>(values.size());
  m.stddev = std::sqrt(m.stddev);
  return m;
}

// A wall 2 m ahead of the sample robot's only sensor, and a target 2 m ahead.
std::unique_ptr<Frame> NoisyFrame(std::uint64_t seed, std::uint64_t step, double stddev, double wall_m = 2) {
  auto model = SampleRobot(1);
  SensorOf<DistanceModel>(*model).sectors[0].noise_stddev_m = stddev;
  SensorOf<TargetModel>(*model).distance_noise_stddev_m = stddev;
  SensorOf<TargetModel>(*model).bearing_noise_stddev_rad = stddev;
  auto frame =
      SampleWorld()
          .Robot(At(0, 0), model)
          .Robot(At(0, 2), model)
          .Object(Box{{0.2, 9, 1}}, {{kSampleRadius_m + wall_m + 0.1, 0, 0.5}, Quaternion::Identity()})
          .Mark(2, 0)
          .MakeFrame();
  frame->seed = seed;
  frame->step = step;
  return frame;
}

TEST(NoiseTest, IsStandardNormal) {
  std::vector<double> values;
  int beyond_two = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    values.push_back(GaussianNoise({7, NoiseKind::kDistance, 1 + i % 10, 1 + i / 10 % 10, i / 100, 0}));
    beyond_two += std::abs(values.back()) > 2;
  }
  const Moments m = MomentsOf(values);
  EXPECT_NEAR(m.mean, 0, 0.03);  // four standard errors
  EXPECT_NEAR(m.stddev, 1, 0.02);
  EXPECT_NEAR(beyond_two / 20000.0, 0.0455, 0.006);
}

TEST(NoiseTest, UniformNoiseIsEvenBetweenItsBoundsAndIndependentOfTheGaussian) {
  const ValueNoise noise{.uniform = 0.3};
  EXPECT_FALSE(noise.exact());
  std::vector<double> values;
  double product = 0, sum = 0;
  for (std::uint64_t step = 0; step < 20000; ++step) {
    const NoiseKey key{7, NoiseKind::kLight, 1, 1, step, 0};
    values.push_back(Noisy(2, noise, key));
    EXPECT_LE(std::abs(values.back() - 2), 0.3);
    product += CentredNoise(key) * GaussianNoise(key);
    sum += Noisy(0, {.stddev = 1, .uniform = 0.3}, key) - GaussianNoise(key);
  }
  const Moments m = MomentsOf(values);
  EXPECT_NEAR(m.mean, 2, 4 * 0.3 / std::sqrt(3.0 * 20000));  // four standard errors
  EXPECT_NEAR(m.stddev, 0.3 / std::sqrt(3.0), 0.003);
  EXPECT_NEAR(product / 20000, 0, 4 / std::sqrt(3.0 * 20000));
  EXPECT_NEAR(sum / 20000, 0, 4 * 0.3 / std::sqrt(3.0 * 20000));
  EXPECT_GT(*std::ranges::max_element(values), 2.29);
  EXPECT_LT(*std::ranges::min_element(values), 1.71);
}

TEST(NoiseTest, DiffersInEveryPartOfItsKey) {
  const NoiseKey key{7, NoiseKind::kDistance, 1, 2, 3, 0};
  EXPECT_EQ(GaussianNoise(key), GaussianNoise(key));
  NoiseKey other = key;
  other.seed = 8;
  EXPECT_NE(GaussianNoise(key), GaussianNoise(other));
  other = key;
  other.kind = NoiseKind::kTargetBearing;
  EXPECT_NE(GaussianNoise(key), GaussianNoise(other));
  other = {7, NoiseKind::kDistance, 2, 1, 3, 0};
  EXPECT_NE(GaussianNoise(key), GaussianNoise(other));
  other = key;
  other.step = 4;
  EXPECT_NE(GaussianNoise(key), GaussianNoise(other));
  other = key;
  other.sample = 1;
  EXPECT_NE(GaussianNoise(key), GaussianNoise(other));
}

TEST(NoiseTest, StepsAreNotCorrelated) {
  double product = 0;
  for (std::uint64_t step = 0; step < 10000; ++step) {
    product += GaussianNoise({1, NoiseKind::kDistance, 1, 1, step, 0}) *
               GaussianNoise({1, NoiseKind::kDistance, 1, 1, step + 1, 0});
  }
  EXPECT_NEAR(product / 10000, 0, 0.04);
}

TEST(NoiseTest, RangesScatterAroundTheTrueOneWithTheModelsDeviation) {
  std::vector<double> ranges;
  for (std::uint64_t step = 0; step < 2000; ++step)
    ranges.push_back(Distances(*NoisyFrame(7, step, 0.05), 0)[0]);
  const Moments m = MomentsOf(ranges);
  EXPECT_NEAR(m.mean, 2, 4 * 0.05 / std::sqrt(2000));
  EXPECT_NEAR(m.stddev, 0.05, 0.004);
}

TEST(NoiseTest, ReadingAgainGivesTheSameValue) {
  const auto frame = NoisyFrame(7, 5, 0.05);
  const auto again = NoisyFrame(7, 5, 0.05);
  EXPECT_EQ(Distances(*frame, 0)[0], Distances(*frame, 0)[0]);
  EXPECT_EQ(Distances(*frame, 0)[0], Distances(*again, 0)[0]);
  EXPECT_EQ(SeenTargets(*frame, 0)[0].bearing_rad, SeenTargets(*again, 0)[0].bearing_rad);
  EXPECT_NE(Distances(*frame, 0)[0], Distances(*NoisyFrame(7, 6, 0.05), 0)[0]);
  EXPECT_NE(Distances(*frame, 0)[0], Distances(*NoisyFrame(8, 5, 0.05), 0)[0]);
}

TEST(NoiseTest, NoisyRangesStayBetweenZeroAndTheMaximum) {
  double smallest = 1, largest = 0;
  for (std::uint64_t step = 0; step < 200; ++step) {
    smallest = std::min(smallest, Distances(*NoisyFrame(7, step, 0.5, 0.1), 0)[0]);
    largest = std::max(largest, Distances(*NoisyFrame(7, step, 0.5, kSampleRange_m - 0.1), 0)[0]);
  }
  EXPECT_EQ(smallest, 0);
  EXPECT_EQ(largest, kSampleRange_m);
}

TEST(NoiseTest, NothingInRangeStaysInfinite) {
  EXPECT_EQ(Distances(*NoisyFrame(7, 1, 0.5, 6), 0)[0], std::numeric_limits<double>::infinity());
}

TEST(NoiseTest, SightingsScatterWithTheModelsDeviation) {
  std::vector<double> distances, bearings;
  for (std::uint64_t step = 0; step < 2000; ++step) {
    const auto frame = NoisyFrame(7, step, 0.05);
    distances.push_back(SeenTargets(*frame, 0)[0].distance_m);
    bearings.push_back(SeenRobots(*frame, 0)[0].bearing_rad);
  }
  EXPECT_NEAR(MomentsOf(distances).mean, 2, 0.005);
  EXPECT_NEAR(MomentsOf(distances).stddev, 0.05, 0.004);
  EXPECT_NEAR(MomentsOf(bearings).mean, std::numbers::pi / 2, 0.005);
  EXPECT_NEAR(MomentsOf(bearings).stddev, 0.05, 0.004);
}

}  // namespace
}  // namespace coopdyn
