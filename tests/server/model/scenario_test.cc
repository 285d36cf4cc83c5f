// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "server/model/scenario.h"
#include "tests/server/model/read_text.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kData = SourceDir() + "/tests/server/model/data/";
const std::string kRobot = "[ROBOT_1]\ntype single\nposition 0 0\n";

ReadResult Load(const std::string& file) {
  Diagnostics diagnostics;
  auto scenario = LoadScenario(file, ShippedRobots(), diagnostics);
  return {scenario, diagnostics.ToString()};
}

/// The messages for a.scenario with text `scenario`, beside a world `name` with text `world`; both without
/// their folder.
ReadResult LoadBeside(const TempFolder& folder, const std::string& name, const std::string& world,
                      const std::string& scenario) {
  folder.Write(name, world);
  ReadResult result = Load(folder.Write("a.scenario", scenario));
  result.messages = folder.Strip(result.messages);
  return result;
}

TEST(PaperFilesTest, FilledInTemplatesLoadUnchanged) {
  const auto [scenario, messages] = Load(kData + "paper.scenario");
  EXPECT_EQ(messages, "");
  ASSERT_NE(scenario, nullptr);
  EXPECT_EQ(scenario->name, "paper");
  EXPECT_EQ(scenario->floor.length_m, 10);
  ASSERT_EQ(scenario->objects.size(), 4u);
  EXPECT_TRUE(scenario->objects[0].is_static());
  EXPECT_EQ(scenario->objects[1].mass_kg, 5);
  EXPECT_DOUBLE_EQ(std::get<Sphere>(scenario->objects[2].shape).radius_m, 0.25);
  EXPECT_EQ(scenario->objects[3].name, "carrier_bar");
  ASSERT_EQ(scenario->targets.size(), 2u);
  EXPECT_EQ(scenario->targets[0].color_name, "red");
  EXPECT_EQ(scenario->targets[1].color_name, "green");
  EXPECT_EQ(scenario->targets[1].p_WT, Vector3(-3, 2, 0));
  ASSERT_EQ(scenario->robots.size(), 3u);
  EXPECT_EQ(scenario->robots[0].model->type, "coopbot");
  EXPECT_EQ(scenario->robots[0].color, (Color{1, 0, 0}));
}

TEST(PaperFilesTest, Team2IsALeaderAndAHelperBehind) {
  const auto [scenario, messages] = Load(kData + "paper.scenario");
  ASSERT_NE(scenario, nullptr);
  const RobotEntry& leader = scenario->robots.at(1);
  const RobotEntry& helper = scenario->robots.at(2);
  EXPECT_EQ(leader.name, "carrier_leader");
  EXPECT_EQ(helper.name, "carrier_helper");
  EXPECT_LT((leader.X_WR.Inverse() * helper.X_WR.p - Vector3(-1.2, 0, 0)).norm(), 1e-9);
  EXPECT_NEAR(Heading(helper.X_WR.q), Heading(leader.X_WR.q), 1e-12);
}

TEST(PaperFilesTest, WindowsLineEndsLatin1AndPathsLoadTheSame) {
  const auto [scenario, messages] = Load(kData + "windows.scenario");
  EXPECT_EQ(messages, "");
  ASSERT_NE(scenario, nullptr);
  const auto other = Load(kData + "paper.scenario").scenario;
  EXPECT_EQ(scenario->objects.size(), other->objects.size());
  EXPECT_EQ(scenario->robots.size(), other->robots.size());
  EXPECT_EQ(Summary(*scenario), Summary(*other));
}

TEST(DiagnosticsTest, TenMistakesGiveTenDiagnosticsInOneGo) {
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(FileText("tests/server/model/data/ten_mistakes.scenario"),
                                     "ten_mistakes.scenario", ShippedRobots(), false, diagnostics);
  EXPECT_EQ(scenario, nullptr);
  EXPECT_EQ(diagnostics.errors(), 10);
  EXPECT_EQ(diagnostics.ToString(), FileText("tests/server/model/data/ten_mistakes.expected"));
}

TEST(ScenarioTest, EmptyTextIsAnEmptyWorld) {
  const auto scenario = Good("");
  EXPECT_EQ(scenario->robots.size(), 0u);
  EXPECT_EQ(scenario->floor.length_m, 20);
  EXPECT_EQ(scenario->simulation.seed, 1u);
  EXPECT_FALSE(scenario->simulation.mode);
}

TEST(ScenarioTest, OneFileCanBeAWholeLesson) {
  const auto scenario = Good("[FLOOR]\nsize 4 4 0.1\n[BOX_1]\ntype box\nsize 1 1 1\nposition 1 1\n" + kRobot +
                             "[TARGET]\nred 1 0 0\nred -1 0\n");
  EXPECT_EQ(scenario->floor.length_m, 4);
  EXPECT_EQ(scenario->objects.size(), 1u);
  EXPECT_EQ(scenario->targets.size(), 2u);
  EXPECT_EQ(scenario->robots.at(0).name, "robot1");
  EXPECT_EQ(scenario->robots.at(0).id, RobotId{1});
  EXPECT_EQ(scenario->targets.at(1).id, TargetId{2});
}

TEST(SimulationTest, AllWords) {
  const auto scenario = Good(
      "[SIMULATION]\nmode Lockstep\nstep 50ms\nsubsteps 10\nseed 18446744073709551615\nspeed 2.5\nduration "
      "60\n"
      "gravity 1.62\nangles deg\n[ROBOT]\ntype single\nposition 0 0\norientation 90\n");
  const SimulationOptions& options = scenario->simulation;
  EXPECT_EQ(options.mode, Mode::kLockstep);
  EXPECT_EQ(options.step, 50'000'000);
  EXPECT_EQ(options.substeps, 10);
  EXPECT_EQ(options.seed, 18446744073709551615u);
  EXPECT_EQ(options.speed, 2.5);
  EXPECT_EQ(options.duration_s, 60);
  EXPECT_EQ(options.g_W, Vector3(0, 0, -1.62));
  EXPECT_NEAR(Heading(scenario->robots.at(0).X_WR.q), std::numbers::pi / 2, 1e-12);
}

TEST(SimulationTest, StepIsBetweenHalfAndAHundredMilliseconds) {
  EXPECT_EQ(Good("[SIMULATION]\nstep 0.5ms\n")->simulation.step, kMinStep);
  EXPECT_EQ(Good("[SIMULATION]\nstep 0.1\n")->simulation.step, kMaxStep);
  EXPECT_EQ(Good("[SIMULATION]\nstep 0.0105\n")->simulation.step, 10'500'000);
  for (const char* step : {"0.4ms", "101ms", "10", "0", "-1", "1e-300", "1e300"}) {
    EXPECT_THAT(Read(std::string("[SIMULATION]\nstep ") + step).messages, HasSubstr(":2: error: 'step' must"))
        << step;
  }
}

TEST(SimulationTest, StepIsWholeMicroseconds) {
  EXPECT_THAT(Read("[SIMULATION]\nstep 10.0005ms\n").messages,
              HasSubstr("must be whole microseconds, not 10000.5"));
}

TEST(SimulationTest, SubstepsAreAtMostTenMilliseconds) {
  EXPECT_THAT(Read("[SIMULATION]\nstep 50ms\nsubsteps 4\n").messages, HasSubstr("needs at least 5 substeps"));
  EXPECT_THAT(Read("[SIMULATION]\nsubsteps 0\n").messages, HasSubstr("whole number from 1"));
  EXPECT_THAT(Read("[SIMULATION]\nsubsteps 1.5\n").messages, HasSubstr("whole number from 1"));
}

TEST(SimulationTest, GravityIsOneNumberDownwardsOrAVector) {
  EXPECT_EQ(Good("[SIMULATION]\ngravity 0\n")->simulation.g_W, Vector3::Zero());
  EXPECT_EQ(Read("[SIMULATION]\ngravity -9.81\n").messages,
            "test.scenario:2: warning: 'gravity' counts downwards, so things fall up with -9.81 m/s²: write "
            "9.81 if "
            "they should fall down\n");
  EXPECT_THAT(Read("[SIMULATION]\ngravity -1001\n").messages, HasSubstr("must be at least -1000"));
  EXPECT_EQ(Good("[SIMULATION]\ngravity 1 -2 -9.81\n")->simulation.g_W, Vector3(1, -2, -9.81));
  EXPECT_THAT(Read("[SIMULATION]\ngravity 0 0 -1001\n").messages, HasSubstr("must be at least -1000"));
  EXPECT_THAT(Read("[SIMULATION]\ngravity 0 -9.81\n").messages,
              HasSubstr("needs 1 or 3 numbers (m/s² downwards, or x y z of the acceleration), not 2"));
}

TEST(SimulationTest, SpeedBelowZeroMeansNoLimit) {
  EXPECT_EQ(Good("[SIMULATION]\nspeed 0\n")->simulation.speed, 0);
  EXPECT_EQ(Good("[SIMULATION]\nspeed -1\n")->simulation.speed, -1);
}

TEST(SimulationTest, MisspeltSectionIsGuessed) {
  EXPECT_THAT(Read("[SIMULATON]\nmode free\n").messages, HasSubstr("did you mean [SIMULATION]?"));
}

TEST(TaskTest, LinesAreParagraphsAndThoseWithADashAList) {
  const auto scenario = Good(
      "[TASK]\ntitle Reach the red target\ntext Drive **there**.\ntext - slowly\ntext - gently\ntext Then "
      "stop.\n"
      "hint Look first.\nhint Turn left.\ncounts 2 points: arrived\n");
  EXPECT_EQ(scenario->task.title, "Reach the red target");
  EXPECT_EQ(scenario->task.text, "Drive **there**.\n\n- slowly\n- gently\n\nThen stop.");
  EXPECT_EQ(scenario->task.hints, (std::vector<std::string>{"Look first.", "Turn left."}));
  EXPECT_EQ(scenario->task.counts, (std::vector<std::string>{"2 points: arrived"}));
}

TEST(TaskTest, UnknownKeysAreGuessedAndTooMuchTextIsRefused) {
  EXPECT_THAT(Read("[TASK]\nhits Look\n").messages,
              HasSubstr("unknown key 'hits' in [TASK]; did you mean 'hint'?"));
  EXPECT_THAT(Read("[TASK]\ntitle a\ntitle b\n").messages, HasSubstr("[TASK] has one title"));
  std::string hints = "[TASK]\n";
  for (int i = 0; i < 25; ++i) hints += "hint more\n";
  EXPECT_THAT(Read(hints).messages, HasSubstr("at most 20000 bytes of text, 20 hints"));
}

TEST(ViewTest, ItIsANamedOneOrACameraAndWhatItLooksAt) {
  EXPECT_EQ(Good("[FLOOR]\n")->view.from, View::From::kWhole);
  const auto named = Good("[VIEW]\nfrom Top\n");
  EXPECT_EQ(named->view.from, View::From::kTop);
  EXPECT_FALSE(named->view.look_W);
  const auto placed = Good("[VIEW]\neye 3 -200cm 2\nlook 0 0 0.2\n");
  EXPECT_EQ(placed->view.eye_W, Vector3(3, -2, 2));
  EXPECT_EQ(placed->view.look_W, Vector3(0, 0, 0.2));
}

TEST(ViewTest, HalfAViewIsRefused) {
  for (const char* keys :
       {"", "eye 3 -2 2\n", "look 0 0 0\n", "from top\neye 3 -2 2\nlook 0 0 0\n", "from top\nlook 0 0 0\n"})
    EXPECT_THAT(Read(std::string("[VIEW]\n") + keys).messages, HasSubstr("says either 'from' (whole, top"))
        << keys;
  EXPECT_THAT(Read("[VIEW]\neye 1 1 1\nlook 1 1 1\n").messages,
              HasSubstr("'eye' must be at least 1 cm away from 'look'"));
  EXPECT_THAT(Read("[VIEW]\nfrom topp\n").messages, HasSubstr("top"));
}

TEST(TargetTest, ColoursRepeatAndNumbersTakeAPalette) {
  const auto scenario = Good("[TARGET]\nred 1 0 0\nred 2 0 0\ncolor_3 3 0 0\n");
  ASSERT_EQ(scenario->targets.size(), 3u);
  EXPECT_EQ(scenario->targets[1].color_name, "red");
  EXPECT_EQ(scenario->targets[2].color_name, "blue");
  EXPECT_EQ(scenario->targets[2].color, (Color{0, 0, 1}));
}

TEST(TargetTest, UnknownColourIsGuessed) {
  EXPECT_THAT(Read("[TARGET]\ngren 1 0 0\n").messages, HasSubstr("did you mean 'green'?"));
  EXPECT_THAT(Read("[TARGET]\ncolor_0 1 0 0\n").messages, HasSubstr("unknown colour 'color_0'"));
  EXPECT_THAT(Read("[TARGET]\nred 1\n").messages,
              HasSubstr(":2: error: 'red' needs 2 or 3 numbers (x y, or x y z)"));
}

TEST(FloorTest, FloorInBothFilesIsAnError) {
  const TempFolder folder;
  const ReadResult result = LoadBeside(folder, "a.world", "[FLOOR]\nsize 4 4 0.1\n",
                                       "[WORLD]\nfile a.world\n[FLOOR]\nsize 5 5 0.1\n");
  EXPECT_THAT(
      result.messages,
      HasSubstr("a.scenario:3: error: [FLOOR] stands in the world too (a.world:1): keep one of them"));
}

TEST(WorldFileTest, ObjectsOfTheWorldComeFirst) {
  const TempFolder folder;
  const ReadResult result = LoadBeside(folder, "a.world", "[B]\ntype box\nsize 1 1 1\nposition 0 0\n",
                                       "[A]\ntype box\nsize 1 1 1\nposition 3 0\n[WORLD]\nfile a\n");
  EXPECT_EQ(result.messages, "");
  ASSERT_NE(result.scenario, nullptr);
  EXPECT_EQ(result.scenario->objects.at(0).name, "B");
  EXPECT_EQ(result.scenario->objects.at(1).name, "A");
  EXPECT_EQ(folder.Strip(result.scenario->world.file), "a.world");
}

TEST(WorldFileTest, OneNameInBothFilesIsAnError) {
  const TempFolder folder;
  const ReadResult result = LoadBeside(folder, "a.world", "[B]\ntype box\nsize 1 1 1\nposition 0 0\n",
                                       "[WORLD]\nfile a\n[b]\ntype box\nsize 1 1 1\nposition 3 0\n");
  EXPECT_THAT(result.messages, HasSubstr("a.scenario:3: error: [b] stands in the world too"));
}

TEST(WorldFileTest, MistakesInTheWorldAreNamedThere) {
  const TempFolder folder;
  const ReadResult result =
      LoadBeside(folder, "a.world", "[B]\ntype bx\nsize 1 1 1\nposition 0 0\n", "[WORLD]\nfile a.world\n");
  EXPECT_EQ(result.messages, "a.world:2: error: 'type' cannot be 'bx'; did you mean 'box'?\n");
}

TEST(WorldFileTest, NamesMayHoldSpacesAndBackslashes) {
  const TempFolder folder;
  const ReadResult result = LoadBeside(folder, "my worlds/big arena.world", "[FLOOR]\nsize 7 7\n",
                                       "[WORLD]\nfile my worlds\\big arena.world # here\n");
  EXPECT_EQ(result.messages, "");
  ASSERT_NE(result.scenario, nullptr);
  EXPECT_EQ(result.scenario->floor.length_m, 7);
}

TEST(WorldFileTest, MissingAbsolutePathIsTriedByItsBaseName) {
  const TempFolder folder;
  folder.Write("arena.world", "[FLOOR]\nsize 7 7\n");
  for (const char* path : {"/no/such/folder/arena.world", "D:\\lab\\arena.world"}) {
    EXPECT_EQ(Load(folder.Write("a.scenario", std::string("[WORLD]\nfile ") + path)).messages, "") << path;
  }
}

TEST(WorldFileTest, AWorldLoadsAsAScenarioWithoutRobots) {
  const ReadResult result = Load(kData + "arena.world");
  EXPECT_EQ(result.messages, "");
  ASSERT_NE(result.scenario, nullptr);
  EXPECT_EQ(Summary(*result.scenario),
            "no robots, 3 objects (1 static), no targets, floor 10 x 8 m, realtime 10 ms");
  // The stored text reads back the same.
  EXPECT_EQ(Good(result.scenario->text)->objects.size(), 3u);
}

TEST(BySocketTest, WorldsAreNamedByBareName) {
  for (const char* name : {"/etc/passwd", "../x.world", "..\\x", "C:\\x.world", "a/b"}) {
    EXPECT_THAT(Read(std::string("[WORLD]\nfile ") + name, true).messages, HasSubstr("bare name")) << name;
  }
  EXPECT_EQ(Read("[WORLD]\nfile corridor\n", true).messages, "");
}

TEST(BySocketTest, TextHasNoFile) {
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(kRobot, "", ShippedRobots(), true, diagnostics);
  ASSERT_NE(scenario, nullptr);
  EXPECT_EQ(scenario->name, "(text)");
  EXPECT_EQ(scenario->file, "");
  EXPECT_EQ(scenario->text, kRobot);
}

TEST(BySocketTest, TheLastLineOfATextTellsItsName) {
  const auto name = [](const std::string& last_line) {
    Diagnostics diagnostics;
    const auto scenario = ReadScenario(kRobot + last_line, "(text)", ShippedRobots(), true, diagnostics);
    return scenario == nullptr ? diagnostics.ToString() : scenario->name;
  };
  EXPECT_EQ(name("\n# file: lesson 1.scenario\n"), "lesson 1");
  EXPECT_EQ(name("\r\n# file: C:\\lessons\\fünf.world"), "fünf");
  EXPECT_EQ(name("\n# file: ../../etc/passwd\n"), "passwd");
  EXPECT_EQ(name("\n# file: a\x1b[31m.scenario\n"), "(text)");
  EXPECT_EQ(name("\n# file: " + std::string(300, 'a') + "\n"), "(text)");
  EXPECT_EQ(name("\n# file: \n"), "(text)");
  EXPECT_EQ(name("\n# file: lesson.scenario\n# more\n"), "(text)");
}

TEST(BySocketTest, ScenariosAreNamedByBareName) {
  Diagnostics diagnostics;
  EXPECT_EQ(LoadScenario("../scenarios/classroom", ShippedRobots(), diagnostics, true), nullptr);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("bare name"));
  Diagnostics good;
  EXPECT_NE(LoadScenario("classroom", ShippedRobots(), good, true), nullptr);
}

TEST(LoadTest, MissingScenarioIsGuessed) {
  const ReadResult result = Load("classrom");
  EXPECT_EQ(result.messages, "classrom: error: there is no such scenario; did you mean 'classroom'?\n");
}

TEST(LoadTest, FolderIsNoScenario) {
  EXPECT_NE(Load(kData).messages, "");
}

}  // namespace
}  // namespace coopdyn
