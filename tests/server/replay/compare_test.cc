// SPDX-License-Identifier: MIT
// Compares two recordings: changes are reported even if all motion is equal.
#include <gmock/gmock.h>

#include "tests/server/replay/verify_fixture.h"

namespace coopdyn {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class CompareTest : public VerifyTest {
 protected:
  /// Two equal lessons with a note; `sql` changes the second.
  VerifyReport AgainstChanged(const std::string& sql) {
    for (const char* name : {"a.run", "b.run"}) {
      LiveRun run(File(name), kLesson);
      Drive(run, 20);
      run.Apply(edit::Note{"look"});
      Drive(run, 40);
    }
    Tamper(File("b.run")).Run(sql);
    return Against(File("a.run"), File("b.run"));
  }
};

TEST_F(CompareTest, RunsWithTheSameInputsAreEqual) {
  MakeLesson(File("a.run"));
  MakeLesson(File("b.run"));
  EXPECT_EQ(ToString(Against(File("a.run"), File("b.run"))), "equal, 120 steps\n");
}

TEST_F(CompareTest, ARunOfAnotherSceneWithoutExactStatesIsReadInItsOwnScene) {
  MakeLesson(File("a.run"));
  {
    LiveRun run(File("b.run"), std::string(kLesson) + "[ROBOT_3]\ntype coopbot\nname robot3\nposition 3 0\n");
    run.Step(10);
    run.Command("robot3", 1.5, 2.25);
    run.Step(10);
  }
  Tamper(File("b.run")).Run("DELETE FROM keyframe");
  for (const auto& [one, other] : {std::pair("a.run", "b.run"), std::pair("b.run", "a.run")}) {
    const VerifyReport report = Against(File(one), File(other));
    EXPECT_TRUE(report.difference || !report.error.empty());
    EXPECT_THAT(ToString(report), HasSubstr("b.run"));
  }
}

TEST_F(CompareTest, ALongerRunIsSaid) {
  MakeLesson(File("a.run"));
  {
    LiveRun run(File("b.run"), kLesson);
    Drive(run, 80);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  EXPECT_EQ(report.steps, 80u);
  EXPECT_THAT(report.warning, HasSubstr("a.run has steps 0 to 120"));
}

TEST_F(CompareTest, TwoRunsPartAtACommandWithBothExactValues) {
  MakeLesson(File("a.run"));
  {
    LiveRun run(File("b.run"), kLesson);
    Drive(run, 78);
    run.Command("robot2", 1.5, 2.25);
    run.Step(40);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 79u);
  EXPECT_EQ(report.steps, 78u);
  EXPECT_EQ(report.difference->what, "robot2");
  EXPECT_EQ(report.difference->field, "left_wheel_joint_setpoint_rad_s");
  EXPECT_EQ(report.difference->recorded, "2");
  EXPECT_EQ(report.difference->repeated, "1.5");
  EXPECT_EQ(report.difference->recorded_is, File("a.run"));
  EXPECT_TRUE(report.difference->exact);
  EXPECT_THAT(report.difference->note,
              HasSubstr("b.run: set-points that came in force with step 79: robot2"));
}

TEST_F(CompareTest, TwoRunsThatBeginDifferentlyPartAtTheFirstBody) {
  MakeLesson(File("a.run"));
  std::string moved = kLesson;
  moved.replace(moved.find("position 0.8 0"), 14, "position 0.8 1");
  {
    LiveRun run(File("b.run"), moved);
    run.Step(10);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 0u);
  EXPECT_EQ(report.difference->what, "CRATE_1");
  EXPECT_EQ(report.difference->field, "y_m");
  EXPECT_EQ(report.difference->recorded, "0");
  EXPECT_EQ(report.difference->repeated, "1");
  EXPECT_THAT(report.warning, HasSubstr("their scenarios differ"));
}

TEST_F(CompareTest, RunsOfDifferentThingsAreSaidToBe) {
  MakeLesson(File("a.run"));
  {
    LiveRun run(File("b.run"), "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n");
    run.Step(10);
  }
  EXPECT_THAT(Against(File("a.run"), File("b.run")).error, HasSubstr("are different runs from the start on"));
}

TEST_F(CompareTest, RunsWithoutCommonStepsAreSaid) {
  {
    LiveRun run(File("a.run"), kLesson);
    run.Step(10);
    const SavedStatePtr state = run.Apply(edit::Save{}).saved;
    run.End();
    LiveRun later(File("b.run"), state);
    later.Step(30);
    const SavedStatePtr last = later.Apply(edit::Save{}).saved;
    later.End();
    LiveRun last_run(File("c.run"), last);
    last_run.Step(5);
  }
  EXPECT_THAT(Against(File("a.run"), File("c.run")).error, HasSubstr("no step in common"));
}

// --- equal motion, but different recordings

TEST_F(CompareTest, CommandsThatWereInForceAlreadyAreNoDamage) {
  for (const bool again : {true, false}) {
    LiveRun run(File(again ? "a.run" : "b.run"), kLesson);
    for (int k = 0; k < 40; ++k) {
      if (again || k == 0) run.Command("robot1", 3, 2);
      run.Step();
    }
  }
  const std::string said =
      "equal, 40 steps\n"
      "warning: the runs are equal, but their commands differ: from step 2 on " +
      File("a.run") + " also has commands that repeat those in force\n";
  EXPECT_EQ(ToString(Against(File("a.run"), File("b.run"))), said);
  EXPECT_EQ(ToString(Against(File("b.run"), File("a.run"))), said);
}

TEST_F(CompareTest, CommandsOfControllersThatOneFileHasAreNoDamage) {
  const std::string scenario =
      std::string(kLesson) + "[ROBOT_3]\ntype minibot\nname m\nposition 3 3\ncontroller diffuse\n";
  for (const bool controllers : {true, false}) {
    LiveRun run(File(controllers ? "a.run" : "b.run"), scenario, {.what = {.controllers = controllers}});
    Drive(run, 40);
    run.Step(20);
  }
  const std::string said =
      "equal, 60 steps\nwarning: the commands of controllers are recorded in " + File("a.run") + " only\n";
  EXPECT_EQ(ToString(Against(File("a.run"), File("b.run"))), said);
  EXPECT_EQ(ToString(Against(File("b.run"), File("a.run"))), said);
}

TEST_F(CompareTest, BothAreSaidOnce) {
  const std::string scenario =
      "[ROBOT_1]\ntype minibot\nname m\nposition 3 3\ncontroller diffuse\n"
      "[ROBOT_2]\ntype minibot\nname robot1\nposition 0 0\n";
  for (const bool first : {true, false}) {
    LiveRun run(File(first ? "a.run" : "b.run"), scenario, {.what = {.controllers = first}});
    for (int k = 0; k < 10; ++k) {
      if (!first || k == 0) run.Command("robot1", 3, 2);
      run.Step();
    }
  }
  EXPECT_EQ(Against(File("a.run"), File("b.run")).warning,
            "the commands of controllers are recorded in " + File("a.run") +
                " only\nthe runs are equal, but their commands differ: from step 2 on " + File("b.run") +
                " also has commands that repeat those in force");
}

// --- inputs other than commands

TEST_F(CompareTest, AnotherStepLengthIsNamedFirst) {
  for (const bool longer : {false, true}) {
    LiveRun run(File(longer ? "b.run" : "a.run"), kLesson);
    Drive(run, 30);
    if (longer) run.Apply(edit::SetStep{20'000'000});
    Drive(run, 30);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.steps, 30u);
  EXPECT_EQ(report.difference->step, 31u);
  EXPECT_EQ(report.difference->what + " " + report.difference->field, "the step length_s");
  EXPECT_EQ(report.difference->recorded, "0.01");
  EXPECT_EQ(report.difference->repeated, "0.02");
  EXPECT_THAT(report.difference->note, HasSubstr("the first input that differs: " + File("a.run") +
                                                 " none, " + File("b.run") + " set_step 0.02 after step 30"));
}

TEST_F(CompareTest, RunsOfOtherStepLengthPartAtTheFirstStep) {
  for (const bool longer : {false, true}) {
    LiveRun run(File(longer ? "b.run" : "a.run"), kLesson);
    run.Apply(edit::SetStep{longer ? 20'000'000 : 5'000'000});
    run.Step(5);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 1u);
  EXPECT_EQ(report.difference->recorded, "0.005");
  EXPECT_THAT(report.difference->note,
              HasSubstr("set_step 0.005 after step 0, " + File("b.run") + " set_step 0.02 after step 0"));
}

TEST_F(CompareTest, AnInputThatSetsOtherValuesIsNamedBesides) {
  for (const bool stopped : {true, false}) {
    LiveRun run(File(stopped ? "a.run" : "b.run"), kLesson);
    Drive(run, 30);
    run.Apply(edit::SetSpeed{stopped ? 2. : 3.});  // decides when steps run, not their results
    if (stopped) run.Apply(edit::StopAll{});
    run.Step(10);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->what, "robot1");
  EXPECT_THAT(report.difference->note, HasSubstr("the first input that differs: " + File("a.run") +
                                                 " stop_all after step 30, " + File("b.run") + " none"));
}

TEST_F(CompareTest, EqualInputsAreNotNamed) {
  for (const double left_rad_s : {1, 2}) {
    LiveRun run(File(left_rad_s == 1 ? "a.run" : "b.run"), kLesson);
    run.Apply(edit::SetStep{5'000'000});
    run.Step(10);
    run.Command("robot1", left_rad_s, 1);
    run.Step(10);
  }
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->field, "left_wheel_joint_setpoint_rad_s");
  EXPECT_THAT(report.difference->note, ::testing::Not(HasSubstr("input")));
}

// --- files changed after recording

struct Changed {
  const char* name;
  const char* sql;
  const char* told;  // after the file's name
};

class ChangedCompareTest : public CompareTest, public ::testing::WithParamInterface<Changed> {};

TEST_P(ChangedCompareTest, IsToldWithFileAndRow) {
  const VerifyReport report = AgainstChanged(GetParam().sql);
  EXPECT_THAT(report.error, StartsWith(File("b.run") + GetParam().told)) << ToString(report);
  EXPECT_THAT(report.error, HasSubstr("apart from that, ")) << ToString(report);
  EXPECT_EQ(report.warning, "") << "what was commanded is not known";
}

INSTANTIATE_TEST_SUITE_P(
    All, ChangedCompareTest,
    ::testing::Values(
        Changed{"Commands",
                "UPDATE step SET commands = (SELECT commands FROM step WHERE step = 8) WHERE step = 22",
                " is damaged from step 22 on, t = 0.22 s: the row of step 22: its chain is "},
        Changed{"Poses", "UPDATE step SET poses = NULL WHERE step = 30",
                " is damaged from step 30 on, t = 0.3 s: the row of step 30: its chain is "},
        Changed{"RobotName", "UPDATE robot SET name = 'robot9' WHERE place = 1",
                " is damaged from step 0 on, t = 0 s: scene "},
        Changed{"Note", "UPDATE event SET text = 'look away' WHERE text = 'look'",
                " is damaged from step 20 on, t = 0.2 s: event 1: its chain is "},
        Changed{
            "FakeNote", "INSERT INTO event SELECT 9, step, time_ns, level, text, chain FROM event",
            " is damaged from step 20 on, t = 0.2 s: event 2: it is missing, event 9 was not written after "
            "event 1"},
        Changed{"NoteOut", "DELETE FROM event", ": its table event ends with row 0"},
        Changed{"StepOut", "DELETE FROM step WHERE step = 40",
                " is damaged from step 41 on, t = 0.41 s: the row of step 41: its chain is "},
        Changed{"Seal", "UPDATE meta SET value = '2001-01-01T00:00:00Z' WHERE key = 'started'",
                ": its table meta was changed after it was written: it is damaged"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(CompareTest, ADifferenceIsToldBeforeTheDamage) {
  const VerifyReport report = AgainstChanged(
      "UPDATE step SET hash = hash + 1 WHERE step = 50; UPDATE step SET commands = NULL WHERE step = 28");
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 50u);
  EXPECT_EQ(report.error, "");
  EXPECT_THAT(report.warning, HasSubstr(File("b.run") + " is damaged from step 28 on"));
}

TEST_F(CompareTest, BothFilesAreLookedAt) {
  AgainstChanged("UPDATE step SET chain = 1 WHERE step = 12");
  Tamper(File("a.run")).Run("UPDATE step SET chain = 1 WHERE step = 33");
  const VerifyReport report = Against(File("a.run"), File("b.run"));
  EXPECT_THAT(report.error, HasSubstr(File("a.run") + " is damaged from step 33 on"));
  EXPECT_THAT(report.error, HasSubstr(File("b.run") + " is damaged from step 12 on"));
  EXPECT_THAT(report.error, EndsWith("apart from that, 60 steps are equal"));
}

TEST_F(CompareTest, AFileWithoutChainsIsRefused) {
  const VerifyReport report = AgainstChanged("ALTER TABLE step DROP COLUMN chain");
  EXPECT_THAT(report.error, HasSubstr("b.run"));
  EXPECT_THAT(report.error, HasSubstr("record it again"));
}

}  // namespace
}  // namespace coopdyn
