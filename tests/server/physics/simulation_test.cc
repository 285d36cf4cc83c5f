// SPDX-License-Identifier: MIT
// A simulation that is restarted, or restored to any of its states, continues like a newly built one.
#include "server/physics/simulation.h"
#include "server/base/sanitizers.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "tests/server/physics/simulation_scene.h"

namespace coopdyn {
namespace {

constexpr int kSteps = 300;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kRestarts = 100;
constexpr long kMayGrow = 512 << 20;  // bytes: they keep freed memory for a while
#else
constexpr int kRestarts = 1000;
constexpr long kMayGrow = 1 << 20;  // bytes: a leak of 2 kB each time would be as much
#endif

const std::vector<Fidelity> kAll = {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar};

std::vector<std::uint64_t> Fresh(const std::shared_ptr<const Scene>& scene, std::uint64_t seed = 1) {
  SteppedSimulation simulation(scene, seed);
  return WholeHashes(simulation, kSteps);
}

long ResidentBytes() {
  std::ifstream stream("/proc/self/statm");
  long size = 0, resident = 0;
  stream >> size >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

class RestartTest : public testing::TestWithParam<std::vector<Fidelity>> {};

TEST_P(RestartTest, ManyRestartsEqualAFreshBuild) {
  const auto scene = SimulationScene(GetParam());
  SteppedSimulation simulation(scene);
  for (int k = 0; k < kRestarts; ++k) {
    simulation.Steps(k % 5);
    simulation->Restart(1, 2);
  }
  EXPECT_EQ(WholeHashes(simulation, kSteps), Fresh(scene));
}

TEST_P(RestartTest, WithAnotherSeedItEqualsAFreshBuildWithThatSeed) {
  const auto scene = SimulationScene(GetParam());
  SteppedSimulation simulation(scene, 1);
  simulation.Steps(70);
  simulation->Restart(99, 2);
  const auto other = WholeHashes(simulation, kSteps);
  EXPECT_EQ(other, Fresh(scene, 99));
  simulation->Restart(1, 3);
  EXPECT_EQ(WholeHashes(simulation, kSteps), Fresh(scene, 1));
}

TEST_P(RestartTest, RestoredAtAnyStepItGoesOnBitForBit) {
  const auto scene = SimulationScene(GetParam());
  SteppedSimulation run(scene);
  std::vector<SavedState> saved = {run->Save()};
  std::vector<std::uint64_t> expected = {WholeHash(*run->frame())};
  for (int k = 0; k < kSteps; ++k) {
    expected.push_back(WholeHash(*run.Step()));
    saved.push_back(run->Save());
  }
  SteppedSimulation same(scene);
  // Back and forth, so that each state is restored from a very different one.
  for (const int at : {150, 3, 299, 0, 61, 60, 119, 7, 250, 1}) {
    EXPECT_EQ(same->Restore(saved[static_cast<std::size_t>(at)], 5), "");
    EXPECT_EQ(same->frame()->epoch, 5u);
    const auto hashes = WholeHashes(same, std::min(60, kSteps - at));
    EXPECT_TRUE(std::equal(hashes.begin(), hashes.end(), expected.begin() + at)) << "from step " << at;
  }
}

TEST_P(RestartTest, RestoredIntoAFreshBuildItGoesOnToTheEnd) {
  const auto scene = SimulationScene(GetParam());
  SteppedSimulation run(scene);
  run.Steps(137);
  const SavedState saved = run->Save();
  const auto expected = WholeHashes(run, 200);
  SteppedSimulation other(SimulationScene(GetParam()), 77);
  EXPECT_EQ(other->Restore(saved, 1), "");
  EXPECT_EQ(WholeHashes(other, 200), expected);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, RestartTest,
                         testing::Values(std::vector{Fidelity::kFull}, std::vector{Fidelity::kRolling},
                                         std::vector{Fidelity::kPlanar}, kAll),
                         [](const auto& info) {
                           return info.param.size() > 1 ? std::string("All") : ToString(info.param[0]);
                         });

TEST(SimulationSceneTest, ItSaysSomething) {
  // Otherwise the tests of this scene would prove little: seeds matter, bodies sleep, broadcasts are pending.
  const auto scene = SimulationScene({Fidelity::kFull});
  SteppedSimulation simulation(scene), other(scene, 2);
  other.Steps(250);
  const std::uint64_t drawn = simulation->frame()->solver_seed;
  simulation.Steps(250);
  EXPECT_NE(simulation->frame()->solver_seed, drawn);
  const auto same = [](const BodyState& a, const BodyState& b) { return a.p_WB == b.p_WB; };
  const std::vector<BodyState>&bodies = simulation->frame()->bodies, &others = other->frame()->bodies;
  EXPECT_FALSE(std::equal(bodies.begin(), bodies.end(), others.begin(), same));
  EXPECT_GT(simulation->frame()->messages.size(), 10u);
  EXPECT_TRUE(std::any_of(bodies.begin(), bodies.end(), [](const BodyState& b) { return b.v_WB.isZero(); }));
}

/// The state in which a robot of the crowd and a thing are about to explode.
SavedState AboutToExplode(SteppedSimulation& simulation) {
  simulation.Steps(40);
  const Frame& now = *simulation->frame();
  auto frame = std::make_shared<Frame>();
  frame->step = now.step;
  frame->time = now.time;
  frame->seed = now.seed;
  frame->solver_seed = now.solver_seed;
  frame->scene = now.scene;
  frame->bodies = now.bodies;
  frame->channels = now.channels;
  frame->commanded = now.commanded;
  frame->messages = now.messages;
  const auto robot = static_cast<std::size_t>(now.scene->robots[2].first_body);
  frame->bodies[robot].v_WB = {0, 800, 0};
  frame->bodies[0].v_WB = {0, 0, 900};
  return {frame, {}, Mode::kRealtime, false, {}, {}};
}

TEST(SimulationFreezeTest, ARestartForgetsWhatWasFrozen) {
  const auto scene = SimulationScene(kAll);
  SteppedSimulation simulation(scene);
  EXPECT_EQ(simulation->Restore(AboutToExplode(simulation), 1), "");
  simulation.Steps(5);
  ASSERT_GE(simulation->TakeFrozen().size(), 2u);
  ASSERT_TRUE(IsFrozen(*simulation->frame(), 2));
  simulation->Restart(1, 2);
  EXPECT_EQ(WholeHashes(simulation, kSteps), Fresh(scene));
  EXPECT_TRUE(simulation->TakeFrozen().empty());
}

TEST(SimulationFreezeTest, WhatIsFrozenStaysSoWhenRestored) {
  const auto scene = SimulationScene(kAll);
  SteppedSimulation run(scene);
  EXPECT_EQ(run->Restore(AboutToExplode(run), 1), "");
  run.Steps(5);
  const SavedState saved = run->Save();
  const auto expected = WholeHashes(run, 100);
  for (SteppedSimulation* other : {&run, std::make_unique<SteppedSimulation>(scene).release()}) {
    const std::unique_ptr<SteppedSimulation> owned(other == &run ? nullptr : other);
    (*other)->TakeFrozen();
    EXPECT_EQ((*other)->Restore(saved, 1), "");
    EXPECT_TRUE(IsFrozen(*(*other)->frame(), 2));
    EXPECT_EQ(WholeHashes(*other, 100), expected);
    EXPECT_TRUE((*other)->TakeFrozen().empty()) << "it is no news";
  }
}

TEST(SimulationTest, BroadcastsOnTheirWayAreRestoredAndForgottenByARestart) {
  SteppedSimulation simulation(SimulationScene(kAll));
  simulation.Steps(20);
  const SavedState saved = simulation->Save();
  const auto count = saved.frame->messages.size();
  ASSERT_GT(count, 0u);
  simulation->Restart(1, 2);
  EXPECT_TRUE(simulation->frame()->messages.empty());
  EXPECT_EQ(simulation->Restore(saved, 3), "");
  EXPECT_EQ(simulation->frame()->messages.size(), count);
  EXPECT_EQ(simulation->frame()->messages.front().step, 16u);  // it may be heard for four more steps
}

TEST(SimulationTest, StepsOfAnotherLengthAreRestored) {
  const auto scene = SimulationScene(kAll);
  SteppedSimulation run(scene);
  for (int k = 0; k < 50; ++k) run.Step(3'000'000);
  const SavedState saved = run->Save();
  EXPECT_EQ(saved.frame->step_length, 3'000'000);
  EXPECT_EQ(saved.frame->time, 150'000'000);
  std::vector<std::uint64_t> expected, hashes;
  for (int k = 0; k < 50; ++k) expected.push_back(WholeHash(*run.Step(7'000'000)));
  run->Restart(1, 2);
  EXPECT_EQ(run->Restore(saved, 3), "");
  EXPECT_EQ(run->frame()->step_length, 3'000'000);
  for (int k = 0; k < 50; ++k) hashes.push_back(WholeHash(*run.Step(7'000'000)));
  EXPECT_EQ(hashes, expected);
}

TEST(SimulationTest, TheFirstFrameSaysHowLongStepsWillBe) {
  SteppedSimulation simulation(SimulationScene(kAll));
  EXPECT_EQ(simulation->frame()->step_length, kDefaultStep);
  simulation->SetStepLength(5'000'000);
  EXPECT_EQ(simulation->frame()->step_length, 5'000'000);
  simulation.Step(5'000'000);
  simulation->SetStepLength(2'000'000);
  EXPECT_EQ(simulation->frame()->step_length, 5'000'000) << "of the step that made it";
  simulation->Restart(1, 2);
  EXPECT_EQ(simulation->frame()->step_length, 2'000'000);
}

TEST(SimulationTest, WorkersMakeNoDifferenceToARestart) {
  const auto scene = SimulationScene(kAll, 40);
  WorkerPool pool(3);
  SteppedSimulation simulation(scene, 1, {&pool, nullptr});
  simulation.Steps(30);
  const SavedState saved = simulation->Save();
  simulation.Steps(30);
  simulation->Restart(1, 2);
  EXPECT_EQ(WholeHashes(simulation, kSteps), Fresh(scene));
  SteppedSimulation alone(scene);
  EXPECT_EQ(alone->Restore(saved, 1), "");
  EXPECT_EQ(simulation->Restore(saved, 1), "");
  EXPECT_EQ(WholeHashes(simulation, 60), WholeHashes(alone, 60));
}

TEST(SimulationTest, RestartsTakeTheSameTimeAndMemoryEachTime) {
  const auto scene = SimulationScene({Fidelity::kFull}, 17);  // 20 robots
  SteppedSimulation simulation(scene);
  std::vector<double> cpu_s;
  long warm = 0;
  for (int k = 0; k < kRestarts; ++k) {
    simulation.Steps(3);
    const std::clock_t began = std::clock();
    simulation->Restart(1, static_cast<std::uint64_t>(k));
    cpu_s.push_back(static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
    if (k == kRestarts / 10) warm = ResidentBytes();
  }
  EXPECT_LT(ResidentBytes() - warm, kMayGrow);
  const auto tenth = static_cast<std::ptrdiff_t>(cpu_s.size() / 10);
  EXPECT_LT(*std::min_element(cpu_s.end() - tenth, cpu_s.end()),
            2 * *std::min_element(cpu_s.begin(), cpu_s.begin() + tenth) + 1e-3);
  std::sort(cpu_s.begin(), cpu_s.end());
  RecordProperty("median_cpu_us", std::to_string(1e6 * cpu_s[cpu_s.size() / 2]));
}

}  // namespace
}  // namespace coopdyn
