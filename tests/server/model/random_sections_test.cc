// SPDX-License-Identifier: MIT
// [RANDOM] of scenarios: drawn values, and messages about mistakes.
#include "server/model/random_sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "server/model/ground_plan.h"
#include "server/model/swarm.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

constexpr const char* kText =
    "[ROBOT_1]\ntype coopbot\nposition 0 0\n"
    "[BOX_1]\ntype box\nsize 0.3 0.3 0.3\nposition 1 0\nmass 1\n"
    "[SWARM_1]\ntype minibot\ncount 3\ncolor red\n";

ReadResult ReadFor(std::uint64_t seed, const std::string& text) {
  Diagnostics diagnostics;
  auto scenario = ReadScenario(text, "test.scenario", ShippedRobots(), true, diagnostics, seed);
  return {scenario, diagnostics.ToString()};
}

/// The values drawn for `seed`, by key.
std::map<std::string, std::string> Drawn(const std::string& random, std::uint64_t seed = 1) {
  const ReadResult read = ReadFor(seed, kText + std::string("[RANDOM]\n") + random);
  EXPECT_EQ(read.messages, "");
  std::map<std::string, std::string> values;
  if (read.scenario == nullptr) return values;
  for (const RandomKey& key : read.scenario->random) values[key.name] = key.value;
  return values;
}

std::string Draw(const std::string& text, std::uint64_t seed, std::string_view key = "box_1.size",
                 std::uint32_t attempt = 0) {
  std::string error;
  const auto value = RandomValue::Parse(text, error);
  EXPECT_TRUE(value) << error;
  return value ? value->Draw({seed, key, attempt}) : "";
}

struct Moments {
  double mean = 0, deviation = 0, least = 1e9, most = -1e9;
};
Moments MomentsOf(const std::string& text) {
  constexpr int kDraws = 20'000;
  Moments moments;
  double sum = 0, squares = 0;
  for (int seed = 0; seed < kDraws; ++seed) {
    const double x = std::stod(Draw(text, static_cast<std::uint64_t>(seed)));
    sum += x;
    squares += x * x;
    moments.least = std::min(moments.least, x);
    moments.most = std::max(moments.most, x);
  }
  moments.mean = sum / kDraws;
  moments.deviation = std::sqrt(squares / kDraws - moments.mean * moments.mean);
  return moments;
}

TEST(RandomValueTest, UniformHasItsMomentsAndBounds) {
  const Moments moments = MomentsOf("uniform -2 4");
  EXPECT_NEAR(moments.mean, 1, 0.05);
  EXPECT_NEAR(moments.deviation, 6 / std::sqrt(12), 0.03);
  EXPECT_GE(moments.least, -2);
  EXPECT_LE(moments.most, 4);
  EXPECT_LT(moments.least, -1.99);
  EXPECT_GT(moments.most, 3.99);
}

TEST(RandomValueTest, NormalHasItsMomentsAndIsCutAtThreeDeviations) {
  const Moments moments = MomentsOf("normal 0.3 0.05");
  EXPECT_NEAR(moments.mean, 0.3, 0.002);
  EXPECT_NEAR(moments.deviation, 0.05 * 0.9866, 0.001);  // of the truncated normal distribution
  EXPECT_GE(moments.least, 0.15);
  EXPECT_LE(moments.most, 0.45);
}

TEST(RandomValueTest, ChoicesAreEqual) {
  std::map<std::string, int> counts;
  for (std::uint64_t seed = 0; seed < 9000; ++seed) ++counts[Draw("choice red green blue", seed)];
  ASSERT_EQ(counts.size(), 3u);
  for (const auto& [word, count] : counts) EXPECT_NEAR(count, 3000, 200) << word;
}

TEST(RandomValueTest, ChoicesOfSeveralWordsStandBetweenBars) {
  std::map<std::string, int> counts;
  for (std::uint64_t seed = 0; seed < 100; ++seed) ++counts[Draw("choice 0 1 | 2 3|4 5", seed)];
  EXPECT_EQ(counts.size(), 3u);
  EXPECT_TRUE(counts.contains("0 1") && counts.contains("2 3") && counts.contains("4 5"));
}

TEST(RandomValueTest, UnitsAndOtherWordsStay) {
  const std::string drawn = Draw("diffuse speed=uniform 10cm 20cm turn=0.5", 3);
  EXPECT_TRUE(drawn.starts_with("diffuse speed=1")) << drawn;
  EXPECT_TRUE(drawn.ends_with("cm turn=0.5")) << drawn;
}

TEST(RandomValueTest, DependsOnSeedKeyComponentAndTry) {
  const std::string once = Draw("uniform 0 1 uniform 0 1", 1);
  EXPECT_EQ(once, Draw("uniform 0 1 uniform 0 1", 1));
  EXPECT_NE(once, Draw("uniform 0 1 uniform 0 1", 2));
  EXPECT_NE(once, Draw("uniform 0 1 uniform 0 1", 1, "box_2.size"));
  EXPECT_NE(once, Draw("uniform 0 1 uniform 0 1", 1, "box_1.size", 1));
  EXPECT_NE(once.substr(0, once.find(' ')), once.substr(once.find(' ') + 1));
  // Other sections have no effect, so that a file can grow.
  EXPECT_EQ(once.substr(0, once.find(' ')), Draw("uniform 0 1", 1));
}

TEST(RandomValueTest, TheBitsAreTheSameForever) {
  EXPECT_EQ(Draw("uniform 0 1", 1), "0.534641625");
}

TEST(RandomSectionsTest, TheWorldHasTheDrawnValues) {
  const ReadResult read = ReadFor(
      7, kText + std::string("[RANDOM]\nBOX_1.mass uniform 2 3\nrobot_1.Orientation uniform -180deg 180deg\n"
                             "BOX_1.color choice red green\nFLOOR.friction uniform 0.2 0.4\n"
                             "SIMULATION.gravity uniform 5 6\n"));
  ASSERT_NE(read.scenario, nullptr) << read.messages;
  const Scenario& scenario = *read.scenario;
  ASSERT_EQ(scenario.random.size(), 5u);
  EXPECT_NEAR(scenario.objects[0].mass_kg, std::stod(scenario.random[0].value), 1e-9);
  EXPECT_EQ(scenario.random[1].name, "ROBOT_1.orientation");
  EXPECT_EQ(scenario.random[1].distribution, "uniform -180deg 180deg");
  EXPECT_NE(scenario.robots[0].X_WR.q.coeffs(), Quaternion::Identity().coeffs());
  EXPECT_LE(scenario.floor.friction, 0.4);
  EXPECT_LE(scenario.simulation.g_W.z(), -5);
  EXPECT_GE(scenario.simulation.g_W.z(), -6);
}

TEST(RandomSectionsTest, TheSeedDecides) {
  const std::string random = "BOX_1.mass uniform 2 3\nSWARM_1.spacing uniform 0.2 0.4\n";
  EXPECT_EQ(Drawn(random, 4), Drawn(random, 4));
  EXPECT_NE(Drawn(random, 4), Drawn(random, 5));
}

TEST(RandomSectionsTest, TheSeedOfTheFileDecidesWithoutAnother) {
  const std::string random = "[RANDOM]\nBOX_1.mass uniform 2 3\n";
  const auto of_file = Good(kText + ("[SIMULATION]\nseed 9\n" + random));
  const ReadResult given = ReadFor(9, kText + random);
  ASSERT_EQ(of_file->random.size(), 1u);
  EXPECT_EQ(of_file->random[0].value, given.scenario->random[0].value);
}

TEST(RandomSectionsTest, SeveralSectionsAreOne) {
  const auto scenario = Good(std::string(kText) +
                             "[RANDOM_1]\nBOX_1.mass uniform 2 3\n[RANDOM_2]\nBOX_1.friction uniform 0 1\n");
  EXPECT_EQ(scenario->random.size(), 2u);
}

TEST(RandomSectionsTest, NothingOverlaps) {
  std::string text =
      "[FLOOR]\nsize 8 8\n[WALL_1]\ntype box\nsize 4 0.2 0.5\nposition 0 0\norientation 45deg\n";
  std::string random = "[RANDOM]\n";
  for (int i = 1; i <= 6; ++i) {
    const std::string n = std::to_string(i);
    text += "[ROBOT_" + n + "]\ntype coopbot\nposition 0 0\n[BOX_" + n +
            "]\ntype box\nsize 1 1 1\nposition 0 0\n";
    random += "ROBOT_" + n + ".position uniform -2 2 uniform -2 2\nBOX_" + n +
              ".position uniform -2 2 uniform -2 2\nBOX_" + n +
              ".size normal 0.4 0.1 uniform 0.1 0.5 0.3\nBOX_" + n + ".orientation uniform -180deg 180deg\n";
  }
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const ReadResult read = ReadFor(seed, text + random);
    ASSERT_NE(read.scenario, nullptr) << read.messages;
    const std::vector<Standing> plan = GroundPlan(*read.scenario);
    ASSERT_EQ(plan.size(), 13u);
    for (std::size_t i = 0; i < plan.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_FALSE(Overlap(plan[i], plan[k]))
            << "seed " << seed << ": " << plan[i].name << " " << plan[k].name;
      }
    }
  }
}

TEST(RandomSectionsTest, SwarmsLeaveDrawnThingsTheirPlaces) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ReadResult read = ReadFor(seed, std::string(kText) +
                                              "[RANDOM]\nBOX_1.position uniform -1 1 uniform -1 1\n"
                                              "SWARM_1.area 0 0 uniform 2 4 2\n");
    ASSERT_NE(read.scenario, nullptr) << read.messages;
    for (const RobotEntry& robot : read.scenario->robots) {
      const double distance = DistanceToShadow(read.scenario->objects[0], robot.X_WR.p.x(), robot.X_WR.p.y());
      EXPECT_GE(distance, robot.model->footprint_radius_m);
    }
  }
}

TEST(RandomSectionsTest, WhatStandsOnAnotherMayStandThere) {
  const ReadResult read =
      ReadFor(1, std::string(kText) +
                     "[TOP]\ntype box\nsize 0.1 0.1 0.1\nposition 1 0 0.35\nmass 1\n"
                     "[RANDOM]\nTOP.position uniform 0.95 1.05 uniform -0.05 0.05 0.35\n");
  EXPECT_EQ(read.messages, "");
}

TEST(RandomSectionsTest, ColoursDoNotMoveWhatStandsInAnother) {
  const ReadResult read = ReadFor(1, std::string(kText) +
                                         "[PART]\ntype box\nsize 0.1 0.1 0.1\nposition 1 0\n"
                                         "[RANDOM]\nPART.color choice red blue\n");
  EXPECT_EQ(read.messages, "");
}

TEST(RandomSectionsTest, TooNarrowIsAnErrorAfterManyTries) {
  const ReadResult read = ReadFor(3, std::string(kText) + "[RANDOM]\nBOX_1.position uniform -0.1 0.1 0\n");
  EXPECT_EQ(read.scenario, nullptr);
  EXPECT_EQ(
      read.messages,
      "test.scenario:14: error: [BOX_1] stands in something in each of 1000 draws for seed 3, at last in "
      "robot1: draw its position from a larger area, or take smaller or fewer things\n");
}

TEST(RandomSectionsTest, AllMistakesAreToldAtOnce) {
  const ReadResult read = Read(
      std::string(kText) + "[RANDOM]\nBOX_1.mass unifrom 1 2\nBOX_2.mass uniform 1 2\nBOX_1.color choice\n");
  EXPECT_EQ(std::ranges::count(read.messages, '\n'), 3) << read.messages;
}

TEST(RandomSectionsTest, ValuesThatCannotBeAreToldAtTheirLine) {
  const ReadResult read = Read(std::string(kText) + "[RANDOM]\nBOX_1.mass uniform -2 -1\n");
  EXPECT_TRUE(read.messages.starts_with("test.scenario:14: error: 'mass' must be at least 0, not -1."))
      << read.messages;
}

TEST(RandomSectionsTest, NothingRandomIsInserted) {
  Diagnostics diagnostics;
  EXPECT_EQ(ReadInsertion("[RANDOM]\nBOX_1.mass uniform 1 2\n", ShippedRobots(), Scenario(), diagnostics),
            nullptr);
  EXPECT_NE(diagnostics.ToString().find("[RANDOM] cannot be inserted"), std::string::npos);
}

struct Mistake {
  const char* line;
  const char* said;
};

class RandomMistakeTest : public testing::TestWithParam<Mistake> {};

TEST_P(RandomMistakeTest, IsToldWithWhatToWrite) {
  const ReadResult read = Read(std::string(kText) + "[RANDOM]\n" + GetParam().line + "\n");
  EXPECT_EQ(read.scenario, nullptr);
  EXPECT_EQ(read.messages, std::string("test.scenario:14: error: ") + GetParam().said + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    , RandomMistakeTest,
    testing::Values(
        Mistake{
            "mass uniform 1 2",
            "a line of [RANDOM] is SECTION.key and how to draw its value, for example: BOX_1.mass uniform "
            "0.5 2"},
        Mistake{"BOX_1.mass 1",
                "'BOX_1.mass': nothing is drawn here: write uniform LEAST MOST, normal MEAN "
                "DEVIATION or choice A B C"},
        Mistake{"BOX_1.mass",
                "'BOX_1.mass': nothing is drawn here: write uniform LEAST MOST, normal MEAN "
                "DEVIATION or choice A B C"},
        Mistake{"BOX_1.mass unifrom 1 2",
                "'BOX_1.mass': unknown distribution 'unifrom'; did you mean 'uniform'?"},
        Mistake{
            "BOX_1.mass uniform 1",
            "'BOX_1.mass': 'uniform' takes two numbers, the least and the most: write for example uniform "
            "0.1 0.3"},
        Mistake{"BOX_1.mass uniform 1 heavy",
                "'BOX_1.mass': 'uniform' takes two numbers, the least and the most, not 'heavy': write for "
                "example uniform 0.1 0.3"},
        Mistake{"BOX_1.mass uniform 2 1",
                "'BOX_1.mass': 'uniform' takes the least number first: write uniform 1 2"},
        Mistake{"BOX_1.mass normal 2 -0.1",
                "'BOX_1.mass': the standard deviation, the second number of 'normal', is not below 0: write "
                "normal 2 0.1"},
        Mistake{"BOX_1.orientation uniform -180 180deg",
                "'BOX_1.orientation': both numbers of 'uniform' have the same unit: write uniform -180deg "
                "180deg"},
        Mistake{"BOX_1.color choice red",
                "'BOX_1.color': 'choice' takes the values to choose from: write for example choice red green "
                "blue, or choice 0 1 | 2 3"},
        Mistake{"BOX_1.position choice 1 2 |", "'BOX_1.position': a value of 'choice' is missing beside '|'"},
        Mistake{"SWARM_1.controller diffuse speed=uniform(0.1,0.2)",
                "'SWARM_1.controller': numbers stand behind the word, without brackets: write for example "
                "speed=uniform 0.1 0.3"},
        Mistake{"BOX_2.mass uniform 1 2", "the scenario has no section [BOX_2]; did you mean 'BOX_1'?"},
        Mistake{"BOX_1.maas uniform 1 2", "unknown word 'maas' in [BOX_1]; did you mean 'mass'?"},
        Mistake{"ROBOT_1.type choice coopbot minibot",
                "'type' of robots cannot be random, since their clients stay over a reset: write it in "
                "[ROBOT_1]"},
        Mistake{"SIMULATION.step choice 1ms 2ms",
                "of [SIMULATION] only gravity and ambient_light can be random"}));

TEST(RandomSectionsTest, AKeyIsDrawnOnce) {
  const ReadResult read = Read(std::string(kText) +
                               "[RANDOM]\nBOX_1.color choice red blue\n"
                               "BOX_1.colour choice red blue\n");
  EXPECT_EQ(read.messages,
            "test.scenario:15: error: 'BOX_1.colour' is drawn twice (first in line 14): keep one\n");
}

}  // namespace
}  // namespace coopdyn
