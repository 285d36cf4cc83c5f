// SPDX-License-Identifier: MIT
// Nothing tunnels through thin things at any speed, at 1, 5 and 10 ms.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

class SweepTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { scene_.step_length = GetParam() * 1'000'000; }

  /// Sets the speed of objects, as if thrown.
  void Throw(std::initializer_list<Vector3> velocities) {
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    auto frame = scene_.Capture();
    std::size_t i = 0;
    for (const Vector3& v_W : velocities) frame->bodies[i++].v_WB = v_W;
    scene_.Restore(*frame);
  }

  PhysicsScene scene_;
};

TEST_P(SweepTest, ABallDoesNotPassThroughAThinWall) {
  for (const double speed_m_s : {2.0, 5.0, 20.0, 50.0}) {
    for (int phase = 0; phase < 6; ++phase) {
      scene_ = PhysicsScene();
      SetUp();
      const double start_m = -0.2 - 0.1 * phase / 6 * speed_m_s * GetParam() * 1e-3;
      scene_.Add(Sphere{0.005}, At(start_m, 0.003, 1), 0.01);
      scene_.Add(Box{{0.01, 2, 4}}, At(0, 0, 2));
      Throw({{speed_m_s, 0.5, 0.2}});
      scene_.RunFor(0.3);
      const Vector3 p_W = scene_.object(0).p;
      EXPECT_LT(p_W.x(), -0.009) << speed_m_s << " m/s, phase " << phase;
      EXPECT_GT(p_W.x(), -0.05) << "it does not bounce";
    }
  }
}

TEST_P(SweepTest, ATumblingBoxDoesNotPassThroughAThinPlateThatItFallsOn) {
  scene_.Add(Box{{0.05, 0.05, 0.05}}, At(0, 0, 22), 1);
  scene_.Add(Box{{60, 60, 0.01}}, At(0, 0, 2));
  Throw({{0, 0, 0}});
  auto frame = scene_.Capture();
  frame->bodies[0].w_WB = {3, 5, 1};
  scene_.Restore(*frame);
  scene_.RunFor(4);
  EXPECT_GT(scene_.object(0).p.z(), 2.02);
  EXPECT_LT(scene_.object(0).p.z(), 2.06);
}

TEST_P(SweepTest, ASmallBoxDoesNotTurnThroughAThinWallThatItsCornerHits) {
  for (const double speed_m_s : {5.0, 10.0}) {
    for (int turn = 0; turn < 12; ++turn) {
      scene_ = PhysicsScene();
      SetUp();
      const Quaternion q = FromRollPitchYaw(0.5 * turn, 1.3 * turn, 0);
      scene_.SetGravity(0);
      scene_.Add(Box{{0.01, 0.02, 0.015}}, {{-0.2 - 0.013 * turn, 0, 1}, q}, 0.01, 0.5);
      scene_.Add(Box{{0.01, 2, 2}}, At(0, 0, 1), 0, 0.5);
      Throw({{speed_m_s, 0, 0}});
      scene_.RunFor(0.3);
      EXPECT_LT(scene_.object(0).p.x(), 0) << speed_m_s << " m/s, turn " << turn;
    }
  }
}

TEST_P(SweepTest, SpinningBallsStayBeforeAHeavyWallThatMeetsThem) {
  scene_.SetGravity(0);
  scene_.Add(Sphere{0.005}, At(-0.5882, -1.75, 0.889), 0.01, 0.5);
  scene_.Add(Sphere{0.005}, At(-0.4182, 2.75, 1.066), 0.01, 0.5);
  scene_.Add(Box{{0.01, 12, 3}}, At(0.3, 0, 1.6), 500, 0.5);
  Throw({{5, 0, 0}, {5, 0, 0}, {-5, 0, 0}});
  auto frame = scene_.Capture();
  frame->bodies[0].w_WB = {0, 17.9, 0};
  frame->bodies[1].w_WB = {0, 8.1, 0};
  scene_.Restore(*frame);
  scene_.RunFor(0.2);
  for (const int ball : {0, 1}) EXPECT_LT(scene_.object(ball).p.x(), scene_.object(2).p.x()) << ball;
  EXPECT_TRUE(scene_.world().TakeUnsolved().empty());
}

TEST_P(SweepTest, BallsThatMeetHeadOnDoNotPassThroughEachOther) {
  scene_.Add(Sphere{0.02}, At(-1, 0, 1), 0.1);
  scene_.Add(Sphere{0.02}, At(1.013, 0, 1), 0.1);
  Throw({{30, 0, 0}, {-30, 0, 0}});
  scene_.RunFor(0.1);
  EXPECT_LT(scene_.object(0).p.x() + 0.039, scene_.object(1).p.x());
  EXPECT_NEAR(scene_.object_body(0).v_WB.x() + scene_.object_body(1).v_WB.x(), 0, 0.1);
}

TEST_P(SweepTest, AFastBallRollsOnTheFloorUnhindered) {
  scene_.Add(Sphere{0.01}, At(0, 0, 0.01), 0.01);
  scene_.Build();
  auto frame = scene_.Capture();
  frame->bodies[0].v_WB = {8, 0, 0};
  frame->bodies[0].w_WB = {0, 800, 0};
  scene_.Restore(*frame);
  scene_.RunFor(1);
  EXPECT_GT(scene_.object(0).p.x(), 7.6);
  EXPECT_LT(scene_.object(0).p.x(), 8.1);
}

TEST_P(SweepTest, ABallThatRunsAlongTheFloorStopsAtAWall) {
  scene_.Add(Sphere{0.01}, At(0, 0, 0.01), 0.01, 0);
  scene_.Add(Box{{0.01, 2, 1}}, At(1, 0, 0.5));
  Throw({{40, 0, 0}});
  scene_.RunFor(0.5);
  EXPECT_LT(scene_.object(0).p.x(), 0.987);
}

TEST_P(SweepTest, ABallHitsARobotThatStandsInItsWay) {
  scene_.AddRobot(0, 0);
  scene_.Add(Sphere{0.01}, At(-1, 0.01, 0.15), 0.05);
  scene_.Build();
  auto frame = scene_.Capture();
  const auto ball = static_cast<std::size_t>(scene_.world().things().all[0].first_body);
  frame->bodies[ball].v_WB = {40, 0, 0};
  scene_.Restore(*frame);
  scene_.RunFor(0.3);
  EXPECT_LT(scene_.object(0).p.x(), 0);
}

/// Small things in 40 attitudes that fall at 20 m/s, each on a plate of 1 cm, or on the floor.
class ImpactTest : public SweepTest {
 protected:
  void Drop(const Shape& shape, bool on_plates) {
    std::mt19937 random{3};
    const auto any = [&random] { return static_cast<double>(random() % 2001) / 1000 - 1; };
    for (int i = 0; i < kCount; ++i) {
      const double x = 1.5 * (i % 8), y = 1.5 * (i / 8 % 5), top_m = on_plates ? 2.005 : 0;
      if (on_plates) scene_.Add(Box{{1, 1, 0.01}}, At(x, y, 2));
      WorldObject thing;
      thing.shape = shape;
      thing.mass_kg = 0.05;
      thing.X_WO = {{x, y, top_m + 0.35 + 0.15 * any()}, FromRollPitchYaw(3 * any(), 1.5 * any(), 0)};
      thing.v_WO = {0, 0, -20};
      thing.w_WO = {10 * any(), 10 * any(), 0};
      scene_.Add(std::move(thing));
    }
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
  }
  /// The fastest of them.
  double Fastest_m_s() {
    double fastest = 0;
    for (const BodyState& body : scene_.Capture()->bodies) fastest = std::max(fastest, body.v_WB.norm());
    return fastest;
  }

  static constexpr int kCount = 40;
};

TEST_P(ImpactTest, ACylinderDoesNotSinkThroughThePlateThatItHits) {
  for (const Cylinder& cylinder : {Cylinder{0.01, 0.02}, Cylinder{0.015, 0.01}}) {
    scene_ = PhysicsScene();
    SetUp();
    Drop(cylinder, true);
    scene_.RunFor(0.8);
    for (int i = 0; i < kCount; ++i) {
      const Vector3 p_W = scene_.object(2 * static_cast<std::size_t>(i) + 1).p;
      const bool is_above =
          std::abs(p_W.x() - 1.5 * (i % 8)) < 0.5 && std::abs(p_W.y() - 1.5 * (i / 8 % 5)) < 0.5;
      if (!is_above) continue;  // it has left the plate
      EXPECT_GT(p_W.z(), 2) << i;
    }
  }
}

TEST_P(ImpactTest, ABoxGainsNoSpeed) {
  for (const bool on_plates : {false, true}) {
    scene_ = PhysicsScene();
    SetUp();
    Drop(Box{{0.05, 0.1, 0.15}}, on_plates);
    double fastest_m_s = 0;
    for (int i = 0; i < 50; ++i) {
      scene_.RunFor(0.01);
      fastest_m_s = std::max(fastest_m_s, Fastest_m_s());
    }
    EXPECT_LT(fastest_m_s, 20.5);
    EXPECT_TRUE(scene_.world().TakeFrozen().empty());
  }
}

TEST_P(ImpactTest, ASmallBoxDoesNotExplode) {
  Drop(Box{{0.01, 0.02, 0.03}}, true);
  scene_.RunFor(0.5);
  const std::size_t known = GetParam() == 10 ? 1 : 0;  // at 10 ms one in a hundred turns too fast
  EXPECT_LE(scene_.world().TakeFrozen().size(), known);
}

INSTANTIATE_TEST_SUITE_P(Steps, ImpactTest, ::testing::Values(1, 5, 10),
                         [](const auto& info) { return std::to_string(info.param) + "ms"; });
INSTANTIATE_TEST_SUITE_P(Steps, SweepTest, ::testing::Values(1, 5, 10),
                         [](const auto& step) { return std::to_string(step.param) + "ms"; });

}  // namespace
}  // namespace coopdyn
