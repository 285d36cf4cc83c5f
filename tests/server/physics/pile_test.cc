// SPDX-License-Identifier: MIT
// Towers and piles of objects: they stand, come to rest, and sleep.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "server/base/portable_math.h"
#include "server/physics/rest.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

bool AllSleep(PhysicsScene& scene, int count) {
  for (int i = 0; i < count; ++i) {
    if (scene.object_body(i).sleep_counter != kAsleep) return false;
  }
  return true;
}

class Steps : public testing::TestWithParam<int> {
 protected:
  Steps() { scene_.step_length = GetParam() * 1'000'000; }
  double Seconds(int steps) const { return 1e-3 * GetParam() * steps; }

  PhysicsScene scene_;
};

using TowerTest = Steps;

TEST_P(TowerTest, OfTenAndOfTwentyBoxesDriftsLessThanAMillimetreInAMinute) {
  for (const int count : {10, 20}) {
    PhysicsScene scene;
    scene.step_length = scene_.step_length;
    for (int i = 0; i < count; ++i) scene.Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.05 + 0.1 * i), 1, 0.8);
    scene.RunFor(60);
    for (int i = 0; i < count; ++i) {
      EXPECT_LT((scene.object(i).p - Vector3(0, 0, 0.05 + 0.1 * i)).norm(), 1e-4) << count << " " << i;
    }
    EXPECT_TRUE(AllSleep(scene, count)) << count;
  }
}

TEST_P(TowerTest, OfTwentyBoxesThatFallsOnTheFloorStays) {
  for (int i = 0; i < 20; ++i) scene_.Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.1 + 0.1 * i), 1);
  scene_.RunFor(4);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_LT(scene_.object(i).p.head<2>().norm(), 1e-5) << i;
    EXPECT_NEAR(scene_.object(i).p.z(), 0.05 + 0.1 * static_cast<double>(i), 1e-3) << i;
  }
}

TEST_P(TowerTest, OfTenRobotsOfOneLinkStandsAsOneOfObjectsDoes) {
  RobotModel model;
  model.type = "brick";
  LinkModel link;
  link.name = "brick";
  link.mass_kg = 1;
  link.collisions = {{Box{{0.1, 0.1, 0.1}}, {}, {}, 0.8, false}};
  link.inertia_kg_m2 = SolidInertia(link.collisions[0].shape, 1);
  model.links = {link};
  model.footprint_radius_m = BoundingRadius(link.collisions[0].shape);
  model.height_m = 1;
  scene_.robot_model = std::make_shared<const RobotModel>(model);
  for (int i = 0; i < 10; ++i) scene_.AddRobot(At(0, 0, 0.05 + 0.1 * i));
  scene_.RunFor(10);
  for (int i = 0; i < 10; ++i) {
    EXPECT_LT((scene_.robot(i).p - Vector3(0, 0, 0.05 + 0.1 * i)).norm(), 1e-4) << i;
  }
}

TEST_P(TowerTest, OfCylindersStandsStillAndSleeps) {
  for (int i = 0; i < 6; ++i) scene_.Add(Cylinder{0.05, 0.1}, At(0, 0, 0.05 + 0.1 * i), 0.5, 0.8);
  scene_.RunFor(2);
  for (int i = 0; i < 6; ++i)
    EXPECT_LT((scene_.object(i).p - Vector3(0, 0, 0.05 + 0.1 * i)).norm(), 1e-4) << i;
  EXPECT_TRUE(AllSleep(scene_, 6));
}

TEST_P(TowerTest, OfCylindersStandsOnABox) {
  for (int i = 0; i < 4; ++i) scene_.Add(Cylinder{0.05, 0.1}, At(0, 0, 0.25 + 0.1 * i), 0.5, 0.8);
  scene_.Add(Box{{1, 1, 0.2}}, At(0, 0, 0.1));
  scene_.RunFor(2);
  EXPECT_TRUE(AllSleep(scene_, 4));
}

TEST_P(TowerTest, ATonneStandsOnAKilogram) {
  scene_.Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.05), 1, 0.8)
      .Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.15), 1000, 0.8);
  scene_.RunFor(5);
  EXPECT_NEAR(scene_.object(1).p.z(), 0.15, 5e-4);
}

TEST_P(TowerTest, HeavyThingsStandOnThingsThatAreAMillionTimesLighter) {
  const std::pair<double, double> cases[] = {{1e-3, 10}, {1e-2, 1000}, {1e-3, 1000}};
  for (const auto& [light_kg, heavy_kg] : cases) {
    PhysicsScene scene;
    scene.step_length = scene_.step_length;
    scene.Add(Box{{0.2, 0.2, 0.2}}, At(0, 0, 0.1), light_kg);
    scene.Add(Box{{0.2, 0.2, 0.2}}, At(0, 0, 0.3), heavy_kg);
    scene.RunFor(5);
    EXPECT_NEAR(scene.object(0).p.z(), 0.1, 1e-3) << heavy_kg / light_kg;
    EXPECT_NEAR(scene.object(1).p.z(), 0.3, 1e-3) << heavy_kg / light_kg;
  }
}

TEST_P(TowerTest, FallsWhereItLeansTooFar) {
  // The centre of mass of the upper two is beyond the edge of the lowest.
  scene_.Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.05), 1, 0.8)
      .Add(Box{{0.1, 0.1, 0.1}}, At(0.04, 0, 0.15), 1, 0.8)
      .Add(Box{{0.1, 0.1, 0.1}}, At(0.08, 0, 0.25), 1, 0.8);
  scene_.RunFor(3);
  EXPECT_LT(scene_.object(2).p.z(), 0.16);
}

using SlideTest = Steps;

TEST_P(SlideTest, ABoxOnABoxThatLeansSlidesDownByTheFormula) {
  const double g = kG, angle = 0.5235987755982988, friction = 0.3;
  const Quaternion q = FromRollPitchYaw(0, angle, 0.7);
  const Vector3 n = q * Vector3::UnitZ(), down = q * Vector3::UnitX();
  scene_.Add(Box{{0.2, 0.2, 0.1}}, {Vector3(0, 0, 3) + 0.15 * n - 2 * down, q}, 1, friction);
  scene_.Add(Box{{6, 1, 0.2}}, {Vector3(0, 0, 3), q}, 0, friction);
  scene_.Build();
  const Vector3 start = scene_.object(0).p;
  scene_.RunFor(1);
  const double expected_m = 0.5 * g * (portable::Sin(angle) - friction * portable::Cos(angle));
  EXPECT_NEAR((scene_.object(0).p - start).dot(down), expected_m,
              0.005 * expected_m + 0.02 * GetParam() * 0.1);
  EXPECT_LT(std::abs((scene_.object(0).p - start).dot(n)), 5e-4);
}

TEST_P(SlideTest, ABoxAtRestBeginsToSlideInTheFirstStep) {
  constexpr double kPull_m_s2 = 4, kFriction = 0.3;
  scene_.SetGravity(Vector3(kPull_m_s2, 0, -kG)).Add(Box{{0.2, 0.2, 0.2}}, At(0, 0, 0.1), 2, kFriction);
  scene_.Build();
  scene_.Run(1);
  const double expected_m_s = 1e-3 * GetParam() * (kPull_m_s2 - kFriction * kG);
  EXPECT_NEAR(scene_.object_body(0).v_WB.x(), expected_m_s, 0.01 * expected_m_s);
}

using SpinTest = Steps;

TEST_P(SpinTest, ADiscThatFallsWhileItLeansComesToRestOnTheFloor) {
  for (const double lean_rad : {0.005, 0.05, 0.3}) {
    PhysicsScene scene;
    scene.step_length = scene_.step_length;
    scene.Add(Cylinder{0.1, 0.05}, {{0, 0, 0.06}, FromRollPitchYaw(lean_rad, lean_rad / 2, 0)}, 1);
    scene.RunFor(4);
    EXPECT_NEAR(scene.object(0).p.z(), 0.025, 1e-3) << lean_rad;
    EXPECT_TRUE(AllSleep(scene, 1)) << lean_rad;
  }
}

TEST_P(SpinTest, ADiscThatTurnsAgainstAWallDoesNotSinkIntoTheFloor) {
  for (const double rate_rad_s : {50.0, 200.0, 1000.0}) {
    PhysicsScene scene;
    scene.step_length = scene_.step_length;
    WorldObject disc;
    disc.name = "disc";
    disc.shape = Cylinder{0.05, 0.02};
    disc.X_WO = At(0, 0, 0.01);
    disc.mass_kg = 1;
    disc.friction = 0.3;
    disc.w_WO = {0, 0, rate_rad_s};
    scene.Add(disc);
    scene.Add(Box{{0.1, 1, 0.2}}, At(0.1, 0, 0.1), 0);
    double lowest_m = 1;
    for (int i = 0; Seconds(i) < 2; ++i) {
      scene.RunFor(Seconds(1));
      lowest_m = std::min(lowest_m, scene.object(0).p.z());
    }
    EXPECT_GT(lowest_m, 0.008) << rate_rad_s;
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, SpinTest, testing::Values(1, 5, 10),
                         [](const auto& step) { return std::to_string(step.param) + "ms"; });
INSTANTIATE_TEST_SUITE_P(Steps, TowerTest, testing::Values(1, 2, 5, 10),
                         [](const auto& info) { return std::to_string(info.param) + "ms"; });
INSTANTIATE_TEST_SUITE_P(Steps, SlideTest, testing::Values(1, 5, 10),
                         [](const auto& info) { return std::to_string(info.param) + "ms"; });

/// `count` things dropped between four walls, each with another orientation.
class PileScene : public PhysicsScene {
 public:
  PileScene(int count, const Shape& shape, unsigned seed = 3, double rolling_friction_m = 0) {
    std::mt19937 random{seed};
    const auto any = [&random] { return static_cast<double>(random() % 2001) / 1000 - 1; };
    constexpr int kSide = 5;
    for (int i = 0; i < count; ++i) {
      const double x = (i % kSide) * 0.19 + 0.01 * any(), y = (i / kSide % kSide) * 0.19 + 0.01 * any();
      const double roll = 0.3 * any(), pitch = 0.3 * any();
      WorldObject object;
      object.shape = shape;
      object.X_WO = {{x, y, 0.1 + 0.19 * (i / kSide / kSide)}, FromRollPitchYaw(roll, pitch, any())};
      object.mass_kg = 1;
      object.friction = 0.6;
      object.rolling_friction_m = rolling_friction_m;
      Add(std::move(object));
    }
    for (const double side : {-1.0, 1.0}) {
      Add(Box{{0.1, 2, 2}}, At(0.38 + 0.55 * side, 0.38, 1));
      Add(Box{{2, 0.1, 2}}, At(0.38, 0.38 + 0.55 * side, 1));
    }
  }
};

TEST(Pile, OfTwoHundredBoxesFallsAsleep) {
  PileScene scene(200, Box{{0.1, 0.1, 0.1}});
  scene.RunFor(8);
  EXPECT_TRUE(AllSleep(scene, 200));
  for (int i = 0; i < 200; ++i) EXPECT_GT(scene.object(i).p.z(), 0.049) << i;
  EXPECT_TRUE(scene.world().TakeFrozen().empty());
}

TEST(Pile, PushesOutABallWhoseCentreIsInTheFaceOfABox) {
  PhysicsScene scene;
  scene.step_length = 10'000'000;
  scene.AllowOverlaps();
  WorldObject ball;
  ball.shape = Sphere{0.1};
  ball.X_WO = At(0.15, 0.02, 3.01);
  ball.mass_kg = 1;
  ball.rolling_friction_m = 5e-4;
  scene.Add(std::move(ball));
  scene.Add(Box{{0.4, 0.4, 0.4}}, At(0, 0, 3), 2);
  scene.RunFor(5);
  EXPECT_LT(scene.object(0).p.z(), 0.6);
  EXPECT_NEAR(scene.object(1).p.z(), 0.2, 0.01);
  EXPECT_TRUE(scene.world().TakeUnsolved().empty());
}

TEST(Pile, LeavesNothingHangingInTheAir) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    PileScene scene(200, Box{{0.1, 0.1, 0.1}}, seed);
    scene.RunFor(2);
    const auto before = scene.Capture();
    scene.RunFor(0.1);
    for (int i = 0; i < 200; ++i) {
      const BodyState& body = before->bodies[static_cast<std::size_t>(i)];
      if (body.v_WB.norm() < 0.5) continue;
      EXPECT_GT((scene.object_body(i).p_WB - body.p_WB).norm(), 1e-4) << seed << " " << i;
    }
  }
}

TEST(Pile, OfAHundredBallsCalmsDown) {
  PileScene scene(100, Sphere{0.05});
  scene.RunFor(8);
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(scene.object_body(i).v_WB.norm(), 0.02) << i;
    EXPECT_GT(scene.object(i).p.z(), 0.049) << i;
  }
}

TEST(Pile, OfBallsThatResistRollingFallsAsleep) {
  PileScene scene(100, Sphere{0.05}, 5, 0.00025);
  scene.step_length = 10'000'000;
  scene.RunFor(10);
  EXPECT_TRUE(AllSleep(scene, 100));
  EXPECT_LT(scene.world().TakeUnsolved().size(), 30u);  // of 1,000 steps
}

TEST(Pile, DoesTheSameWithAnyNumberOfThreads) {
  WorkerPool pool(3);
  PileScene one(60, Box{{0.1, 0.1, 0.1}}), many(60, Box{{0.1, 0.1, 0.1}});
  many.pool = &pool;
  one.RunFor(1.5);
  many.RunFor(1.5);
  EXPECT_EQ(StateHash(*one.Capture()), StateHash(*many.Capture()));
}

TEST(Pile, GoesOnFromASavedFrameWithTheSameBits) {
  PileScene scene(60, Box{{0.1, 0.1, 0.1}});
  scene.RunFor(0.8);
  const auto saved = scene.Capture();
  scene.RunFor(0.5);
  const auto hash = StateHash(*scene.Capture());
  scene.Restore(*saved);
  scene.RunFor(0.5);
  EXPECT_EQ(StateHash(*scene.Capture()), hash);
}

}  // namespace
}  // namespace coopdyn
