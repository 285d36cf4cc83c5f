// SPDX-License-Identifier: MIT
// Ranges computed for many robots at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <latch>
#include <numbers>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

constexpr int kCrowd = 900;

/// Worlds of many noisy robots and a few moving things; the same for the same seed.
class Swarm {
 public:
  Swarm() {
    auto model = SampleRobot(11);
    for (SectorModel& sensor : SensorOf<DistanceModel>(*model).sectors) sensor.noise_stddev_m = 0.01;
    auto short_model = SampleRobot(24);
    for (SectorModel& sensor : SensorOf<DistanceModel>(*short_model).sectors) sensor.max_range_m = 0.2;
    SampleWorld world;
    for (int i = 0; i < kCrowd; ++i)
      world.Robot(At(i % 30, i / 30, 0.7 * i), i % 3 == 0 ? short_model : model);
    for (int i = 0; i < 40; ++i) {
      world.Object(Cylinder{0.1, 0.5}, {{i % 8 * 3.7, i / 8 * 5.3, 0.25}, Quaternion::Identity()}, i % 2);
    }
    first_ = world.MakeFrame(Fidelity::kRolling);
  }

  /// A frame of the scene with new random poses.
  std::unique_ptr<Frame> MakeFrame(unsigned seed) const {
    auto frame = std::make_unique<Frame>();
    frame->scene = first_->scene;
    frame->step = seed;
    frame->bodies = first_->bodies;
    frame->channels = first_->channels;
    std::mt19937 engine(seed);
    std::uniform_real_distribution<> shift(-0.4, 0.4);
    for (BodyState& body : frame->bodies) {
      body.p_WB.x() += shift(engine);
      body.p_WB.y() += shift(engine);
    }
    return frame;
  }

 private:
  std::unique_ptr<Frame> first_;
};

std::vector<int> AllRobots() {
  std::vector<int> robots(kCrowd);
  std::iota(robots.begin(), robots.end(), 0);
  return robots;
}

std::vector<double> ReadAll(const Frame& frame) {
  std::vector<double> values;
  for (int robot = 0; robot < kCrowd; ++robot) {
    const auto ranges_m = Distances(frame, robot);
    values.insert(values.end(), ranges_m.begin(), ranges_m.end());
  }
  return values;
}

TEST(PrepareDistancesTest, AnyNumberOfThreadsGivesTheBitsOfOneRobotAtATime) {
  const Swarm swarm;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::vector<double> expected = ReadAll(*swarm.MakeFrame(seed));
    EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](double m) { return std::isfinite(m); }),
              1000);
    for (const int threads : {1, 2, 4}) {
      WorkerPool pool(threads);
      const auto frame = swarm.MakeFrame(seed);
      PrepareDistances(*frame, AllRobots(), pool);
      EXPECT_EQ(ReadAll(*frame), expected) << threads << " threads, seed " << seed;
    }
  }
}

TEST(PrepareDistancesTest, SomeRobotsInAnyOrderAndTwice) {
  const Swarm swarm;
  const std::vector<double> expected = ReadAll(*swarm.MakeFrame(5));
  const auto frame = swarm.MakeFrame(5);
  WorkerPool pool(2);
  PrepareDistances(*frame, std::vector<int>{77, 3, 899, 3}, pool);
  PrepareDistances(*frame, std::vector<int>{3, 4}, pool);
  EXPECT_EQ(ReadAll(*frame), expected);
}

TEST(PrepareDistancesTest, BuffersOfOlderFramesLeaveNoTrace) {
  const Swarm swarm;
  WorkerPool pool(2);
  std::vector<std::unique_ptr<Frame>> held;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    held.push_back(swarm.MakeFrame(seed));
    PrepareDistances(*held.back(), AllRobots(), pool);
    if (held.size() > 2) held.erase(held.begin());
  }
  // Results still held are unchanged; a new one in reused buffers equals a first one.
  EXPECT_EQ(ReadAll(*held.front()), ReadAll(*Swarm().MakeFrame(7)));
  held.clear();
  EXPECT_EQ(ReadAll(*swarm.MakeFrame(9)), ReadAll(*Swarm().MakeFrame(9)));
}

TEST(PrepareDistancesTest, RobotsThreadsMayReadMeanwhile) {
  const Swarm swarm;
  const std::vector<double> expected = ReadAll(*swarm.MakeFrame(6));
  const auto frame = swarm.MakeFrame(6);
  WorkerPool pool(2);
  std::vector<double> read;
  std::latch start(2);
  {
    const std::jthread reader([&] {
      start.arrive_and_wait();
      read = ReadAll(*frame);
    });
    start.arrive_and_wait();
    PrepareDistances(*frame, AllRobots(), pool);
  }
  EXPECT_EQ(read, expected);
  EXPECT_EQ(ReadAll(*frame), expected);
}

}  // namespace
}  // namespace coopdyn
