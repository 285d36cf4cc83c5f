// SPDX-License-Identifier: MIT
// Small worlds for tests of frame readers: a scenario written in C++, and its start frame.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/state/frame.h"
#include "tests/server/model/sensor_of.h"

namespace coopdyn {

inline constexpr double kSampleRadius_m = 0.2;   // of the sample robot's chassis
inline constexpr double kSampleHeight_m = 0.3;   // of its top above the floor
inline constexpr double kSampleSensor_m = 0.15;  // height of its distance sensors
inline constexpr double kSampleRange_m = 4;

/// A cylinder on two wheels with `sensors` single-ray distance sensors from −90° to 90°.
inline std::shared_ptr<RobotModel> SampleRobot(int sensors = 3) {
  auto model = std::make_shared<RobotModel>();
  model->type = "sample";
  LinkModel chassis;
  chassis.name = "chassis";
  chassis.X_RL.p = {0, 0, 0.05};
  chassis.X_LI.p = {0, 0, 0.05};
  chassis.mass_kg = 10;
  const LinkShape body{Cylinder{kSampleRadius_m, 0.25}, {{0, 0, 0.125}, Quaternion::Identity()}, {}, 1, true};
  chassis.collisions = {body};
  chassis.visuals = {body};
  model->links.push_back(chassis);
  for (const double side : {1.0, -1.0}) {
    LinkModel wheel;
    wheel.name = side > 0 ? "left_wheel" : "right_wheel";
    wheel.X_RL.p = {0, side * 0.17, 0.06};
    wheel.mass_kg = 0.5;
    const Quaternion lying = FromRollPitchYaw(std::numbers::pi / 2, 0, 0);
    wheel.collisions = {{Sphere{0.06}, {}, {}, 1, false}};
    wheel.visuals = {{Cylinder{0.06, 0.03}, {Vector3::Zero(), lying}, {0.1, 0.1, 0.1}, 1, false}};
    model->links.push_back(wheel);
  }
  for (int i = 0; i < sensors; ++i) {
    SectorModel sensor;
    sensor.bearing_rad = sensors > 1 ? std::numbers::pi * (static_cast<double>(i) / (sensors - 1) - 0.5) : 0;
    sensor.X_RS.q = FromRollPitchYaw(0, 0, sensor.bearing_rad);
    sensor.X_RS.p = sensor.X_RS.q * Vector3(kSampleRadius_m, 0, 0) + Vector3(0, 0, kSampleSensor_m);
    sensor.max_range_m = kSampleRange_m;
    SensorOf<DistanceModel>(*model).sectors.push_back(sensor);
  }
  SensorOf<TargetModel>(*model);
  model->footprint_radius_m = 0.23;
  model->height_m = kSampleHeight_m;
  return model;
}

/// A pose on the floor.
inline Pose At(double x_m, double y_m, double heading_rad = 0) {
  return {{x_m, y_m, 0}, FromRollPitchYaw(0, 0, heading_rad)};
}

/// Collects a scenario and makes its first frame.
class SampleWorld {
 public:
  SampleWorld& Robot(const Pose& X_WR, std::shared_ptr<const RobotModel> model = SampleRobot(),
                     Color color = {0.2, 0.4, 0.9}) {
    RobotEntry entry;
    entry.name = "robot" + std::to_string(scenario_.robots.size() + 1);
    entry.model = std::move(model);
    entry.X_WR = X_WR;
    entry.color = color;
    scenario_.robots.push_back(std::move(entry));
    return *this;
  }
  SampleWorld& Object(const Shape& shape, const Pose& X_WO, double mass_kg = 0,
                      Color color = {0.8, 0.6, 0.3}) {
    WorldObject object;
    object.name = "OBJECT_" + std::to_string(scenario_.objects.size() + 1);
    object.shape = shape;
    object.X_WO = X_WO;
    object.mass_kg = mass_kg;
    object.color = color;
    scenario_.objects.push_back(std::move(object));
    return *this;
  }
  SampleWorld& Mark(double x_m, double y_m, double z_m = 0, Color color = {1, 0, 0}) {
    Target target;
    target.color = color;
    target.p_WT = {x_m, y_m, z_m};
    scenario_.targets.push_back(std::move(target));
    return *this;
  }
  SampleWorld& Floor(double length_m, double width_m) {
    scenario_.floor.length_m = length_m;
    scenario_.floor.width_m = width_m;
    return *this;
  }

  std::unique_ptr<Frame> MakeFrame(Fidelity fidelity = Fidelity::kFull) const {
    auto frame = std::make_unique<Frame>();
    auto scenario = std::make_shared<Scenario>(scenario_);
    for (RobotEntry& robot : scenario->robots) robot.fidelity = fidelity;
    frame->scene = MakeScene(std::move(scenario));
    frame->seed = 7;
    frame->step = 100;
    frame->bodies.resize(frame->scene->body_ids.size());
    frame->channels.resize(frame->scene->channels.size());
    const auto place = [&frame](int body, const Pose& X_WB) {
      BodyState& state = frame->bodies[static_cast<std::size_t>(body)];
      state.p_WB = X_WB.p;
      state.q_WB = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
    };
    for (const SceneObject& object : frame->scene->objects) {
      if (object.body >= 0) place(object.body, object.object.X_WO);
    }
    for (const SceneRobot& robot : frame->scene->robots) {
      int body = robot.first_body;
      if (robot.one_body()) {
        place(body, robot.entry.X_WR * robot.X_BR.Inverse());
        continue;
      }
      for (const LinkModel& link : robot.entry.model->links) {
        place(body++, robot.entry.X_WR * link.X_RL * link.X_LI);
      }
    }
    return frame;
  }

 private:
  Scenario scenario_;
};

}  // namespace coopdyn
