// SPDX-License-Identifier: MIT
// Scenes and frames for tests of recordings, without physics: numbers with random bits, from a fixed seed.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/model/readers.h"
#include "server/record/run_writer.h"
#include "server/record/sqlite_db.h"
#include "server/state/frame.h"
#include "tests/server/base/temp_folder.h"
#include "tests/source_dir.h"

namespace coopdyn {

/// A box that moves, one that does not, three robots of all fidelities and two targets.
inline constexpr const char* kRecordScenario = R"([SIMULATION]
mode lockstep
seed 7
[FLOOR]
size 20 20 0.1
[BOX_1]
type box
size 0.5 0.5 0.5
position 3 3
mass 2kg
[WALL_1]
type box
size 4 0.1 0.5
position 0 5
[TARGET]
red 3 1 0.3
blue -3 1 0.3
[ROBOT_1]
type coopbot
name robot1
position 0 0
[ROBOT_2]
type minibot
name robot2
position 1 1
fidelity rolling
[ROBOT_3]
type minibot
name robot3
position -1 1
fidelity planar
sockets off
)";

/// Reads the robot models once for all tests.
inline RobotLibrary& RecordLibrary() {
  static RobotLibrary library([] {
    SearchPath path;
    path.folders.emplace_back(SourceDir());
    return path;
  }());
  return library;
}

inline std::shared_ptr<const Scenario> ReadRecordScenario(const std::string& text = kRecordScenario) {
  Diagnostics diagnostics;
  auto scenario = ReadScenario(text, "test.scenario", RecordLibrary(), false, diagnostics);
  EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
  return scenario;
}

inline std::shared_ptr<const Scene> RecordScene(const std::string& text = kRecordScenario) {
  return MakeScene(ReadRecordScenario(text));
}

/// The same with a first robot that has sensors: an IMU's measurements, contacts, samples at 30 Hz.
inline std::shared_ptr<const Scene> SensingScene() {
  auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
  auto model = std::make_shared<RobotModel>(*scenario->robots[0].model);
  model->AddSensor("imu", ImuModel(), {30, 0.05});
  model->AddSensor("bumper", ContactModel());
  scenario->robots[0].model = model;
  return MakeScene(scenario);
}

/// Random frames of a scene; each call returns another one, each program run the same ones.
class FrameMaker {
 public:
  explicit FrameMaker(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}

  double Uniform(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
  }
  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  void SetScene(std::shared_ptr<const Scene> scene) { scene_ = std::move(scene); }

  BodyState Body() {
    BodyState body;
    for (double& p_m : body.p_WB) p_m = Uniform(-10, 10);
    double square = 0;
    for (double& component : body.q_WB) {
      component = Uniform(-1, 1);
      square += component * component;
    }
    for (double& component : body.q_WB) component /= std::sqrt(square);
    const Matrix3 R = body.orientation().toRotationMatrix();
    for (int i = 0; i < 9; ++i) body.R_WB[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
    for (double& speed : body.v_WB) speed = Uniform(-1, 1);
    for (double& speed : body.w_WB) speed = Uniform(-3, 3);
    body.sleep_counter = random_() % 100;
    return body;
  }

  /// Frame `step` at `step` times 10 ms. Every robot has a new set-point; none is commanded.
  std::shared_ptr<Frame> Make(std::uint64_t step) {
    auto frame = std::make_shared<Frame>();
    frame->epoch = 1;
    frame->step = step;
    frame->time = static_cast<Nanoseconds>(step) * kDefaultStep;
    frame->seed = 7;
    frame->solver_seed = random_();
    frame->scene = scene_;
    for (std::size_t i = 0; i < scene_->body_ids.size(); ++i) frame->bodies.push_back(Body());
    for (std::size_t i = 0; i < scene_->channels.size(); ++i) {
      frame->channels.push_back({Uniform(-100, 100), Uniform(-5, 5), 0, {Uniform(-5, 5)}});
    }
    frame->commanded.resize(scene_->actuators.size());
    return frame;
  }

  SavedStatePtr Start(std::uint64_t step = 0, Mode mode = Mode::kLockstep) {
    auto state = std::make_shared<SavedState>();
    state->frame = Make(step);
    state->mode = mode;
    return state;
  }

 private:
  std::mt19937_64 random_{1};
  std::shared_ptr<const Scene> scene_;
};

/// The state after `frame`, if requested.
inline SavedStatePtr ExactIf(bool wanted, const FramePtr& frame, Mode mode) {
  if (!wanted) return nullptr;
  const auto state = std::make_shared<SavedState>();
  state->frame = frame;
  state->mode = mode;
  return state;
}

/// A writer of `file` that begins with `state`; by default records everything.
inline std::unique_ptr<RunWriter> MakeWriter(const std::string& file, const SavedState& state,
                                             const RecordWhat& what = {true, true, true, true},
                                             Nanoseconds pose_every = 0) {
  RunWriterOptions options;
  options.header = HeaderOf(*state.frame, state.mode, what, pose_every);
  options.header.version = "1.2.3";
  options.header.build = "0123456789abcdef";
  options.header.cpu = "a processor";
  options.header.started = "2026-01-02T03:04:05Z";
  options.header.command = "coopdyn serve test.scenario --record test.run";
  std::string error;
  auto writer = RunWriter::Create(file, std::move(options), state, error);
  EXPECT_NE(writer, nullptr) << error;
  return writer;
}

/// The first column of the first row of `sql` in `file`; −1 if there is no row.
inline std::int64_t Ask(const std::string& file, const std::string& sql) {
  std::string error;
  const auto database = Database::Open(file, Database::Access::kReadOnly, error);
  EXPECT_NE(database, nullptr) << error;
  if (database == nullptr) return -1;
  return database->Integer(sql).value_or(-1);
}

inline std::string AskText(const std::string& file, const std::string& sql) {
  std::string error;
  const auto database = Database::Open(file, Database::Access::kReadOnly, error);
  EXPECT_NE(database, nullptr) << error;
  if (database == nullptr) return {};
  return database->Text(sql).value_or("");
}

/// Bitwise equal, unlike ==, for which 0 equals −0.
template <typename Numbers>
bool SameBits(const Numbers& a, const Numbers& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

inline bool SameBody(const BodyState& a, const BodyState& b) {
  return SameBits(a.p_WB, b.p_WB) && SameBits(a.q_WB, b.q_WB) && SameBits(a.R_WB, b.R_WB) &&
         SameBits(a.v_WB, b.v_WB) && SameBits(a.w_WB, b.w_WB) && a.sleep_counter == b.sleep_counter;
}

}  // namespace coopdyn
