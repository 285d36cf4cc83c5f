// SPDX-License-Identifier: MIT
// A swarm without physics for tests of controllers: robots on a lattice that move exactly as their wheels
// turn.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/controllers/controller_host.h"
#include "server/state/frame.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {

/// A disc with `sensors` distance sensors all round and neighbours.
inline std::shared_ptr<RobotModel> DiscModel(int sensors = 8) {
  auto model = std::make_shared<RobotModel>();
  model->type = "disc";
  LinkModel chassis;
  chassis.mass_kg = 1;
  chassis.collisions = {{Cylinder{0.08, 0.1}, {{0, 0, 0.06}, Quaternion::Identity()}, {}, 1, true}};
  model->links = {chassis};
  for (int i = 0; i < sensors; ++i) {
    SectorModel sensor;
    sensor.bearing_rad = 2 * std::numbers::pi * (i + 0.5) / sensors - std::numbers::pi;
    sensor.opening_rad = 0.7;
    sensor.rays = 5;
    sensor.X_RS.q = FromRollPitchYaw(0, 0, sensor.bearing_rad);
    sensor.X_RS.p = sensor.X_RS.q * Vector3(0.08, 0, 0) + Vector3(0, 0, 0.05);
    sensor.max_range_m = 0.5;
    SensorOf<DistanceModel>(*model).sectors.push_back(sensor);
  }
  model->joints = {{.name = "left"}, {.name = "right"}};
  model->actuators = {
      {"motors", {0, 1}, DriveModel{.wheel_radius_m = 0.03, .track_m = 0.14, .max_wheel_speed_rad_s = 10}}};
  SensorOf<NeighboursModel>(*model) = {.range_m = 1.5, .message_range_m = 1.5};
  SensorOf<TargetModel>(*model);
  SensorOf<CompassModel>(*model);
  model->footprint_radius_m = 0.085;
  model->height_m = 0.11;
  return model;
}

/// Robots, their controllers, and the frame that contains them.
class Swarm {
 public:
  explicit Swarm(std::shared_ptr<const RobotModel> model = DiscModel()) : model_(std::move(model)) {}

  /// Adds a robot, robot1, robot2, ..., driven by the shared object `file`.
  Swarm& Add(const std::string& file, std::vector<std::pair<std::string, double>> options = {}) {
    RobotEntry entry;
    const int index = static_cast<int>(scenario_.robots.size());
    entry.name = "robot" + std::to_string(index + 1);
    entry.model = model_;
    entry.X_WR = {{0.4 * (index % 10), 0.4 * (index / 10), 0}, FromRollPitchYaw(0, 0, 0.9 * index)};
    if (!file.empty()) {
      const std::size_t slash = file.rfind('/');
      entry.controller.name = file.substr(slash + 1, file.size() - slash - 4);
      entry.controller.file = file;
      entry.controller.options = std::move(options);
      entry.controller.where = {"test.scenario", 10 + index};
    }
    scenario_.robots.push_back(std::move(entry));
    return *this;
  }
  /// The run's supervisor.
  Swarm& Supervise(const std::string& file, std::vector<std::pair<std::string, double>> options = {}) {
    ControllerChoice& supervisor = scenario_.simulation.supervisor;
    const std::size_t slash = file.rfind('/');
    supervisor.name = file.substr(slash + 1, file.size() - slash - 4);
    supervisor.file = file;
    supervisor.options = std::move(options);
    supervisor.where = {"test.scenario", 2};
    return *this;
  }
  Swarm& Mark(double x_m, double y_m) {
    Target target;
    target.color = {1, 0, 0};
    target.p_WT = {x_m, y_m, 0};
    scenario_.targets.push_back(target);
    return *this;
  }

  const Scenario& scenario() const { return scenario_; }
  std::size_t size() const { return scenario_.robots.size(); }

  FramePtr Start(std::uint64_t seed = 1) const {
    auto frame = std::make_shared<Frame>();
    frame->scene = MakeScene(std::make_shared<Scenario>(scenario_));
    frame->seed = seed;
    frame->bodies.resize(frame->scene->body_ids.size());
    frame->channels.resize(frame->scene->channels.size());
    frame->commanded.resize(size());
    for (std::size_t i = 0; i < size(); ++i) {
      Put(scenario_.robots[i].X_WR,
          frame->bodies[static_cast<std::size_t>(frame->scene->robots[i].first_body)]);
    }
    return frame;
  }

  /// The frame after `frame` if the wheels turn at `setpoints`.
  FramePtr Next(const FramePtr& frame, const std::vector<WheelSpeeds>& setpoints,
                std::vector<SentMessage> messages) const {
    auto next = std::make_shared<Frame>();
    next->scene = frame->scene;
    next->seed = frame->seed;
    next->step = frame->step + 1;
    next->time = frame->time + frame->step_length;
    next->bodies = frame->bodies;
    next->channels = frame->channels;
    next->commanded = frame->commanded;
    next->messages = std::move(messages);
    const double step_s = ToSeconds(frame->step_length);
    for (std::size_t i = 0; i < next->channels.size(); ++i) {
      next->channels[i].velocity = setpoints[i / 2][i % 2];
      next->channels[i].position += next->channels[i].velocity * step_s;
    }
    for (std::size_t i = 0; i < size(); ++i) {
      const DriveModel& drive = *model_->drive();
      const double left = setpoints[i][0] * drive.wheel_radius_m,
                   right = setpoints[i][1] * drive.wheel_radius_m;
      Pose X_WR = RobotPose(*frame, static_cast<int>(i));
      const double heading = Heading(X_WR.q);
      X_WR.p += (left + right) / 2 * step_s * Vector3(std::cos(heading), std::sin(heading), 0);
      X_WR.q = FromRollPitchYaw(0, 0, heading + (right - left) / drive.track_m * step_s);
      Put(X_WR, next->bodies[static_cast<std::size_t>(frame->scene->robots[i].first_body)]);
    }
    return next;
  }

 private:
  static void Put(const Pose& X_WR, BodyState& body) {
    body.p_WB = X_WR.p;
    body.q_WB = {X_WR.q.w(), X_WR.q.x(), X_WR.q.y(), X_WR.q.z()};
  }

  std::shared_ptr<const RobotModel> model_;
  Scenario scenario_;
};

/// The results of a run.
struct Record {
  std::vector<std::vector<WheelSpeeds>> setpoints;  // by step, then robot
  std::vector<SentMessage> messages;
  std::vector<StoppedController> stopped;
  std::vector<Supervision> supervision;  // by step
};

/// Options for a child that is the tests' own program.
ControllerOptions TestOptions(bool in_process = false, int threads = 1);

/// Clock, pool and host, and the swarm that it drives.
class Driven {
 public:
  explicit Driven(Swarm swarm, ControllerOptions options = TestOptions(), Logger logger = NullLogger())
      : swarm_(std::move(swarm)), pool_(options.threads), host_(options, clock_, std::move(logger), pool_) {}

  ControllerHost& host() { return host_; }
  const FramePtr& frame() const { return frame_; }
  void Start(std::uint64_t seed = 1) {
    frame_ = swarm_.Start(seed);
    host_.Configure(frame_);
    TakeStopped();
  }
  /// One more step; a robot without controller keeps (0.25, 0.5).
  void Step() {
    std::vector<Setpoint> channels =
        ByChannel(std::vector<WheelSpeeds>(frame_->channels.size() / 2, {0.25, 0.5}));
    std::vector<SentMessage> messages;
    host_.Step(frame_, channels, messages);
    std::vector<WheelSpeeds> setpoints = ByRobot(channels);
    frame_ = swarm_.Next(frame_, setpoints, messages);
    run_.setpoints.push_back(std::move(setpoints));
    run_.messages.insert(run_.messages.end(), messages.begin(), messages.end());
    run_.supervision.push_back(host_.TakeSupervision());
    TakeStopped();
  }
  const Record& Steps(int count) {
    for (int i = 0; i < count; ++i) Step();
    return run_;
  }
  const Record& run() const { return run_; }
  /// Discards the run's steps so far; for long runs.
  void Forget() {
    run_.setpoints.clear();
    run_.messages.clear();
    run_.supervision.clear();
  }
  /// Continues at `frame` with the state saved there.
  bool Restore(const FramePtr& frame, std::span<const std::byte> saved) {
    frame_ = frame;
    return host_.Restore(frame, saved);
  }

 private:
  void TakeStopped() {
    for (StoppedController& stopped : host_.TakeStopped()) run_.stopped.push_back(std::move(stopped));
  }

  Swarm swarm_;
  SteadyClock clock_;
  WorkerPool pool_;
  ControllerHost host_;
  FramePtr frame_;
  Record run_;
};

inline ControllerOptions TestOptions(bool in_process, int threads) {
  ControllerOptions options;
  options.in_process = in_process;
  options.threads = threads;
  options.share_from = 0;  // always
  options.program = CONTROLLERS_TEST_CHILD;
  return options;
}

/// A shipped sample, and a shared object of these tests.
inline std::string Sample(const std::string& name) {
  return std::string(SAMPLE_CONTROLLERS) + "/" + name + ".so";
}
inline std::string TestPlugin(const std::string& name) {
  return std::string(TEST_CONTROLLERS) + "/" + name + ".so";
}

/// Five robots, four of them with a controller, under the supervisor of these tests, which does `deed` in
/// step `at`, or in each.
inline Swarm Supervised(int deed, int at = -1) {
  Swarm swarm;
  swarm.Mark(3, 1);
  for (int i = 0; i < 5; ++i) swarm.Add(i == 4 ? "" : Sample(i % 2 == 0 ? "diffuse" : "flock"));
  return swarm.Supervise(TestPlugin("overseer"), {{"deed", deed}, {"at", at}});
}

}  // namespace coopdyn
