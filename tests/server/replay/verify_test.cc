// SPDX-License-Identifier: MIT
#include "server/replay/verify.h"

#include <gmock/gmock.h>

#include "tests/server/replay/verify_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class VerifyFidelityTest : public VerifyTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(VerifyFidelityTest, ARunWithIrregularCommandsIsEqual) {
  {
    LiveRun run(File(), std::string(kLesson) +
                            "[SWARM_1]\ntype minibot\nname m\ncount 12\narea 0 3 2 2\nfidelity " +
                            GetParam() + "\n");
    for (int k = 0; k < 120; ++k) {
      if (k % 7 == 0) run.Command("robot1", 3 + 0.1 * k, 3);
      if (k % 3 == 0) run.Command("m_" + std::to_string(1 + k % 12), 5, 4 - 0.01 * k);
      run.Step();
    }
  }
  ExpectEqual(File(), 120);
}

INSTANTIATE_TEST_SUITE_P(All, VerifyFidelityTest, ::testing::Values("full", "rolling", "planar"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(VerifyTest, AStepThatChangesInTheMiddleIsEqual) {
  {
    LiveRun run(File(), kLesson);
    Drive(run, 30);
    run.Apply(edit::SetStep{25'000'000});
    Drive(run, 30);
    run.Apply(edit::SetStep{2'000'000});
    Drive(run, 30);
  }
  ExpectEqual(File(), 90);
}

TEST_F(VerifyTest, StopAllAndChangesOfModeAreEqual) {
  {
    LiveRun run(File(), kLesson);
    Drive(run, 30);
    run.Apply(edit::StopAll{});
    run.Step(10);
    run.Apply(edit::SetMode{Mode::kRealtime});
    Drive(run, 20);
  }
  ExpectEqual(File(), 60);
}

TEST_F(VerifyTest, ARecordingThatBeginsLaterIsEqual) {
  {
    LiveRun run(File("start.run"), kLesson);
    Drive(run, 40);
    const EditResult saved = run.Apply(edit::Save{});
    ASSERT_NE(saved.saved, nullptr);
    run.End();
    LiveRun later(File("later.run"), saved.saved);
    EXPECT_EQ(later.frame()->step, 40u);
    later.Step(60);  // with the set-points that are in force
  }
  ExpectEqual(File("later.run"), 60);
}

TEST_F(VerifyTest, AnotherNumberOfThreadsIsEqual) {
  {
    LiveRun run(File(), "[SWARM_1]\ntype minibot\nname m\ncount 60\narea 0 0 3 3\nfidelity rolling\n");
    for (int k = 0; k < 60; ++k) {
      run.Command("m_" + std::to_string(1 + k % 60), 5, 4 - 0.01 * k);
      run.Step();
    }
  }
  EXPECT_EQ(ToString(Repeat(File(), 2)), "equal, 60 steps\n");
}

TEST_F(VerifyTest, ProgressGrowsToTheEnd) {
  MakeLesson(File());
  std::string error;
  const auto reader = RunReader::Open(File(), error);
  const Repeating repeating;
  std::vector<double> shares;
  Verify(*reader, repeating.services, [&](double share) { shares.push_back(share); });
  EXPECT_GT(shares.size(), 5u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

// --- errors in a file are located

TEST_F(VerifyTest, ABitOfACommandIsNamedByItsStep) {
  MakeLesson(File());
  // robot1 gets a command in step 22 (k = 21): its left wheel's lowest bit, which moves nothing by 1 µm.
  Tamper(File()).FlipCommand(22, 40);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 22u);
  EXPECT_EQ(report.steps, 21u);
  EXPECT_TRUE(report.difference->exact);
  EXPECT_EQ(report.difference->value_step, 50u) << ToString(report);  // the next exact state
  EXPECT_THAT(report.difference->note, HasSubstr("robot1 (5.1"));
  EXPECT_NE(report.difference->recorded, report.difference->repeated);
  EXPECT_EQ(ToString(report), "differs from step 22 on, t = 0.22 s: " + report.difference->what + " " +
                                  report.difference->field + "\n  recorded  " + report.difference->recorded +
                                  "\n  repeated  " + report.difference->repeated +
                                  "\n  at step 50, where it shows first\n  " + report.difference->note +
                                  "\n21 steps before it are equal\n");
}

TEST_F(VerifyTest, EveryBitOfACommandsNumbersMatters) {
  MakeLesson(File());
  for (const std::size_t bit : {40u, 58u, 92u, 103u, 144u, 168u, 196u, 207u}) {
    {
      Tamper tamper(File());
      tamper.FlipCommand(29, bit);  // robot1 and its k = 28
    }
    const VerifyReport report = Repeat(File());
    // Some bits make an impossible speed.
    const bool named =
        report.difference ? report.difference->step == 29 : report.error.find("step 29") != std::string::npos;
    EXPECT_TRUE(named) << "bit " << bit << ": " << ToString(report);
    Tamper tamper(File());
    tamper.FlipCommand(29, bit);
  }
  ExpectEqual(File(), 120);
}

TEST_F(VerifyTest, ACommandThatMovesARobotElsewhereIsNamedByItsPose) {
  MakeLesson(File());
  Tamper(File()).FlipCommand(78, 40 + 63);  // backwards
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 78u);
  EXPECT_EQ(report.difference->value_step, 78u);
  EXPECT_THAT(report.difference->what, StartsWith("robot1."));
  EXPECT_FALSE(report.difference->exact);
}

TEST_F(VerifyTest, ABitOfAHashIsNamed) {
  const VerifyReport report = Tampered("UPDATE step SET hash = hash + 1 WHERE step = 60");
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 60u);
  EXPECT_EQ(report.difference->field, "hash");
  EXPECT_THAT(report.difference->note, HasSubstr("step 61 is equal again"));
}

TEST_F(VerifyTest, ABitOfALaterKeyframeIsNamed) {
  MakeLesson(File());
  FlipKeyframe(50);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 50u);
  EXPECT_EQ(report.difference->what, "CRATE_1");
  EXPECT_EQ(report.difference->field, "x_m");
  EXPECT_EQ(report.steps, 49u);
}

TEST_F(VerifyTest, ABitOfTheFirstKeyframeIsNamed) {
  MakeLesson(File());
  FlipKeyframe(0);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 0u);
  EXPECT_EQ(report.steps, 0u);
}

TEST_F(VerifyTest, AStepThatTookNoTimeIsDamage) {
  EXPECT_THAT(Tampered("UPDATE step SET time_ns = time_ns - 10000000 WHERE step = 33").error,
              HasSubstr("step 33 is damaged"));
}

TEST_F(VerifyTest, LostStepsAreCountedAndItGoesOnFromTheNextKeyframe) {
  const VerifyReport report = RecordedAs(
      "DELETE FROM step WHERE step BETWEEN 31 AND 49; UPDATE meta SET value = 19 WHERE key = 'lost'");
  EXPECT_FALSE(report.difference) << ToString(report);
  EXPECT_EQ(report.not_verified, 19u);
  EXPECT_EQ(report.steps, 101u);
  EXPECT_EQ(ToString(report), "equal, 101 steps; 19 lost steps could not be verified\n");
}

TEST_F(VerifyTest, AMissingStepThatTheRecordingDoesNotCallLostIsNamed) {
  const VerifyReport report = RecordedAs("DELETE FROM step WHERE step = 110");
  EXPECT_THAT(report.error,
              HasSubstr("11 steps are not to be verified, from step 110 on, where it calls 0 lost"));
  EXPECT_EQ(report.steps, 109u);
  EXPECT_EQ(report.not_verified, 11u);
}

TEST_F(VerifyTest, StepsCutOffTheEndAreDamage) {
  EXPECT_THAT(Tampered("DELETE FROM step WHERE step > 100").error,
              HasSubstr("20 steps are missing at its end"));
}

TEST_F(VerifyTest, OneStepCutOffTheEndIsToldAsOne) {
  EXPECT_THAT(Tampered("DELETE FROM step WHERE step > 119").error, HasSubstr("1 step is missing at its end"));
}

TEST_F(VerifyTest, AChangedPictureOfAnUnchangedRunIsNamed) {
  const VerifyReport report =
      Tampered("UPDATE step SET poses = (SELECT poses FROM step WHERE step = 90) WHERE step = 91");
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 91u);
  EXPECT_EQ(report.steps, 90u);
}

TEST_F(VerifyTest, ABitOfAReadingIsNamed) {
  {
    LiveOptions options;
    options.what.distances = true;
    LiveRun run(File(), kLesson, options);
    Drive(run);
  }
  Tamper(File()).FlipBit("SELECT distances FROM step WHERE step = 40",
                         "UPDATE step SET distances = ?1 WHERE step = 40", 8 * 4 + 1);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 40u);
  EXPECT_EQ(report.difference->what, "robot1");
  EXPECT_EQ(report.difference->field, "d2_m");
}

TEST_F(VerifyTest, AReadingIsNamedByItsRobotAndSensorOrTarget) {
  {
    LiveOptions options;
    options.what.distances = options.what.targets = true;
    LiveRun run(File(), std::string(kLesson) + "[TARGET]\nred 3 0\nred 0 2.5\n", options);
    run.Step(10);
  }
  std::string error;
  const auto reader = RunReader::Open(File(), error);
  Diagnostics diagnostics;
  ASSERT_NE(reader->LoadScenario(TestPath(), diagnostics), nullptr);
  const auto recorded = reader->Read(4);
  ASSERT_TRUE(recorded);
  const std::size_t distances = recorded->distances.size(), targets = recorded->targets.size();
  ASSERT_EQ(targets, 8u);  // two of each target, for each robot
  const auto changed = [this](const std::string& column, std::size_t place) {
    const auto flip = [&] {
      Tamper(File()).FlipBit("SELECT " + column + " FROM step WHERE step = 4",
                             "UPDATE step SET " + column + " = ?1 WHERE step = 4", 8 * 4 * place + 1);
    };
    flip();
    const VerifyReport report = Repeat(File());
    flip();
    return report.difference ? report.difference->what + " " + report.difference->field : ToString(report);
  };
  EXPECT_EQ(changed("distances", distances / 2 + 2), "robot2 d3_m");
  EXPECT_EQ(changed("targets", 0), "robot1 red1_distance_m");
  EXPECT_EQ(changed("targets", 7), "robot2 red2_bearing_rad");
}

TEST_F(VerifyTest, ACommandOfNobodyWithoutEffectIsNamed) {
  {
    LiveRun run(File(), kLesson);
    for (int k = 0; k < 10; ++k) {
      run.Command("robot1", 3, 3);
      run.Step();
    }
  }
  Tamper(File()).FlipCommand(5, 31);  // by_client
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 5u);
  EXPECT_EQ(report.difference->what, "robot1");
}

constexpr const char* kMadeElsewhere =
    "UPDATE meta SET value = '0123456789abcdef' WHERE key = 'build';"
    "UPDATE meta SET value = 'libode.so.7 0123456789abcdef' WHERE key = 'libraries';"
    "UPDATE meta SET value = 'Abacus' WHERE key = 'cpu';";

TEST_F(VerifyTest, AnEqualRunOfAnotherBuildAndProcessorHasNoWarning) {
  const VerifyReport report = RecordedAs(kMadeElsewhere);
  EXPECT_FALSE(report.difference);
  EXPECT_EQ(report.error, "");
  EXPECT_EQ(report.warning, "");
}

constexpr const char* kDiffers = "UPDATE step SET hash = hash + 1 WHERE step = 5;";

TEST_F(VerifyTest, WhereARunDiffersAnotherBuildLibraryAndProcessorAreSaid) {
  const VerifyReport report = RecordedAs(std::string(kMadeElsewhere) + kDiffers);
  EXPECT_TRUE(report.difference);
  EXPECT_EQ(report.warning, File() +
                                " was made by another build (version test, 0123456789abcdef), with another "
                                "libode.so.7, on another processor (Abacus); repeat it with that build and "
                                "those libraries (coopdyn info lists them)");
}

TEST_F(VerifyTest, WhereOnlyTheProcessorIsAnotherTheControllersAreNamed) {
  const VerifyReport report =
      RecordedAs(std::string("UPDATE meta SET value = 'Abacus' WHERE key = 'cpu';") + kDiffers);
  EXPECT_EQ(report.warning, File() +
                                " was made on another processor (Abacus); with the same build and libraries "
                                "only a controller of yours computes otherwise there");
}

TEST_F(VerifyTest, AProcessorThatTheRunDoesNotNameIsNoOtherOne) {
  EXPECT_EQ(RecordedAs(std::string("DELETE FROM meta WHERE key = 'cpu';") + kDiffers).warning, "");
}

}  // namespace
}  // namespace coopdyn
