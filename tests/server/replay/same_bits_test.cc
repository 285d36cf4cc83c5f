// SPDX-License-Identifier: MIT
// Twenty runs whose bodies must stay the same to the last bit while the structure of the program changes:
// crowds, pushed objects, sleepers, long steps and loaded controllers in every fidelity. The hashes are those
// of hash version 1: step, time, bodies, wheel set-points and solver seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
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

/// The state hash of run files of format 1.
class OldHash {
 public:
  explicit OldHash(const Frame& frame) {
    Add(frame.step);
    Add(frame.time);
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      Add(std::uint64_t{frame.scene->body_ids[i].value});
      Add(frame.bodies[i]);
    }
    for (const ChannelState& channel : frame.channels) Add(channel.setpoint.reference);
    Add(frame.solver_seed);
  }
  std::uint64_t value() const { return XXH3_64bits(bytes_.data(), bytes_.size()); }

 private:
  template <typename T>
  void Add(const T& value) {
    const std::size_t size = bytes_.size();
    bytes_.resize(size + sizeof(T));
    std::memcpy(bytes_.data() + size, &value, sizeof(T));
  }
  std::vector<unsigned char> bytes_;
};

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
      {"FullCrowd", Crowd("full"), 1, 300, 10 * kMs, 1, "ea70014e8ac221a0"},
      {"RollingCrowd", Crowd("rolling"), 2, 400, 10 * kMs, 1, "b1ef938072485222"},
      {"PlanarCrowd", Crowd("planar"), 3, 400, 10 * kMs, 1, "b20efa864cf1815a"},
      {"MixedCrowd", Crowd("mixed"), 4, 400, 10 * kMs, 1, "37855510ad5cfeb0"},
      {"MixedCrowdOnTwoThreads", Crowd("mixed"), 4, 400, 10 * kMs, 2, "37855510ad5cfeb0"},
      {"FullThings", Things("full"), 5, 300, 10 * kMs, 1, "b704ba343200bca4"},
      {"RollingThings", Things("rolling"), 6, 300, 10 * kMs, 1, "64d106d9a744340d"},
      {"PlanarThings", Things("planar"), 7, 300, 10 * kMs, 1, "8f6a613a32272756"},
      {"MixedThings", Things("mixed"), 8, 300, 10 * kMs, 1, "60c8338842aa40fa"},
      {"FullLongSteps", Things("full"), 9, 60, 50 * kMs, 1, "19116f71b80fc9ec"},
      {"RollingLongSteps", Crowd("rolling"), 10, 60, 50 * kMs, 1, "ded0e5b995245ee8"},
      {"PlanarShortSteps", Things("planar"), 11, 600, 2 * kMs, 1, "41b74c8b343a12f8"},
      {"MixedShortSteps", Crowd("mixed"), 12, 600, 2 * kMs, 1, "f4efdad9cddd3808"},
      {"Fig4", Shipped("fig4"), 13, 500, 10 * kMs, 1, "837c28dd92f9363c"},
      {"BoxMaze", Shipped("box_maze"), 14, 500, 10 * kMs, 1, "4b558f6d41c63799"},
      {"Diffuse", Shipped("diffuse100"), 15, 200, 10 * kMs, 1, "5e2b0ea6b3ee2bfb"},
      {"Flock", Shipped("flock50"), 16, 200, 10 * kMs, 1, "e5fffb5d81b44960"},
      {"Aggregate", Shipped("aggregate50"), 17, 300, 10 * kMs, 2, "366224bf4e00c648"},
      {"Crowd200", Shipped("crowd200"), 18, 60, 10 * kMs, 2, "07516bc2d47d207b"},
      {"Arena", Shipped("arena20"), 19, 300, 10 * kMs, 1, "d094883aa0d8d743"},
  };
}

class SameBitsTest : public ::testing::TestWithParam<SameBitsCase> {};

/// Drives the robots that no controller drives: they start, turn and stop by step and index.
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
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "the C library computes sines otherwise without FMA";
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
    if (i % 20 == 0) hashes.push_back(OldHash(*simulation->frame()).value());
  }
  EXPECT_TRUE(simulation->TakeFrozen().empty());
  EXPECT_EQ(HashText(XXH3_64bits(hashes.data(), 8 * hashes.size())), run.hash);
}

INSTANTIATE_TEST_SUITE_P(Runs, SameBitsTest, ::testing::ValuesIn(Runs()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace coopdyn
