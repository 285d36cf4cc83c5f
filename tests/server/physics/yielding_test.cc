// SPDX-License-Identifier: MIT
// Contacts that yield: a spring and a damper along the normal, against closed forms at 1, 5 and 10 ms. With a
// loose body and with one that has thrusters.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>

#include "server/physics/rest.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn::yielding {
namespace {

constexpr double kRadius_m = 0.1;

/// One link, its centre in the origin of R.
std::shared_ptr<const RobotModel> Body(const Shape& shape, double mass_kg, double stiffness_n_m,
                                       double damping_n_s_m, bool thrusts = false) {
  RobotModel model;
  model.type = "body";
  LinkModel link;
  link.name = "body";
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = SolidInertia(shape, mass_kg);
  LinkShape collision{shape, {}, {}, 1, false};
  collision.contact_stiffness_n_m = stiffness_n_m;
  collision.contact_damping_n_s_m = damping_n_s_m;
  link.collisions = {collision};
  model.links = {link};
  model.footprint_radius_m = BoundingRadius(shape);
  model.height_m = 1;
  if (thrusts) {
    JointModel thruster;
    thruster.name = "x";
    thruster.kind = JointModel::Kind::kForce;
    thruster.axis_R = Vector3::UnitX();
    thruster.max_effort = 100;
    model.joints = {thruster};
    model.actuators = {{"thrusters", {0}, ThrustersModel()}};
  }
  return std::make_shared<const RobotModel>(model);
}

class YieldingTest : public testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  void SetUp() override { scene_.step_length = std::get<int>(GetParam()) * 1'000'000; }
  /// A ball on the floor, not yet pressed in.
  void AddBall(double mass_kg, double stiffness_n_m, double damping_n_s_m) {
    scene_.robot_model =
        Body(Sphere{kRadius_m}, mass_kg, stiffness_n_m, damping_n_s_m, std::get<bool>(GetParam()));
    scene_.AddRobot(At(0, 0, kRadius_m));
    Build();
  }
  void Build() {
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    if (std::get<bool>(GetParam())) scene_.setpoints.assign(scene_.robot_count(), {0, ControlMode::kIdle});
  }
  BodyState Now(std::size_t body = 0) { return scene_.Capture()->bodies.at(body); }

  PhysicsScene scene_;
};

TEST_P(YieldingTest, ABallSinksByItsWeightOverTheStiffness) {
  AddBall(2, 4000, 300);
  scene_.RunFor(2);
  EXPECT_NEAR(kRadius_m - Now().p_WB.z(), 2 * kG / 4000, 2e-6);
}

TEST_P(YieldingTest, ItFallsAsleepThere) {
  AddBall(2, 4000, 300);
  scene_.RunFor(5);
  EXPECT_EQ(Now().sleep_counter, kAsleep);
}

TEST_P(YieldingTest, AStrongDamperLetsItSinkWithItsTimeConstant) {
  constexpr double kStiffness_n_m = 1000, kDamping_n_s_m = 1000, kMass_kg = 1;
  AddBall(kMass_kg, kStiffness_n_m, kDamping_n_s_m);
  scene_.RunFor(1);
  const double expected_m = kMass_kg * kG / kStiffness_n_m * (1 - std::exp(-1.0));
  EXPECT_NEAR((kRadius_m - Now().p_WB.z()) / expected_m, 1, 0.01);
}

TEST_P(YieldingTest, WithoutADamperItSwingsWithItsPeriodAndIsDampedByTheStepOnly) {
  constexpr double kStiffness_n_m = 1000, kMass_kg = 1;
  AddBall(kMass_kg, kStiffness_n_m, 0);
  const double rate_rad_s = std::sqrt(kStiffness_n_m / kMass_kg);
  scene_.RunFor(std::numbers::pi / rate_rad_s);
  // An implicit step h damps like a damper with the ratio rate · h / 2.
  const double damping = rate_rad_s * std::get<int>(GetParam()) * 1e-3 / 2;
  const double expected_m = kMass_kg * kG / kStiffness_n_m * (1 + std::exp(-std::numbers::pi * damping));
  EXPECT_NEAR((kRadius_m - Now().p_WB.z()) / expected_m, 1, 0.03);
}

TEST_P(YieldingTest, ABoxHasASpringAtEachCorner) {
  scene_.robot_model = Body(Box{{0.2, 0.2, 0.2}}, 8, 5000, 300, std::get<bool>(GetParam()));
  scene_.AddRobot(At(0, 0, 0.1));
  Build();
  scene_.RunFor(3);
  EXPECT_NEAR(0.1 - Now().p_WB.z(), 8 * kG / (4 * 5000), 5e-6);
}

TEST_P(YieldingTest, SpringsOfBothAreInSeries) {
  scene_.robot_model = Body(Box{{0.2, 0.2, 0.2}}, 8, 5000, 300, std::get<bool>(GetParam()));
  scene_.AddRobot(At(0, 0, 0.1)).AddRobot(At(0, 0, 0.3));
  Build();
  scene_.RunFor(4);
  constexpr double kAsleepBefore_m = 1e-4;
  EXPECT_NEAR(0.2 - (Now(1).p_WB.z() - Now(0).p_WB.z()), 8 * kG / (4 * 2500), kAsleepBefore_m);
}

TEST_P(YieldingTest, AnObjectSinksIntoWhatYields) {
  std::shared_ptr<RobotModel> mat =
      std::make_shared<RobotModel>(*Body(Box{{1, 1, 0.2}}, 50, 5000, 300, std::get<bool>(GetParam())));
  mat->fixed_base = true;
  scene_.robot_model = mat;
  scene_.AddRobot(At(0, 0, 0.1));
  scene_.Add(Box{{0.2, 0.2, 0.2}}, At(0, 0, 0.3), 4);
  Build();
  scene_.RunFor(3);
  EXPECT_NEAR(0.3 - scene_.object(0).p.z(), 4 * kG / (4 * 5000), 5e-6);
}

TEST_P(YieldingTest, AManyTimesStifferOneIsHard) {
  AddBall(2, 1e12, 1);
  scene_.RunFor(2);
  EXPECT_NEAR(Now().p_WB.z(), kRadius_m, 1e-5);
}

TEST_P(YieldingTest, WhatIsPressedInDeepIsNotThrownHigherThanItsSpringSays) {
  constexpr double kStiffness_n_m = 5000, kDeep_m = 0.02, kMass_kg = 1;
  AddBall(kMass_kg, kStiffness_n_m, 0);
  Frame frame;
  scene_.world().Fill(frame);
  frame.bodies.front().p_WB.z() -= kDeep_m;
  scene_.world().Restore(frame);
  const double highest_m = kStiffness_n_m * kDeep_m * kDeep_m / 2 / (kMass_kg * kG) - kDeep_m;
  double seen_m = 0;
  for (int i = 0; i < 100; ++i) {
    scene_.RunFor(0.01);
    seen_m = std::max(seen_m, Now().p_WB.z() - kRadius_m);
  }
  EXPECT_GT(seen_m, 0);
  EXPECT_LT(seen_m, highest_m * 1.001);
}

TEST_P(YieldingTest, InAStackEachSpringCarriesWhatStandsOnIt) {
  constexpr int kCount = 6;
  constexpr double kMass_kg = 2, kStiffness_n_m = 5000;
  scene_.robot_model = Body(Box{{0.2, 0.2, 0.2}}, kMass_kg, kStiffness_n_m, 300, std::get<bool>(GetParam()));
  for (int i = 0; i < kCount; ++i) scene_.AddRobot(At(0, 0, 0.1 + 0.2 * i));
  Build();
  scene_.RunFor(4);
  constexpr double kAsleepBefore_m = 1e-4;
  EXPECT_NEAR(0.1 - Now().p_WB.z(), kCount * kMass_kg * kG / (4 * kStiffness_n_m), kAsleepBefore_m);
  for (int i = 1; i < kCount; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(0.2 - (Now(k).p_WB.z() - Now(k - 1).p_WB.z()),
                (kCount - i) * kMass_kg * kG / (4 * kStiffness_n_m / 2), kAsleepBefore_m)
        << i;
  }
}

TEST_P(YieldingTest, AStackSlidesAsFarAsItsFrictionSays) {
  scene_.robot_model = Body(Box{{0.4, 0.4, 0.02}}, 2, 50'000, 500, std::get<bool>(GetParam()));
  for (int i = 0; i < 5; ++i) scene_.AddRobot(At(0, 0, 0.01 + 0.02 * i));
  Build();
  scene_.RunFor(0.5);
  Frame frame;
  scene_.world().Fill(frame);
  for (BodyState& body : frame.bodies) {
    body.v_WB.x() = 1;
    body.sleep_counter = 0;
  }
  scene_.world().Restore(frame);
  const double start_m = Now().p_WB.x();
  scene_.RunFor(1);
  const double step_s = 1e-3 * std::get<int>(GetParam());
  EXPECT_NEAR(Now().p_WB.x() - start_m, 1 / (2 * kG), 0.5 * step_s + 5e-4);  // friction 1
}

TEST_P(YieldingTest, AWeakSpringThatCannotStopItGivesItNoEnergy) {
  constexpr double kSmall_m = 0.01;
  scene_.robot_model = Body(Sphere{kSmall_m}, 1, 50, 0, std::get<bool>(GetParam()));
  scene_.AddRobot(At(0, 0, 1 + kSmall_m));
  Build();
  double fastest_m_s = 0;
  for (int i = 0; i < 300; ++i) {
    scene_.RunFor(0.01);
    const BodyState now = Now();
    fastest_m_s = std::max(fastest_m_s,
                           now.v_WB.norm() - std::sqrt(2 * kG * std::max(0.0, 1 + kSmall_m - now.p_WB.z())));
  }
  EXPECT_LT(fastest_m_s, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Steps, YieldingTest, testing::Combine(testing::Values(1, 5, 10), testing::Bool()),
                         [](const auto& info) {
                           return std::to_string(std::get<int>(info.param)) +
                                  (std::get<bool>(info.param) ? "MsThrusters" : "MsLoose");
                         });

}  // namespace
}  // namespace coopdyn::yielding
