// SPDX-License-Identifier: MIT
// Runs with loaded controllers and broadcasts: the controllers compute the same again.
#include "server/replay/resimulator.h"

#include <gmock/gmock.h>

#include "server/replay/verify.h"
#include "tests/server/controllers/plugins/deeds.h"
#include "tests/server/record/rechain.h"
#include "tests/server/replay/replay_fixture.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

/// Twelve robots driven by a controller, and one by clients.
std::string Swarm(const std::string& controller) {
  return "[SWARM_1]\ntype minibot\nname m\ncount 12\narea 0 0 1.5 1.5\nfidelity rolling\ncontroller " +
         controller + "\n[ROBOT_1]\ntype minibot\nname robot1\nposition 1.2 0\n";
}

class ResimulatorTest : public ::testing::Test {
 protected:
  std::string File(const std::string& name = "swarm.run") const { return folder_.File(name); }
  static VerifyReport Repeat(const std::string& file, const SearchPath& path = TestPath(), int threads = 1) {
    std::string error;
    const auto reader = RunReader::Open(file, error);
    EXPECT_NE(reader, nullptr) << error;
    Repeating repeating(threads);
    repeating.services.path = path;
    return Verify(*reader, repeating.services, nullptr);
  }
  static void ExpectEqual(const std::string& file, std::uint64_t steps) {
    EXPECT_EQ(ToString(Repeat(file)), "equal, " + std::to_string(steps) + " steps\n");
  }
  void MakeSwarm(const std::string& controller, int steps, LiveOptions options = {}) {
    LiveRun run(File(), Swarm(controller), options);
    for (int k = 0; k < steps; ++k) {
      if (k % 9 == 0) run.Command("robot1", 5, 4 - 0.05 * k);
      run.Step();
    }
  }
  /// A search path without controllers.
  SearchPath Nowhere() const {
    SearchPath path;
    path.folders.emplace_back(SourceDir());
    return path;
  }

  const TempFolder folder_;
};

TEST_F(ResimulatorTest, LoadedControllersComputeTheSameAgain) {
  MakeSwarm("aggregate", 120);
  ExpectEqual(File(), 120);
}

TEST_F(ResimulatorTest, AnotherNumberOfThreadsIsEqual) {
  MakeSwarm("flock", 120, {.threads = 2});
  EXPECT_EQ(ToString(Repeat(File(), TestPath(), 1)), "equal, 120 steps\n");
  EXPECT_EQ(ToString(Repeat(File(), TestPath(), 3)), "equal, 120 steps\n");
}

TEST_F(ResimulatorTest, WithoutTheirSetpointsInTheFileToo) {
  MakeSwarm("diffuse", 120, {.what = {}});
  ExpectEqual(File(), 120);
}

TEST_F(ResimulatorTest, ABitOfAControllersCommandIsNamedByItsStep) {
  MakeSwarm("flock", 60);
  // Its first robot comes first in the blob whenever its set-point has changed.
  Tamper(File()).FlipCommand(31, 40 + 3);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 31u);
  EXPECT_THAT(report.difference->what, ::testing::StartsWith("m_"));
  EXPECT_EQ(report.difference->field, "left_wheel_joint_setpoint_rad_s");
  EXPECT_TRUE(report.difference->exact);
}

TEST_F(ResimulatorTest, BroadcastsOfClientsAndControllersAreRepeated) {
  {
    LiveRun run(File(), Swarm("mirror what=4"));
    for (int k = 0; k < 100; ++k) {
      if (k % 4 == 0) run.Send("robot1", {0.5 * k, 1, 2});
      run.Step();
    }
    // Some robot heard a message; otherwise this test proves nothing.
    EXPECT_TRUE(std::any_of(run.frame()->messages.begin(), run.frame()->messages.end(),
                            [](const SentMessage& sent) { return sent.message.values[0] > 0; }));
  }
  ExpectEqual(File(), 100);
}

TEST_F(ResimulatorTest, ABitOfABroadcastThatAControllerHearsIsNamed) {
  {
    // The nearest one hears robot1 alone.
    LiveRun run(File(),
                "[ROBOT_1]\ntype minibot\nname m\nposition 0 0\ncontroller mirror what=4\n"
                "[ROBOT_2]\ntype minibot\nname robot1\nposition 0.3 0\n");
    for (int k = 0; k < 40; ++k) {
      run.Send("robot1", {0.5 * k, 1, 2});
      run.Step();
    }
  }
  ExpectEqual(File(), 40);
  const std::string where = " WHERE step = 20";
  // m's message comes first: u32 robot, u32 count, and its numbers; then robot1's.
  std::size_t bit = 0;
  {
    std::string error;
    const auto reader = RunReader::Open(File(), error);
    const auto step = reader->Read(20, true);
    ASSERT_EQ(step->messages.size(), 2u);
    bit = 8 * (8 + 8 * step->messages[0].message.count + 8) + 3;
  }
  Tamper(File()).FlipBit("SELECT messages FROM step" + where, "UPDATE step SET messages = ?1" + where, bit);
  const VerifyReport report = Repeat(File());
  ASSERT_TRUE(report.difference) << ToString(report);
  EXPECT_EQ(report.difference->step, 21u);  // m reports what it has heard
  EXPECT_EQ(report.difference->what, "m");
  EXPECT_EQ(report.difference->field, "broadcast");
}

TEST_F(ResimulatorTest, AnUnloadedControllerLeavesItsRobotToClients) {
  {
    LiveRun run(File(), Swarm("diffuse"));
    run.Step(30);
    EXPECT_EQ(run.Apply(edit::UnloadController{"m_3"}).error, Error::kOk);
    run.Step(30);
    run.Command("m_3", 4, 5);
    run.Send("m_3", {1, 2});
    run.Step(60);
  }
  ExpectEqual(File(), 120);
}

TEST_F(ResimulatorTest, AnUnloadedControllerIsRepeatedWithoutRecordedSetpoints) {
  {
    LiveRun run(File(), Swarm("diffuse"), {.what = {}});
    run.Step(30);
    run.Apply(edit::UnloadController{"m_3"});
    run.Step(30);
    run.Command("m_3", 4, 5);
    run.Step(30);
    run.Apply(edit::StopAll{});
    run.Step(30);
  }
  ExpectEqual(File(), 120);
}

TEST_F(ResimulatorTest, ARecordingThatBeginsAfterAControllerWasUnloadedIsEqual) {
  SavedStatePtr state;
  {
    LiveRun run(File("before.run"), Swarm("diffuse"));
    run.Step(10);
    run.Apply(edit::UnloadController{"m_3"});
    run.Command("m_3", 4, 5);
    run.Step(10);
    state = run.Apply(edit::Save{}).saved;
  }
  for (const bool setpoints : {true, false}) {
    const std::string file = File(setpoints ? "with.run" : "without.run");
    LiveRun run(file, state, {.what = {.controllers = setpoints}});
    run.Step(10);
    run.Apply(edit::StopAll{});
    run.Step(60);
    run.End();
    ExpectEqual(file, 70);
  }
}

TEST_F(ResimulatorTest, ACrashingControllerStopsInTheSameStep) {
  {
    LiveRun run(File(), Swarm("hostile deed=" + std::to_string(kDivideByZero) + " at=70"));
    run.Step(120);
    EXPECT_FALSE(run.events().empty());
  }
  ExpectEqual(File(), 120);
}

TEST_F(ResimulatorTest, AControllerThatThrowsLeavesTheOthersDriving) {
  {
    LiveRun run(File(), Swarm("aggregate") +
                            "[ROBOT_2]\ntype minibot\nname bad\nposition -1.2 0\ncontroller hostile deed=" +
                            std::to_string(kThrowError) + " at=33\n");
    run.Step(80);
  }
  ExpectEqual(File(), 80);
}

TEST_F(ResimulatorTest, WithoutTheControllersTheirRecordedSetpointsAreUsed) {
  MakeSwarm("flock", 80);
  const VerifyReport report = Repeat(File(), Nowhere());
  EXPECT_EQ(report.error, "");
  EXPECT_FALSE(report.difference) << ToString(report);
  EXPECT_EQ(report.steps, 80u);
  EXPECT_THAT(report.warning,
              HasSubstr("controller flock is not found: the set-points of controllers are taken "
                        "from the recording, not computed again"));
}

TEST_F(ResimulatorTest, AControllerThatIsNotTheRecordedOneIsNamed) {
  MakeSwarm("flock", 20);
  std::string error;
  const std::vector<PluginHash> plugins = RunReader::Open(File(), error)->header().controllers;
  ASSERT_EQ(plugins.size(), 1U);
  EXPECT_EQ(plugins[0].name, "flock");
  EXPECT_EQ(plugins[0].hash.size(), 16U);
  ExpectEqual(File(), 20);
  Tamper(File()).Run("UPDATE meta SET value = 'flock 0123456789abcdef' WHERE key = 'controllers'");
  Rechain(File());
  const VerifyReport report = Repeat(File());
  EXPECT_EQ(report.error, "");
  EXPECT_EQ(report.warning, "controller flock is not the one that was recorded (hash 0123456789abcdef, now " +
                                plugins[0].hash + ")");
}

TEST_F(ResimulatorTest, ABranchWarnsOfAControllerThatIsNotTheRecordedOne) {
  MakeSwarm("flock", 60);
  Tamper(File()).Run("UPDATE meta SET value = 'flock 0123456789abcdef' WHERE key = 'controllers'");
  Rechain(File());
  std::string error;
  const auto reader = RunReader::Open(File(), error);
  Diagnostics diagnostics;
  ASSERT_NE(reader->LoadScenario(TestPath(), diagnostics), nullptr);
  const Repeating repeating;
  for (const std::uint64_t step : {0u, 20u, 50u}) {
    const SavedStatePtr state = StateAt(*reader, step, repeating.services, error);
    ASSERT_NE(state, nullptr) << error;
    EXPECT_THAT(state->warning,
                HasSubstr("controller flock is not the one that was recorded (hash 0123456789abcdef, now "))
        << step;
  }
}

TEST_F(ResimulatorTest, WithoutControllersAndSetpointsItSaysWhatToDo) {
  MakeSwarm("diffuse", 20, {.what = {}});
  EXPECT_THAT(Repeat(File(), Nowhere()).error, HasSubstr("name its folder with --scenarios DIR"));
}

TEST_F(ResimulatorTest, ABranchBetweenKeyframesHasTheOriginalHashesWithControllersToo) {
  std::vector<std::uint64_t> hashes;
  const auto drive = [](LiveRun& run) {
    const std::uint64_t k = run.frame()->step;
    if (k % 9 == 0) run.Command("robot1", 5, 4 - 0.05 * static_cast<double>(k));
    if (k == 40) run.Apply(edit::UnloadController{"m_3"});
    if (k == 45) run.Command("m_3", 3, 4);
    run.Step();
  };
  {
    LiveRun run(File(), Swarm("flock"));
    hashes.push_back(run.hash());
    while (run.frame()->step < 110) {
      drive(run);
      hashes.push_back(run.hash());
    }
  }
  for (const std::uint64_t step : {0u, 37u, 50u, 63u, 100u}) {
    SavedStatePtr state;
    {
      std::string error;
      const auto reader = RunReader::Open(File(), error);
      Diagnostics diagnostics;
      ASSERT_NE(reader->LoadScenario(TestPath(), diagnostics), nullptr);
      const Repeating repeating;
      state = StateAt(*reader, step, repeating.services, error);
      ASSERT_NE(state, nullptr) << error;
    }
    LiveRun branch(File("branch" + std::to_string(step) + ".run"), state);
    while (branch.frame()->step < 110) {
      drive(branch);
      ASSERT_EQ(branch.hash(), hashes[branch.frame()->step]) << "branch at " << step;
    }
  }
}

}  // namespace
}  // namespace coopdyn
