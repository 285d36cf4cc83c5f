// SPDX-License-Identifier: MIT
// The data that a reader returns from a recording, and its seeks.
#include "server/record/run_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {
namespace {

class RunReaderTest : public testing::Test {
 protected:
  /// Writes the sample and opens it, with its scenario.
  void Record(const SampleRun::Options& options = {}) {
    sample_.Write(file_, options);
    Open();
  }
  void Open() {
    std::string error;
    reader_ = RunReader::Open(file_, error);
    ASSERT_NE(reader_, nullptr) << error;
    reader_->UseScenario(sample_.scenario());
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  const SampleRun sample_;
  std::unique_ptr<RunReader> reader_;
};

TEST_F(RunReaderTest, SaysWhatTheRunIs) {
  Record();
  const RunHeader& header = reader_->header();
  EXPECT_EQ(header.version, "1.2.3");
  EXPECT_EQ(header.build, "0123456789abcdef");
  EXPECT_EQ(header.started, "2026-01-02T03:04:05Z");
  EXPECT_EQ(header.scenario_text, SampleRun::kText);
  EXPECT_EQ(header.mode, Mode::kLockstep);
  EXPECT_EQ(header.seed, 7u);
  EXPECT_EQ(header.step_length, SampleRun::kStep);
  EXPECT_EQ(header.what, (RecordWhat{true, true, true, true}));
  EXPECT_FALSE(reader_->mended());
  EXPECT_FALSE(reader_->growing());
}

TEST_F(RunReaderTest, GivesTheExtent) {
  Record();
  const RunExtent extent = reader_->extent();
  EXPECT_EQ(extent.first, 0u);
  EXPECT_EQ(extent.last, 20u);
  EXPECT_EQ(extent.begin, 0);
  EXPECT_EQ(extent.end, 20 * SampleRun::kStep);
  EXPECT_EQ(extent.steps, 20u);
  EXPECT_EQ(extent.lost, 0u);
}

TEST_F(RunReaderTest, CountsLostSteps) {
  Record({.lost_from = 5, .lost_to = 9});
  EXPECT_EQ(reader_->extent().lost, 5u);
  EXPECT_EQ(reader_->extent().steps, 15u);
}

TEST_F(RunReaderTest, ReadsAStepAsItWasRecorded) {
  Record();
  const std::optional<RecordedStep> step = reader_->Read(6);
  ASSERT_TRUE(step) << reader_->error();
  const FramePtr frame = sample_.FrameAt(6);
  EXPECT_EQ(step->time, frame->time);
  EXPECT_EQ(step->hash, StateHash(*frame));
  ASSERT_EQ(step->bodies.size(), frame->bodies.size());
  for (std::size_t i = 0; i < frame->bodies.size(); ++i) {
    EXPECT_LT((step->bodies[i].p_WB - frame->bodies[i].p_WB).norm(), 2e-6);
  }
  ASSERT_EQ(step->channels.size(), 4u);
  EXPECT_NEAR(step->channels[3].position, 1.2, 1e-5);
  EXPECT_EQ(step->channels[2].velocity, 10);
  ASSERT_EQ(step->commands.size(), 2u);
  EXPECT_TRUE(step->commands[0].by_client);
  EXPECT_EQ(step->commands[0].setpoint, Setpoint{0.06});
  EXPECT_EQ(step->commands[1].setpoint, Setpoint{-0.06});
  EXPECT_EQ(step->distances.size(), frame->scene->robots[0].entry.model->sector_count() +
                                        frame->scene->robots[1].entry.model->sector_count());
  EXPECT_EQ(step->targets.size(), 4u);
}

TEST_F(RunReaderTest, ReadsInputsAlone) {
  Record();
  const std::optional<RecordedStep> step = reader_->Read(15, true);
  ASSERT_TRUE(step) << reader_->error();
  EXPECT_TRUE(step->bodies.empty());
  EXPECT_TRUE(step->distances.empty());
  EXPECT_EQ(step->commands.size(), 2u);
  ASSERT_EQ(step->messages.size(), 1u);
  EXPECT_EQ(step->messages[0].step, 15u);
  EXPECT_EQ(step->messages[0].message.values[0], 15);
}

TEST_F(RunReaderTest, AStepThatIsNotThereIsNoDamage) {
  Record({.lost_from = 5, .lost_to = 9});
  EXPECT_FALSE(reader_->Read(7));
  EXPECT_EQ(reader_->error(), "");
  EXPECT_FALSE(reader_->Read(1000));
  EXPECT_FALSE(reader_->Read(~std::uint64_t{0}));
  EXPECT_EQ(reader_->error(), "");
}

TEST_F(RunReaderTest, FindsTheStepAtOrBeforeATime) {
  Record({.steps = 100, .lost_from = 50, .lost_to = 59});
  EXPECT_EQ(reader_->StepAt(-1, false), 0u);
  EXPECT_EQ(reader_->StepAt(0, false), 0u);
  EXPECT_EQ(reader_->StepAt(1'000'000'000'000, false), 100u);
  for (std::uint64_t step = 0; step <= 100; ++step) {
    const auto time = static_cast<Nanoseconds>(step) * SampleRun::kStep;
    const std::uint64_t there = step >= 50 && step <= 59 ? 49 : step;
    EXPECT_EQ(reader_->StepAt(time, false), there) << step;
    EXPECT_EQ(reader_->StepAt(time + 1, false), there) << step;
  }
}

TEST_F(RunReaderTest, FindsStepsThatHavePoses) {
  Record({.steps = 50, .pose_every = 10 * SampleRun::kStep});
  EXPECT_EQ(reader_->StepAt(25 * SampleRun::kStep, true), 20u);
  EXPECT_EQ(reader_->StepAt(25 * SampleRun::kStep, false), 25u);
  EXPECT_EQ(reader_->NextShown(20, false), 30u);
  EXPECT_EQ(reader_->NextShown(20, true), 10u);
  EXPECT_EQ(reader_->NextShown(50, false), std::nullopt);
  EXPECT_EQ(reader_->NextShown(0, true), std::nullopt);
  EXPECT_TRUE(reader_->Read(25)->bodies.empty());
}

TEST_F(RunReaderTest, RunsThroughManyStepsInOrder) {
  Record({.steps = 1203, .keyframe_every = 100});
  std::vector<std::uint64_t> steps;
  EXPECT_TRUE(reader_->ForEach(1, 5000, true, [&](const RecordedStep& step) {
    steps.push_back(step.step);
    return true;
  }));
  ASSERT_EQ(steps.size(), 1203u);
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i], i + 1);
}

TEST_F(RunReaderTest, StopsWhenItIsTold) {
  Record();
  int count = 0;
  EXPECT_TRUE(reader_->ForEach(0, 20, false, [&](const RecordedStep&) { return ++count < 3; }));
  EXPECT_EQ(count, 3);
}

TEST_F(RunReaderTest, GivesTheNewestKeyframeExactly) {
  Record();
  EXPECT_EQ(reader_->Keyframes(), (std::vector<std::uint64_t>{0, 8, 16}));
  const SavedStatePtr state = reader_->Keyframe(15);
  ASSERT_NE(state, nullptr) << reader_->error();
  EXPECT_EQ(state->frame->step, 8u);
  EXPECT_EQ(StateHash(*state->frame), StateHash(*sample_.FrameAt(8)));
}

TEST_F(RunReaderTest, GivesInputsAndEvents) {
  Record();
  const std::vector<RunInput> inputs = reader_->Inputs(0, 20);
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(Encode(inputs[0]), (InputText{"set_mode", "free"}));
  EXPECT_EQ(Encode(inputs[1]), (InputText{"deadline", "robot2 hold"}));
  EXPECT_EQ(reader_->Inputs(4, 8).size(), 0u);
  EXPECT_EQ(reader_->Inputs(9, 9).size(), 1u);
  const std::vector<Event> events = reader_->Events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].level, "note");
  EXPECT_DOUBLE_EQ(events[1].time_s, 0.05);
}

TEST_F(RunReaderTest, TheSceneIsThatOfTheRun) {
  Record();
  const std::shared_ptr<const Scene> scene = reader_->SceneOf(1);
  ASSERT_NE(scene, nullptr) << reader_->error();
  EXPECT_EQ(scene->robots.size(), 2u);
  EXPECT_EQ(scene->robots[1].entry.name, "robot2");
  EXPECT_EQ(scene, reader_->SceneOf(1));
  EXPECT_EQ(reader_->SceneOf(99), nullptr);
  EXPECT_NE(reader_->error(), "");
}

TEST_F(RunReaderTest, CarriesItsScenarioWithWorldAndRobots) {
  Record();
  Diagnostics diagnostics;
  const auto scenario = reader_->LoadScenario(SearchPath(), diagnostics);  // no robots are found there
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->robots[1].model->type, "minibot");
  const std::shared_ptr<const Scene> scene = reader_->SceneOf(1);
  ASSERT_NE(scene, nullptr) << reader_->error();
  EXPECT_EQ(scene->scenario, scenario);
  EXPECT_TRUE(reader_->Read(20));
}

TEST_F(RunReaderTest, AStepCanBeReadAgainAfterOneThatIsNotThere) {
  Record();
  EXPECT_FALSE(reader_->Read(1000));
  EXPECT_TRUE(reader_->Read(10));
  EXPECT_FALSE(reader_->NextShown(20, false));
  EXPECT_EQ(reader_->NextShown(4, false), 5u);
}

TEST_F(RunReaderTest, NeedsTheScenarioForPosesAlone) {
  sample_.Write(file_);
  std::string error;
  reader_ = RunReader::Open(file_, error);
  ASSERT_NE(reader_, nullptr) << error;
  EXPECT_TRUE(reader_->Read(3, true));
  EXPECT_FALSE(reader_->Read(3));
  EXPECT_NE(reader_->error().find("has not been loaded"), std::string::npos);
}

TEST_F(RunReaderTest, TellsItsContents) {
  Record();
  const std::optional<RunContents> contents = reader_->Contents();
  ASSERT_TRUE(contents) << reader_->error();
  ASSERT_EQ(contents->robots.size(), 2u);
  EXPECT_EQ(contents->robots[0].name, "robot1");
  EXPECT_EQ(contents->robots[1].type, "minibot");
  EXPECT_EQ(contents->bodies, 3u);
  EXPECT_EQ(contents->scenes, 1u);
  EXPECT_EQ(contents->keyframes, 3u);
  EXPECT_EQ(contents->inputs, 2u);
  EXPECT_EQ(contents->last_hash, StateHash(*sample_.FrameAt(20)));
  EXPECT_EQ(contents->bytes, std::filesystem::file_size(file_));
  EXPECT_EQ(reader_->CountCommands(), 6u);
}

}  // namespace
}  // namespace coopdyn
