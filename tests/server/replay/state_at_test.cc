// SPDX-License-Identifier: MIT
#include "server/replay/state_at.h"

#include <gmock/gmock.h>

#include "tests/server/replay/replay_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const char* const kStatesLesson =
    "[CRATE_1]\ntype box\nsize 0.3 0.3 0.3\nposition 0.8 0\nmass 2\n"
    "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
    "[ROBOT_2]\ntype coopbot\nname robot2\nposition 1.6 0\norientation 180deg\n";

class StateAtTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name = "lesson1.run") const { return folder_.File(name); }

  std::unique_ptr<RunReader> OpenRun(const std::string& file) {
    std::string error;
    auto reader = RunReader::Open(file, error);
    EXPECT_NE(reader, nullptr) << error;
    Diagnostics diagnostics;
    EXPECT_NE(reader->LoadScenario(TestPath(), diagnostics), nullptr) << diagnostics.ToString();
    return reader;
  }

  static void DriveStep(LiveRun& run) {
    const auto k = static_cast<int>(run.frame()->step);
    if (k % 7 == 0) run.Command("robot1", 3 + 0.05 * k, 3);
    if (k % 11 == 3) run.Command("robot2", 2, 2 - 0.02 * k);
    run.Step();
  }
  void MakeLesson(const std::string& file, int steps) {
    LiveRun run(file, kStatesLesson);
    for (int k = 0; k < steps; ++k) DriveStep(run);
  }
  /// The hash of every step of a file.
  std::vector<std::uint64_t> Hashes(const std::string& file) {
    std::vector<std::uint64_t> hashes;
    const auto reader = OpenRun(file);
    const RunExtent extent = reader->extent();
    EXPECT_TRUE(reader->ForEach(extent.first, extent.last, true, [&](const RecordedStep& step) {
      hashes.push_back(step.hash);
      return true;
    }));
    return hashes;
  }

  const TempFolder folder_;
};

TEST_F(StateAtTest, ABranchAtKeyframesAndBetweenHasTheOriginalHashesToTheEnd) {
  constexpr int kSteps = 120;
  MakeLesson(File(), kSteps);
  const std::vector<std::uint64_t> hashes = Hashes(File());
  ASSERT_EQ(hashes.size(), kSteps + 1u);
  for (const std::uint64_t step : {0u, 1u, 49u, 50u, 51u, 77u, 78u, 100u, 119u}) {
    SavedStatePtr state;
    {
      const auto reader = OpenRun(File());
      const Repeating repeating;
      std::string error;
      state = StateAt(*reader, step, repeating.services, error);
      ASSERT_NE(state, nullptr) << error;
    }
    EXPECT_EQ(state->frame->step, step);
    EXPECT_EQ(StateHash(*state->frame), hashes[step]);
    LiveRun branch(File("branch" + std::to_string(step) + ".run"), state);
    for (std::uint64_t k = step; k < kSteps; ++k) {
      DriveStep(branch);
      ASSERT_EQ(branch.hash(), hashes[k + 1]) << "branch at " << step << ", step " << k + 1;
    }
  }
}

TEST_F(StateAtTest, TheModeIsTheOneInForceThen) {
  {
    LiveRun run(File(), kStatesLesson);
    run.Step(10);
    run.Apply(edit::SetMode{Mode::kRealtime});
    run.Step(10);
  }
  const auto reader = OpenRun(File());
  const Repeating repeating;
  std::string error;
  EXPECT_EQ(StateAt(*reader, 10, repeating.services, error)->mode, Mode::kFree);
  EXPECT_EQ(StateAt(*reader, 11, repeating.services, error)->mode, Mode::kRealtime);
}

TEST_F(StateAtTest, AStepThatIsNotThereIsSaid) {
  MakeLesson(File(), 60);
  Tamper(File()).Run("DELETE FROM step WHERE step BETWEEN 20 AND 22");
  const Repeating repeating;
  const auto error_at = [&](std::uint64_t step) {
    std::string error;
    const auto reader = OpenRun(File());
    const SavedStatePtr state = StateAt(*reader, step, repeating.services, error);
    EXPECT_EQ(state == nullptr, !error.empty());
    return error;
  };
  EXPECT_THAT(error_at(21), HasSubstr("step 21 was not recorded"));
  EXPECT_THAT(error_at(30), HasSubstr("no exact state is after it"));
  EXPECT_EQ(error_at(19), "");
  EXPECT_EQ(error_at(55), "");
  EXPECT_THAT(error_at(61), HasSubstr("step 61"));
}

TEST_F(StateAtTest, ARepetitionThatComesOutOtherwiseIsRefused) {
  MakeLesson(File(), 60);
  Tamper(File()).FlipCommand(29, 60);
  Tamper(File()).Run("UPDATE meta SET value = 'Abacus' WHERE key = 'cpu'");
  const auto reader = OpenRun(File());
  const Repeating repeating;
  std::string error;
  EXPECT_NE(StateAt(*reader, 28, repeating.services, error), nullptr) << error;
  EXPECT_EQ(StateAt(*reader, 40, repeating.services, error), nullptr);
  EXPECT_THAT(error, HasSubstr("step 29 differs from the recording"));
  EXPECT_THAT(error, HasSubstr("another processor (Abacus)"));
}

class FindStepTest : public StateAtTest {
 protected:
  void SetUp() override {
    LiveRun run(File(), kStatesLesson);
    run.Step(20);
    run.End();
    reader_ = OpenRun(File());
  }
  std::string Find(const std::string& when) {
    std::string error;
    const auto step = FindStep(*reader_, when, error);
    return step ? std::to_string(*step) : error;
  }
  std::unique_ptr<RunReader> reader_;
};

TEST_F(FindStepTest, SecondsFindTheNewestStepUpToThen) {
  EXPECT_EQ(Find("0"), "0");
  EXPECT_EQ(Find("0.1"), "10");
  EXPECT_EQ(Find("0.1s"), "10");
  EXPECT_EQ(Find("0.109"), "10");
  EXPECT_EQ(Find("1e-1"), "10");
  EXPECT_EQ(Find("0.2"), "20");
}

TEST_F(FindStepTest, WordsAndStepNumbers) {
  EXPECT_EQ(Find("start"), "0");
  EXPECT_EQ(Find("end"), "20");
  EXPECT_EQ(Find("#7"), "7");
  EXPECT_EQ(Find("step7"), "7");
}

TEST_F(FindStepTest, WhatLiesOutsideIsSaidWithTheRange) {
  for (const char* when : {"0.201", "-1", "1e300", "#21"}) {
    EXPECT_THAT(Find(when), HasSubstr("has 0 s to 0.2 s (steps 0 to 20)")) << when;
    EXPECT_THAT(Find(when), HasSubstr("is not in it")) << when;
  }
}

TEST_F(FindStepTest, WhatIsNoMomentIsSaidWithAnExample) {
  for (const char* when : {"", "now", "1,5", "1.5m", "nan", "inf", "0.1ss"}) {
    EXPECT_THAT(Find(when), HasSubstr("is no moment of a run: write simulated seconds (12.5)")) << when;
  }
  for (const char* when : {"#", "#-1", "stepx", "#1.5"})
    EXPECT_THAT(Find(when), HasSubstr("is no step")) << when;
}

}  // namespace
}  // namespace coopdyn
