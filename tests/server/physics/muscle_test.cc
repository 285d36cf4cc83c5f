// SPDX-License-Identifier: MIT
// Muscles against Hill's equations: a muscle pulls a bob, on a horizontal rail or free, to a post.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::muscles {
namespace {

constexpr double kForce_n = 30, kOptimal_m = 0.5, kFastest_m_s = 3, kMass_kg = 1.5;

MuscleModel Biceps() {
  MuscleModel muscle;
  muscle.max_force_n = kForce_n;
  muscle.optimal_length_m = kOptimal_m;
  muscle.max_velocity_m_s = kFastest_m_s;
  return muscle;
}

/// Channel 0 is the rail's motor, 1 the muscle. The origins of both links are the muscle's ends.
RobotModel Rail(MuscleModel muscle, double length_m) {
  RobotModel model;
  model.type = "rail";
  model.fixed_base = true;
  LinkModel base, bob;
  base.name = "base";
  base.X_RL.p = {0, 0, 3};
  base.mass_kg = kMass_kg;
  base.inertia_kg_m2 = Vector3::Constant(0.01);
  base.collisions = {{Sphere{0.02}, {}, {}, 1, false}};
  bob = base;
  bob.name = "bob";
  bob.X_RL.p = {length_m, 0, 3};
  model.links = {base, bob};
  JointModel rail;
  rail.name = "rail";
  rail.kind = JointModel::Kind::kSlider;
  rail.child = 1;
  rail.p_RJ = bob.X_RL.p;
  rail.axis_R = Vector3::UnitX();
  rail.max_effort = 1000;
  rail.max_velocity = 10;
  JointModel joint;
  joint.name = "biceps";
  joint.kind = JointModel::Kind::kMuscle;
  joint.child = 1;
  muscle.p_from_R = base.X_RL.p;
  muscle.p_to_R = bob.X_RL.p;
  joint.muscle = muscle;
  model.joints = {rail, joint};
  model.actuators = {{"joints", {0}, BoardModel()}, {"muscles", {1}, MusclesModel()}};
  model.footprint_radius_m = 1;
  model.height_m = 3.1;
  return model;
}

/// The bob hangs below the post, held only by its muscle.
RobotModel Hanging(const MuscleModel& muscle, double length_m) {
  RobotModel model = Rail(muscle, length_m);
  model.links[1].X_RL.p = {0, 0, 3 - length_m};
  model.joints.erase(model.joints.begin());
  model.joints[0].muscle->p_to_R = model.links[1].X_RL.p;
  model.actuators = {{"muscles", {0}, MusclesModel()}};
  return model;
}

class MuscleTest : public ::testing::Test {
 protected:
  void Add(const RobotModel& model, int step_ms = 1) {
    scene_.step_length = step_ms * 1'000'000;
    scene_.robot_model = std::make_shared<const RobotModel>(model);
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(model.joints.size(), {0, ControlMode::kIdle});
  }
  void Activate(double activation) { scene_.setpoints.back() = {activation, ControlMode::kPwm}; }
  ChannelState Pulled() { return scene_.Capture()->channels.back(); }

  PhysicsScene scene_;
};

TEST_F(MuscleTest, HeldFastItPullsByItsLength) {
  for (const double length_m : {0.3, 0.4, 0.5, 0.62, 0.8}) {
    scene_ = PhysicsScene();
    Add(Rail(Biceps(), length_m));
    scene_.setpoints[0] = {0, ControlMode::kVelocity};
    Activate(0.7);
    scene_.RunFor(0.1);
    const double off = std::abs(length_m - kOptimal_m) / (0.56 * kOptimal_m);
    const double wanted_n = 0.7 * kForce_n * std::exp(std::log(0.05) * std::pow(off, 3));
    EXPECT_NEAR(Pulled().effort, wanted_n, 0.01 * wanted_n) << length_m;
    EXPECT_NEAR(Pulled().position, length_m, 1e-4);
  }
}

TEST_F(MuscleTest, WithoutTheFactorOfLengthEachLengthIsTheOptimum) {
  MuscleModel muscle = Biceps();
  muscle.use_length = false;
  Add(Rail(muscle, 0.9));
  scene_.setpoints[0] = {0, ControlMode::kVelocity};
  Activate(1);
  scene_.RunFor(0.1);
  EXPECT_NEAR(Pulled().effort, kForce_n, 0.01);
}

TEST_F(MuscleTest, ShorteningItPullsLess) {
  MuscleModel muscle = Biceps();
  muscle.use_length = false;
  for (const double speed_m_s : {0.3, 1.0, 2.4}) {
    scene_ = PhysicsScene();
    Add(Rail(muscle, 0.9));
    scene_.setpoints[0] = {-speed_m_s, ControlMode::kVelocity};
    Activate(1);
    scene_.RunFor(0.1);
    const double wanted_n = kForce_n * (kFastest_m_s - speed_m_s) / (kFastest_m_s + 5 * speed_m_s);
    EXPECT_NEAR(Pulled().effort, wanted_n, 0.01 * kForce_n) << speed_m_s;
    EXPECT_NEAR(Pulled().velocity, -speed_m_s, 1e-3);
  }
}

TEST_F(MuscleTest, LengtheningItPullsMore) {
  MuscleModel muscle = Biceps();
  muscle.use_length = false;
  for (const double speed_m_s : {0.3, 1.0, 2.4}) {
    scene_ = PhysicsScene();
    Add(Rail(muscle, 0.5));
    scene_.setpoints[0] = {speed_m_s, ControlMode::kVelocity};
    Activate(1);
    scene_.RunFor(0.1);
    const double v = -speed_m_s;
    const double wanted_n = kForce_n * (1.5 + 0.5 * (kFastest_m_s + v) / (7.56 * 5 * v - kFastest_m_s));
    EXPECT_NEAR(Pulled().effort, wanted_n, 0.01 * kForce_n) << speed_m_s;
  }
}

TEST_F(MuscleTest, AtItsGreatestSpeedItDoesNotPull) {
  MuscleModel muscle = Biceps();
  muscle.use_length = false;
  Add(Rail(muscle, 0.9));
  scene_.setpoints[0] = {-3.5, ControlMode::kVelocity};
  Activate(1);
  scene_.RunFor(0.1);
  EXPECT_EQ(Pulled().effort, 0);
}

TEST_F(MuscleTest, AMassMovesAsTheReference) {
  Add(Rail(Biceps(), 0.7));
  Activate(0.8);
  double x[2] = {0.7, 0};
  const auto slope = [](const double* at, double* out) {
    const double off = std::abs(at[0] - kOptimal_m) / (0.56 * kOptimal_m), u = -at[1];
    const double fv = u >= 0 ? (kFastest_m_s - u) / (kFastest_m_s + 5 * u)
                             : 1.5 + 0.5 * (kFastest_m_s + u) / (7.56 * 5 * u - kFastest_m_s);
    out[0] = at[1];
    out[1] = -0.8 * kForce_n * std::exp(std::log(0.05) * std::pow(off, 3)) * fv / kMass_kg;
  };
  for (int i = 1; i <= 250; ++i) {
    scene_.Run(1);
    for (int k = 0; k < 100; ++k) {
      constexpr double h = 1e-5;
      double a[2], b[2], c[2], d[2], y[2];
      slope(x, a);
      for (int j = 0; j < 2; ++j) y[j] = x[j] + h / 2 * a[j];
      slope(y, b);
      for (int j = 0; j < 2; ++j) y[j] = x[j] + h / 2 * b[j];
      slope(y, c);
      for (int j = 0; j < 2; ++j) y[j] = x[j] + h * c[j];
      slope(y, d);
      for (int j = 0; j < 2; ++j) x[j] += h / 6 * (a[j] + 2 * b[j] + 2 * c[j] + d[j]);
    }
    ASSERT_NEAR(Pulled().position, x[0], 0.01 * 0.2) << i;
  }
  EXPECT_LT(x[0], 0.6);  // it has moved
}

TEST_F(MuscleTest, AMuscleAloneHoldsABobWhereItCarriesItsWeight) {
  for (const int step_ms : {1, 5, 10}) {
    scene_ = PhysicsScene();
    Add(Hanging(Biceps(), 0.4), step_ms);
    Activate(0.6);
    scene_.RunFor(4);
    const double factor = kMass_kg * kG / (0.6 * kForce_n);
    const double off = std::cbrt(std::log(factor) / std::log(0.05));
    EXPECT_NEAR(Pulled().position, kOptimal_m * (1 - 0.56 * off), 0.005) << step_ms;
    EXPECT_NEAR(Pulled().effort, kMass_kg * kG, 0.01 * kMass_kg * kG) << step_ms;
  }
}

TEST_F(MuscleTest, WithoutActivationTheBobFalls) {
  Add(Hanging(Biceps(), 0.4));
  scene_.RunFor(0.3);
  EXPECT_NEAR(Pulled().position, 0.4 + kG * 0.09 / 2, 0.01);
  EXPECT_EQ(Pulled().effort, 0);
}

TEST_F(MuscleTest, ARestoredFrameGoesOnWithTheSameBits) {
  Add(Hanging(Biceps(), 0.4));
  Activate(0.9);
  scene_.RunFor(0.2);
  const std::shared_ptr<Frame> saved = scene_.Capture();
  scene_.RunFor(0.3);
  const std::uint64_t hash = StateHash(*scene_.Capture());
  scene_.Restore(*saved);
  scene_.RunFor(0.3);
  EXPECT_EQ(StateHash(*scene_.Capture()), hash);
}

}  // namespace
}  // namespace coopdyn::muscles
