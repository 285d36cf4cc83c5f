// SPDX-License-Identifier: MIT
// The same inputs give the same bits: from the start, and from any frame.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

Pose At(double x, double y, double z) {
  return {{x, y, z}, Quaternion::Identity()};
}

/// A crowd beyond the direct solver's reach, single robots, and objects of every shape.
void Populate(PhysicsScene& scene) {
  for (int i = 0; i < 16; ++i) {
    const double x = 0.4 * (i % 4), y = 0.4 * (i / 4);
    scene.AddRobot(x, y, std::atan2(0.61 - y, 0.6 - x));  // facing the middle
  }
  scene.AddRobot(5, 5).AddRobot(6, -5, 2);
  scene.Add(Box{Vector3(0.1, 6, 0.5)}, At(1.8, 0, 0.25))
      .Add(Box{Vector3(0.2, 0.3, 0.2)}, At(0.2, 1.7, 0.3), 1);
  scene.Add(Cylinder{0.1, 0.2}, At(0.6, 1.7, 0.2), 1).Add(Sphere{0.1}, At(1, 1.7, 0.4), 1);
}

void Command(PhysicsScene& scene, int step) {
  for (int i = 0; i < 18; ++i) scene.SetWheels(i, (step / 10 + i) % 4 + 1, (step / 10 + 3 * i) % 5);
}

std::vector<std::uint64_t> Hashes(PhysicsScene& scene, int from, int to) {
  std::vector<std::uint64_t> hashes;
  for (int step = from; step < to; ++step) {
    Command(scene, step);
    scene.Run(1);
    hashes.push_back(StateHash(*scene.Capture()));
  }
  return hashes;
}

TEST(Determinism, SameSceneTwiceGivesTheSameHashes) {
  PhysicsScene a, b;
  Populate(a);
  Populate(b);
  EXPECT_EQ(Hashes(a, 0, 200), Hashes(b, 0, 200));
}

TEST(Determinism, TheCrowdUsesTheIterativeSolver) {
  // Else the tests here would say nothing about it: it is the one that draws from the random seed.
  PhysicsScene scene;
  Populate(scene);
  Hashes(scene, 0, 60);
  const std::uint64_t before = scene.Capture()->solver_seed;
  Hashes(scene, 60, 61);
  EXPECT_NE(scene.Capture()->solver_seed, before);
}

TEST(Determinism, InterleavedWorldsDoNotDisturbEachOther) {
  PhysicsScene alone, a, b;
  Populate(alone);
  Populate(a);
  Populate(b);
  const auto expected = Hashes(alone, 0, 100);
  std::vector<std::uint64_t> mixed;
  for (int step = 0; step < 100; ++step) {
    mixed.push_back(Hashes(a, step, step + 1).front());
    Hashes(b, step, step + 1);
  }
  EXPECT_EQ(mixed, expected);
}

TEST(Determinism, RestoredIntoAFreshWorldGivesTheSameHashes) {
  PhysicsScene a, b;
  Populate(a);
  Populate(b);
  Hashes(a, 0, 80);
  b.Restore(*a.Capture());
  EXPECT_EQ(StateHash(*b.Capture()), StateHash(*a.Capture()));
  EXPECT_EQ(Hashes(b, 80, 200), Hashes(a, 80, 200));
}

TEST(Determinism, RestoredIntoAUsedWorldGivesTheSameHashes) {
  PhysicsScene scene;
  Populate(scene);
  Hashes(scene, 0, 50);
  const auto frame = scene.Capture();
  const auto first = Hashes(scene, 50, 150);
  scene.Restore(*frame);
  EXPECT_EQ(Hashes(scene, 50, 150), first);
}

TEST(Determinism, RestoreBringsWheelAnglesAndSetPointsBack) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).SetWheels(0, 3, 4);
  scene.Run(50);
  const auto frame = scene.Capture();
  scene.Run(50);
  scene.Restore(*frame);
  EXPECT_EQ(scene.Capture()->robots[0].wheel_angle_rad, frame->robots[0].wheel_angle_rad);
  EXPECT_EQ(scene.Capture()->robots[0].setpoint_rad_s, (std::array<double, 2>{3, 4}));
}

TEST(Determinism, BeforeTheFirstStepSetPointsAreZero) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).SetWheels(0, 3, 4);
  EXPECT_EQ(scene.Capture()->robots[0].setpoint_rad_s, (std::array<double, 2>{0, 0}));
}

TEST(Determinism, OtherCommandsGiveOtherHashes) {
  PhysicsScene a, b;
  a.AddRobot(0, 0).SetWheels(0, 1, 1);
  b.AddRobot(0, 0).SetWheels(0, 1, 1.0000000000000002);
  a.Run(1);
  b.Run(1);
  EXPECT_NE(StateHash(*a.Capture()), StateHash(*b.Capture()));
}

}  // namespace
}  // namespace coopdyn
