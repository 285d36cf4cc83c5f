// SPDX-License-Identifier: MIT
// Control boards against closed forms, at 1, 5 and 10 ms: one joint on a post, with or without weight.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::boards {
namespace {

constexpr double kGravity_m_s2 = 9.81;
constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kInf = JointModel::kInfinity;
constexpr double kMass_kg = 2, kArm_m = 0.5, kOwnInertia_kg_m2 = 0.02;
constexpr double kInertia_kg_m2 = kOwnInertia_kg_m2 + kMass_kg * kArm_m * kArm_m;

/// A weight at the end of an arm that points along x; positive turns it down.
RobotModel Rig() {
  RobotModel model;
  model.type = "rig";
  model.fixed_base = true;
  LinkModel base, arm;
  base.name = "base";
  base.X_RL.p = {0, 0, 3};
  base.mass_kg = 1;
  base.inertia_kg_m2 = Vector3::Constant(0.01);
  base.collisions = {{Sphere{0.02}, {}, {}, 1, false}};
  arm = base;
  arm.name = "arm";
  arm.X_RL.p = {kArm_m, 0, 3};
  arm.mass_kg = kMass_kg;
  arm.inertia_kg_m2 = Vector3::Constant(kOwnInertia_kg_m2);
  model.links = {base, arm};
  JointModel joint;
  joint.name = "shoulder";
  joint.child = 1;
  joint.p_RJ = {0, 0, 3};
  joint.max_effort = 40;
  joint.max_velocity = 4;
  model.joints = {joint};
  model.actuators = {{"arm", {0}, BoardModel()}};
  model.footprint_radius_m = 0.6;
  model.height_m = 3.1;
  return model;
}

/// The same about a vertical axis: it carries no weight.
RobotModel Turntable() {
  RobotModel model = Rig();
  model.joints[0].axis_R = Vector3::UnitZ();
  return model;
}

BoardModel& BoardOf(RobotModel& model) {
  return std::get<BoardModel>(model.actuators[0].kind);
}

class BoardTest : public ::testing::TestWithParam<int> {
 protected:
  void Add(RobotModel model) {
    scene_.step_length = GetParam() * 1'000'000;
    model_ = std::make_shared<const RobotModel>(std::move(model));
    scene_.robot_model = model_;
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(1, Setpoint());
  }
  double step_s() const { return GetParam() * 1e-3; }
  void Command(ControlMode mode, double reference) { scene_.setpoints[0] = {reference, mode}; }
  void Tune(double speed, double acceleration) {
    JointControl control = scene_.world().controls()[0];
    control.speed = speed;
    control.acceleration = acceleration;
    scene_.world().Tune(0, control);
  }
  void SetCompliance(double stiffness, double damping, double offset) {
    JointControl control = scene_.world().controls()[0];
    control.stiffness = stiffness;
    control.damping = damping;
    control.offset = offset;
    scene_.world().Tune(0, control);
  }
  ChannelState channel() { return scene_.Capture()->channels[0]; }
  double position() { return channel().position; }
  double velocity() { return channel().velocity; }
  int StepsIn(double seconds) const { return static_cast<int>(std::lround(seconds / step_s())); }

  PhysicsScene scene_;
  std::shared_ptr<const RobotModel> model_;
};

TEST_P(BoardTest, AMinimumJerkMoveFollowsTheFormulaAndArrivesOnTime) {
  Add(Rig());
  Tune(1.5, 20);
  const double way = -kPi / 2, duration_s = 1.875 * kPi / 2 / 1.5;
  Command(ControlMode::kPosition, way);
  for (int i = 1; i <= StepsIn(duration_s) + 1; ++i) {
    scene_.Run(1);
    const double s = std::min(1.0, i * step_s() / duration_s);
    const double wanted = way * (10 * std::pow(s, 3) - 15 * std::pow(s, 4) + 6 * std::pow(s, 5));
    ASSERT_NEAR(position(), wanted, 0.5 * kDegree) << s;
  }
  EXPECT_NEAR(position(), way, 0.05 * kDegree);
}

TEST_P(BoardTest, ATargetThatMovesInEachStepIsFollowed) {
  Add(Rig());
  Tune(2, 8);
  double furthest_off = 0, last = 0;
  for (int i = 1; i <= StepsIn(10); ++i) {
    const double target = 0.5 * std::sin(i * step_s());
    Command(ControlMode::kPosition, target);
    scene_.Run(1);
    if (i > StepsIn(3)) furthest_off = std::max(furthest_off, std::abs(position() - target));
    ASSERT_LE(std::abs(position()), 0.52);
    ASSERT_LE(std::abs(velocity() - last), 8 * step_s() * 1.05 + 2e-3) << i;
    last = velocity();
  }
  EXPECT_LT(furthest_off, 0.1);
}

TEST_P(BoardTest, ATrapezoidalMoveKeepsToItsSpeedAndAcceleration) {
  RobotModel model = Rig();
  BoardOf(model).profile = BoardModel::Profile::kTrapezoidal;
  Add(model);
  Tune(1, 4);
  Command(ControlMode::kPosition, 1.5);
  const double duration_s = 1.5 / 1 + 1.0 / 4;
  double before = 0, fastest = 0;
  for (int i = 0; i < StepsIn(duration_s + 2 * step_s()); ++i) {
    scene_.Run(1);
    EXPECT_LE(std::abs(velocity() - before), 4 * step_s() * 1.02 + 1e-3) << i;
    before = velocity();
    fastest = std::max(fastest, before);
  }
  EXPECT_NEAR(fastest, 1, 1e-3);
  EXPECT_NEAR(position(), 1.5, 0.05 * kDegree);
}

TEST_P(BoardTest, AServoHoldsItsWeight) {
  Add(Rig());
  Command(ControlMode::kPosition, -0.7);
  scene_.RunFor(4);
  EXPECT_NEAR(position(), -0.7, 0.01 * kDegree);
  EXPECT_NEAR(channel().effort, -kMass_kg * kGravity_m_s2 * kArm_m * std::cos(0.7), 0.02);
}

TEST_P(BoardTest, ADirectReferenceIsReachedAtTheEndOfTheStep) {
  Add(Rig());
  scene_.substeps = 2;
  for (int i = 1; i <= StepsIn(1); ++i) {
    const double wanted = 0.3 * std::sin(2 * i * step_s()) - 0.2 * i * step_s();
    Command(ControlMode::kDirect, wanted);
    scene_.Run(1);
    if (i * step_s() < 0.1) continue;  // it starts from rest
    ASSERT_NEAR(position(), wanted, 0.02 * kDegree) << i;
  }
}

TEST_P(BoardTest, AVelocityIsKeptUnderWeight) {
  Add(Rig());
  Command(ControlMode::kVelocity, -0.8);
  scene_.RunFor(0.5);
  EXPECT_NEAR(velocity(), -0.8, 1e-3);
}

TEST_P(BoardTest, AnEffortAcceleratesByTheInertia) {
  Add(Turntable());
  Command(ControlMode::kEffort, 0.5);
  scene_.RunFor(1);
  EXPECT_NEAR(velocity(), 0.5 / kInertia_kg_m2, 1e-3);
  EXPECT_NEAR(channel().effort, 0.5, 1e-9);
}

TEST_P(BoardTest, ADamperAndFrictionBothResistAnEffort) {
  RobotModel model = Turntable();
  model.joints[0].damping = 2;
  model.joints[0].friction = 1;
  Add(std::move(model));
  Command(ControlMode::kEffort, 0.9);
  scene_.RunFor(1);
  EXPECT_NEAR(position(), 0, 1e-6);
  Command(ControlMode::kEffort, 3);
  scene_.RunFor(4);
  EXPECT_NEAR(velocity(), (3.0 - 1) / 2, 1e-3);
}

TEST_P(BoardTest, AnIdleJointSwings) {
  Add(Rig());
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(0.1);
  const double wanted = kMass_kg * kGravity_m_s2 * kArm_m / kInertia_kg_m2 * 0.1 * 0.1 / 2;
  EXPECT_NEAR(position(), wanted, 0.12 * wanted);
}

TEST_P(BoardTest, GravityCompensationCarriesAnIdleJoint) {
  RobotModel model = Rig();
  BoardOf(model).gravity_compensation = true;
  Add(model);
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(2);
  EXPECT_NEAR(position(), 0, 1e-6);
}

TEST_P(BoardTest, ALoadDeflectsACompliantJoint) {
  Add(Rig());
  SetCompliance(100, 10, 0);
  Command(ControlMode::kPosition, 0);
  scene_.RunFor(5);
  const double load_nm = kMass_kg * kGravity_m_s2 * kArm_m * std::cos(position());
  EXPECT_NEAR(position() / (load_nm / 100), 1, 0.02);
}

TEST_P(BoardTest, TheOffsetOfAComplianceIsAnEffort) {
  Add(Turntable());
  SetCompliance(50, 5, 2);
  Command(ControlMode::kDirect, 0.1);
  scene_.RunFor(6);
  EXPECT_NEAR(position(), 0.1 + 2.0 / 50, 0.02 * 2.0 / 50);
}

TEST_P(BoardTest, AStiffComplianceIsStable) {
  Add(Turntable());
  SetCompliance(1e6, 1e3, 0);
  Command(ControlMode::kDirect, 0.3);
  scene_.RunFor(3);
  EXPECT_NEAR(position(), 0.3, 1e-3);
}

TEST_P(BoardTest, SwitchingModesInMotionGivesNoJump) {
  Add(Rig());
  Tune(2, 10);
  Command(ControlMode::kPosition, 1.2);
  scene_.RunFor(0.3);
  // Effort and weight together bound the change per step.
  const double most = (40 + kMass_kg * kGravity_m_s2 * kArm_m) / kInertia_kg_m2 * step_s() * 1.01;
  double before = velocity();
  const ControlMode modes[] = {ControlMode::kVelocity, ControlMode::kPosition, ControlMode::kIdle,
                               ControlMode::kDirect,   ControlMode::kEffort,   ControlMode::kPosition,
                               ControlMode::kDirect,   ControlMode::kVelocity, ControlMode::kIdle};
  for (const ControlMode mode : modes) {
    const bool is_place = mode == ControlMode::kPosition || mode == ControlMode::kDirect;
    Command(mode, is_place ? position() + 0.1 : mode == ControlMode::kIdle ? 0 : 0.5);
    for (int i = 0; i < StepsIn(0.05); ++i) {
      scene_.Run(1);
      ASSERT_LE(std::abs(velocity() - before), most) << static_cast<int>(mode) << " " << i;
      before = velocity();
    }
  }
}

TEST_P(BoardTest, ANewTargetOnTheWayChangesTheSpeedSmoothly) {
  Add(Turntable());
  Tune(2, 10);
  Command(ControlMode::kPosition, 1.5);
  scene_.RunFor(0.4);
  double before = velocity();
  ASSERT_GT(before, 0.5);
  Command(ControlMode::kPosition, -1);
  for (int i = 0; i < StepsIn(4); ++i) {
    scene_.Run(1);
    ASSERT_LE(std::abs(velocity() - before), 10 * 1.05 * step_s() + 1e-3) << i;
    before = velocity();
  }
  EXPECT_NEAR(position(), -1, 0.01 * kDegree);
}

TEST_P(BoardTest, TheEffortAtAStopIsTheMotors) {
  RobotModel model = Rig();
  model.joints[0].upper = 0.3;
  Add(model);
  Command(ControlMode::kEffort, 5);
  scene_.Run(StepsIn(2));
  EXPECT_NEAR(position(), 0.3, 0.2 * kDegree);
  EXPECT_NEAR(channel().effort, 5, 1e-9);
  Command(ControlMode::kEffort, -3);
  scene_.Run(1);
  EXPECT_NEAR(channel().effort, -3, 1e-9);
}

TEST_P(BoardTest, AJointThatWasKeptFromItsTargetBeginsTheNextWayWhereItIs) {
  RobotModel model = Rig();
  Add(model);
  Tune(1, 4);
  Command(ControlMode::kPosition, 1);
  scene_.Run(1);
  JointControl control = scene_.world().controls()[0];
  control.reference = control.start = 1.5;  // as if an obstacle had blocked it
  scene_.world().Tune(0, control);
  Command(ControlMode::kPosition, -0.5);
  scene_.Run(StepsIn(0.3));
  EXPECT_LT(velocity(), -0.05);
}

TEST_P(BoardTest, LimitsHoldAgainstFullEffort) {
  for (const ControlMode mode : {ControlMode::kVelocity, ControlMode::kEffort, ControlMode::kPosition}) {
    scene_ = PhysicsScene();
    RobotModel model = Rig();
    model.joints[0].lower = -0.4;
    model.joints[0].upper = 0.6;
    Add(model);
    for (const double sign : {-1.0, 1.0}) {
      Command(mode, sign * 100);
      scene_.RunFor(2);
      EXPECT_NEAR(position(), sign < 0 ? -0.4 : 0.6, 0.2 * kDegree) << static_cast<int>(mode);
    }
  }
}

TEST_P(BoardTest, AnIdleJointFallsOntoItsStop) {
  RobotModel model = Rig();
  model.joints[0].upper = 0.5;
  Add(model);
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(3);
  EXPECT_NEAR(position(), 0.5, 0.5 * kDegree);
}

TEST_P(BoardTest, AWeightBeyondTheMotorLeansOnTheStop) {
  RobotModel model = Rig();
  model.joints[0].upper = 0.3;
  model.joints[0].max_effort = 2;
  Add(model);
  Command(ControlMode::kPosition, 0);
  scene_.RunFor(3);
  EXPECT_NEAR(position(), 0.3, 0.5 * kDegree);
}

TEST_P(BoardTest, AnAxisTurnsFourHundredDegreesBothWays) {
  RobotModel model = Rig();
  model.joints[0].lower = -400 * kDegree;
  model.joints[0].upper = 400 * kDegree;
  Add(model);
  Tune(4, 20);
  for (const double sign : {1.0, -1.0}) {
    Command(ControlMode::kPosition, sign * 500 * kDegree);
    scene_.RunFor(9);
    EXPECT_NEAR(position(), sign * 400 * kDegree, 0.05 * kDegree);
  }
}

TEST_P(BoardTest, ASliderLiftsItsLoad) {
  RobotModel model = Rig();
  JointModel& lift = model.joints[0];
  lift.kind = JointModel::Kind::kSlider;
  lift.axis_R = Vector3::UnitZ();
  lift.lower = -0.2;
  lift.upper = 0.4;
  Add(model);
  Command(ControlMode::kPosition, 0.3);
  scene_.RunFor(2);
  EXPECT_NEAR(position(), 0.3, 1e-4);
  EXPECT_NEAR(channel().effort, kMass_kg * kGravity_m_s2, 0.01);
  EXPECT_NEAR(LinkPose(*scene_.Capture(), 0, 1).p.z(), 3.3, 1e-4);
}

TEST_P(BoardTest, AnArmAtItsTargetSleepsAndWakesForTheNext) {
  Add(Rig());
  Command(ControlMode::kPosition, 0.2);
  scene_.RunFor(4);
  const std::uint64_t asleep = scene_.Capture()->bodies[1].sleep_counter;
  EXPECT_EQ(asleep, BodyState::kFrozen - 1);
  Command(ControlMode::kPosition, 0.5);
  scene_.RunFor(4);
  EXPECT_NEAR(position(), 0.5, 0.01 * kDegree);
}

TEST_P(BoardTest, ARestoredMotionGoesOnWithTheSameBits) {
  Add(Rig());
  SetCompliance(200, 10, 0);
  Command(ControlMode::kPosition, 1);
  scene_.RunFor(0.3);
  const auto middle = scene_.Capture();
  scene_.RunFor(0.5);
  const std::uint64_t first = StateHash(*scene_.Capture());
  scene_.Restore(*middle);
  scene_.RunFor(0.5);
  EXPECT_EQ(StateHash(*scene_.Capture()), first);
}

INSTANTIATE_TEST_SUITE_P(Steps, BoardTest, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::boards
