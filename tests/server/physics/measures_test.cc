// SPDX-License-Identifier: MIT
// Measurements of physics for sensors, against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::measures {
namespace {

using testing::SizeIs;

/// A free box of 0.2 m, 3 kg, that feels all its sides.
std::shared_ptr<RobotModel> Crate() {
  auto model = std::make_shared<RobotModel>();
  model->type = "crate";
  model->links = {Block("crate", {0, 0, 0.1}, {0.2, 0.2, 0.2}, 3)};
  model->footprint_radius_m = 0.2;
  model->height_m = 0.2;
  ContactModel contact;
  contact.parts = {{0, 0}};
  model->AddSensor("contact", contact);
  return model;
}

/// A base fixed to the world and a beam of `length_m` and 2 kg on a hinge about y, 1 m high.
std::shared_ptr<RobotModel> Arm(double length_m) {
  auto model = std::make_shared<RobotModel>();
  model->type = "arm";
  model->fixed_base = true;
  model->links = {Block("base", {0, 0, 0.05}, {0.1, 0.1, 0.1}, 5),
                  Block("beam", {length_m / 2, 0, 1}, {length_m, 0.02, 0.02}, 2)};
  JointModel joint;
  joint.name = "shoulder";
  joint.child = 1;
  joint.p_RJ = {0, 0, 1};
  model->joints = {joint};
  model->footprint_radius_m = length_m;
  model->height_m = 1;
  WrenchModel wrench;
  wrench.joint = "shoulder";
  wrench.mount = {1, {{-length_m / 2, 0, 0}, Quaternion::Identity()}};
  const LinkModel& beam = model->links[1];
  wrench.part = {1, beam.mass_kg, beam.X_LI, beam.inertia_kg_m2, {0}};
  model->AddSensor("wrench", wrench);
  return model;
}

Vector3 First(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

Vector3 ForceOn(PhysicsScene& scene, int robot) {
  Vector3 force = Vector3::Zero();
  for (const Contact& contact : scene.Capture()->contacts) {
    if (contact.a.robot == robot) force += contact.force_W;
    if (contact.b.robot == robot) force -= contact.force_W;
  }
  return force;
}

// --- contacts

/// Step lengths that scenarios use.
class MeasuresAtSteps : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Milliseconds, MeasuresAtSteps, testing::Values(1, 5, 10, 40));

TEST_P(MeasuresAtSteps, ContactForcesAddUpToTheWeight) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.robot_model = Crate();
  scene.AddRobot(0, 0);
  scene.RunFor(0.4);  // not asleep yet
  const Vector3 force = ForceOn(scene, 0);
  EXPECT_NEAR(force.z(), 3 * kG, 0.01 * 3 * kG);
  EXPECT_NEAR(force.x(), 0, 0.1);
  for (const Contact& contact : scene.Capture()->contacts) {
    EXPECT_NEAR(contact.p_W.z(), 0, 1e-3);
    EXPECT_GT(contact.normal_W.z(), 0.99);
    EXPECT_EQ(contact.b, ContactEnd());  // the floor
  }
}

TEST_P(MeasuresAtSteps, WhatSleepsWeighsAsMuch) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.robot_model = Crate();
  scene.AddRobot(0, 0);
  scene.Add(Box{{0.1, 0.1, 0.1}}, At(0, 0, 0.25), 1.5);
  scene.RunFor(3);
  Vector3 on_top = Vector3::Zero();
  for (const Contact& contact : scene.Capture()->contacts) {
    if (contact.b.object == 0) on_top += contact.force_W;
    if (contact.a.object == 0) on_top -= contact.force_W;
  }
  EXPECT_NEAR(on_top.z(), -1.5 * kG, 0.01 * 1.5 * kG);
  EXPECT_NEAR(ForceOn(scene, 0).z(), 3 * kG, 0.01 * 3 * kG);
}

TEST(MeasuresTest, AContactIsGoneWhenTheThingHasLeft) {
  PhysicsScene scene;
  scene.robot_model = Crate();
  scene.AddRobot(0, 0);
  scene.RunFor(2);
  auto frame = scene.Capture();
  ASSERT_FALSE(frame->contacts.empty());
  frame->bodies[0].p_WB.z() += 1;
  frame->bodies[0].sleep_counter = 0;
  scene.Restore(*frame);
  scene.Run(2);
  EXPECT_THAT(scene.Capture()->contacts, SizeIs(0));
}

TEST(MeasuresTest, RobotsWithoutSuchSensorsHaveNoContacts) {
  PhysicsScene scene;
  scene.AddRobot(0, 0);
  scene.Add(Box{{0.1, 0.1, 0.1}}, At(0.23, 0, 0.05), 1);
  scene.Run(20);
  EXPECT_TRUE(scene.Capture()->contacts.empty());
  EXPECT_TRUE(scene.Capture()->measured.empty());
}

TEST(MeasuresTest, TwoRobotsPushEachOtherAlike) {
  PhysicsScene scene;
  scene.robot_model = Crate();
  scene.AddRobot(0, 0);
  scene.AddRobot(At(0, 0, 0.2));  // on top
  scene.RunFor(0.4);
  EXPECT_NEAR(ForceOn(scene, 0).z(), 3 * kG, 0.3);
  EXPECT_NEAR(ForceOn(scene, 1).z(), 3 * kG, 0.3);
}

// --- acceleration

ImuModel ImuAt(int link, const Vector3& p_LS) {
  ImuModel imu;
  imu.mount = {link, {p_LS, Quaternion::Identity()}};
  return imu;
}

TEST(MeasuresTest, AtRestNothingIsAccelerated) {
  PhysicsScene scene;
  auto model = Crate();
  model->sensors.clear();
  model->AddSensor("imu", ImuAt(0, {0.05, 0, 0}));
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.RunFor(0.4);
  EXPECT_LT(First(MeasuredBy(scene)).norm(), 0.01 * kG);
}

TEST_P(MeasuresAtSteps, WhatFallsIsAcceleratedByGravity) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  auto model = Crate();
  model->sensors.clear();
  model->AddSensor("imu", ImuAt(0, {0.05, 0, 0}));
  scene.robot_model = model;
  scene.AddRobot(At(0, 0, 3));
  scene.Run(5);
  EXPECT_NEAR((First(MeasuredBy(scene)) - Vector3(0, 0, -kG)).norm(), 0, 1e-6);
}

/// A plate on a vertical axis, driven by a motor.
std::shared_ptr<RobotModel> Turntable() {
  auto model = std::make_shared<RobotModel>();
  model->type = "turntable";
  model->fixed_base = true;
  model->links = {Block("base", {0, 0, 0.05}, {0.1, 0.1, 0.1}, 5),
                  Block("plate", {0, 0, 0.2}, {0.5, 0.5, 0.02}, 2)};
  JointModel joint;
  joint.name = "axis";
  joint.child = 1;
  joint.axis_R = Vector3::UnitZ();
  joint.max_velocity = 10;
  joint.max_effort = 100;
  model->joints = {joint};
  model->actuators = {{"table", {0}, BoardModel{}}};
  model->footprint_radius_m = 0.4;
  model->height_m = 0.3;
  return model;
}

TEST_P(MeasuresAtSteps, OnATurntableTheAccelerationPointsInwards) {
  constexpr double kTurn_rad_s = 5, kRadius_m = 0.2;
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  auto model = Turntable();
  model->AddSensor("imu", ImuAt(1, {kRadius_m, 0, 0}));
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.setpoints = {{kTurn_rad_s, ControlMode::kVelocity}};
  scene.RunFor(1);
  const double expected = kTurn_rad_s * kTurn_rad_s * kRadius_m;
  const Vector3 a_S = First(MeasuredBy(scene));
  EXPECT_NEAR(a_S.x(), -expected, 0.01 * expected);
  EXPECT_NEAR(a_S.y(), 0, 0.01 * expected);
  EXPECT_NEAR(a_S.z(), 0, 0.01);
}

// --- wrenches

TEST_P(MeasuresAtSteps, AHangingBeamsWrenchIsItsWeight) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  auto model = Arm(0.6);
  // The beam hangs: its far end is below.
  model->links[1].X_RL = {{0, 0, 0.7}, FromRollPitchYaw(0, std::numbers::pi / 2, 0)};
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.RunFor(0.2);
  const std::vector<double> wrench = MeasuredBy(scene);
  EXPECT_NEAR(First(wrench).x(), -2 * kG, 0.01 * 2 * kG);  // the sensor's x points down
  EXPECT_NEAR(wrench[1], 0, 0.05);
  EXPECT_NEAR(wrench[2], 0, 0.05);
}

TEST(MeasuresTest, AHeldBeamsTorqueIsItsWeightTimesItsArm) {
  constexpr double kLength_m = 0.6;
  PhysicsScene scene;
  auto model = Arm(kLength_m);
  model->joints[0].max_velocity = 1;
  model->joints[0].max_effort = 100;
  model->actuators = {{"arm", {0}, BoardModel{}}};
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.setpoints = {{0, ControlMode::kVelocity}};
  scene.RunFor(1);
  const std::vector<double> wrench = MeasuredBy(scene);
  EXPECT_NEAR(wrench[2], 2 * kG, 0.01 * 2 * kG);
  EXPECT_NEAR(wrench[4], -2 * kG * kLength_m / 2, 0.01 * kG * kLength_m);
}

TEST(MeasuresTest, TheOtherDirectionHasTheOtherSign) {
  PhysicsScene scene;
  auto model = Arm(0.6);
  WrenchModel other = *model->Find<WrenchModel>();
  other.on_parent = true;
  model->AddSensor("other", other);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.Run(7);
  const std::vector<double> wrench = MeasuredBy(scene, 0, 0), opposite = MeasuredBy(scene, 0, 1);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(opposite[i], -wrench[i]);
}

TEST(MeasuresTest, ASwingingBeamPullsMoreThanItsWeight) {
  // Released from the horizontal. At the bottom a rod has ω² = 3 g / l, and pulls with m g + m ω² l / 2 = 5/2
  // m g.
  constexpr double kLength_m = 0.6;
  PhysicsScene scene;
  scene.step_length = 1'000'000;
  scene.robot_model = Arm(kLength_m);
  scene.AddRobot(0, 0);
  double most_n = 0;
  for (int i = 0; i < 700; ++i) {
    scene.Run(1);
    most_n = std::max(most_n, First(MeasuredBy(scene)).norm());
  }
  EXPECT_NEAR(most_n, 2.5 * 2 * kG, 0.01 * 2.5 * 2 * kG);
}

TEST(MeasuresTest, AWeldedPartWeighsByItself) {
  PhysicsScene scene;
  auto model = Crate();
  model->sensors.clear();
  WrenchModel wrench;  // half of the crate, 1 kg, hangs on a fixed joint at its side
  wrench.mount = {0, {{0.05, 0, 0}, Quaternion::Identity()}};
  wrench.part = {0, 1, {{0.1, 0, 0}, Quaternion::Identity()}, Vector3::Constant(1e-3), {}};
  model->AddSensor("wrench", wrench);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.RunFor(0.4);
  const std::vector<double> values = MeasuredBy(scene);
  EXPECT_NEAR(values[2], kG, 0.01 * kG);
  EXPECT_NEAR(values[4], -0.05 * kG, 0.01 * kG);
}

TEST(MeasuresTest, ALoadThatIsPutOnIsWeighed) {
  // A scale: a plate of 2 kg, a load of 3 kg.
  PhysicsScene scene;
  auto model = Turntable();
  WrenchModel wrench;
  wrench.mount = {1, {}};
  const LinkModel& plate = model->links[1];
  wrench.part = {1, plate.mass_kg, plate.X_LI, plate.inertia_kg_m2, {0}};
  model->AddSensor("wrench", wrench);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.Add(Box{{0.1, 0.1, 0.1}}, At(0.1, 0, 0.265), 3);
  scene.setpoints = {{0, ControlMode::kVelocity}};
  scene.RunFor(0.4);
  const std::vector<double> values = MeasuredBy(scene);
  EXPECT_NEAR(values[2], 5 * kG, 0.01 * 5 * kG);
  EXPECT_NEAR(values[4], -3 * kG * 0.1, 0.01 * 3 * kG);
}

TEST(MeasuresTest, AWrenchCountsItsOwnRobotsContactsOnWhicheverEnd) {
  // Only contacts hold a free crate: with all of them counted, the joint carries nothing.
  PhysicsScene scene;
  auto model = Crate();
  model->sensors.clear();
  const LinkModel& crate = model->links[0];
  WrenchModel wrench;
  wrench.part = {0, crate.mass_kg, crate.X_LI, crate.inertia_kg_m2, {0}};
  model->AddSensor("wrench", wrench);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.AddRobot(At(0, 0, 0.2));  // on top
  scene.AddRobot(1, 0);
  scene.RunFor(0.4);
  for (const int robot : {0, 1, 2}) {
    EXPECT_NEAR(ForceOn(scene, robot).z(), 3 * kG, 0.3);
    EXPECT_LT(First(MeasuredBy(scene, robot)).norm(), 0.01 * 3 * kG);
  }
}

// --- battery

TEST_P(MeasuresAtSteps, ABatteryGivesTheEnergyThatTheMotorPutsIn) {
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  auto model = Turntable();
  model->AddSensor("battery", BatteryModel{.capacity_j = 100, .start = 0.5, .idle_w = 2, .efficiency = 0.5});
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  const auto turn_j = [&] {
    double energy_j = 0;
    const auto frame = scene.Capture();
    for (std::size_t k = 1; k < frame->bodies.size(); ++k) {
      const double w = frame->bodies[k].w_WB.z();
      energy_j += model->links[k].inertia_kg_m2.z() * w * w / 2;
    }
    return energy_j;
  };
  double given_j = 0, time_s = 0;
  for (const double speed : {4.0, 1.0, 0.0}) {
    scene.setpoints = {{speed, ControlMode::kVelocity}};
    double before_j = turn_j();
    for (int i = 0; i < 20; ++i) {
      scene.Run(1);
      time_s += GetParam() * 1e-3;
      const double now_j = turn_j();
      given_j += std::abs(now_j - before_j);
      before_j = now_j;
    }
  }
  EXPECT_GT(given_j, 0.01);
  EXPECT_NEAR(50 - MeasuredBy(scene)[0] - 2 * time_s, given_j / 0.5, 0.01 * given_j / 0.5);
}

TEST(MeasuresTest, AnEmptyBatteryStaysEmpty) {
  PhysicsScene scene;
  auto model = Turntable();
  model->AddSensor("battery", BatteryModel{.capacity_j = 1, .start = 1, .idle_w = 20, .efficiency = 1});
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.RunFor(0.2);
  EXPECT_EQ(MeasuredBy(scene)[0], 0);
  EXPECT_EQ(MeasuredBy(scene)[1], 20);
}

TEST(MeasuresTest, ThreadsDoNotChangeABit) {
  std::vector<double> values;
  std::vector<Vector3> forces;
  for (const int threads : {0, 1, 2, 4}) {
    std::unique_ptr<WorkerPool> pool;
    if (threads > 0) pool = std::make_unique<WorkerPool>(threads);
    PhysicsScene scene;
    scene.pool = pool.get();
    for (int i = 0; i < 12; ++i) {
      auto model = Crate();
      model->AddSensor("imu", ImuAt(0, {0.05, 0, 0}));
      scene.robot_model = model;
      scene.AddRobot(At(i % 4, i / 4, 0.3));
      scene.AddRobot(At(i % 4 + 0.1, i / 4, 0.6));
    }
    scene.RunFor(0.6);
    const auto frame = scene.Capture();
    std::vector<Vector3> these;
    for (const Contact& contact : frame->contacts) these.push_back(contact.force_W);
    EXPECT_FALSE(these.empty());
    if (threads == 0) {
      values = frame->measured;
      forces = these;
    }
    EXPECT_EQ(frame->measured, values) << threads;
    EXPECT_EQ(these, forces) << threads;
  }
}

}  // namespace
}  // namespace coopdyn::measures
