// SPDX-License-Identifier: MIT
// `controller NAME option=value` of robots and swarms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/server/model/read_text.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// A folder with controllers and a library that finds them, in addition to the shipped robots.
class ControllerLineTest : public ::testing::Test {
 protected:
  ControllerLineTest() : library_(SearchPath{{SourceDir(), folder_.path() / "path"}}) {
    folder_.Write("path/controllers/diffuse.so", "");
    folder_.Write("path/wander.so", "");
    folder_.Write("beside/controllers/mine.so", "");
    folder_.Write("beside/flat.so", "");
    folder_.Write("elsewhere/other.so", "");
  }

  /// The reader's result for a robot with `line` as its fourth line.
  std::shared_ptr<const Scenario> Read(const std::string& line, bool by_socket = false) {
    Diagnostics diagnostics;
    const std::string file = by_socket ? "(text)" : (folder_.path() / "beside/a.scenario").string();
    auto scenario = ReadScenario("[ROBOT_1]\ntype single\nposition 1 2\n" + line + "\n", file, library_,
                                 by_socket, diagnostics);
    messages_ = folder_.Strip(diagnostics.ToString());
    return scenario;
  }
  std::string Messages(const std::string& line, bool by_socket = false) {
    EXPECT_EQ(Read(line, by_socket), nullptr) << line;
    return messages_;
  }
  ControllerChoice Choice(const std::string& line, bool by_socket = false) {
    const auto scenario = Read(line, by_socket);
    EXPECT_EQ(messages_, "") << line;
    return scenario == nullptr ? ControllerChoice() : scenario->robots.at(0).controller;
  }

  TempFolder folder_;
  RobotLibrary library_;
  std::string messages_;
};

TEST_F(ControllerLineTest, BareNamesAreFoundBesideTheScenarioAndOnThePath) {
  for (const auto& [name, file] :
       {std::pair("diffuse", "path/controllers/diffuse.so"), std::pair("wander", "path/wander.so"),
        std::pair("mine", "beside/controllers/mine.so"), std::pair("flat", "beside/flat.so")}) {
    const ControllerChoice choice = Choice(std::string("controller ") + name);
    EXPECT_EQ(choice.name, name);
    EXPECT_EQ(folder_.Strip(choice.file), file);
    EXPECT_EQ(choice.where.line, 4);
  }
}

TEST_F(ControllerLineTest, PathsStartAtTheScenariosFolder) {
  for (const char* written : {"../elsewhere/other.so", "../elsewhere/other", "..\\elsewhere\\other"}) {
    const ControllerChoice choice = Choice(std::string("controller ") + written);
    EXPECT_EQ(choice.name, "other");
    EXPECT_EQ(folder_.Strip(choice.file), "elsewhere/other.so");
  }
  EXPECT_THAT(Messages("controller ./other"),
              HasSubstr("there is no controller './other': the file beside/other.so is missing"));
}

TEST_F(ControllerLineTest, ARobotWithAControllerIsNotWaitedFor) {
  EXPECT_FALSE(Read("controller diffuse")->robots.at(0).participates());
  EXPECT_TRUE(Read("color red")->robots.at(0).participates());
}

TEST_F(ControllerLineTest, OptionsAreInSiUnitsInFileOrder) {
  const ControllerChoice choice = Choice("controller = diffuse speed=20cm Turn=90deg rate=3 wait_for=500ms");
  EXPECT_THAT(choice.options, ElementsAre(Pair("speed", 0.2), Pair("turn", std::numbers::pi / 2),
                                          Pair("rate", 3), Pair("wait_for", 0.5)));
}

TEST_F(ControllerLineTest, MisspeltNamesAreGuessed) {
  EXPECT_EQ(
      Messages("controller difuse speed=1"),
      "beside/a.scenario:4: error: there is no controller 'difuse' beside the scenario or on the search "
      "path; did you mean 'diffuse'? There are diffuse, flat, mine and wander\n");
}

TEST_F(ControllerLineTest, WithoutAnyControllersItSaysHowToNameTheirFolder) {
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  folder_.Write("alone/a.scenario", "");
  ReadScenario("[ROBOT_1]\ntype single\nposition 1 2\ncontroller walk\n",
               (folder_.path() / "alone/a.scenario").string(), library, false, diagnostics);
  EXPECT_THAT(diagnostics.ToString(),
              HasSubstr("there is no controller 'walk' beside the scenario or on the search path; none is "
                        "there: coopdyn's own are in the folder controllers of its build, which --scenarios "
                        "FOLDER or COOPDYN_PATH adds; coopdyn new-controller NAME writes a start\n"));
}

TEST_F(ControllerLineTest, OverASocketOnlyBareNamesOnThePath) {
  EXPECT_EQ(folder_.Strip(Choice("controller diffuse", true).file), "path/controllers/diffuse.so");
  EXPECT_THAT(Messages("controller mine", true),
              HasSubstr("there is no controller 'mine' on the search path"));
  for (const char* written : {"./mine", "/tmp/evil.so", "..\\evil"}) {
    EXPECT_THAT(Messages(std::string("controller ") + written, true), HasSubstr("by the bare name of one"));
  }
}

TEST_F(ControllerLineTest, MalformedOptionsSayWhatToWrite) {
  for (const char* options : {"speed", "speed=", "speed 0.2", "=3", "2x=1", "speed = 0.2"}) {
    EXPECT_THAT(Messages(std::string("controller diffuse ") + options),
                HasSubstr("options are written name=value without spaces, for example: controller diffuse "
                          "speed=0.2"))
        << options;
  }
  EXPECT_THAT(Messages("controller diffuse speed=fast"), HasSubstr("option 'speed': 'fast' is not a number"));
  EXPECT_THAT(Messages("controller diffuse speed=0,5"), HasSubstr("write 0.5 for one number"));
  EXPECT_THAT(Messages("controller diffuse speed=2km"),
              HasSubstr("units here are m, cm, mm, rad, deg, kg, g, s and ms"));
  EXPECT_THAT(Messages("controller diffuse speed=inf"), HasSubstr("is not a finite number"));
  EXPECT_THAT(Messages("controller diffuse a=1 a=2"), HasSubstr("option 'a' stands twice"));
}

TEST_F(ControllerLineTest, WaitingContradictsIt) {
  EXPECT_EQ(Messages("controller diffuse\nsync yes"),
            "beside/a.scenario:5: error: 'sync' contradicts 'controller': a robot that the daemon drives "
            "itself is not waited for; keep one of the two lines\n");
  EXPECT_THAT(Messages("waits_for motors\ncontroller diffuse"),
              HasSubstr(":4: error: 'waits_for' contradicts"));
  Choice("controller diffuse\nsync no");
  EXPECT_NE(Read("controller diffuse\ndeadline 1s"), nullptr);
  EXPECT_THAT(messages_, HasSubstr(":5: warning: 'deadline' has no effect as long as the controller drives"));
}

TEST_F(ControllerLineTest, SwarmsHaveTheSameOne) {
  Diagnostics diagnostics;
  const auto scenario = ReadScenario("[SWARM_1]\ntype coopbot\ncount 3\ncontroller diffuse speed=0.1\n",
                                     "a.scenario", library_, false, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  for (const RobotEntry& robot : scenario->robots) {
    EXPECT_EQ(robot.controller.name, "diffuse");
    EXPECT_THAT(robot.controller.options, ElementsAre(Pair("speed", 0.1)));
  }
}

TEST_F(ControllerLineTest, OfARecordingItMayBeGone) {
  const std::string text = "[ROBOT_1]\ntype single\nposition 1 2\ncontroller ";
  Diagnostics none;
  const auto robot = library_.Get("coopbot", {}, none);
  ASSERT_NE(robot, nullptr);
  RobotLibrary library(library_.path(), {{"robot", "coopbot", robot->file, robot->text}});
  for (const auto& [written, name, file] :
       {std::tuple("diffuse", "diffuse", "path/controllers/diffuse.so"), std::tuple("gone", "gone", ""),
        std::tuple("./gone speed=1", "gone", ""),
        std::tuple("../far/wander.so", "wander", "path/wander.so")}) {
    Diagnostics diagnostics;
    const auto scenario = ReadScenario(text + written + "\n", (folder_.path() / "a.scenario").string(),
                                       library, false, diagnostics);
    ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
    const ControllerChoice& choice = scenario->robots.at(0).controller;
    EXPECT_EQ(choice.name, name);
    EXPECT_EQ(folder_.Strip(choice.file), file);
    EXPECT_EQ(diagnostics.all().size(), *file == 0 ? 1u : 0u) << diagnostics.ToString();
  }
}

}  // namespace
}  // namespace coopdyn
