// SPDX-License-Identifier: MIT
// Twenty runs whose bodies must stay bitwise the same when the program is restructured: crowds, pushed
// objects, sleepers, long steps and loaded controllers in every fidelity.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "server/physics/simulation.h"
#include "server/sensing/channel_filters.h"
#include "tests/server/replay/replay_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

struct SameBitsCase {
  std::string name;
  std::string scenario;
  std::uint64_t seed;
  int steps;
  Nanoseconds length;
  int threads;
  const char* hash;
};

std::ostream& operator<<(std::ostream& out, const SameBitsCase& run) {
  return out << run.name;
}

std::string Robots(const std::string& type, const std::string& fidelity, int count, double spacing_m) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const double x = spacing_m * (i % 5), y = spacing_m * (i / 5);
    text += "[ROBOT_" + std::to_string(i + 1) + "]\ntype " + type + "\nposition " + std::to_string(x) + " " +
            std::to_string(y) + "\norientation " + std::to_string(37 * i % 360) + "deg\nfidelity " +
            (fidelity != "mixed" ? fidelity : std::array{"full", "rolling", "planar"}[i % 3]) + "\n";
  }
  return text;
}

std::string Crowd(const std::string& fidelity) {
  return "[FLOOR]\nsize 30 30 0.1\n" + Robots("minibot", fidelity, 25, 0.19);
}

std::string Things(const std::string& fidelity) {
  std::string text = "[FLOOR]\nsize 30 30 0.1\n[WALL_1]\ntype box\nsize 0.1 6 0.5\nposition 2.9 1 0\n";
  const std::array<const char*, 3> kinds = {"type box\nsize 0.2 0.3 0.2\n",
                                            "type cylinder\nsize 0.2 0.2 0.2\n", "type sphere\nsize 0.2\n"};
  for (int i = 0; i < 9; ++i) {
    text += "[OBJECT_" + std::to_string(i + 1) + "]\n" + kinds[static_cast<std::size_t>(i % 3)] +
            "mass 0.8\nposition " + std::to_string(0.35 + 0.6 * (i % 3)) + " " +
            std::to_string(0.3 + 0.6 * (i / 3)) + "\n";
  }
  return text + Robots("coopbot", fidelity, 12, 0.62);
}

std::string Shipped(const std::string& name) {
  std::ifstream file(SourceDir() + std::string("/scenarios/") + name + ".scenario");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<SameBitsCase> Runs() {
  constexpr Nanoseconds kMs = 1'000'000;
  return {
      {"FullCrowd", Crowd("full"), 1, 300, 10 * kMs, 1, "c5a74b80a315a42e"},
      {"RollingCrowd", Crowd("rolling"), 2, 400, 10 * kMs, 1, "3527f118cf70f711"},
      {"PlanarCrowd", Crowd("planar"), 3, 400, 10 * kMs, 1, "00401fe81868001c"},
      {"MixedCrowd", Crowd("mixed"), 4, 400, 10 * kMs, 1, "01196f32cf0903bd"},
      {"MixedCrowdOnTwoThreads", Crowd("mixed"), 4, 400, 10 * kMs, 2, "01196f32cf0903bd"},
      {"FullThings", Things("full"), 5, 300, 10 * kMs, 1, "2d985294452bfa2d"},
      {"RollingThings", Things("rolling"), 6, 300, 10 * kMs, 1, "4708cd5bb4354217"},
      {"PlanarThings", Things("planar"), 7, 300, 10 * kMs, 1, "965ecb6d9dd5307d"},
      {"MixedThings", Things("mixed"), 8, 300, 10 * kMs, 1, "aadde85f20892bdd"},
      {"FullLongSteps", Things("full"), 9, 60, 50 * kMs, 1, "0a2a0d65d432f418"},
      {"RollingLongSteps", Crowd("rolling"), 10, 60, 50 * kMs, 1, "9d74857431d4ab19"},
      {"PlanarShortSteps", Things("planar"), 11, 600, 2 * kMs, 1, "29b052ad3caf856f"},
      {"MixedShortSteps", Crowd("mixed"), 12, 600, 2 * kMs, 1, "a51de63875a6f4b4"},
      {"Fig4", Shipped("fig4"), 13, 500, 10 * kMs, 1, "304e5d50a672e347"},
      {"BoxMaze", Shipped("box_maze"), 14, 500, 10 * kMs, 1, "ddebfb51d8efba92"},
      {"Diffuse", Shipped("diffuse100"), 15, 200, 10 * kMs, 1, "4e158b1ddf7cd888"},
      {"Flock", Shipped("flock50"), 16, 200, 10 * kMs, 1, "994572daeb039a55"},
      {"Aggregate", Shipped("aggregate50"), 17, 300, 10 * kMs, 2, "327817fa17304e71"},
      {"Crowd200", Shipped("crowd200"), 18, 60, 10 * kMs, 2, "6581123cde75b243"},
      {"Arena", Shipped("arena20"), 19, 300, 10 * kMs, 1, "048e193c3c081387"},
  };
}

class SameBitsTest : public ::testing::TestWithParam<SameBitsCase> {};

/// Drives the robots without a controller: they start, turn and stop by step and index.
FramePtr Step(Simulation& simulation, Nanoseconds length) {
  const std::uint64_t step = simulation.frame()->step;
  std::vector<WheelSpeeds> wheels(simulation.scene().robots.size());
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    if (step > 150 || (step / 40 + i) % 4 == 0) continue;
    wheels[i] = {static_cast<double>((step / 25 + i) % 5 + 1), static_cast<double>((step / 25 + 3 * i) % 6)};
  }
  std::vector<Setpoint> setpoints = ByChannel(wheels);
  return simulation.Step(length, {setpoints, {}, {}});
}

TEST_P(SameBitsTest, GivesTheBodiesOfBefore) {
  const SameBitsCase& run = GetParam();
  static RobotLibrary library(TestPath());
  SteadyClock clock;
  WorkerPool pool(run.threads);
  ControllerOptions options = TestControllers(run.threads);
  options.in_process = true;
  ControllerHost controllers(options, clock, NullLogger(), pool);
  Diagnostics diagnostics;
  const auto scenario = ReadScenario(run.scenario, SourceDir() + std::string("/scenarios/same_bits.scenario"),
                                     library, false, diagnostics, run.seed);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  const auto simulation = Simulation::Build(MakeScene(scenario), run.seed, 1,
                                            {&pool, &controllers, AdvanceFilters}, clock, diagnostics);
  ASSERT_NE(simulation, nullptr) << diagnostics.ToString();
  simulation->SetStepLength(run.length);
  simulation->StartControllers();
  std::vector<std::uint64_t> hashes;
  for (int i = 1; i <= run.steps; ++i) {
    Step(*simulation, run.length);
    if (i % 20 == 0) hashes.push_back(StateHash(*simulation->frame()));
  }
  EXPECT_TRUE(simulation->TakeFrozen().empty());
  EXPECT_EQ(HashText(XXH3_64bits(hashes.data(), 8 * hashes.size())), run.hash);
}

INSTANTIATE_TEST_SUITE_P(Runs, SameBitsTest, ::testing::ValuesIn(Runs()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace coopdyn
