// SPDX-License-Identifier: MIT
// The same inputs give the same bits: from the start, and from any frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/physics/rest.h"
#include "tests/server/physics/physics_scene.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

/// A crowd beyond the direct solver's reach, single robots, and objects of every shape.
void Populate(PhysicsScene& scene) {
  for (int i = 0; i < 16; ++i) {
    const double x = 0.4 * (i % 4), y = 0.4 * (i / 4);
    scene.AddRobot(x, y, std::atan2(0.61 - y, 0.6 - x));  // facing the centre
  }
  scene.AddRobot(5, 5).AddRobot(6, -5, 2);
  scene.Add(Box{Vector3(0.1, 6, 0.5)}, At(1.8, 0, 0.25))
      .Add(Box{Vector3(0.2, 0.3, 0.2)}, At(0.2, 1.7, 0.3), 1);
  scene.Add(Cylinder{0.1, 0.2}, At(0.6, 1.7, 0.2), 1).Add(Sphere{0.1}, At(1, 1.7, 0.4), 1);
}

void Command(PhysicsScene& scene, int step) {
  for (int i = 0; i < 18; ++i) scene.SetWheels(i, (step / 10 + i) % 4 + 1, (step / 10 + 3 * i) % 5);
}

using Commands = void(PhysicsScene& scene, int step);

std::vector<std::uint64_t> Hashes(PhysicsScene& scene, int from, int to, Commands command = Command) {
  std::vector<std::uint64_t> hashes;
  for (int step = from; step < to; ++step) {
    command(scene, step);
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

TEST(Determinism, AFarRobotOnWhichOdeGivesUpChangesNothing) {
  const auto run = [](bool has_far) {
    PhysicsScene scene;
    scene.SetGravity(Vector3(-40, 40, -1000));
    scene.AddRobot(0, 0).AddRobot(0.5, 0.05, 1);
    scene.Add(Box{Vector3(0.2, 0.2, 0.2)}, At(0.8, -0.5, 0.1), 1);
    scene.Add(Box{Vector3(90, 90, 0.1)}, At(100, 0, 0.05), 0, 0);  // on this ice ODE gives up in most steps
    if (has_far) scene.AddRobot(At(100, 0, 0.1)).AddRobot(At(105, 3, 0.1));
    scene.step_length = 2'000'000;
    std::vector<Vector3> track;
    for (int step = 0; step < 200; ++step) {
      scene.Run(1);
      track.push_back(scene.robot(0).p);
      track.push_back(scene.robot(1).p);
    }
    return track;
  };
  EXPECT_EQ(run(false), run(true));
}

TEST(Determinism, TheCrowdUsesTheIterativeSolver) {
  // Otherwise the tests here would prove little: only the iterative solver uses the random seed.
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
  EXPECT_EQ(AnglesOf(*scene.Capture(), 0), AnglesOf(*frame, 0));
  EXPECT_EQ(SetpointOf(*scene.Capture(), 0), (std::array<double, 2>{3, 4}));
}

TEST(Determinism, BeforeTheFirstStepSetPointsAreZero) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).SetWheels(0, 3, 4);
  EXPECT_EQ(SetpointOf(*scene.Capture(), 0), (std::array<double, 2>{0, 0}));
}

/// All fidelities at once: crowds, single robots, parked ones, and things of every shape.
void PopulateMixed(PhysicsScene& scene, int copies) {
  for (int copy = 0; copy < copies; ++copy) {
    const double y0 = 8 * copy;
    for (int i = 0; i < 24; ++i) {
      scene.fidelity = static_cast<Fidelity>(i % 3);
      scene.robot_model = i % 2 == 0 ? TestRobot() : SmallRobot();
      const double x = 0.4 * (i % 6), y = 0.4 * (i / 6);
      scene.AddRobot(x, y0 + y, std::atan2(0.61 - y, 1.1 - x));
    }
    for (int i = 0; i < 6; ++i) {
      scene.fidelity = static_cast<Fidelity>(i % 3);
      scene.AddRobot(4 + 0.5 * i, y0 + 3, i);
    }
    scene.Add(Box{Vector3(0.1, 4, 0.5)}, At(3, y0, 0.25))
        .Add(Box{Vector3(0.2, 0.3, 0.2)}, At(0.2, y0 + 1.7, 0.3), 1)
        .Add(Cylinder{0.1, 0.2}, At(0.6, y0 + 1.7, 0.2), 1)
        .Add(Sphere{0.1}, At(1, y0 + 1.7, 0.4), 1)
        .Add(Box{Vector3(0.2, 0.2, 0.2)}, At(6, y0 - 2, 0.1), 1)
        .Add(Box{Vector3(0.2, 0.2, 0.2)}, At(6, y0 - 2, 0.3), 1);
  }
}

/// The robots of the crowd alternately drive into each other and rest; the last two of each copy stay parked.
void CommandMixed(PhysicsScene& scene, int step) {
  for (int i = 0; i < scene.robot_count(); ++i) {
    const bool parked = i % 30 >= 28 || (step / 80 + i) % 5 == 0;
    scene.SetWheels(i, parked ? 0 : (step / 10 + i) % 4 + 1, parked ? 0 : (step / 10 + 3 * i) % 5);
  }
}

TEST(Determinism, MixedFidelitiesRestoredInMidRunContinueBitByBit) {
  PhysicsScene whole;
  PopulateMixed(whole, 1);
  const auto expected = Hashes(whole, 0, 300, CommandMixed);
  PhysicsScene running;
  PopulateMixed(running, 1);
  for (int step = 0; step < 300; step += 50) {
    // Each part of the run in a new world, which knows only the previous frame.
    PhysicsScene part;
    PopulateMixed(part, 1);
    part.Restore(*running.Capture());
    const auto hashes = Hashes(part, step, step + 50, CommandMixed);
    EXPECT_TRUE(std::equal(hashes.begin(), hashes.end(), expected.begin() + step)) << step;
    running.Restore(*part.Capture());
  }
}

TEST(Determinism, TheMixedSceneSleepsTouchesAndUsesBothSolvers) {
  // Otherwise the tests of this scene would prove little.
  PhysicsScene scene;
  PopulateMixed(scene, 1);
  const std::uint64_t seed = scene.Capture()->solver_seed;
  Hashes(scene, 0, 200, CommandMixed);
  const auto frame = scene.Capture();
  EXPECT_NE(frame->solver_seed, seed);
  const auto count = std::count_if(frame->bodies.begin(), frame->bodies.end(),
                                   [](const BodyState& body) { return body.sleep_counter == kAsleep; });
  EXPECT_GT(count, 2);
  EXPECT_LT(count, 20);
}

TEST(Determinism, AnyNumberOfThreadsGivesTheSameHashes) {
  std::vector<std::uint64_t> expected;
  for (const int threads : {0, 1, 2, 4}) {
    WorkerPool pool(threads);
    PhysicsScene scene;
    scene.pool = threads == 0 ? nullptr : &pool;
    PopulateMixed(scene, 12);  // enough robots for parallel loops
    const auto hashes = Hashes(scene, 0, 60, CommandMixed);
    if (threads == 0) expected = hashes;
    EXPECT_EQ(hashes, expected) << threads;
  }
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
