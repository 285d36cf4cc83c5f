// SPDX-License-Identifier: MIT
// Objects given by `count` instead of `position`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/model/swarm.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kCrates = "[CRATE]\ntype box\nsize 0.4 0.3 0.2\nmass 1kg\ncount 30\n";

TEST(ScatteredTest, CopiesAreNumberedAndRestOnTheFloor) {
  const auto scenario = Good(kCrates + "color red\n");
  ASSERT_EQ(scenario->objects.size(), 30u);
  EXPECT_EQ(scenario->objects[0].name, "CRATE_1");
  EXPECT_EQ(scenario->objects[29].name, "CRATE_30");
  for (const WorldObject& crate : scenario->objects) {
    EXPECT_EQ(crate.mass_kg, 1);
    EXPECT_EQ(crate.color, *NamedColor("red"));
    EXPECT_DOUBLE_EQ(crate.X_WO.p.z(), 0.1);
    EXPECT_EQ(crate.where.line, 1);
  }
}

TEST(ScatteredTest, CopiesAreClearOfEverything) {
  const auto scenario =
      Good("[FLOOR]\nsize 8 8\n" + kCrates +
           "[WALL]\ntype box\nsize 4 0.2 1\nposition 0 0\norientation 30deg\n"
           "[ROBOT_1]\ntype single\nposition -2 -2\n[SWARM_1]\ntype minibot\nname ant\ncount 40\n");
  ASSERT_EQ(scenario->objects.size(), 31u);
  ASSERT_EQ(scenario->robots.size(), 41u);
  const double radius = std::hypot(0.4, 0.3) / 2;
  for (std::size_t i = 0; i < 30; ++i) {
    const Vector3& p = scenario->objects[i].X_WO.p;
    EXPECT_LE(std::abs(p.x()), 4 - radius);
    EXPECT_LE(std::abs(p.y()), 4 - radius);
    EXPECT_GT(DistanceToShadow(scenario->objects[30], p.x(), p.y()), radius);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((p - scenario->objects[j].X_WO.p).norm(), 2.5 * radius);
    }
    for (const RobotEntry& robot : scenario->robots) {
      EXPECT_GT(DistanceToShadow(scenario->objects[i], robot.X_WR.p.x(), robot.X_WR.p.y()),
                robot.model->footprint_radius_m);
    }
  }
}

TEST(ScatteredTest, TheyAreTurnedAtRandom) {
  const auto scenario = Good(kCrates);
  double least = 10, most = -10;
  for (const WorldObject& crate : scenario->objects) {
    least = std::min(least, Heading(crate.X_WO.q));
    most = std::max(most, Heading(crate.X_WO.q));
    EXPECT_NEAR(crate.X_WO.q.toRotationMatrix()(2, 2), 1, 1e-12);
  }
  EXPECT_LT(least, -1);
  EXPECT_GT(most, 1);
}

TEST(ScatteredTest, OrientationIsKeptBesideTheTurn) {
  const auto scenario =
      Good("[LOG]\ntype cylinder\nsize 0.2 0.2 1\norientation 90deg 0 0\nmass 1\ncount 5\n");
  ASSERT_EQ(scenario->objects.size(), 5u);
  for (const WorldObject& log : scenario->objects) {
    EXPECT_NEAR((log.X_WO.q * Vector3::UnitZ()).z(), 0, 1e-12);  // they lie on their sides
    EXPECT_NEAR(log.X_WO.p.z(), 0.1, 1e-12);
  }
}

TEST(ScatteredTest, SamePlacesForTheSameSeedOnly) {
  const Vector3 p = Good(kCrates)->objects.at(3).X_WO.p;
  EXPECT_EQ(Good(kCrates)->objects.at(3).X_WO.p, p);
  EXPECT_NE(Good(kCrates + "seed 2\n")->objects.at(3).X_WO.p, p);
  EXPECT_NE(Good("[SIMULATION]\nseed 2\n" + kCrates)->objects.at(3).X_WO.p, p);
  EXPECT_EQ(Good("[SIMULATION]\nseed 2\n" + kCrates + "seed 1\n")->objects.at(3).X_WO.p, p);
}

TEST(ScatteredTest, AreaAndSpacingAreKept) {
  const auto scenario = Good(kCrates + "area 5 -5 4 6\nspacing 0.55\n");
  for (const WorldObject& crate : scenario->objects) {
    EXPECT_LE(std::abs(crate.X_WO.p.x() - 5), 2 - 0.25);
    EXPECT_LE(std::abs(crate.X_WO.p.y() + 5), 3 - 0.25);
  }
}

TEST(ScatteredTest, OrderIsThatOfTheFile) {
  const auto scenario = Good("[A]\ntype sphere\nsize 1\ncount 2\n[B]\ntype sphere\nsize 1\nposition 3 3\n");
  ASSERT_EQ(scenario->objects.size(), 3u);
  EXPECT_EQ(scenario->objects[0].name, "A_1");
  EXPECT_EQ(scenario->objects[1].name, "A_2");
  EXPECT_EQ(scenario->objects[2].name, "B");
}

TEST(ScatteredTest, AWorldMayScatterToo) {
  const TempFolder folder;
  folder.Write("a.world", "[FLOOR]\nsize 6 6\n" + kCrates);
  const std::string file = folder.Write("a.scenario",
                                        "[WORLD]\nfile a.world\n[SIMULATION]\nseed 3\n[ROBOT_1]\ntype "
                                        "single\nposition 0 0\n[PILLAR]\ntype sphere\nsize 1\ncount 1\n");
  Diagnostics diagnostics;
  const auto scenario = LoadScenario(file, ShippedRobots(), diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  ASSERT_EQ(scenario->objects.size(), 31u);
  EXPECT_EQ(scenario->objects[0].name, "CRATE_1");
  EXPECT_EQ(scenario->objects[30].name, "PILLAR_1");
  // Alone it has seed 1, or the run's seed.
  const auto place = [&](std::optional<std::uint64_t> seed) {
    const auto world =
        LoadScenario((folder.path() / "a.world").string(), ShippedRobots(), diagnostics, false, seed);
    return world == nullptr ? Vector3(0, 0, 0) : world->objects.at(0).X_WO.p;
  };
  EXPECT_EQ(place(std::nullopt), place(1));
  EXPECT_NE(place(1), place(2));
}

TEST(ScatteredTest, MistakesAreErrors) {
  EXPECT_THAT(Read(kCrates + "position 0 0\n").messages,
              HasSubstr(":6: error: 'position' and 'count' exclude each other"));
  EXPECT_THAT(Read(kCrates + "area 0 0 1 1\n").messages,
              HasSubstr(" of 30 copies of [CRATE] fit into the area of 1 x 1 m, 0.625 m apart"));
  EXPECT_THAT(Read(kCrates + "spacing 0.4\n").messages, HasSubstr("at least 0.5 m"));
  EXPECT_THAT(Read(kCrates + "area 0 0 0 1\n").messages, HasSubstr("must be above 0"));
  EXPECT_THAT(Read("[A]\ntype sphere\nsize 1\ncount 0\n").messages, HasSubstr("from 1 to 100000, not '0'"));
  EXPECT_THAT(Read("[A]\ntype sphere\nsize 1\nposition 0 0\nspacing 3\n").messages,
              HasSubstr(":5: error: unknown word 'spacing'"));
  EXPECT_THAT(Read("[A]\ntype sphere\nsize 1\ncount 2\n[A_1]\ntype sphere\nsize 1\nposition 3 3\n").messages,
              HasSubstr(":1: error: a copy is called [A_1] as another thing is (test.scenario:5)"));
}

}  // namespace
}  // namespace coopdyn
