// SPDX-License-Identifier: MIT
// The shipped controllers with robots that move exactly as their wheels turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/server/controllers/swarm.h"

namespace coopdyn {
namespace {

double Distance(const Frame& frame, int one, int other) {
  return (RobotPose(frame, one).p - RobotPose(frame, other).p).norm();
}

/// Smallest distance between two robots' centres.
double Nearest(const Frame& frame) {
  double nearest = 1e9;
  const int count = static_cast<int>(frame.scene->robots.size());
  for (int i = 0; i < count; ++i) {
    for (int k = i + 1; k < count; ++k) nearest = std::min(nearest, Distance(frame, i, k));
  }
  return nearest;
}

/// Mean distance of the robots from their common centre.
double Spread(const Frame& frame) {
  Vector3 middle = Vector3::Zero();
  const int count = static_cast<int>(frame.scene->robots.size());
  for (int i = 0; i < count; ++i) middle += RobotPose(frame, i).p / count;
  double spread = 0;
  for (int i = 0; i < count; ++i) spread += (RobotPose(frame, i).p - middle).norm() / count;
  return spread;
}

/// Length of the mean unit vector of all headings: 1 if all are equal.
double Order(const Frame& frame) {
  double x = 0, y = 0;
  const int count = static_cast<int>(frame.scene->robots.size());
  for (int i = 0; i < count; ++i) {
    const double heading = Heading(RobotPose(frame, i).q);
    x += std::cos(heading) / count;
    y += std::sin(heading) / count;
  }
  return std::hypot(x, y);
}

/// `count` robots on the lattice with a sample, in-process.
Driven SwarmOf(const std::string& sample, int count,
               std::vector<std::pair<std::string, double>> options = {}) {
  Swarm swarm;
  for (int i = 0; i < count; ++i) swarm.Add(Sample(sample), options);
  return Driven(swarm.Mark(3, 0.5), TestOptions(true));
}

TEST(SamplesTest, DiffuseSpreadsAndDoesNotCollide) {
  Driven driven = SwarmOf("diffuse", 20, {{"speed", 0.1}});
  driven.Start();
  const double before = Spread(*driven.frame());
  double nearest = 1e9;
  for (int i = 0; i < 30; ++i) {
    driven.Steps(100);
    nearest = std::min(nearest, Nearest(*driven.frame()));
  }
  EXPECT_GT(Spread(*driven.frame()), 1.2 * before);
  EXPECT_GT(nearest, 0.16) << "two radii";
}

TEST(SamplesTest, DiffuseHoldsItsSpeedWhereNothingIsNear) {
  Driven driven = SwarmOf("diffuse", 1, {{"speed", 0.2}});
  driven.Start();
  const FramePtr before = driven.frame();
  driven.Steps(1);
  EXPECT_NEAR((RobotPose(*driven.frame(), 0).p - RobotPose(*before, 0).p).norm(), 0.2 * 0.01, 1e-12);
}

TEST(SamplesTest, BraitenbergDoesNotCollide) {
  Driven driven = SwarmOf("braitenberg", 20);
  driven.Start();
  double nearest = 1e9;
  for (int i = 0; i < 20; ++i) {
    driven.Steps(100);
    nearest = std::min(nearest, Nearest(*driven.frame()));
  }
  EXPECT_GT(nearest, 0.16);
}

TEST(SamplesTest, AggregateGathers) {
  Driven driven = SwarmOf("aggregate", 12);
  driven.Start();
  const double before = Spread(*driven.frame());
  driven.Steps(2000);
  EXPECT_LT(Spread(*driven.frame()), 0.6 * before);
  EXPECT_GT(Nearest(*driven.frame()), 0.16);
}

TEST(SamplesTest, FlockTurnsTheSameWay) {
  Driven driven = SwarmOf("flock", 15);
  driven.Start();
  EXPECT_LT(Order(*driven.frame()), 0.3);
  driven.Steps(3000);
  EXPECT_GT(Order(*driven.frame()), 0.9);
}

TEST(SamplesTest, AttractorReachesTheTargetAndStops) {
  Driven driven = SwarmOf("attractor", 1);
  driven.Start();
  driven.Steps(2000);
  const Vector3 p_WR = RobotPose(*driven.frame(), 0).p;
  EXPECT_NEAR((p_WR - Vector3(3, 0.5, 0)).norm(), 0.4, 0.02);
  EXPECT_EQ(driven.run().setpoints.back()[0], WheelSpeeds{});
}

TEST(SamplesTest, AttractorWaitsForItsColour) {
  Driven driven = SwarmOf("attractor", 1, {{"red", 0}, {"blue", 1}});
  driven.Start();
  driven.Steps(10);
  EXPECT_EQ(driven.run().setpoints.back()[0], WheelSpeeds{});
}

TEST(SamplesTest, AllDescribeTheirOptions) {
  SteadyClock clock;
  WorkerPool pool(1);
  std::vector<std::string> files;
  for (const char* name :
       {"diffuse", "braitenberg", "aggregate", "flock", "attractor", "formation", "transport"}) {
    files.push_back(Sample(name));
  }
  ControllerOptions options = TestOptions();
  options.launcher = std::make_shared<ChildLauncher>(options.program);
  const ControllerSet set(files, options, clock, NullLogger(), pool);
  for (const LoadedController& loaded : set.loaded()) {
    ASSERT_TRUE(loaded.description) << loaded.file << " " << loaded.why;
    EXPECT_FALSE(loaded.description->help.empty());
    EXPECT_FALSE(loaded.description->options.empty());
    for (const ControllerOption& option : loaded.description->options) EXPECT_FALSE(option.help.empty());
  }
}

}  // namespace
}  // namespace coopdyn
