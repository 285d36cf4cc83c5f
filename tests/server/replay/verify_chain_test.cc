// SPDX-License-Identifier: MIT
// Changes to a recording that a repetition cannot detect are found by its chains, with their step; other
// changes are reported by their effect.
#include <gmock/gmock.h>

#include "server/replay/verify.h"
#include "tests/server/record/rechain.h"
#include "tests/server/replay/replay_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Robots whose clients repeat the same set-points, one driven by a controller, and events in between: 60
/// steps, with an exact state every 20.
class VerifyChainTest : public ::testing::Test {
 protected:
  VerifyChainTest() {
    LiveOptions options;
    options.keyframe_steps = 20;
    LiveRun run(file_,
                "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
                "[ROBOT_2]\ntype minibot\nname m\nposition 2 0\ncontroller diffuse\n",
                options);
    for (int k = 1; k <= 60; ++k) {
      if (k < 40) run.Command("robot1", 3, 3);
      if (k == 41) run.Apply(edit::StopAll{});
      if (k % 25 == 0) run.Apply(edit::SetMode{k == 25 ? Mode::kRealtime : Mode::kFree});
      run.Step();
    }
    EXPECT_EQ(run.frame()->step, 60u);
  }

  void Change(const std::string& sql) const { Tamper(file_).Run(sql); }
  VerifyReport Repeat() const {
    std::string error;
    const auto reader = RunReader::Open(file_, error);
    EXPECT_NE(reader, nullptr) << error;
    const Repeating repeating;
    return Verify(*reader, repeating.services, nullptr);
  }
  /// The error that `what` of step `step` differs from the written data.
  void ExpectNamed(std::uint64_t step, const std::string& what, const std::string& field = "chain") const {
    const VerifyReport report = Repeat();
    ASSERT_TRUE(report.difference) << ToString(report);
    EXPECT_EQ(report.difference->step, step) << ToString(report);
    EXPECT_EQ(report.difference->what, what) << ToString(report);
    EXPECT_EQ(report.difference->field, field) << ToString(report);
    EXPECT_EQ(report.steps, step == 0 ? 0 : step - 1) << ToString(report);
  }

  TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
};

TEST_F(VerifyChainTest, AsItWasRecordedItIsEqual) {
  EXPECT_EQ(ToString(Repeat()), "equal, 60 steps\n");
}

TEST_F(VerifyChainTest, ARepeatedCommandThatWasTakenOutIsNamedByItsStep) {
  Change("UPDATE step SET commands = NULL WHERE step = 22");
  const VerifyReport report = Repeat();
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(ToString(report),
            "differs from step 22 on, t = 0.22 s: the row of step 22: its chain\n  recorded  " +
                report.difference->recorded + "\n  computed  " + report.difference->repeated +
                "\n  it is not as it was written, or one before it was taken out, put in or "
                "moved; nothing that was repeated differs\n21 steps before it are equal\n");
}

TEST_F(VerifyChainTest, AMarkOfACommandThatNobodySentIsNamedByItsStep) {
  // stop_all's command to robot1 takes effect in step 41, and changes the set-points in force; now it looks
  // like a client's. It has a record of 13 bytes per wheel.
  Tamper(file_).FlipCommand(41, 31);
  Tamper(file_).FlipCommand(41, 8 * 13 + 31);
  ExpectNamed(41, "the row of step 41");
}

TEST_F(VerifyChainTest, AChangeInTheFirstRowIsNamed) {
  Tamper(file_).FlipCommand(0, 31);
  ExpectNamed(0, "the row of step 0");
}

TEST_F(VerifyChainTest, AChangeInTheLastRowIsNamed) {
  Change("UPDATE step SET chain = chain + 1 WHERE step = 60");
  ExpectNamed(60, "the row of step 60");
}

TEST_F(VerifyChainTest, AStateThatDiffersWithTheRowIsToldFirst) {
  // A bit of a set-point: the motion differs, which says more than that the row was changed.
  Tamper(file_).FlipCommand(22, 40);
  const VerifyReport report = Repeat();
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 22u);
  EXPECT_THAT(report.difference->what, StartsWith("robot1"));
  EXPECT_NE(report.difference->field, "chain");
}

TEST_F(VerifyChainTest, ARowBeforeAStateThatDiffersIsToldFirst) {
  Change("UPDATE step SET commands = NULL WHERE step = 15; UPDATE step SET hash = hash + 1 WHERE step = 33");
  ExpectNamed(15, "the row of step 15");
}

TEST_F(VerifyChainTest, AnInputThatNoStateTellsOfIsNamed) {
  Change("UPDATE input SET detail = 'lockstep' WHERE action = 'set_mode' AND step = 24");
  // Each step was also requested.
  ExpectNamed(24, "input 25");
}

TEST_F(VerifyChainTest, AnInputThatWasTakenOutIsNamed) {
  Change("DELETE FROM input WHERE id = 1");
  const VerifyReport report = Repeat();
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->what, "input 1");
  EXPECT_EQ(report.difference->recorded, "missing");
  EXPECT_EQ(report.difference->note, "it was taken out after it was written, or the row after it was put in");
}

TEST_F(VerifyChainTest, AKeyframeIsNamedThoughItsStateIsEqual) {
  // Whether the run was paused then is not part of the compared state.
  Tamper(file_).FlipBit("SELECT state FROM keyframe WHERE step = 40",
                        "UPDATE keyframe SET state = ?1 WHERE step = 40", 8 * 2);
  ExpectNamed(40, "the keyframe of step 40");
}

TEST_F(VerifyChainTest, StepsThatWereTakenOutAndDeclaredLostAreFound) {
  Change("DELETE FROM step WHERE step BETWEEN 31 AND 39; UPDATE meta SET value = 9 WHERE key = 'lost'");
  const VerifyReport report = Repeat();
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->what, "the row of step 40");
  EXPECT_EQ(report.not_verified, 9u);
  EXPECT_THAT(report.warning, HasSubstr("its table meta was changed after it was written"));
}

TEST_F(VerifyChainTest, AStepThatWasTakenOutIsToldByTheRowAfterItAndNotAsLost) {
  Change("DELETE FROM step WHERE step = 31");
  const VerifyReport report = Repeat();
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->what, "the row of step 32");
  EXPECT_EQ(report.steps, 30u);
  EXPECT_THAT(report.difference->note, HasSubstr("there is no row of step 31"));
  EXPECT_THAT(ToString(report), HasSubstr("30 steps before it are equal; 9 steps could not be verified\n"));
}

TEST_F(VerifyChainTest, StepsThatWereReallyLostAreNoDamage) {
  Change("DELETE FROM step WHERE step BETWEEN 31 AND 39; UPDATE meta SET value = 9 WHERE key = 'lost'");
  Rechain(file_);
  EXPECT_EQ(ToString(Repeat()), "equal, 51 steps; 9 lost steps could not be verified\n");
}

TEST_F(VerifyChainTest, AnEndThatWasCutOffAndDeclaredIsFound) {
  Change("DELETE FROM step WHERE step > 50; UPDATE meta SET value = 50 WHERE key = 'last_step'");
  const VerifyReport report = Repeat();
  EXPECT_THAT(report.error, HasSubstr("its table step ends with row 50"));
  EXPECT_EQ(report.steps, 50u);
}

TEST_F(VerifyChainTest, AnEndThatWasCutOffAsIfByACrashIsFound) {
  Change(
      "DELETE FROM step WHERE step > 50; DELETE FROM keyframe WHERE step > 50; DELETE FROM input WHERE step "
      "> "
      "50; DELETE FROM event WHERE step > 50; DELETE FROM meta WHERE key = 'last_step';"
      "UPDATE meta SET value = 0 WHERE key = 'closed'");
  EXPECT_THAT(Repeat().error, HasSubstr("its table step ends with row 50, where meta tells of another end"));
}

TEST_F(VerifyChainTest, WhatMetaSaysOfTheRunIsSealed) {
  Change("UPDATE meta SET value = '2001-01-01T00:00:00Z' WHERE key = 'started'");
  const VerifyReport report = Repeat();
  EXPECT_EQ(report.error, file_ + ": its table meta was changed after it was written: it is damaged");
  EXPECT_EQ(report.steps, 60u);
  EXPECT_EQ(report.warning, "");
}

TEST_F(VerifyChainTest, ATextThatDoesNotLoadAnyMoreIsSaidToHaveBeenChanged) {
  Change("UPDATE text SET content = 'nonsense' WHERE kind = 'scenario'");
  const VerifyReport report = Repeat();
  EXPECT_THAT(report.error, HasSubstr("its scenario does not load"));
  EXPECT_THAT(report.warning, HasSubstr("a text that it carries (scenario, world or robot) was changed"));
}

TEST_F(VerifyChainTest, AnotherSeedIsToldAsWhatItMakesAndAsAChange) {
  Change("UPDATE meta SET value = '77' WHERE key = 'scenario_seed'");
  const VerifyReport report = Repeat();
  EXPECT_THAT(report.error + report.warning, HasSubstr("its table meta was changed"));
}

class HostileChainTest : public VerifyChainTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(HostileChainTest, IsNamed) {
  Change("UPDATE step SET chain = " + std::string(GetParam()) + " WHERE step = 12");
  ExpectNamed(12, "the row of step 12");
}

INSTANTIATE_TEST_SUITE_P(All, HostileChainTest,
                         ::testing::Values("NULL", "'text'", "x'00'", "0.5", "9223372036854775807",
                                           "chain + 4294967296"),
                         [](const auto& info) { return std::to_string(info.index); });

TEST_F(VerifyChainTest, AFileWithoutChainsIsRefusedWithWhatToDo) {
  Change("ALTER TABLE step DROP COLUMN chain");
  const VerifyReport report = Repeat();
  EXPECT_THAT(report.error, HasSubstr("no such column: chain"));
  EXPECT_THAT(report.error, HasSubstr("record it again"));
}

TEST_F(VerifyChainTest, NotesAreNamed) {
  const std::string notes = folder_.File("notes.run");
  {
    LiveRun run(notes, "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n");
    run.Step(5);
    run.Apply(edit::Note{"before"});
    run.Step(5);
    run.Apply(edit::Note{"after"});
    run.Step(5);
  }
  const auto repeat = [&notes] {
    std::string error;
    const auto reader = RunReader::Open(notes, error);
    const Repeating repeating;
    return ToString(Verify(*reader, repeating.services, nullptr));
  };
  EXPECT_EQ(repeat(), "equal, 15 steps\n");
  Tamper(notes).Run("UPDATE event SET text = 'long before' WHERE text = 'before'");
  EXPECT_THAT(repeat(), StartsWith("differs from step 5 on, t = 0.05 s: event 1: its chain\n"));
  Tamper(notes).Run("UPDATE event SET text = 'before' WHERE id = 1; DELETE FROM event WHERE id = 2");
  EXPECT_THAT(repeat(), HasSubstr("its table event ends with row 1, where meta tells of another end"));
}

}  // namespace
}  // namespace coopdyn
