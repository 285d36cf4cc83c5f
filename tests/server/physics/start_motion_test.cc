// SPDX-License-Identifier: MIT
// Things with an initial speed, bouncing, and gravity of any size, at 1, 5 and 10 ms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::start_motion {
namespace {

WorldObject Ball(double z_m) {
  WorldObject ball;
  ball.shape = Sphere{0.1};
  ball.X_WO = At(0, 0, z_m);
  ball.mass_kg = 0.5;
  return ball;
}

class StartMotionTest : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { scene_.step_length = GetParam() * 1'000'000; }
  double step_s() const { return GetParam() * 1e-3; }

  PhysicsScene scene_;
};

TEST_P(StartMotionTest, AThrownThingFliesAParabola) {
  WorldObject ball = Ball(1);
  ball.v_WO = {2, -1, 3};
  ball.w_WO = {0, 0, 4};
  scene_.Add(ball);
  scene_.RunFor(0.5);
  EXPECT_LT((scene_.object(0).p - Vector3(1, -0.5, 1 + 1.5 - kG / 8)).norm(), 1e-9);
  EXPECT_LT((scene_.object_body(0).w_WB - Vector3(0, 0, 4)).norm(), 1e-9);
  EXPECT_NEAR(Heading(scene_.object(0).q), 2, 1e-3);
}

TEST_P(StartMotionTest, AThingBouncesByItsRestitution) {
  WorldObject ball = Ball(1.1);
  ball.restitution = 0.8;
  scene_.Add(ball);
  double highest_m = 0, before_m = 1.1;
  bool rises = false;
  for (int i = 0; i * step_s() < 1.1; ++i) {
    scene_.Run(1);
    const double z_m = scene_.object(0).p.z();
    rises |= z_m > before_m;
    before_m = z_m;
    if (rises) highest_m = std::max(highest_m, z_m - 0.1);
  }
  EXPECT_NEAR(highest_m, 0.8 * 0.8, 0.01);
}

TEST_P(StartMotionTest, AFullBounceGainsNoHeight) {
  WorldObject ball = Ball(1.1);
  ball.restitution = 1;
  scene_.Add(ball);
  scene_.RunFor(5);
  double highest_m = 0;
  for (int i = 0; i * step_s() < 1; ++i) {
    scene_.Run(1);
    highest_m = std::max(highest_m, scene_.object(0).p.z() - 0.1);
  }
  EXPECT_NEAR(highest_m, 1, 0.01);  // after five bounces
}

TEST_P(StartMotionTest, ABallRollsToRest) {
  WorldObject ball = Ball(0.1);
  ball.rolling_friction_m = 0.002;
  ball.v_WO = {0.6, 0.8, 0};
  ball.w_WO = {-8, 6, 0};
  scene_.Add(ball);
  scene_.RunFor(9);
  const double slower_m_s2 = 5.0 / 7 * 0.002 * kG / 0.1;
  EXPECT_NEAR(scene_.object(0).p.head<2>().norm() * 2 * slower_m_s2, 1, 0.02);
  EXPECT_EQ(scene_.object_body(0).v_WB.norm(), 0);
}

TEST_P(StartMotionTest, ABallStopsSpinning) {
  WorldObject ball = Ball(0.1);
  ball.rolling_friction_m = 0.002;
  ball.w_WO = {0, 0, 20};
  scene_.Add(ball);
  scene_.RunFor(2);
  EXPECT_NEAR(scene_.object_body(0).w_WB.z(), 20 - 2 * 0.002 * kG / (0.4 * 0.01), 0.2);
}

TEST_P(StartMotionTest, WithoutGravityAThingKeepsItsWay) {
  WorldObject ball = Ball(1);
  ball.v_WO = {1, 0.5, 0.2};
  scene_.SetGravity(0).Add(ball);
  scene_.RunFor(10);
  EXPECT_LT((scene_.object(0).p - Vector3(10, 5, 3)).norm(), 1e-9);
}

TEST_P(StartMotionTest, WithoutGravityABallBouncesBetweenWalls) {
  WorldObject ball = Ball(1);
  ball.v_WO = {1, 0, 0};
  ball.restitution = 1;
  scene_.SetGravity(0).Add(ball);
  scene_.Add(Box{Vector3(0.2, 2, 3)}, At(0.7, 0, 1.5)).Add(Box{Vector3(0.2, 2, 3)}, At(-0.7, 0, 1.5));
  scene_.RunFor(20);
  EXPECT_NEAR(scene_.object_body(0).v_WB.norm(), 1, 1e-3);
  EXPECT_LT(std::abs(scene_.object(0).p.x()), 0.52);
}

TEST_P(StartMotionTest, GravityMayPointUp) {
  scene_.SetGravity(-2).Add(Ball(0.1));
  scene_.RunFor(1);
  EXPECT_NEAR(scene_.object(0).p.z(), 0.1 + 1, 2 * step_s());
}

TEST_P(StartMotionTest, GravityMayPointAside) {
  WorldObject ball = Ball(1);
  ball.v_WO = {0, 0, 1};
  scene_.SetGravity(Vector3(2, -1, -3)).Add(ball);
  scene_.RunFor(0.5);
  EXPECT_LT((scene_.object(0).p - Vector3(0.25, -0.125, 1 + 0.5 - 0.375)).norm(), 1e-9);
}

// Gravity of any size, and a floor across it.
TEST_P(StartMotionTest, AThingFallsByItsParabolaInAHundredfoldGravity) {
  WorldObject ball = Ball(3);
  ball.v_WO = {2, 0, 0};
  scene_.SetGravity(1000).Add(ball);
  scene_.RunFor(0.05);
  EXPECT_LT((scene_.object(0).p - Vector3(0.1, 0, 3 - 1000 * 0.05 * 0.05 / 2)).norm(), 1e-9);
  EXPECT_NEAR(scene_.object_body(0).v_WB.z(), -50, 1e-9);
}

TEST_P(StartMotionTest, ABoxRestsInAHundredfoldGravity) {
  scene_.SetGravity(1000).Add(Box{Vector3(0.2, 0.2, 0.2)}, At(0, 0, 0.1), 2);
  scene_.RunFor(2);
  EXPECT_LT((scene_.object(0).p - Vector3(0, 0, 0.1)).norm(), 1e-3);
  EXPECT_LT(scene_.object_body(0).v_WB.norm(), 1e-3);
}

TEST_P(StartMotionTest, ABoxRestsOnASlopeAcrossATiltedGravity) {
  const Quaternion q = FromRollPitchYaw(0.2, 0.4, 0);
  scene_.SetGravity(Vector3(q * Vector3(0, 0, -kG)));
  scene_.Add(Box{Vector3(2, 2, 0.2)}, {{0, 0, 3}, q}, 0, 0.1);
  const Vector3 start_W = Vector3(0, 0, 3) + q * Vector3(0, 0, 0.2);
  scene_.Add(Box{Vector3(0.2, 0.2, 0.2)}, {start_W, q}, 2, 0.1);
  scene_.RunFor(5);
  EXPECT_LT((scene_.object(1).p - start_W).norm(), 1e-3);
  EXPECT_LT(scene_.object_body(1).v_WB.norm(), 1e-3);
}

// With gravity to the side, a floor is a slope.
TEST_P(StartMotionTest, ABoxSlidesWhereGravityPointsAside) {
  const double along_m_s2 = kG * std::sin(0.4), down_m_s2 = kG * std::cos(0.4);
  scene_.SetGravity(Vector3(0, along_m_s2, -down_m_s2));
  scene_.Add(Box{Vector3(0.2, 0.2, 0.1)}, At(0, 0, 0.05), 1, 0.2);
  scene_.Add(Box{Vector3(0.2, 0.2, 0.1)}, At(1, 0, 0.05), 1, 0.5);
  scene_.RunFor(1);
  EXPECT_NEAR(scene_.object(0).p.y(), (along_m_s2 - 0.2 * down_m_s2) / 2, 0.02);
  EXPECT_NEAR(scene_.object(1).p.y(), 0, 1e-3);
}

TEST_P(StartMotionTest, RobotsStandWhereGravityPointsAsideALittle) {
  for (const Fidelity fidelity : {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar}) {
    scene_.fidelity = fidelity;
    scene_.AddRobot(2, scene_.robot_count());
  }
  scene_.SetGravity(Vector3(0.1, 0.5, -kG));
  scene_.RunFor(2);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((scene_.robot(i).p.head<2>() - Eigen::Vector2d(2, i)).norm(), 5e-3) << i;
  }
}

TEST_P(StartMotionTest, RobotsSlideWhereGravityPointsAsideMuch) {
  for (const Fidelity fidelity : {Fidelity::kRolling, Fidelity::kPlanar}) {
    scene_.fidelity = fidelity;
    scene_.AddRobot(2, scene_.robot_count());
  }
  scene_.SetGravity(Vector3(0, 8, -2));
  scene_.RunFor(0.5);
  for (int i = 0; i < 2; ++i) EXPECT_GT(scene_.robot(i).p.y(), i + 0.2) << i;
}

TEST_P(StartMotionTest, WithoutGravityAllThatStandsStaysWhereItIs) {
  scene_.SetGravity(0).Add(Ball(0.1)).AddRobot(2, 0);
  scene_.Add(Box{Vector3(0.2, 0.2, 0.2)}, At(0, 2, 0.1), 1)
      .Add(Box{Vector3(0.2, 0.2, 0.2)}, At(0, 2, 0.3), 1);
  for (const Fidelity fidelity : {Fidelity::kRolling, Fidelity::kPlanar}) {
    scene_.fidelity = fidelity;
    scene_.AddRobot(2, scene_.robot_count());
  }
  scene_.Build();
  ASSERT_EQ(scene_.diagnostics().ToString(), "");
  scene_.RunFor(2);
  EXPECT_TRUE(scene_.world().TakeFrozen().empty());
  EXPECT_LT((scene_.object(2).p - Vector3(0, 2, 0.3)).norm(), 1e-3);
  for (int i = 0; i < 3; ++i) EXPECT_LT((scene_.robot(i).p - Vector3(2, i, 0)).norm(), 1e-3);
}

TEST_P(StartMotionTest, WithoutGravityABoxThatIsHitFliesOnWithTheMomentum) {
  WorldObject ball = Ball(1);
  ball.v_WO = {2, 0, 0};
  scene_.SetGravity(0).Add(ball).Add(Box{Vector3(0.2, 0.2, 0.2)}, At(1, 0, 1), 0.5);
  scene_.RunFor(2);
  const Vector3 sum = scene_.object_body(0).v_WB + scene_.object_body(1).v_WB;
  EXPECT_LT((sum - Vector3(2, 0, 0)).norm(), 1e-6);
  EXPECT_GT(scene_.object_body(1).v_WB.x(), 0.9);
  EXPECT_TRUE(scene_.world().TakeFrozen().empty());
}

TEST_P(StartMotionTest, WheelsWithoutWeightDoNotDrive) {
  for (const Fidelity fidelity : {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar}) {
    scene_.fidelity = fidelity;
    scene_.AddRobot(0, 2.0 * scene_.robot_count());
  }
  scene_.SetGravity(0).Build();
  for (int i = 0; i < 3; ++i) scene_.SetVelocity(i, 0.5, 0);
  scene_.RunFor(1);
  EXPECT_TRUE(scene_.world().TakeFrozen().empty());
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(scene_.robot(i).p.x()), 0.02) << i;
}

INSTANTIATE_TEST_SUITE_P(Steps, StartMotionTest, testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::start_motion
