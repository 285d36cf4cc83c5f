// SPDX-License-Identifier: MIT
#include "tests/server/physics/physics_scene.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace coopdyn {

namespace {

LinkModel Wheel(const char* name, double y_m, const Cylinder& tyre, double mass_kg, const Vector3& inertia) {
  LinkModel link;
  link.name = name;
  link.X_RL = {{0, y_m, tyre.radius_m}, FromRollPitchYaw(-std::numbers::pi / 2, 0, 0)};
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = inertia;
  link.collisions = {{tyre, {}, {}, 1, false}};
  return link;
}

JointModel Hinge(const char* name, int child, double y_m, double z_m, double effort_nm) {
  return {.name = name, .child = child, .p_RJ = {0, y_m, z_m}, .max_effort = effort_nm};
}

Pose Raised(double x_m, double z_m) {
  return {{x_m, 0, z_m}, Quaternion::Identity()};
}

/// A round chassis with two balls under it and a wheel on either side.
struct Dimensions {
  const char* type;
  double mass_kg;  // of the chassis; its centre of mass lies at this height
  double center_z_m;
  Vector3 inertia_kg_m2;
  Cylinder hull;  // with its centre at this height
  double hull_z_m;
  double ball_radius_m;
  double ball_x_m;
  Cylinder tyre;
  double wheel_mass_kg;
  Vector3 wheel_inertia_kg_m2;
  double track_m;
  double max_wheel_speed_rad_s;
  double max_torque_nm;
  double height_m;
};

std::shared_ptr<const RobotModel> MakeRobot(const Dimensions& of) {
  auto model = std::make_shared<RobotModel>();
  model->type = of.type;
  LinkModel chassis;
  chassis.name = "chassis";
  chassis.mass_kg = of.mass_kg;
  chassis.X_LI.p = {0, 0, of.center_z_m};
  chassis.inertia_kg_m2 = of.inertia_kg_m2;
  chassis.collisions = {{of.hull, Raised(0, of.hull_z_m), {}, 0.3, false},
                        {Sphere{of.ball_radius_m}, Raised(of.ball_x_m, of.ball_radius_m), {}, 0, false},
                        {Sphere{of.ball_radius_m}, Raised(-of.ball_x_m, of.ball_radius_m), {}, 0, false}};
  const double wheel_radius_m = of.tyre.radius_m, left_m = of.track_m / 2;
  model->links = {chassis, Wheel("left_wheel", left_m, of.tyre, of.wheel_mass_kg, of.wheel_inertia_kg_m2),
                  Wheel("right_wheel", -left_m, of.tyre, of.wheel_mass_kg, of.wheel_inertia_kg_m2)};
  model->joints = {Hinge("left", 1, left_m, wheel_radius_m, of.max_torque_nm),
                   Hinge("right", 2, -left_m, wheel_radius_m, of.max_torque_nm)};
  model->actuators = {
      {"motors", {0, 1}, DriveModel{wheel_radius_m, of.track_m, of.max_wheel_speed_rad_s, of.max_torque_nm}}};
  model->footprint_radius_m = of.hull.radius_m;
  model->height_m = of.height_m;
  return model;
}

}  // namespace

LinkModel Block(const char* name, const Vector3& p_RL, const Vector3& size_m, double mass_kg) {
  LinkModel link;
  link.name = name;
  link.X_RL.p = p_RL;
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = SolidInertia(Box{size_m}, mass_kg);
  link.collisions = {{Box{size_m}, {}, {}, 1, false}};
  return link;
}

std::shared_ptr<const RobotModel> TestRobot() {
  return MakeRobot({.type = "testbot",
                    .mass_kg = 9,
                    .center_z_m = 0.09,
                    .inertia_kg_m2 = {0.0684, 0.0684, 0.1152},
                    .hull = {0.18, 0.21},
                    .hull_z_m = 0.155,
                    .ball_radius_m = 0.025,
                    .ball_x_m = 0.14,
                    .tyre = {0.075, 0.025},
                    .wheel_mass_kg = 0.5,
                    .wheel_inertia_kg_m2 = {0.000729167, 0.000729167, 0.00140625},
                    .track_m = 0.28,
                    .max_wheel_speed_rad_s = 14,
                    .max_torque_nm = 1,
                    .height_m = 0.26});
}

std::shared_ptr<const RobotModel> SmallRobot() {
  return MakeRobot({.type = "smallbot",
                    .mass_kg = 1.5,
                    .center_z_m = 0.045,
                    .inertia_kg_m2 = {0.00291, 0.00291, 0.00422},
                    .hull = {0.085, 0.1},
                    .hull_z_m = 0.07,
                    .ball_radius_m = 0.012,
                    .ball_x_m = 0.065,
                    .tyre = {0.03, 0.015},
                    .wheel_mass_kg = 0.05,
                    .wheel_inertia_kg_m2 = {1.21875e-5, 1.21875e-5, 2.25e-5},
                    .track_m = 0.14,
                    .max_wheel_speed_rad_s = 17,
                    .max_torque_nm = 0.08,
                    .height_m = 0.12});
}

double TiltOf(const Pose& pose) {
  return std::acos(std::min(1.0, (pose.q * Vector3::UnitZ()).z()));
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
  entry.fidelity = fidelity;
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

PhysicsScene& PhysicsScene::Add(WorldObject object) {
  object.name = "THING_" + std::to_string(1 + scenario_.objects.size());
  scenario_.objects.push_back(std::move(object));
  return *this;
}

PhysicsScene& PhysicsScene::SetFloorFriction(double friction) {
  scenario_.floor.friction = friction;
  return *this;
}

PhysicsScene& PhysicsScene::SetGravity(const Vector3& g_W) {
  scenario_.simulation.g_W = g_W;
  return *this;
}

PhysicsScene& PhysicsScene::AllowOverlaps() {
  scenario_.simulation.overlaps = true;
  return *this;
}

void PhysicsScene::Build() {
  scene_ = MakeScene(std::make_shared<const Scenario>(scenario_));
  world_ = PhysicsWorld::Build(scene_, 1, diagnostics_, pool);
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
  const DriveModel& drive = *scenario_.robots.at(static_cast<std::size_t>(robot)).model->drive();
  const double turn = angular_rad_s * drive.track_m / 2;
  SetWheels(robot, (linear_m_s - turn) / drive.wheel_radius_m, (linear_m_s + turn) / drive.wheel_radius_m);
}

void PhysicsScene::Run(int steps) {
  for (int i = 0; i < steps; ++i) {
    world().Step(step_length, substeps > 0 ? substeps : DefaultSubsteps(step_length),
                 setpoints.empty() ? ByChannel(setpoints_) : setpoints);
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
