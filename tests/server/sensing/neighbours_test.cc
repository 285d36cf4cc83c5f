// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

std::shared_ptr<RobotModel> Talker(double range_m = 1, double message_range_m = 1) {
  auto model = SampleRobot(1);
  SensorOf<NeighboursModel>(*model).range_m = range_m;
  SensorOf<NeighboursModel>(*model).message_range_m = message_range_m;
  return model;
}

/// `count` robots of `model` at random positions in a square.
std::unique_ptr<Frame> Crowd(int count, double side_m, const std::shared_ptr<const RobotModel>& model,
                             unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<> place(0, side_m), heading(-std::numbers::pi, std::numbers::pi);
  SampleWorld world;
  for (int i = 0; i < count; ++i) {
    const double x = place(engine), y = place(engine);
    world.Robot(At(x, y, heading(engine)), model);
  }
  return world.MakeFrame();
}

void Broadcast(Frame& frame, int robot, std::uint64_t step, double value = 0) {
  SentMessage sent;
  sent.robot = static_cast<std::uint32_t>(robot);
  sent.step = step;
  sent.message.count = 1;
  sent.message.values[0] = value;
  frame.messages.push_back(sent);
}

TEST(NeighboursTest, AreSeenByRangeAndBearingByIncreasingId) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0, std::numbers::pi / 2), Talker())
                         .Robot(At(0, -0.9), Talker())
                         .Robot(At(3, 0), Talker())
                         .Robot(At(0.5, 0), Talker())
                         .MakeFrame();
  const std::vector<Sighting> seen = Neighbours(*frame, 0);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].index, 1);
  EXPECT_NEAR(seen[0].distance_m, 0.9, 1e-12);
  EXPECT_NEAR(std::abs(seen[0].bearing_rad), std::numbers::pi, 1e-12);
  EXPECT_EQ(seen[1].index, 3);
  EXPECT_NEAR(seen[1].distance_m, 0.5, 1e-12);
  EXPECT_NEAR(seen[1].bearing_rad, -std::numbers::pi / 2, 1e-12);
}

TEST(NeighboursTest, AreSeenThroughWalls) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Talker())
                         .Robot(At(0.9, 0), Talker())
                         .Object(Box{{0.05, 2, 1}}, {{0.45, 0, 0.5}, Quaternion::Identity()})
                         .MakeFrame();
  EXPECT_EQ(Neighbours(*frame, 0).size(), 1U);
}

TEST(NeighboursTest, ARobotWithoutTheModuleSeesAndHearsNobody) {
  auto frame = SampleWorld().Robot(At(0, 0)).Robot(At(0.5, 0), Talker()).MakeFrame();
  Broadcast(*frame, 1, frame->step);
  EXPECT_TRUE(Neighbours(*frame, 0).empty());
  EXPECT_TRUE(HeardMessages(*frame, 0).empty());
  EXPECT_EQ(Neighbours(*frame, 1).size(), 1U);
}

TEST(NeighboursTest, EqualAllPairsAndAreMutual) {
  int pairs = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const double range_m = 0.2 * seed;
    const auto frame = Crowd(150, 8, Talker(range_m), seed);
    std::vector<std::vector<double>> distances(150, std::vector<double>(150, -1));
    for (int robot = 0; robot < 150; ++robot) {
      std::vector<int> expected, found;
      const Vector3 p = RobotPose(*frame, robot).p;
      for (int other = 0; other < 150; ++other) {
        const Vector3 way = RobotPose(*frame, other).p - p;
        if (other != robot && std::hypot(way.x(), way.y()) <= range_m) expected.push_back(other);
      }
      for (const Sighting& sighting : Neighbours(*frame, robot)) {
        found.push_back(sighting.index);
        const Vector3 way = RobotPose(*frame, sighting.index).p - p;
        EXPECT_NEAR(sighting.distance_m, std::hypot(way.x(), way.y()), 1e-12);
        const double bearing_rad = std::atan2(way.y(), way.x()) - Heading(RobotPose(*frame, robot).q);
        EXPECT_NEAR(std::remainder(sighting.bearing_rad - bearing_rad, 2 * std::numbers::pi), 0, 1e-9);
        distances[static_cast<std::size_t>(robot)][static_cast<std::size_t>(sighting.index)] =
            sighting.distance_m;
      }
      ASSERT_EQ(found, expected) << "robot " << robot << " range " << range_m;
      pairs += static_cast<int>(found.size());
    }
    for (std::size_t a = 0; a < 150; ++a) {
      for (std::size_t b = 0; b < a; ++b) ASSERT_EQ(distances[a][b], distances[b][a]);
    }
  }
  EXPECT_GT(pairs, 1000);
}

TEST(NeighboursTest, NoiseScattersWithTheModelsDeviationWhateverIsReadFirst) {
  auto model = Talker();
  SensorOf<NeighboursModel>(*model).distance_noise_stddev_m = 0.02;
  SensorOf<NeighboursModel>(*model).bearing_noise_stddev_rad = 0.1;
  double square_m2 = 0, square_rad2 = 0;
  constexpr int kSteps = 2000;
  for (int step = 0; step < kSteps; ++step) {
    const SampleWorld world = SampleWorld().Robot(At(0, 0), model).Robot(At(0.5, 0), model);
    const auto frame = world.MakeFrame(), again = world.MakeFrame();
    frame->step = again->step = static_cast<std::uint64_t>(step);
    const Sighting seen = Neighbours(*frame, 0)[0];
    square_m2 += std::pow(seen.distance_m - 0.5, 2) / kSteps;
    square_rad2 += std::pow(seen.bearing_rad, 2) / kSteps;
    const Sighting other_first = Neighbours(*again, 1)[0];
    EXPECT_NE(other_first.distance_m, seen.distance_m);
    EXPECT_EQ(Neighbours(*again, 0)[0].distance_m, seen.distance_m);
    EXPECT_EQ(Neighbours(*again, 0)[0].bearing_rad, seen.bearing_rad);
  }
  EXPECT_NEAR(std::sqrt(square_m2), 0.02, 0.002);
  EXPECT_NEAR(std::sqrt(square_rad2), 0.1, 0.01);
}

TEST(HeardMessagesTest, ComeFromWithinTheMessageRangeOfTheirStep) {
  auto frame = SampleWorld()
                   .Robot(At(0, 0), Talker(5, 1))
                   .Robot(At(0.9, 0), Talker(5, 1))
                   .Robot(At(0, 1.1), Talker(5, 1))
                   .MakeFrame();
  Broadcast(*frame, 1, frame->step - 1, 1);
  for (int robot = 0; robot < 3; ++robot) Broadcast(*frame, robot, frame->step, 10 + robot);
  const auto heard = HeardMessages(*frame, 0);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].sender, 1);
  EXPECT_EQ(heard[0].message->values[0], 11);
  EXPECT_NEAR(heard[0].from.distance_m, 0.9, 1e-12);
  EXPECT_NEAR(heard[0].from.bearing_rad, 0, 1e-12);
}

TEST(HeardMessagesTest, ArriveAfterTheDelayAndOnlyThen) {
  auto model = Talker();
  SensorOf<NeighboursModel>(*model).delay_steps = 3;
  const SampleWorld world = SampleWorld().Robot(At(0, 0), model).Robot(At(0.5, 0), model);
  for (std::uint64_t step = 0; step <= 12; ++step) {
    const auto frame = world.MakeFrame();
    frame->step = step;
    if (step >= 5) Broadcast(*frame, 1, 5, 42);
    const auto heard = HeardMessages(*frame, 0);
    ASSERT_EQ(heard.size(), step == 8 ? 1U : 0U) << step;
    if (step == 8) {
      EXPECT_EQ(heard[0].message->values[0], 42);
    }
  }
}

TEST(HeardMessagesTest, AnEmptyBroadcastIsNone) {
  auto frame = SampleWorld().Robot(At(0, 0), Talker()).Robot(At(0.5, 0), Talker()).MakeFrame();
  Broadcast(*frame, 1, frame->step);
  frame->messages[0].message.count = 0;
  EXPECT_TRUE(HeardMessages(*frame, 0).empty());
}

TEST(HeardMessagesTest, EqualAllPairsWhoeverBroadcasts) {
  for (const int every : {1, 3, 40}) {  // all, some, few
    auto frame = Crowd(200, 6, Talker(1, 0.8), 7);
    for (int robot = 0; robot < 200; robot += every) Broadcast(*frame, robot, frame->step, robot);
    int heard_count = 0;
    for (int robot = 0; robot < 200; ++robot) {
      std::vector<int> expected, found;
      for (int sender = 0; sender < 200; sender += every) {
        const Vector3 way = RobotPose(*frame, sender).p - RobotPose(*frame, robot).p;
        if (sender != robot && std::hypot(way.x(), way.y()) <= 0.8) expected.push_back(sender);
      }
      for (const HeardMessage& heard : HeardMessages(*frame, robot)) found.push_back(heard.sender);
      ASSERT_EQ(found, expected) << "robot " << robot << " every " << every;
      heard_count += static_cast<int>(found.size());
    }
    EXPECT_GT(heard_count, 10);
  }
}

TEST(HeardMessagesTest, AreLostAtTheRateOfTheModelEachReceiverForItself) {
  auto model = Talker();
  SensorOf<NeighboursModel>(*model).loss = 0.3;
  const SampleWorld world =
      SampleWorld().Robot(At(0, 0), model).Robot(At(0.5, 0), model).Robot(At(0, 0.5), model);
  constexpr int kSteps = 4000;
  int first = 0, second = 0, both = 0;
  std::vector<bool> lost, lost_again, lost_with_other_seed;
  for (int step = 0; step < kSteps; ++step) {
    const auto hears = [&](std::uint64_t seed, int receiver) {
      const auto frame = world.MakeFrame();
      frame->seed = seed;
      frame->step = static_cast<std::uint64_t>(step);
      Broadcast(*frame, 2, frame->step);
      return !HeardMessages(*frame, receiver).empty();
    };
    const bool by_first = hears(7, 0), by_second = hears(7, 1);
    first += by_first;
    second += by_second;
    both += by_first && by_second;
    lost.push_back(!by_first);
    if (step < 200) lost_again.push_back(!hears(7, 0));
    if (step < 200) lost_with_other_seed.push_back(!hears(8, 0));
  }
  // Four standard errors.
  EXPECT_NEAR(first / double{kSteps}, 0.7, 0.03);
  EXPECT_NEAR(second / double{kSteps}, 0.7, 0.03);
  EXPECT_NEAR(both / double{kSteps}, 0.49, 0.032);
  lost.resize(200);
  EXPECT_EQ(lost, lost_again);
  EXPECT_NE(lost, lost_with_other_seed);
}

}  // namespace
}  // namespace coopdyn
