// SPDX-License-Identifier: MIT
// coopdyn bench swarm, on tiny worlds.
#include "tests/bench/bench_swarm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <boost/json.hpp>
#include <cmath>
#include <numbers>

#include "server/model/swarm.h"
#include "tests/bench/bench_commands.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

RobotLibrary& Library() {
  static RobotLibrary library(SearchPath{{SourceDir(), COOPDYN_BUILD_DIR}});
  return library;
}

SwarmBenchOptions Tiny() {
  SwarmBenchOptions options;
  options.arena.robots = 10;
  options.seconds = 0.2;
  options.repeats = 2;
  options.program = COOPDYN_PROGRAM;
  return options;
}

SwarmBenchResult RunBench(const SwarmBenchOptions& options) {
  Diagnostics diagnostics;
  const auto result = RunSwarmBench(options, Library(), diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return result.value_or(SwarmBenchResult());
}

std::shared_ptr<const Scenario> Arena(const ArenaOptions& options) {
  Diagnostics diagnostics;
  auto scenario = MakeArena(options, Library(), diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return scenario != nullptr ? scenario : std::make_shared<Scenario>();
}

TEST(BenchArenaTest, WallsHoldTheRobotsAtTheDensityAskedFor) {
  const auto scenario = Arena({.robots = 50, .density_m2 = 2});
  ASSERT_EQ(scenario->robots.size(), 50u);
  ASSERT_EQ(scenario->objects.size(), 4u);
  for (const WorldObject& wall : scenario->objects) {
    // The walls' inner faces are 2.5 m from the centre: 25 m².
    EXPECT_NEAR(DistanceToShadow(wall, 0, 0), 2.5, 1e-9);
    EXPECT_TRUE(wall.is_static());
    for (const RobotEntry& robot : scenario->robots) {
      EXPECT_GT(DistanceToShadow(wall, robot.X_WR.p.x(), robot.X_WR.p.y()), 0.085);
    }
  }
}

TEST(BenchArenaTest, SeedGivesThePlaces) {
  const Vector3 p = Arena({.robots = 10, .seed = 5})->robots[3].X_WR.p;
  EXPECT_EQ(Arena({.robots = 10, .seed = 5})->robots[3].X_WR.p, p);
  EXPECT_NE(Arena({.robots = 10, .seed = 6})->robots[3].X_WR.p, p);
}

TEST(BenchArenaTest, RaysAreSpreadOverTheModelsSector) {
  const auto minibot = Arena({.robots = 1, .rays = 8, .range_m = 0.5})->robots.at(0).model;
  const std::vector<SectorModel> sectors = minibot->sectors();
  ASSERT_EQ(sectors.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    const SectorModel& sensor = sectors[i];
    EXPECT_NEAR(sensor.bearing_rad, (-157.5 + 45 * static_cast<double>(i)) * kDegree, 1e-9);
    EXPECT_EQ(sensor.rays, 1);
    EXPECT_EQ(sensor.max_range_m, 0.5);
    EXPECT_NEAR((sensor.X_RS.p -
                 Vector3(0.085 * std::cos(sensor.bearing_rad), 0.085 * std::sin(sensor.bearing_rad), 0.06))
                    .norm(),
                0, 1e-12);
  }
  // Eleven sectors of 20 degrees, -110 to 110.
  const auto coopbot =
      Arena({.robots = 1, .robot = "coopbot", .rays = 22, .density_m2 = 0.1})->robots.at(0).model;
  ASSERT_EQ(coopbot->sector_count(), 22u);
  EXPECT_NEAR(coopbot->sectors().front().bearing_rad, -105 * kDegree, 1e-9);
  EXPECT_NEAR(coopbot->sectors().back().bearing_rad, 105 * kDegree, 1e-9);
}

TEST(BenchArenaTest, AsManyRaysAsTheModelHasAreTheModels) {
  const auto own = Arena({.robots = 1})->robots.at(0).model;
  const auto same = WithSensors(*own, 24, std::nullopt);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_NEAR(same->sectors()[i].bearing_rad, own->sectors()[i].bearing_rad, 1e-12);
    EXPECT_EQ(same->sectors()[i].max_range_m, own->sectors()[i].max_range_m);
  }
}

TEST(BenchArenaTest, WithoutRaysThereIsNoDistanceModule) {
  const auto model = Arena({.robots = 1, .rays = 0})->robots.at(0).model;
  EXPECT_EQ(model->sector_count(), 0u);
  for (const ModuleModel& module : model->modules()) EXPECT_NE(module.type, "distance");
}

TEST(BenchSwarmTest, RepeatsStartAfreshAndEndInTheSameState) {
  const SwarmBenchResult result = RunBench(Tiny());
  EXPECT_EQ(result.steps, 20u);
  ASSERT_EQ(result.hashes.size(), 2u);
  EXPECT_TRUE(result.hashes_agree());
  EXPECT_EQ(result.rays, 24);
  EXPECT_GT(result.median.robot_steps_per_cpu_s, 0);
  EXPECT_GT(result.median.split.physics_us, 0);
  EXPECT_GT(result.median.split.sense_us, 0);
  EXPECT_TRUE(result.problems.empty());
}

TEST(BenchSwarmTest, ThreadsDoNotChangeTheHash) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    SwarmBenchOptions options = Tiny();
    options.threads = threads;
    options.repeats = 1;
    hashes.push_back(RunBench(options).hashes.at(0));
  }
  EXPECT_EQ(hashes[1], hashes[0]);
  EXPECT_EQ(hashes[2], hashes[0]);
}

TEST(BenchSwarmTest, NeitherThreadsNorTheChildChangeTheHashWithAController) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    for (const bool in_process : {false, true}) {
      SwarmBenchOptions options = Tiny();
      options.threads = threads;
      options.controllers_in_process = in_process;
      options.repeats = 1;
      options.arena.controller = "diffuse speed=0.2";
      const SwarmBenchResult result = RunBench(options);
      EXPECT_THAT(result.problems, ::testing::IsEmpty());
      EXPECT_GT(result.median.split.control_us, 0);
      hashes.push_back(result.hashes.at(0));
    }
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(BenchSwarmTest, FidelitiesAndDensitiesAreRun) {
  SwarmBenchOptions options = Tiny();
  for (const Fidelity fidelity : {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar}) {
    options.arena.fidelity = fidelity;
    options.arena.density_m2 = 3;
    const SwarmBenchResult result = RunBench(options);
    EXPECT_TRUE(result.hashes_agree());
    EXPECT_THAT(result.frozen, ::testing::IsEmpty());
  }
}

TEST(BenchSwarmTest, AnotherSeedGivesAnotherHash) {
  SwarmBenchOptions options = Tiny();
  options.repeats = 1;
  const std::string first = RunBench(options).hashes.at(0);
  options.arena.seed = 2;
  EXPECT_NE(RunBench(options).hashes.at(0), first);
}

TEST(BenchSwarmTest, DifferentHashesAreNoticed) {
  SwarmBenchResult result;
  result.hashes = {"a", "a", "b"};
  EXPECT_FALSE(result.hashes_agree());
}

TEST(BenchSwarmTest, JsonHasTheDocumentedKeys) {
  const SwarmBenchOptions options = Tiny();
  const boost::json::object json = boost::json::parse(BenchJson(options, RunBench(options))).as_object();
  for (const char* key : {"robots",
                          "robot",
                          "rays",
                          "range",
                          "fidelity",
                          "controller",
                          "controllers",
                          "density",
                          "boxes",
                          "threads",
                          "seed",
                          "seconds",
                          "repeats",
                          "steps",
                          "robot_steps_per_cpu_s",
                          "robot_steps_per_wall_s",
                          "spread",
                          "rtf",
                          "kb_per_robot",
                          "split",
                          "hash"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json.at("robots").as_int64(), 10);
  EXPECT_EQ(json.at("rays").as_int64(), 24);
  EXPECT_EQ(json.at("steps").as_int64(), 20);
  EXPECT_EQ(json.at("fidelity").as_string(), "rolling");
  EXPECT_EQ(json.at("hash").as_string().size(), 16u);
  for (const char* key : {"sense", "control", "physics", "publish", "other"}) {
    EXPECT_TRUE(json.at("split").as_object().contains(key)) << key;
  }
}

TEST(BenchSwarmTest, TableSaysWhatWasRun) {
  const SwarmBenchOptions options = Tiny();
  const std::string table = BenchTable(options, RunBench(options));
  EXPECT_THAT(table, HasSubstr("10 minibot, rolling, 24 rays of 0.1 m, controller none"));
  EXPECT_THAT(table, HasSubstr("(20 steps), 1 thread, median of 2"));
}

TEST(BenchSwarmTest, WhatCannotBeBuiltIsSaid) {
  const auto said = [](SwarmBenchOptions options) {
    Diagnostics diagnostics;
    EXPECT_FALSE(RunSwarmBench(options, Library(), diagnostics).has_value());
    return diagnostics.ToString();
  };
  SwarmBenchOptions options = Tiny();
  options.arena.density_m2 = 100;
  EXPECT_THAT(said(options), HasSubstr("of 10 robots fit"));
  options = Tiny();
  options.arena.robot = "minibto";
  EXPECT_THAT(said(options), HasSubstr("did you mean 'minibot'?"));
  options = Tiny();
  options.arena.controller = "no_such";
  EXPECT_THAT(said(options), HasSubstr("there is no controller 'no_such'"));
}

/// The parser's error for `arguments` of coopdyn bench; empty: none.
std::string Parse(const std::string& arguments) {
  CLI::App bench;
  std::function<int()> chosen;
  AddBenchSwarm(bench, chosen);
  try {
    bench.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  EXPECT_TRUE(chosen != nullptr);
  return "";
}

TEST(BenchSwarmTest, WrongOptionsAreRefused) {
  EXPECT_EQ(Parse("swarm --robots 10 --rays 8 --range 0.1 --fidelity full --threads 2 --seconds 0.5 --json"),
            "");
  for (const char* wrong :
       {"--robots 0", "--robots x", "--rays -1", "--range 0", "--fidelity quick", "--threads 0",
        "--seconds 0", "--repeats 0", "--density -1", "--controllers here", "--seed -1", "--seed 1.5"}) {
    EXPECT_THAT(Parse(std::string("swarm ") + wrong), HasSubstr(std::string(wrong).substr(0, 6))) << wrong;
  }
}

}  // namespace
}  // namespace coopdyn
