// SPDX-License-Identifier: MIT
// A world without physics for tests of modules: hand-made frames on the real boards. Each step turns the
// wheels at their set-points and moves the robots 1 cm along x.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "server/state/command_board.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/scene.h"
#include "tests/server/model/sensor_of.h"

namespace coopdyn {

/// Radius 0.1 m, track 0.4 m, at most 10 rad/s; three sensors of 4 m; all four modules.
inline std::shared_ptr<const RobotModel> SmallModel(const std::string& type = "small") {
  auto model = std::make_shared<RobotModel>();
  model->type = type;
  LinkModel chassis;
  chassis.name = "chassis";
  chassis.mass_kg = 1;
  chassis.X_LI.p = Vector3(0.05, 0, 0.1);
  chassis.inertia_kg_m2 = Vector3(1, 1, 1);
  chassis.collisions.push_back(
      {Cylinder{0.15, 0.2}, {Vector3(0, 0, 0.1), Quaternion::Identity()}, {}, 1, false});
  model->links = {chassis};
  model->joints.resize(2);
  model->actuators = {
      {"motors", {0, 1}, DriveModel{.wheel_radius_m = 0.1, .track_m = 0.4, .max_wheel_speed_rad_s = 10}}};
  for (const double bearing_rad : {-1.0, 0.0, 1.0}) {
    SectorModel sensor;
    sensor.bearing_rad = bearing_rad;
    const Quaternion q = FromRollPitchYaw(0, 0, bearing_rad);
    sensor.X_RS = {q * Vector3(0.15, 0, 0) + Vector3(0, 0, 0.1), q};
    sensor.opening_rad = 0.2;
    sensor.rays = 1;
    sensor.max_range_m = 4;
    SensorOf<DistanceModel>(*model).sectors.push_back(sensor);
  }
  SensorOf<TargetModel>(*model);
  SensorOf<PoseModel>(*model);
  model->footprint_radius_m = 0.15;
  model->height_m = 0.2;
  return model;
}

/// Robots called robot1 … at y = 0, 10, …; targets red at (3, 0), green at (0, 4), red at (9, 0).
inline std::shared_ptr<const Scenario> SmallScenario(int robots) {
  auto scenario = std::make_shared<Scenario>();
  scenario->name = "small";
  const auto model = SmallModel();
  for (int i = 0; i < robots; ++i) {
    RobotEntry entry;
    entry.name = "robot" + std::to_string(i + 1);
    entry.model = model;
    entry.X_WR.p = Vector3(0, 10.0 * i, 0);
    scenario->robots.push_back(entry);
  }
  const auto add = [&](const std::string& color, double x, double y) {
    Target target;
    target.color_name = color;
    target.p_WT = Vector3(x, y, 0.1);
    scenario->targets.push_back(target);
  };
  add("red", 3, 0);
  add("green", 0, 4);
  add("red", 9, 0);
  return scenario;
}

class SmallWorld {
 public:
  explicit SmallWorld(int robots = 1, Mode mode = Mode::kLockstep) { Load(SmallScenario(robots), mode); }

  void Load(std::shared_ptr<const Scenario> scenario, Mode mode, StepEnd end = StepEnd::kLoad) {
    scene_ = MakeScene(std::move(scenario));
    step_ = 0;
    frames.Publish(MakeFrame({}));
    board.SetMode(mode, 0);
    board.Configure(*scene_, end, frames.Latest(), 0);
  }

  /// Makes commands that complete the ready robots run the step immediately, as the daemon does.
  void StepInline() {
    board.set_all_ready_hook([this] {
      if (board.mode() == Mode::kLockstep) Step();
    });
  }

  /// Runs one step: publishes its frame, then answers the pending requests.
  void Step() {
    Publish();
    Finish();
  }
  void Publish() {
    const std::span<const Setpoint> setpoints = board.Latch(++step_);
    frames.Publish(MakeFrame({setpoints.begin(), setpoints.end()}));
  }
  void Finish() { board.FinishStep(frames.Latest(), 0); }

  std::shared_ptr<Frame> MakeFrame(const std::vector<Setpoint>& setpoints) const {
    auto frame = std::make_shared<Frame>();
    frame->step = step_;
    frame->time = static_cast<Nanoseconds>(step_) * kDefaultStep;
    frame->scene = scene_;
    for (std::size_t i = 0; i < scene_->robots.size(); ++i) {
      BodyState body;
      body.p_WB = scene_->robots[i].entry.X_WR.p + Vector3(0.05 + 0.01 * static_cast<double>(step_), 0, 0.1);
      body.v_WB = Vector3(1, 0, 0);
      frame->bodies.push_back(body);
    }
    frame->channels.resize(scene_->channels.size());
    for (std::size_t i = 0; i < setpoints.size(); ++i) {
      frame->channels[i].setpoint = setpoints[i];
      frame->channels[i].velocity = setpoints[i].reference;
    }
    frame->commanded.resize(scene_->actuators.size());
    return frame;
  }

  CommandBoard board;
  FrameBoard frames;
  Doorbell bell;
  EditQueue edits{bell};

 private:
  std::shared_ptr<const Scene> scene_;
  std::uint64_t step_ = 0;
};

}  // namespace coopdyn
