// SPDX-License-Identifier: MIT
// --set SECTION.key=value, applied to scenarios as texts.
#include "server/model/settings.h"

#include <gtest/gtest.h>

#include "server/model/readers.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

constexpr const char* kSettings =
    "[ROBOT_1]\ntype coopbot\nposition 1 2\ncolor red\n[Wall_1]\ntype box\nsize 1 2 3\nposition 4 4\n";

struct Set {
  std::shared_ptr<const Scenario> scenario;
  std::string said;
};

Set ReadWith(const Settings& settings, const std::string& text = kSettings) {
  Diagnostics diagnostics;
  const std::string whole = WithSettings(text, settings, diagnostics);
  auto scenario = ReadScenario(whole, "lesson.scenario", ShippedRobots(), true, diagnostics);
  return {diagnostics.has_errors() ? nullptr : scenario, diagnostics.ToString()};
}

TEST(SettingsTest, ASettingTakesThePlaceOfTheKey) {
  const Set read = ReadWith({"ROBOT_1.position=5 6", "wall_1.SIZE=2 2 2"});
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->robots[0].X_WR.p, Vector3(5, 6, 0));
  EXPECT_EQ(std::get<Box>(read.scenario->objects[0].shape).size_m, Vector3(2, 2, 2));
}

TEST(SettingsTest, AKeyThatIsNotThereIsAdded) {
  const Set read = ReadWith({"ROBOT_1.name=ana"});
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->robots[0].name, "ana");
}

TEST(SettingsTest, OptionalSectionsAreMade) {
  const Set read =
      ReadWith({"SIMULATION.step=0.02", "FLOOR.size=30 30", "TARGET.red=3 1", "SIMULATION.mode=free"});
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->simulation.step, 20'000'000);
  EXPECT_EQ(read.scenario->simulation.mode, Mode::kFree);
  EXPECT_EQ(read.scenario->floor.length_m, 30);
  EXPECT_EQ(read.scenario->targets.size(), 1u);
}

TEST(SettingsTest, AnEmptyValueTakesTheKeyAway) {
  const Set read = ReadWith({"ROBOT_1.color="});
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->robots[0].color, RobotEntry().color);
}

TEST(SettingsTest, TheLastOfTwoForOneKeyCounts) {
  const Set read = ReadWith({"ROBOT_1.name=ana", "ROBOT_1.name=eva"});
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->robots[0].name, "eva");
}

TEST(SettingsTest, TheTextCarriesItsSettings) {
  Diagnostics diagnostics;
  std::string text = WithSettings(kSettings, {"ROBOT_1.position=5 6"}, diagnostics);
  text = WithSettings(text, {"ROBOT_1.name=ana"}, diagnostics);
  EXPECT_EQ(SettingsIn(text), (Settings{"robot_1.position=5 6", "robot_1.name=ana"}));
  const Set again = ReadWith({}, text);
  ASSERT_NE(again.scenario, nullptr) << again.said;
  EXPECT_EQ(again.scenario->robots[0].name, "ana");
  EXPECT_EQ(again.scenario->text, text);
}

TEST(SettingsTest, RobotsMeansEachRobotAndSwarm) {
  const Set read = ReadWith({"ROBOTS.fidelity=rolling"},
                            std::string(kSettings) + "[SWARM_1]\ntype single\ncount 2\nname s\n");
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->robots[0].fidelity, Fidelity::kRolling);
  EXPECT_EQ(read.scenario->robots.back().fidelity, Fidelity::kRolling);
}

TEST(SettingsTest, RobotsOfAScenarioWithoutAnyIsAMistake) {
  const Set read = ReadWith({"ROBOTS.color=red"}, "[WORLD]\nfile empty.world\n");
  EXPECT_NE(read.said.find("--set ROBOTS.color=red: error: the scenario has no [ROBOT_n] and no [SWARM_n]"),
            std::string::npos)
      << read.said;
}

TEST(SettingsTest, ATextKeepsTheNameOfItsFile) {
  const Set read = ReadWith({"ROBOT_1.name=ana"}, std::string(kSettings) + "# file: lesson.scenario\n");
  ASSERT_NE(read.scenario, nullptr) << read.said;
  EXPECT_EQ(read.scenario->name, "lesson");
}

TEST(SettingsTest, WithoutSettingsTheTextIsTheSame) {
  Diagnostics diagnostics;
  EXPECT_EQ(WithSettings(kSettings, {}, diagnostics), kSettings);
}

struct Wrong {
  const char* setting;
  const char* said;
};

class WrongSettingTest : public testing::TestWithParam<Wrong> {};

TEST_P(WrongSettingTest, IsToldWithWhatToWrite) {
  const Set read = ReadWith({GetParam().setting});
  EXPECT_EQ(read.scenario, nullptr);
  EXPECT_EQ(read.said, std::string("--set ") + GetParam().said + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    , WrongSettingTest,
    testing::Values(
        Wrong{"ROBOT_1",
              "ROBOT_1: error: a setting is SECTION.key=value, for example: --set SWARM_1.count=20"},
        Wrong{"ROBOT_1.name",
              "ROBOT_1.name: error: a setting is SECTION.key=value, for example: --set SWARM_1.count=20"},
        Wrong{".name=a",
              ".name=a: error: a setting is SECTION.key=value, for example: --set SWARM_1.count=20"},
        Wrong{"ROBOT_1.=a",
              "ROBOT_1.=a: error: a setting is SECTION.key=value, for example: --set SWARM_1.count=20"},
        Wrong{
            "ROBOT_1.name=a # b",
            "ROBOT_1.name=a # b: error: a setting is SECTION.key=value, for example: --set SWARM_1.count=20"},
        Wrong{"ROBOT_2.name=a",
              "ROBOT_2.name=a: error: the scenario has no section [ROBOT_2]; did you mean 'ROBOT_1'?"},
        Wrong{"ROBOT_1.positon=1 2",
              "ROBOT_1.positon=1 2: error: unknown word 'positon' in [ROBOT_1]; did you mean 'position'?"},
        Wrong{"ROBOT_1.position=here", "ROBOT_1.position=here: error: 'position': 'here' is not a number"},
        Wrong{"ROBOT_1.colr=",
              "ROBOT_1.colr=: error: [ROBOT_1] has no 'colr' to be taken away; did you mean 'color'?"},
        Wrong{"TARGET.rde=1 2",
              "TARGET.rde=1 2: error: unknown colour 'rde' in [TARGET]; did you mean 'red'?"}));

TEST(SettingsTest, LinesOfTheFileStayInMessages) {
  const Set read =
      ReadWith({"ROBOT_1.name=ana"}, std::string(kSettings) + "[BALL]\ntype sphere\nsize x\nposition 0 0\n");
  EXPECT_EQ(read.said.substr(0, 26), "lesson.scenario:11: error:") << read.said;
}

TEST(SettingsTest, AKeyThatStandsTwiceIsNotSet) {
  const Set read = ReadWith({"TARGET.red=1 1"}, std::string(kSettings) + "[TARGET]\nred 0 0\nred 2 2\n");
  EXPECT_EQ(
      read.said,
      "--set TARGET.red=1 1: error: 'red' stands 2 times in [TARGET]: change the scenario's file instead\n");
}

}  // namespace
}  // namespace coopdyn
