// SPDX-License-Identifier: MIT
// Drive trains against their equations, and whole motions against a reference integrated with a hundredth of
// the step: a turntable about a vertical axis, or an arm with a weight.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::trains {
namespace {

constexpr double kInertia_kg_m2 = 0.01;
constexpr double kRatio = 10, kNoLoad_rad_s = 5, kStall_nm = 2;  // at the joint
constexpr double kRotor_kg_m2 = 1e-3;                            // likewise

DriveTrainModel Train() {
  DriveTrainModel train;
  train.pwm = {{1, kNoLoad_rad_s * kRatio, kStall_nm / kRatio, 4}};
  train.ratio = kRatio;
  train.rotor_inertia_kg_m2 = kRotor_kg_m2 / (kRatio * kRatio);
  train.brake_nms_rad = kStall_nm / kNoLoad_rad_s / (kRatio * kRatio);
  return train;
}

/// A disc on a post; `mass_kg` is attached off the axis, which is then horizontal.
RobotModel Turntable(const DriveTrainModel& train, double arm_m = 0) {
  RobotModel model;
  model.type = "turntable";
  model.fixed_base = true;
  LinkModel base, disc;
  base.name = "base";
  base.X_RL.p = {0, 0, 3};
  base.mass_kg = 1;
  base.inertia_kg_m2 = Vector3::Constant(kInertia_kg_m2);
  base.collisions = {{Sphere{0.02}, {}, {}, 1, false}};
  disc = base;
  disc.name = "disc";
  disc.X_RL.p = {arm_m, 0, 3};
  if (arm_m > 0) disc.inertia_kg_m2 = Vector3::Constant(kInertia_kg_m2 - arm_m * arm_m);
  model.links = {base, disc};
  JointModel joint;
  joint.name = "hinge";
  joint.child = 1;
  joint.p_RJ = {0, 0, 3};
  joint.axis_R = arm_m > 0 ? Vector3(-Vector3::UnitY()) : Vector3::UnitZ();  // positive: up
  joint.max_effort = kStall_nm;
  joint.max_velocity = kNoLoad_rad_s;
  joint.drive_train = train;
  model.joints = {joint};
  model.actuators = {{"joints", {0}, BoardModel()}};
  model.footprint_radius_m = 0.1;
  model.height_m = 3.1;
  return model;
}

/// Joint and rotor: angles and rates, integrated by Runge and Kutta's formula of fourth order.
struct TwoMass {
  using State = std::array<double, 4>;  // joint rad, rad/s; rotor rad, rad/s
  double inertia = kInertia_kg_m2, rotor = kRotor_kg_m2;
  std::function<double(double twist, double rate)> coupling;
  std::function<double(double rate)> motor;
  double load = 0;
  State x{};

  State Slope(const State& at) const {
    const double torque = coupling(at[2] - at[0], at[3] - at[1]);
    return {at[1], (torque + load) / inertia, at[3], (motor(at[3]) - torque) / rotor};
  }
  void Run(double time_s, double dt_s) {
    const auto moved = [](const State& from, const State& slope, double by) {
      State to = from;
      for (std::size_t i = 0; i < 4; ++i) to[i] += by * slope[i];
      return to;
    };
    for (double t = 0; t < time_s - dt_s / 2; t += dt_s) {
      const State a = Slope(x), b = Slope(moved(x, a, dt_s / 2)), c = Slope(moved(x, b, dt_s / 2)),
                  d = Slope(moved(x, c, dt_s));
      for (std::size_t i = 0; i < 4; ++i) x[i] += dt_s / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
  }
};

class TrainTest : public ::testing::Test {
 protected:
  void Add(const RobotModel& model, int step_ms = 1) {
    scene_.step_length = step_ms * 1'000'000;
    scene_.robot_model = std::make_shared<const RobotModel>(model);
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(1, {0, ControlMode::kIdle});
  }
  void Command(ControlMode mode, double reference) { scene_.setpoints[0] = {reference, mode}; }
  ChannelState joint() { return scene_.Capture()->channels[0]; }
  DriveTrainState train() { return scene_.Capture()->drive_trains[0]; }
  double twist() { return train().rotor_rad - joint().position; }
  void Twist(double angle_rad) {
    const std::shared_ptr<Frame> frame = scene_.Capture();
    frame->drive_trains[0].rotor_rad = angle_rad;
    scene_.Restore(*frame);
  }

  PhysicsScene scene_;
};

TEST_F(TrainTest, FullDutyEndsAtItsNoLoadSpeed) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(1);
  EXPECT_NEAR(joint().velocity, kNoLoad_rad_s, 1e-3);
}

TEST_F(TrainTest, ADutyBetweenTwoRowsEndsBetweenTheirSpeeds) {
  DriveTrainModel train = Train();
  train.pwm = {{0.2, 0.1 * kNoLoad_rad_s * kRatio, 0.05, 1}, {1, kNoLoad_rad_s * kRatio, 0.2, 4}};
  Add(Turntable(train));
  Command(ControlMode::kPwm, -0.6);
  scene_.RunFor(1);
  EXPECT_NEAR(joint().velocity, -0.55 * kNoLoad_rad_s, 1e-3);
}

TEST_F(TrainTest, HeldFastItGivesItsStallTorque) {
  RobotModel model = Turntable(Train());
  model.joints[0].lower = model.joints[0].upper = 0;
  Add(model);
  Command(ControlMode::kPwm, 0.5);
  scene_.RunFor(0.5);
  EXPECT_NEAR(joint().effort, kStall_nm / 2, 0.01 * kStall_nm);
  EXPECT_NEAR(joint().position, 0, 1e-4);
}

TEST_F(TrainTest, TheRotorsInertiaCountsByTheSquareOfTheRatio) {
  DriveTrainModel train = Train();
  train.rotor_inertia_kg_m2 *= 20;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 1);
  const double inertia = kInertia_kg_m2 + 20 * kRotor_kg_m2, rise_s = inertia * kNoLoad_rad_s / kStall_nm;
  for (int i = 1; i <= 200; ++i) {
    scene_.Run(1);
    const double wanted = kNoLoad_rad_s * (1 - std::exp(-i * 1e-3 / rise_s));
    ASSERT_NEAR(joint().velocity, wanted, 0.01 * kNoLoad_rad_s) << i;
  }
}

TEST_F(TrainTest, LongStepsRunUpToTheSameSpeed) {
  for (const int step_ms : {5, 10}) {
    scene_ = PhysicsScene();
    Add(Turntable(Train()), step_ms);
    Command(ControlMode::kPwm, 1);
    scene_.RunFor(1);
    EXPECT_NEAR(joint().velocity, kNoLoad_rad_s, 1e-3) << step_ms;
  }
}

TEST_F(TrainTest, InTheGapTheRotorTurnsAlone) {
  DriveTrainModel train = Train();
  train.backlash_rad = 0.2;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 0.5);
  for (scene_.Run(1); twist() < 0.0999; scene_.Run(1)) ASSERT_NEAR(joint().velocity, 0, 1e-9);
  scene_.RunFor(0.5);
  EXPECT_NEAR(twist(), 0.1, 1e-4);
  EXPECT_NEAR(joint().velocity, kNoLoad_rad_s / 2, 1e-3);
}

TEST_F(TrainTest, BacklashGivesWayByItsWholeGap) {
  DriveTrainModel train = Train();
  train.backlash_rad = 0.2;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 0.5);
  scene_.RunFor(0.5);
  const double before = twist();
  Command(ControlMode::kPwm, -0.5);
  scene_.RunFor(1);
  EXPECT_NEAR(before - twist(), 0.2, 2e-4);
}

TEST_F(TrainTest, AWeightTwistsTheCouplingByItsStiffness) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 20;
  train.damping_nms_rad = 0.5;
  Add(Turntable(train, 0.05));
  Command(ControlMode::kPosition, 0);
  scene_.RunFor(2);
  const double angle = joint().position;
  EXPECT_NEAR(train.stiffness_nm_rad * twist(), kG * 0.05 * std::cos(angle), 0.01 * kG * 0.05);
}

TEST_F(TrainTest, TwoMassesSwingAsTheReference) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 1;
  train.damping_nms_rad = 1e-3;
  scene_.substeps = 20;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 1);
  TwoMass reference;
  reference.coupling = [](double twist, double rate) { return twist + 1e-3 * rate; };
  reference.motor = [](double rate) { return kStall_nm * (1 - rate / kNoLoad_rad_s); };
  for (int i = 0; i < 300; ++i) {
    scene_.Run(1);
    reference.Run(1e-3, 1e-5);
    ASSERT_NEAR(joint().position, reference.x[0], 0.01 * 1.5) << i;
    ASSERT_NEAR(twist(), reference.x[2] - reference.x[0], 0.01 * 1.5) << i;
  }
}

TEST_F(TrainTest, TheFreeRotorSwingsOnItsSpringAtItsFrequency) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 1;
  scene_.substeps = 10;
  RobotModel model = Turntable(train);
  model.joints[0].lower = model.joints[0].upper = 0;
  Add(model);
  std::shared_ptr<Frame> frame = scene_.Capture();
  frame->drive_trains[0].rotor_rad = 0.1;
  scene_.Restore(*frame);
  int crossings = 0;
  double last = 0.1;
  for (int i = 0; i < 1000; ++i) {
    scene_.Run(1);
    crossings += (twist() < 0) != (last < 0);
    last = twist();
  }
  EXPECT_NEAR(crossings, 2 * std::sqrt(1 / kRotor_kg_m2) / (2 * std::numbers::pi), 1);
}

/// The rotor is twisted by 0.1 rad against a disc of the same inertia; then both are released.
RobotModel TwoEqualMasses(double stiffness_nm_rad) {
  DriveTrainModel train = Train();
  train.rotor_inertia_kg_m2 = kInertia_kg_m2 / (kRatio * kRatio);
  train.stiffness_nm_rad = stiffness_nm_rad;
  return Turntable(train);
}

TEST_F(TrainTest, AnUndampedCouplingKeepsItsAmplitude) {
  constexpr double kOneHertz_nm_rad = kInertia_kg_m2 / 2 * 4 * std::numbers::pi * std::numbers::pi;
  for (const int step_ms : {1, 5, 10}) {
    scene_ = PhysicsScene();
    Add(TwoEqualMasses(kOneHertz_nm_rad), step_ms);
    Twist(0.1);
    scene_.RunFor(19.5);
    double most = 0, least = 0;
    for (int i = 0; i < 1000 / step_ms; ++i) {
      scene_.Run(1);
      most = std::max(most, twist());
      least = std::min(least, twist());
    }
    EXPECT_NEAR(most, 0.1, 1e-3) << step_ms;
    EXPECT_NEAR(least, -0.1, 1e-3) << step_ms;
    EXPECT_NEAR(joint().position, (0.1 - twist()) / 2, 1e-6) << step_ms;  // their common motion is at rest
  }
}

TEST_F(TrainTest, AStiffUndampedCouplingDoesNotRing) {
  Add(TwoEqualMasses(1e5), 10);
  Twist(0.01);
  scene_.RunFor(1);
  EXPECT_NEAR(twist(), 0, 1e-6);
}

TEST_F(TrainTest, ADampedCouplingFollowsItsFormula) {
  constexpr double kRate_rad_s = 2 * std::numbers::pi, kHalf_kg_m2 = kInertia_kg_m2 / 2, kZeta = 0.1;
  for (const int step_ms : {1, 5, 10}) {
    scene_ = PhysicsScene();
    RobotModel model = TwoEqualMasses(kHalf_kg_m2 * kRate_rad_s * kRate_rad_s);
    model.joints[0].drive_train->damping_nms_rad = 2 * kZeta * kRate_rad_s * kHalf_kg_m2;
    Add(model, step_ms);
    Twist(0.1);
    const double damped_rad_s = kRate_rad_s * std::sqrt(1 - kZeta * kZeta), decay = kZeta * kRate_rad_s;
    double worst = 0;
    for (int i = 1; i <= 2000 / step_ms; ++i) {
      scene_.Run(1);
      const double t = i * step_ms * 1e-3;
      const double wanted = 0.1 * std::exp(-decay * t) *
                            (std::cos(damped_rad_s * t) + decay / damped_rad_s * std::sin(damped_rad_s * t));
      worst = std::max(worst, std::abs(twist() - wanted));
    }
    EXPECT_LT(worst, 4e-4 * step_ms) << step_ms;
  }
}

TEST_F(TrainTest, APrestressedSpringDoesNotGiveBelowItsPreload) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 5;
  train.damping_nms_rad = 0.05;
  train.preload_nm = 0.6;
  Add(Turntable(train, 0.05));  // 0.49 N m
  Command(ControlMode::kPosition, 0);
  scene_.RunFor(2);
  EXPECT_NEAR(twist(), 0, 1e-4);
}

TEST_F(TrainTest, APrestressedSpringGivesByWhatIsBeyondItsPreload) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 5;
  train.damping_nms_rad = 0.05;
  train.preload_nm = 0.2;
  Add(Turntable(train, 0.05));
  Command(ControlMode::kPosition, 0);
  scene_.RunFor(3);
  const double load = kG * 0.05 * std::cos(joint().position);
  EXPECT_NEAR(twist(), (load - 0.2) / 5, 0.01 * load / 5);
}

TEST_F(TrainTest, StaticFrictionHoldsUpToItsTorque) {
  DriveTrainModel train = Train();
  train.static_friction_nm = 0.5;
  train.dynamic_friction_nm = 0.1;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 0.24);  // 0.48 N m
  scene_.RunFor(0.5);
  EXPECT_NEAR(joint().velocity, 0, 1e-4);
  Command(ControlMode::kPwm, 0.26);
  scene_.RunFor(0.5);
  EXPECT_GT(joint().velocity, 0.5);
}

TEST_F(TrainTest, DynamicFrictionSlowsEvenly) {
  DriveTrainModel train = Train();
  train.static_friction_nm = 0.5;
  train.dynamic_friction_nm = 0.1;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(0.5);
  EXPECT_NEAR(joint().velocity, kNoLoad_rad_s * (1 - 0.1 / kStall_nm), 0.01);
  const double before = joint().velocity;
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(0.2);
  EXPECT_NEAR(before - joint().velocity, 0.1 / (kInertia_kg_m2 + kRotor_kg_m2) * 0.2, 0.02);
}

TEST_F(TrainTest, ARelaxedMotorRunsOn) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(0.5);
  const double before = joint().velocity;
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(0.5);
  EXPECT_NEAR(joint().velocity, before, 1e-6);
}

TEST_F(TrainTest, AShortCircuitBrakesByTheSpeed) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(0.5);
  const double before = joint().velocity;
  Command(ControlMode::kPwm, 0);
  const double fall_s = (kInertia_kg_m2 + kRotor_kg_m2) * kNoLoad_rad_s / kStall_nm;
  for (int i = 1; i < 80; ++i) {
    scene_.Run(1);
    ASSERT_NEAR(joint().velocity, before * std::exp(-i * 1e-3 / fall_s), 0.01 * before);
  }
}

TEST_F(TrainTest, TheCurrentFollowsTheTorque) {
  RobotModel model = Turntable(Train());
  model.joints[0].lower = model.joints[0].upper = 0;
  Add(model);
  Command(ControlMode::kPwm, -0.5);
  scene_.RunFor(0.3);
  EXPECT_NEAR(train().current_a, -2, 0.02);
  Command(ControlMode::kIdle, 0);
  scene_.RunFor(0.3);
  EXPECT_EQ(train().current_a, 0);
}

TEST_F(TrainTest, AtItsNoLoadSpeedNoCurrentFlows) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(1);
  EXPECT_NEAR(train().current_a, 0, 1e-3);
}

TEST_F(TrainTest, TheEnergyOfARunUpIsTwiceThatOfTheMasses) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(1);
  const double moved_j = (kInertia_kg_m2 + kRotor_kg_m2) * kNoLoad_rad_s * kNoLoad_rad_s / 2;
  EXPECT_NEAR(train().energy_j, 2 * moved_j, 0.01 * moved_j);
}

TEST_F(TrainTest, ABrakeDrawsNothing) {
  Add(Turntable(Train()));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(0.5);
  const double before = train().energy_j;
  Command(ControlMode::kPwm, 0);
  scene_.RunFor(0.5);
  EXPECT_EQ(train().energy_j, before);
}

TEST_F(TrainTest, TheGearTakesItsPartOfTheTorque) {
  DriveTrainModel train = Train();
  train.efficiency = 0.5;
  RobotModel model = Turntable(train);
  Add(model);
  Command(ControlMode::kPwm, 1);
  // Driving: J w' + I w' / efficiency = m.
  const double inertia = kRotor_kg_m2 + kInertia_kg_m2 / 0.5, rise_s = inertia * kNoLoad_rad_s / kStall_nm;
  for (int i = 1; i <= 100; ++i) {
    scene_.Run(1);
    ASSERT_NEAR(joint().velocity, kNoLoad_rad_s * (1 - std::exp(-i * 1e-3 / rise_s)), 0.01 * kNoLoad_rad_s);
  }
}

TEST_F(TrainTest, ABackDrivenGearPassesOnItsPart) {
  DriveTrainModel train = Train();
  train.efficiency = 0.5;
  Add(Turntable(train));
  Command(ControlMode::kPwm, 1);
  scene_.RunFor(1);
  const double before = joint().velocity;
  Command(ControlMode::kPwm, 0);
  // The disc drives: J w' + I w' · efficiency = −s w.
  const double inertia = kRotor_kg_m2 + kInertia_kg_m2 * 0.5, fall_s = inertia * kNoLoad_rad_s / kStall_nm;
  for (int i = 1; i < 60; ++i) {
    scene_.Run(1);
    ASSERT_NEAR(joint().velocity, before * std::exp(-i * 1e-3 / fall_s), 0.02 * before);
  }
}

TEST_F(TrainTest, ALossyGearHoldsWhatTheMotorAloneWouldNot) {
  DriveTrainModel train = Train();
  train.efficiency = 0.5;
  Add(Turntable(train, 0.05));       // 0.49 N m
  Command(ControlMode::kPwm, 0.15);  // 0.3 N m at the joint: holds 0.15 to 0.6
  scene_.RunFor(1);
  EXPECT_NEAR(joint().position, 0, 1e-3);
  EXPECT_NEAR(joint().velocity, 0, 1e-6);
}

TEST_F(TrainTest, AServoOnTheRotorReachesItsPosition) {
  for (const int step_ms : {1, 5, 10}) {
    scene_ = PhysicsScene();
    Add(Turntable(Train()), step_ms);
    Command(ControlMode::kPosition, 1);
    scene_.RunFor(2);
    EXPECT_NEAR(joint().position, 1, 1e-3) << step_ms;
  }
}

TEST_F(TrainTest, AServoHasNoMoreThanItsMotor) {
  Add(Turntable(Train()));
  Command(ControlMode::kVelocity, 4.9);
  double before = 0;
  const double inertia = kInertia_kg_m2 + kRotor_kg_m2;
  for (int i = 0; i < 300; ++i) {
    scene_.Run(1);
    const double now = joint().velocity, most = kStall_nm * (1 - before / kNoLoad_rad_s);
    ASSERT_LE((now - before) / 1e-3 * inertia, most * 1.05 + 1e-3);
    before = now;
  }
  EXPECT_NEAR(before, 4.9, 0.01);
}

TEST_F(TrainTest, AnEffortTurnsRotorAndJoint) {
  Add(Turntable(Train()));
  Command(ControlMode::kEffort, 0.2);
  scene_.RunFor(0.1);
  EXPECT_NEAR(joint().velocity, 0.2 * 0.1 / (kInertia_kg_m2 + kRotor_kg_m2), 0.01);
}

TEST_F(TrainTest, NothingJumpsWithStiffCouplingsAndLongSteps) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 1e5;
  train.damping_nms_rad = 10;
  train.backlash_rad = 0.02;
  train.preload_nm = 0.1;
  train.efficiency = 0.7;
  train.static_friction_nm = 0.1;
  train.dynamic_friction_nm = 0.05;
  Add(Turntable(train, 0.05), 10);
  for (int i = 0; i < 300; ++i) {
    Command(ControlMode::kPwm, std::sin(i * 0.1));
    scene_.Run(1);
    ASSERT_LE(std::abs(joint().velocity), 2 * kNoLoad_rad_s) << i;
    ASSERT_LE(std::abs(twist()), 0.012) << i;
  }
}

TEST_F(TrainTest, ARestoredFrameGoesOnWithTheSameBits) {
  DriveTrainModel train = Train();
  train.stiffness_nm_rad = 3;
  train.damping_nms_rad = 0.01;
  train.backlash_rad = 0.05;
  Add(Turntable(train, 0.05));
  Command(ControlMode::kPwm, 0.8);
  scene_.RunFor(0.2);
  const std::shared_ptr<Frame> saved = scene_.Capture();
  scene_.RunFor(0.3);
  const std::uint64_t hash = StateHash(*scene_.Capture());
  scene_.Restore(*saved);
  scene_.RunFor(0.3);
  EXPECT_EQ(StateHash(*scene_.Capture()), hash);
}

TEST_F(TrainTest, TheRotorIsPartOfTheHash) {
  Add(Turntable(Train()));
  const std::shared_ptr<Frame> frame = scene_.Capture();
  const std::uint64_t hash = StateHash(*frame);
  frame->drive_trains[0].rotor_rad_s = 1e-9;
  EXPECT_NE(StateHash(*frame), hash);
}

}  // namespace
}  // namespace coopdyn::trains
