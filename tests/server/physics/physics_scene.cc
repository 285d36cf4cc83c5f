// SPDX-License-Identifier: MIT
#include "tests/server/physics/physics_scene.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace coopdyn {

namespace {

constexpr double kWheelRadius_m = 0.075, kTrack_m = 0.28;

LinkModel Wheel(const char* name, double y_m) {
  const Cylinder tyre{kWheelRadius_m, 0.025};
  LinkModel link;
  link.name = name;
  link.X_RL = {{0, y_m, kWheelRadius_m}, FromRollPitchYaw(-std::numbers::pi / 2, 0, 0)};
  link.mass_kg = 0.5;
  link.inertia_kg_m2 = {0.000729167, 0.000729167, 0.00140625};
  link.collisions = {{tyre, {}, {}, 1, false}};
  return link;
}

JointModel Hinge(const char* name, int child, double y_m) {
  return {name, 0, child, {0, y_m, kWheelRadius_m}, Vector3::UnitY(), 1.0};
}

}  // namespace

std::shared_ptr<const RobotModel> TestRobot() {
  auto model = std::make_shared<RobotModel>();
  model->type = "testbot";
  LinkModel chassis;
  chassis.name = "chassis";
  chassis.mass_kg = 9;
  chassis.X_LI.p = {0, 0, 0.09};
  chassis.inertia_kg_m2 = {0.0684, 0.0684, 0.1152};
  chassis.collisions = {{Cylinder{0.18, 0.21}, {{0, 0, 0.155}, Quaternion::Identity()}, {}, 0.3, false},
                        {Sphere{0.025}, {{0.14, 0, 0.025}, Quaternion::Identity()}, {}, 0, false},
                        {Sphere{0.025}, {{-0.14, 0, 0.025}, Quaternion::Identity()}, {}, 0, false}};
  model->links = {chassis, Wheel("left_wheel", kTrack_m / 2), Wheel("right_wheel", -kTrack_m / 2)};
  model->joints = {Hinge("left", 1, kTrack_m / 2), Hinge("right", 2, -kTrack_m / 2)};
  model->drive = {0, 1, kWheelRadius_m, kTrack_m, 14, 1};
  model->footprint_radius_m = 0.18;
  model->height_m = 0.26;
  return model;
}

PhysicsScene& PhysicsScene::AddRobot(double x_m, double y_m, double heading_rad) {
  return AddRobot({{x_m, y_m, 0}, FromRollPitchYaw(0, 0, heading_rad)});
}

PhysicsScene& PhysicsScene::AddRobot(const Pose& X_WR) {
  RobotEntry entry;
  entry.name = "robot" + std::to_string(scenario_.robots.size() + 1);
  if (!robot_model) robot_model = TestRobot();
  entry.model = robot_model;
  entry.X_WR = X_WR;
  entry.where = {"test.scenario", 100 + static_cast<int>(scenario_.robots.size())};
  scenario_.robots.push_back(std::move(entry));
  return *this;
}

PhysicsScene& PhysicsScene::Add(const Shape& shape, const Pose& X_WO, double mass_kg, double friction) {
  const int line = 1 + static_cast<int>(scenario_.objects.size());
  scenario_.objects.push_back(
      {"THING_" + std::to_string(line), shape, X_WO, mass_kg, {}, friction, {"test.world", line}});
  return *this;
}

PhysicsScene& PhysicsScene::SetFloorFriction(double friction) {
  scenario_.floor.friction = friction;
  return *this;
}

void PhysicsScene::Build() {
  scene_ = MakeScene(std::make_shared<const Scenario>(scenario_), 1);
  world_ = PhysicsWorld::Build(scene_, 1, diagnostics_);
  setpoints_.resize(scene_->robots.size());
}

PhysicsWorld& PhysicsScene::world() {
  if (!scene_) Build();
  if (!world_) throw std::runtime_error(diagnostics_.ToString());
  return *world_;
}

void PhysicsScene::SetWheels(int robot, double left_rad_s, double right_rad_s) {
  world();
  setpoints_.at(static_cast<std::size_t>(robot)) = {left_rad_s, right_rad_s};
}

void PhysicsScene::SetVelocity(int robot, double linear_m_s, double angular_rad_s) {
  const double turn = angular_rad_s * kTrack_m / 2;
  SetWheels(robot, (linear_m_s - turn) / kWheelRadius_m, (linear_m_s + turn) / kWheelRadius_m);
}

void PhysicsScene::Run(int steps) {
  for (int i = 0; i < steps; ++i) {
    world().Step(step_length, substeps > 0 ? substeps : DefaultSubsteps(step_length), setpoints_);
    ++step_;
    time_ += step_length;
  }
  frame_.reset();
}

void PhysicsScene::RunFor(double duration_s) {
  Run(static_cast<int>(std::lround(duration_s * 1e9 / static_cast<double>(step_length))));
}

std::shared_ptr<Frame> PhysicsScene::Capture() {
  if (!frame_) {
    world();
    frame_ = std::make_shared<Frame>();
    frame_->step = step_;
    frame_->time = time_;
    frame_->scene = scene_;
    world().Fill(*frame_);
  }
  return frame_;
}

void PhysicsScene::Restore(const Frame& frame) {
  world().Restore(frame);
  step_ = frame.step;
  time_ = frame.time;
  frame_.reset();
}

Pose PhysicsScene::robot(int index) {
  return RobotPose(*Capture(), index);
}

Pose PhysicsScene::object(int index) {
  return ObjectPose(*Capture(), scene_->objects.at(static_cast<std::size_t>(index)));
}

const BodyState& PhysicsScene::object_body(int index) {
  const int body = scene_->objects.at(static_cast<std::size_t>(index)).body;
  return Capture()->bodies.at(static_cast<std::size_t>(body));
}

}  // namespace coopdyn
