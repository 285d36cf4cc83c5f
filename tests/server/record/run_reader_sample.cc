// SPDX-License-Identifier: MIT
#include "tests/server/record/run_reader_sample.h"
#include "tests/server/state/wheels.h"
#include "tests/source_dir.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coopdyn {

const char* const SampleRun::kText = R"([BALL]
type sphere
size 0.2
position 0 3
mass 1
[TARGET]
red 2 0 0.3
[ROBOT_1]
type coopbot
name robot1
position 0 0
fidelity rolling
[ROBOT_2]
type minibot
name robot2
position 1 0
fidelity planar
)";

SearchPath SourcePath() {
  SearchPath path;
  path.folders.emplace_back(SourceDir());
  return path;
}

SampleRun::SampleRun(const std::string& text) {
  static RobotLibrary robots(SourcePath());
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(text, "sample.scenario", robots, false, diagnostics);
  EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
  scene_ = MakeScene(scenario);
}

FramePtr SampleRun::FrameAt(std::uint64_t step) const {
  auto frame = std::make_shared<Frame>();
  const auto k = static_cast<double>(step);
  const double t_s = 0.01 * k;
  frame->step = step;
  frame->time = static_cast<Nanoseconds>(step) * kStep;
  frame->step_length = kStep;
  frame->seed = 7;
  frame->scene = scene_;
  frame->bodies.resize(scene_->body_ids.size());
  for (std::size_t i = 0; i < frame->bodies.size(); ++i) {
    BodyState& body = frame->bodies[i];
    const auto place = static_cast<double>(i);
    body.p_WB = {place + 0.2 * (place + 1) * t_s, place, 0.1};
    body.v_WB = {0.2 * (place + 1), 0, 0};
    body.w_WB = {0, 0, 0.5};
    const Quaternion q(Eigen::AngleAxisd(0.5 * t_s, Vector3::UnitZ()));
    body.q_WB = {q.w(), q.x(), q.y(), q.z()};
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = q.toRotationMatrix();
    std::copy(R.data(), R.data() + 9, body.R_WB.begin());
  }
  frame->channels.resize(scene_->channels.size());
  frame->commanded.resize(scene_->actuators.size());
  const int robots = static_cast<int>(scene_->robots.size());
  for (int robot = 0; robot < robots; ++robot) SetTurned(*frame, robot, {0.1 * k, 0.2 * k}, {10, 20});
  if (robots > 0) {
    const double commanded = 0.01 * static_cast<double>(step - step % 3);
    SetSetpoint(*frame, 0, {commanded, -commanded});
    frame->commanded[0] = step > 0 && step % 3 == 0 ? 1 : 0;
  }
  if (robots > 1 && step > 0 && step % 5 == 0) {
    frame->messages.push_back({1, step, {1, {k}}});
  }
  return frame;
}

SavedState SampleRun::StateAt(std::uint64_t step) const {
  SavedState state;
  state.frame = FrameAt(step);
  return state;
}

std::unique_ptr<RunWriter> SampleRun::Write(const std::string& file, const Options& options) const {
  const SavedState first = StateAt(0);
  RunWriterOptions write;
  write.header =
      HeaderOf(*first.frame, Mode::kLockstep, {options.channels, true, true, true}, options.pose_every);
  write.header.version = "1.2.3";
  write.header.build = "0123456789abcdef";
  write.header.started = "2026-01-02T03:04:05Z";
  write.header.command = "coopdyn serve sample --record lesson1.run";
  write.overwrite = true;
  write.page_size = options.page_size;
  std::string error;
  auto writer = RunWriter::Create(file, write, first, error);
  EXPECT_NE(writer, nullptr) << error;
  for (std::uint64_t step = 1; step <= options.steps; ++step) {
    if (options.lost_from != 0 && step >= options.lost_from && step <= options.lost_to) continue;
    const bool found_again = options.lost_from != 0 && step == options.lost_to + 1;
    if (found_again) writer->AddLost(options.lost_to - options.lost_from + 1);
    writer->AddStep(*FrameAt(step));
    if (found_again || step % options.keyframe_every == 0) writer->AddKeyframe(StateAt(step));
  }
  writer->AddInput({3, edit::SetMode{Mode::kFree}});
  writer->AddInput({9, DeadlineFired{"robot2", LossPolicy::kHold}});
  writer->AddEvent({4, 0.04, "note", "here it turns"});
  writer->AddEvent({5, 0.05, "warning", "robot1 has left the floor"});
  EXPECT_TRUE(writer->Commit()) << writer->error();
  if (!options.close) return writer;
  std::string remark;
  EXPECT_TRUE(writer->Close(remark)) << writer->error();
  EXPECT_EQ(remark, "");
  return nullptr;
}

void SampleRun::Append(RunWriter& writer, std::uint64_t first, std::uint64_t last,
                       std::uint64_t keyframe_every) const {
  for (std::uint64_t step = first; step <= last; ++step) {
    writer.AddStep(*FrameAt(step));
    if (step % keyframe_every == 0) writer.AddKeyframe(StateAt(step));
  }
  EXPECT_TRUE(writer.Commit()) << writer.error();
}

}  // namespace coopdyn
