// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <atomic>
#include <exception>
#include <latch>
#include <thread>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/mounted.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

constexpr int kRobots = 40;

std::unique_ptr<Frame> CrowdedFrame() {
  auto model = SampleRobot(11);
  for (SectorModel& sensor : SensorOf<DistanceModel>(*model).sectors) sensor.noise_stddev_m = 0.01;
  SampleWorld world;
  for (int i = 0; i < kRobots; ++i) world.Robot(At(i % 8 * 0.9, i / 8 * 1.1, 0.7 * i), model);
  return world.Mark(1, 1).Mark(-3, 2).MakeFrame();
}

std::vector<double> ReadAll(const Frame& frame, int first) {
  std::vector<double> values(kRobots * 13);
  for (int k = 0; k < kRobots; ++k) {
    const int robot = (first + k) % kRobots;
    double* value = values.data() + 13 * robot;
    for (const double range : Distances(frame, robot)) *value++ = range;
    *value++ = SeenTargets(frame, robot)[1].bearing_rad;
    *value++ = SeenRobots(frame, robot)[5].distance_m;
  }
  return values;
}

TEST(SensingThreadsTest, FourThreadsAtOnceReadWhatOneReads) {
  const std::vector<double> expected = ReadAll(*CrowdedFrame(), 0);
  for (int round = 0; round < 20; ++round) {
    const auto frame = CrowdedFrame();
    std::vector<std::vector<double>> results(4);
    std::latch start(4);
    {
      std::vector<std::jthread> threads;
      for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
          start.arrive_and_wait();
          results[static_cast<std::size_t>(t)] = ReadAll(*frame, t % 2 * 17);
        });
      }
    }
    for (const auto& result : results) EXPECT_EQ(result, expected);
  }
}

TEST(SensingThreadsTest, AReadingThatCannotBeMadeHoldsNoReaderUp) {
  LidarModel lidar;
  lidar.columns = 4;
  lidar.rows = -(1 << 30);  // 2^64 - 2^32 rays: too many for a vector, so computing them throws
  const auto frame = SampleWorld().Robot(At(0, 0), range_sensors::With(lidar)).MakeFrame();
  std::latch start(4);
  std::atomic<int> told = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        start.arrive_and_wait();
        try {
          Scan(*frame, 0);
        } catch (const std::exception&) {
          ++told;
        }
      });
    }
  }
  EXPECT_EQ(told, 4);
}

}  // namespace
}  // namespace coopdyn
