// SPDX-License-Identifier: MIT
// Measurements of physics while things move, stand on feet, lie in piles or continue from a frame, against
// closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"
#include "tests/source_dir.h"

namespace coopdyn::measured_motion {
namespace {

/// Total force and torque through `joint` on its child.
WrenchModel WrenchAt(const RobotModel& model, const JointModel& joint) {
  WrenchModel wrench;
  wrench.joint = joint.name;
  const LinkModel& child = model.links[static_cast<std::size_t>(joint.child)];
  wrench.mount = {joint.child, {joint.p_RJ - child.X_RL.p, Quaternion::Identity()}};
  wrench.part = {joint.child, child.mass_kg, child.X_LI, child.inertia_kg_m2, {}};
  for (std::size_t i = 0; i < child.collisions.size(); ++i) wrench.part.collisions.push_back(i);
  return wrench;
}

JointModel HingeAt(const Vector3& p_RJ) {
  JointModel hinge;
  hinge.p_RJ = p_RJ;
  return hinge;
}

/// A base fixed to the world, 1 m high, and `moving` on a joint there.
std::shared_ptr<RobotModel> OneJoint(LinkModel moving, JointModel joint) {
  auto model = std::make_shared<RobotModel>();
  model->type = "joint";
  model->fixed_base = true;
  model->links = {Block("base", {0, 0, 0.1}, {0.1, 0.1, 0.2}, 5), std::move(moving)};
  joint.name = "joint";
  joint.child = 1;
  model->joints = {joint};
  model->footprint_radius_m = 1;
  model->height_m = 1;
  model->AddSensor("wrench", WrenchAt(*model, model->joints[0]));
  return model;
}

std::span<const double> Read(PhysicsScene& scene, int robot = 0, std::size_t sensor = 0) {
  return MeasuredOf(*scene.Capture(), robot, sensor);
}

Vector3 Three(std::span<const double> values) {
  return {values[0], values[1], values[2]};
}

/// Total contact force on a robot, or on one of its links.
Vector3 ForceOn(PhysicsScene& scene, int robot, int link = -1) {
  Vector3 force = Vector3::Zero();
  for (const Contact& contact : scene.Capture()->contacts) {
    const auto is_meant = [&](const ContactEnd& end) {
      return end.robot == robot && (link < 0 || end.link == link);
    };
    if (is_meant(contact.a)) force += contact.force_W;
    if (is_meant(contact.b)) force -= contact.force_W;
  }
  return force;
}

class MotionAtSteps : public testing::TestWithParam<int> {
 protected:
  MotionAtSteps() { scene_.step_length = GetParam() * 1'000'000; }

  double dt_s() const { return GetParam() * 1e-3; }
  PhysicsScene scene_;
};
INSTANTIATE_TEST_SUITE_P(Milliseconds, MotionAtSteps, testing::Values(1, 5, 10));

// --- wrenches in motion

// A rod released from the horizontal: along it m (g cos θ + ω² l / 2), across it m g sin θ / 4, and no torque
// about its axis. θ and ω are those of the middle of the step. The torque's arms are those of the step's
// start, an error of half a step's turn, at most m l² / 4 · ω³ dt / 2 (5 % of m g l / 2 at 10 ms).
TEST_P(MotionAtSteps, ASwingingRodPullsAsThePendulumsLawSays) {
  constexpr double kLength_m = 0.6, kMass_kg = 2;
  scene_.robot_model =
      OneJoint(Block("rod", {kLength_m / 2, 0, 1}, {kLength_m, 0.001, 0.001}, kMass_kg), HingeAt({0, 0, 1}));
  scene_.AddRobot(0, 0);
  // From the vertical; y turns x downwards.
  const auto angle = [this] {
    const Vector3 along = scene_.Capture()->bodies[1].orientation() * Vector3::UnitX();
    return std::atan2(along.x(), -along.z());
  };
  const auto turn = [this] { return -scene_.Capture()->bodies[1].w_WB.y(); };
  const int steps = static_cast<int>(1.2 / dt_s());  // down, up and back
  const double tolerance = std::max(0.01, 1.5 * dt_s());
  for (int i = 0; i < steps; ++i) {
    const double angle_before = angle(), turn_before = turn();
    scene_.Run(1);
    const double theta = (angle_before + angle()) / 2, w = (turn_before + turn()) / 2;
    const std::span<const double> wrench = Read(scene_);
    const double along_n = kMass_kg * (kG * std::cos(theta) + w * w * kLength_m / 2);
    ASSERT_NEAR(wrench[0], -along_n, tolerance * 2.5 * kMass_kg * kG) << i * dt_s() << " s";
    ASSERT_NEAR(std::abs(wrench[2]), kMass_kg * kG * std::abs(std::sin(theta)) / 4,
                tolerance * 2.5 * kMass_kg * kG);
    ASSERT_NEAR(wrench[1], 0, 1e-6);
    ASSERT_NEAR(wrench[4], 0, 0.01 * kMass_kg * kG * kLength_m / 2) << i * dt_s() << " s";
  }
}

TEST_P(MotionAtSteps, ASliderIsPushedByItsMotorsForce) {
  constexpr double kMass_kg = 4, kForce_n = 6;
  JointModel slider;
  slider.kind = JointModel::Kind::kSlider;
  slider.p_RJ = {0, 0, 1};
  slider.axis_R = Vector3::UnitX();
  slider.max_velocity = 10;
  slider.max_effort = 100;
  auto model = OneJoint(Block("sled", {0, 0, 1}, {0.1, 0.1, 0.1}, kMass_kg), slider);
  model->actuators = {{"sled", {0}, BoardModel{}}};
  scene_.robot_model = model;
  scene_.AddRobot(0, 0);
  scene_.setpoints = {{kForce_n, ControlMode::kEffort}};
  scene_.RunFor(0.3);
  EXPECT_NEAR(scene_.Capture()->channels[0].velocity, kForce_n / kMass_kg * 0.3, 0.05);
  const std::span<const double> wrench = Read(scene_);
  EXPECT_NEAR(wrench[0], kForce_n, 0.01 * kForce_n);
  EXPECT_NEAR(wrench[1], 0, 1e-6);
  EXPECT_NEAR(wrench[2], kMass_kg * kG, 0.01 * kMass_kg * kG);
}

TEST_P(MotionAtSteps, WhatFallsFreelyPassesNoForceThroughItsJoints) {
  auto model = OneJoint(Block("arm", {0, 0, 0.4}, {0.1, 0.1, 0.2}, 1), HingeAt({0, 0, 0.3}));
  model->fixed_base = false;
  scene_.robot_model = model;
  scene_.AddRobot(At(0, 0, 3));
  scene_.Run(5);
  for (const double value : Read(scene_)) EXPECT_NEAR(value, 0, 1e-6);
}

// A crate of 2 kg welded to a foot of 1 kg, on which it stands: the weld carries the crate's 2 kg.
TEST_P(MotionAtSteps, AWeldedFootCarriesWhatStandsOnIt) {
  auto model = std::make_shared<RobotModel>();
  model->type = "welded";
  LinkModel link = Block("crate", {0, 0, 0.2}, {0.2, 0.2, 0.2}, 3);
  link.collisions[0].X_LG.p = {0, 0, 0.05};
  link.collisions.push_back({Box{{0.2, 0.2, 0.1}}, {{0, 0, -0.15}, Quaternion::Identity()}, {}, 1, false});
  model->links = {link};
  model->footprint_radius_m = 0.2;
  model->height_m = 0.4;
  WrenchModel wrench;
  wrench.mount = {0, {{0, 0, -0.1}, Quaternion::Identity()}};
  wrench.part = {0, 1, {{0, 0, -0.15}, Quaternion::Identity()}, {0.004, 0.004, 0.007}, {1}};
  model->AddSensor("wrench", wrench);
  scene_.robot_model = model;
  scene_.AddRobot(0, 0);
  scene_.RunFor(0.4);
  EXPECT_NEAR(Read(scene_)[2], -2 * kG, 0.01 * 2 * kG);  // the crate presses the foot down
  scene_.RunFor(2);                                      // it sleeps
  EXPECT_NEAR(Read(scene_)[2], -2 * kG, 0.01 * 2 * kG);
}

// --- one body for all links

class OneBody : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Fidelities, OneBody, testing::Values(Fidelity::kRolling, Fidelity::kPlanar));

TEST_P(OneBody, OnACircleImuAndWrenchShowWhatTheTurnNeeds) {
  constexpr double kSpeed_m_s = 0.5, kTurn_rad_s = 1, kMass_kg = 0.5;
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  ImuModel imu;
  imu.mount = {0, {{0.1, 0, 0.2}, Quaternion::Identity()}};
  model->AddSensor("imu", imu);
  WrenchModel mast;
  mast.mount = {0, {{0, 0, 0.26}, Quaternion::Identity()}};
  mast.part = {0, kMass_kg, {{0, 0, 0.36}, Quaternion::Identity()}, Vector3::Constant(1e-3), {}};
  model->AddSensor("wrench", mast);
  scene.robot_model = model;
  scene.fidelity = GetParam();
  scene.AddRobot(0, 0);
  scene.SetVelocity(0, kSpeed_m_s, kTurn_rad_s);
  scene.RunFor(3);
  const double inwards = kSpeed_m_s * kTurn_rad_s;  // m/s², to the left
  const Vector3 a_S = Three(Read(scene, 0, 0));
  EXPECT_NEAR(a_S.x(), -kTurn_rad_s * kTurn_rad_s * 0.1, 0.01 * inwards);
  EXPECT_NEAR(a_S.y(), inwards, 0.01 * inwards);
  EXPECT_NEAR(a_S.z(), 0, 1e-9);
  const std::span<const double> wrench = Read(scene, 0, 1);
  EXPECT_NEAR(wrench[0], 0, 0.01 * kMass_kg * inwards);
  EXPECT_NEAR(wrench[1], kMass_kg * inwards, 0.01 * kMass_kg * inwards);
  EXPECT_NEAR(wrench[2], kMass_kg * kG, 1e-9);
  EXPECT_NEAR(wrench[3], -0.1 * kMass_kg * inwards, 0.01 * kMass_kg * inwards);
}

TEST_P(OneBody, ABatteryGivesTheEnergyOfTheMotion) {
  constexpr double kSpeed_m_s = 0.5, kEfficiency = 0.5;
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  model->AddSensor("battery", BatteryModel{.capacity_j = 100, .efficiency = kEfficiency});
  scene.robot_model = model;
  scene.fidelity = GetParam();
  scene.AddRobot(0, 0);
  scene.SetVelocity(0, kSpeed_m_s, 0);
  scene.RunFor(2);
  const double energy_j = 10 * kSpeed_m_s * kSpeed_m_s / 2;  // 10 kg
  EXPECT_NEAR(100 - Read(scene)[0], energy_j / kEfficiency, 0.01 * energy_j);
  EXPECT_NEAR(Read(scene)[1], 0, 1e-6);
}

// --- bodies with many contacts

TEST(MeasuredContacts, ALargeIslandPressesTheFloorByItsWeight) {
  // Sixteen crates side by side: more rows than the exact solver handles.
  constexpr int kCrates = 16;
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>();
  model->type = "crate";
  model->links = {Block("crate", {0, 0, 0.1}, {0.2, 0.2, 0.2}, 3)};
  model->footprint_radius_m = 0.15;
  model->height_m = 0.2;
  ContactModel contact;
  contact.parts = {{0, 0}};
  model->AddSensor("contact", contact);
  scene.robot_model = model;
  for (int i = 0; i < kCrates; ++i) scene.AddRobot(0.2 * i, 0);
  const auto pressed_n = [&scene] {
    double sum = 0;
    for (int i = 0; i < scene.robot_count(); ++i) sum += ForceOn(scene, i).z();
    return sum;
  };
  scene.RunFor(0.4);
  EXPECT_NEAR(pressed_n(), kCrates * 3 * kG, 0.01 * kCrates * 3 * kG);
  scene.RunFor(3);
  EXPECT_NEAR(pressed_n(), kCrates * 3 * kG, 0.01 * kCrates * 3 * kG);
}

TEST(MeasuredContacts, AHumanoidPressesItsFeetByItsWeight) {
  Diagnostics diagnostics;
  PhysicsScene scene;
  const auto shipped = ReadRobotModel(SourceDir() + "/robots/humanoid/model.sdf", SearchPath{}, diagnostics);
  ASSERT_TRUE(shipped) << diagnostics.ToString();
  auto model = std::make_shared<RobotModel>(*shipped);
  ContactModel contact;
  double mass_kg = 0;
  for (std::size_t i = 0; i < model->links.size(); ++i) {
    mass_kg += model->links[i].mass_kg;
    for (std::size_t k = 0; k < model->links[i].collisions.size(); ++k) {
      contact.parts.push_back({static_cast<int>(i), k});
    }
  }
  model->AddSensor("contact", contact);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.Build();
  ASSERT_EQ(scene.diagnostics().ToString(), "");
  scene.setpoints.assign(scene.Capture()->channels.size(), {0, ControlMode::kVelocity});
  scene.RunFor(2);
  EXPECT_LT(TiltOf(scene.robot(0)), 0.05);
  const Vector3 force = ForceOn(scene, 0);
  EXPECT_NEAR(force.z(), mass_kg * kG, 0.01 * mass_kg * kG);
  EXPECT_NEAR(force.head<2>().norm(), 0, 0.01 * mass_kg * kG);
}

TEST(MeasuredContacts, ARobotAtAWallFeelsWhatItsWheelsPush) {
  // The motors give 1 N m at wheels of 7.5 cm: no more than 2 / 0.075 N reach the wall.
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  ContactModel contact;
  contact.parts = {{0, 0}};
  model->AddSensor("contact", contact);
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.Add(Box{{0.1, 1, 1}}, At(0.4, 0, 0.5));
  scene.SetVelocity(0, 0.3, 0);
  scene.RunFor(3);
  double pushed_n = 0;
  for (const Contact& one : scene.Capture()->contacts) {
    if (one.b.object != 0 && one.a.object != 0) continue;
    pushed_n += std::abs(one.force_W.x());
    EXPECT_NEAR(one.p_W.x(), 0.35, 5e-3);
  }
  EXPECT_NEAR(pushed_n, 2 / 0.075, 0.05 * 2 / 0.075);
}

// --- continuing from a frame

TEST(MeasuredRestore, AnotherWorldGoesOnWithTheSameBits) {
  const auto begin = [](PhysicsScene& scene) {
    auto model = std::make_shared<RobotModel>(*TestRobot());
    ContactModel contact;
    contact.parts = {{0, 0}};
    model->AddSensor("imu", ImuModel{});
    model->AddSensor("contact", contact);
    model->AddSensor("battery", BatteryModel{.capacity_j = 100, .idle_w = 1, .efficiency = 0.7});
    model->AddSensor("odometry", OdometryModel{.resolution_rad = 0.01, .slip_stddev = 0.05});
    scene.robot_model = model;
    scene.AddRobot(0, 0);
    scene.Add(Box{{0.1, 1, 1}}, At(0.6, 0, 0.5), 3);
    scene.SetVelocity(0, 0.4, 0.1);
  };
  PhysicsScene one, other;
  begin(one);
  begin(other);
  one.RunFor(1);
  other.Restore(*one.Capture());
  EXPECT_EQ(other.Capture()->measured, one.Capture()->measured);
  for (int i = 0; i < 50; ++i) {
    one.Run(1);
    other.Run(1);
    ASSERT_EQ(other.Capture()->measured, one.Capture()->measured) << i;
    ASSERT_EQ(other.Capture()->contacts.size(), one.Capture()->contacts.size()) << i;
  }
  EXPECT_EQ(StateHash(*other.Capture()), StateHash(*one.Capture()));
}

TEST(MeasuredRestore, AStateWithoutValuesBeginsWithThoseOfTheStart) {
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  model->AddSensor("battery", BatteryModel{.capacity_j = 100, .start = 0.5, .idle_w = 10});
  scene.robot_model = model;
  scene.AddRobot(0, 0);
  scene.RunFor(1);
  EXPECT_NEAR(Read(scene)[0], 40, 1e-9);
  Frame without;  // like a frame of a run recorded before there were sensors
  without.scene = scene.Capture()->scene;
  scene.world().Fill(without);
  without.measured.clear();
  scene.Restore(without);
  EXPECT_EQ(Read(scene)[0], 50);
  scene.RunFor(1);
  EXPECT_NEAR(Read(scene)[0], 40, 1e-9);
}

// --- odometry

TEST(MeasuredOdometry, SlipScattersTheWaysAsItsDeviationSays) {
  // Noise scatters each wheel's way in each step: after n steps of w by s w √n.
  constexpr double kSlip = 0.1;
  constexpr int kRobots = 60, kSteps = 100;
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  model->AddSensor("odometry", OdometryModel{.slip_stddev = kSlip});
  scene.robot_model = model;
  scene.fidelity = Fidelity::kPlanar;
  for (int i = 0; i < kRobots; ++i) scene.AddRobot(0, 2.0 * i);
  const double speed_m_s = 0.4, way_m = speed_m_s * 0.01, track_m = model->drive()->track_m;
  for (int i = 0; i < kRobots; ++i) scene.SetVelocity(i, speed_m_s, 0);
  scene.RunFor(1);  // to full speed; the same noise in each step
  std::vector<double> before;
  for (int i = 0; i < kRobots; ++i) before.push_back(Read(scene, i)[2]);
  const std::vector<Setpoint> setpoints(2 * kRobots, {speed_m_s / 0.075, ControlMode::kVelocity});
  for (std::uint64_t k = 1; k <= kSteps; ++k) scene.world().Step(kDefaultStep, 1, setpoints, {7, k});
  Frame frame;
  frame.scene = scene.Capture()->scene;
  scene.world().Fill(frame);
  double squares = 0;
  for (int i = 0; i < kRobots; ++i) {
    const double turned = MeasuredOf(frame, i, 0)[2] - before[static_cast<std::size_t>(i)];
    squares += turned * turned;
  }
  const double expected_rad = std::numbers::sqrt2 * kSlip * way_m / track_m * std::sqrt(kSteps);
  EXPECT_NEAR(std::sqrt(squares / kRobots), expected_rad, 0.3 * expected_rad);
}

TEST(MeasuredOdometry, ExactWheelsFollowTheArcExactly) {
  PhysicsScene scene;
  auto model = std::make_shared<RobotModel>(*TestRobot());
  model->AddSensor("odometry", OdometryModel{});
  scene.robot_model = model;
  scene.fidelity = Fidelity::kPlanar;
  scene.AddRobot(0, 0);
  scene.SetVelocity(0, 0.5, 0.7);
  scene.RunFor(20);
  const std::span<const double> values = Read(scene);
  EXPECT_NEAR(values[0], scene.robot(0).p.x(), 1e-6);
  EXPECT_NEAR(values[1], scene.robot(0).p.y(), 1e-6);
  EXPECT_NEAR(WrapAngle(values[2] - Heading(scene.robot(0).q)), 0, 1e-6);
}

}  // namespace
}  // namespace coopdyn::measured_motion
