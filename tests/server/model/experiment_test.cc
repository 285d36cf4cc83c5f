// SPDX-License-Identifier: MIT
// An experiment of YARS as a scenario.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/readers.h"
#include "server/model/settings.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kXml =
    "<rosiml version=\"1.0\">\n<environment>\n<sphere name=\"ball\" radius=\"0.1\" mass=\"1\">\n"
    "<pose x=\"2\" z=\"0.1\"/><randomise x=\"1 3\"/>\n</sphere>\n</environment>\n<movables>\n"
    "<movable name=\"m\" type=\"active\">\n<body><object name=\"a\" mass=\"1\"><pose z=\"0.5\"/>"
    "<sphere radius=\"0.5\"/></object></body>\n</movable>\n</movables>\n</rosiml>\n";

SearchPath Shipped() {
  return {{SourceDir()}};
}

TEST(ExperimentTest, ItsKeptTextIsTheXmlAndItsRobotsAreSources) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(kXml, "x.xml", robots, false, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->text, kXml);
  ASSERT_EQ(scenario->sources.size(), 1u);
  EXPECT_EQ(scenario->sources[0].name, "x.m");
}

TEST(ExperimentTest, ItsTextAndSourcesGiveTheSameScenarioAgain) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const auto first = ReadScenario(kXml, "x.xml", robots, false, diagnostics, 7);
  ASSERT_NE(first, nullptr) << diagnostics.ToString();
  RobotLibrary embedded(SearchPath{}, first->sources);
  const auto again = ReadScenario(first->text, first->file, embedded, false, diagnostics, 7);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  ASSERT_EQ(again->objects.size(), 1u);
  EXPECT_EQ(again->objects[0].X_WO.p, first->objects[0].X_WO.p);
  EXPECT_EQ(again->robots[0].model->text, first->robots[0].model->text);
}

TEST(ExperimentTest, WhatIsDrawnStandsClearWhateverTheLineBreaks) {
  std::string lines = "<rosiml version=\"1.0\">\n<environment>\n";
  for (int i = 0; i < 4; ++i) {
    lines += "<box name=\"b" + std::to_string(i) + "\" width=\"0.5\" depth=\"0.5\" height=\"1\">\n" +
             "<pose z=\"0.5\"/><randomise x=\"0 1.5\" y=\"0 1.5\"/></box>\n";
  }
  lines +=
      "</environment>\n<movables><movable name=\"m\" type=\"passive\"><body><object name=\"o\" mass=\"1\">\n"
      "<pose x=\"5\" z=\"0.1\"/><sphere radius=\"0.1\"/></object></body></movable></movables>\n</rosiml>\n";
  std::string one_line = lines;
  std::erase(one_line, '\n');
  RobotLibrary robots(Shipped());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Diagnostics diagnostics;
    const auto apart = ReadScenario(lines, "x.xml", robots, false, diagnostics, seed);
    const auto together = ReadScenario(one_line, "x.xml", robots, false, diagnostics, seed);
    ASSERT_TRUE(apart != nullptr && together != nullptr) << diagnostics.ToString();
    ASSERT_EQ(together->objects.size(), apart->objects.size());
    for (std::size_t i = 0; i < apart->objects.size(); ++i)
      EXPECT_EQ(together->objects[i].X_WO.p, apart->objects[i].X_WO.p) << "seed " << seed;
  }
}

TEST(ExperimentTest, AMeshNeedsTheFilesThatAnExperimentWithoutThemCannotHave) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const std::string xml =
      "<rosiml version=\"0.8.41\"><simulator frequency=\"100\"/><robots><robot name=\"r\"><body>"
      "<ply name=\"m\" filename=\"m.ply\"><pose z=\"1\"/><physics/></ply></body></robot></robots></rosiml>";
  EXPECT_EQ(ReadScenario(xml, "x.xml", robots, true, diagnostics), nullptr);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("the mesh 'm.ply' is a file, and this model came without"));
}

TEST(ExperimentTest, ExperimentsAreListedAsScenariosAndOtherXmlIsNot) {
  const auto names = Shipped().ScenarioNames();
  EXPECT_THAT(names, ::testing::Contains("braitenberg"));
  EXPECT_THAT(names, ::testing::Contains("corridor"));
  EXPECT_THAT(SearchPath{{SourceDir() + "/tests/server/model/data"}}.ScenarioNames(),
              ::testing::Not(::testing::Contains("package")));
}

TEST(ExperimentTest, AChangedTextOfOneNameHasItsNewRobot) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  ASSERT_NE(ReadScenario(kXml, "x.xml", robots, false, diagnostics), nullptr);
  std::string changed = kXml;
  changed.replace(changed.find("radius=\"0.5\""), 12, "radius=\"0.4\"");
  const auto scenario = ReadScenario(changed, "x.xml", robots, false, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_NEAR(scenario->robots[0].model->footprint_radius_m, 0.4, 1e-12);
}

TEST(ExperimentTest, AMistakeThatTheScenarioShowsHasTheLineOfTheXml) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  std::string wrong = kXml;
  wrong.replace(wrong.find("mass=\"1\""), 8, "mass=\"1e-9\"");
  EXPECT_EQ(ReadScenario(wrong, "x.xml", robots, false, diagnostics), nullptr);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("x.xml:3: error: "));
}

TEST(ExperimentTest, MistakesOfTheXmlTheModelsAndTheScenarioAreToldAtOnce) {
  const auto movable = [](const std::string& name, const std::string& kg) {
    return "<movable name=\"" + name + "\" type=\"active\">\n<body><object name=\"a\" mass=\"" + kg +
           "\"><pose z=\"0.5\"/><sphere radius=\"0.5\"/></object></body>\n</movable>\n";
  };
  const std::string xml =
      "<rosiml version=\"1.0\">\n<environment>\n"
      "<sphere name=\"b\" radius=\"0.1\" mass=\"1e-9\"><randomise x=\"1 3\"/></sphere>\n"
      "</environment>\n<movables>\n" +
      movable("m", "fat") + movable("n", "1e-9") + movable("o", "1") +
      "</movables>\n<score kind=\"distance\" of=\"m, n, o\"/>\n"
      "<score kind=\"time\" tilt=\"3\"/>\n</rosiml>\n# file: x.xml\n";
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  EXPECT_EQ(ReadScenario(xml, "x.xml", robots, false, diagnostics), nullptr);
  EXPECT_EQ(diagnostics.ToString(),
            "x.xml:3: error: a mass below 1 mg cannot be simulated: write 0 for something that never moves\n"
            "x.xml:7: error: 'mass' in <object> is a number from 0 to 1000000, not 'fat'\n"
            "x.xml:10: error: robot 'n': the mass of link 'a' must be a positive number of kg, at most 1e6\n"
            "x.xml:17: error: 'tilt' goes with 'kind upright' only: leave it out\n");
}

TEST(ExperimentTest, SettingsChangeItAndStandBehindTheXml) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const std::string text = WithSettings(kXml, {"ball.mass=3", "SCORE_1.kind=distance"}, diagnostics);
  EXPECT_EQ(SettingsIn(text), (Settings{"ball.mass=3", "score_1.kind=distance"}));
  const auto scenario = ReadScenario(text, "x.xml", robots, false, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->objects[0].mass_kg, 3);
  EXPECT_EQ(scenario->scores.size(), 1u);
}

TEST(ExperimentTest, ItsFileMayBeNamedBehindIt) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(kXml + "# file: swing.xml\n", "(text)", robots, true, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->name, "swing");
}

TEST(ExperimentTest, ABareNameFindsIt) {
  EXPECT_TRUE(Shipped().FindScenario("lightseeker").has_value());
}

TEST(ExperimentTest, ARobotOfItIsATypeForOtherScenarios) {
  RobotLibrary robots(Shipped());
  Diagnostics diagnostics;
  const std::string file = SourceDir() + "/scenarios/lightseeker.xml";
  const auto model = robots.Get(file + "#seeker", {"x.scenario", 1}, diagnostics, SourceDir());
  ASSERT_NE(model, nullptr) << diagnostics.ToString();
  EXPECT_NE(model->drive(), nullptr);
  EXPECT_EQ(robots.Get(file + "#seekr", {"x.scenario", 1}, diagnostics, SourceDir()), nullptr);
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("did you mean 'seeker'?"));
}

}  // namespace
}  // namespace coopdyn
