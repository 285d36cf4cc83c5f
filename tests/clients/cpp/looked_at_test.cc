// SPDX-License-Identifier: MIT
// Robots that a program only reads, commands that were not recorded, and names of recordings.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/run_file.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"
#include "tests/source_dir.h"

namespace coopdyn::client {
namespace {

namespace fs = std::filesystem;

/// A run of mini_1 to mini_4, which nobody drives, and auto, driven by a loaded controller; in a new folder.
class LookedAt : public testing::Test {
 protected:
  LookedAt() {
    std::string name = (fs::temp_directory_path() / "coopdyn_looked_at_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~LookedAt() override { fs::remove_all(folder_); }

  std::string Record(const std::string& what) const {
    const std::string file = (folder_ / "m.run").string();
    const std::string command = std::string(std::getenv("COOPDYN_BINARY")) + " serve " + SourceDir() +
                                "/tests/clients/python/looked_at.scenario" +
                                " --mode free --no-net --duration 0.8 " + "--record " + file +
                                " --record-what " + what + " > /dev/null 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return file;
  }

  fs::path folder_;
};

std::string OwnerOf(Simulation& sim, const std::string& name) {
  const Json status = sim.status();
  for (const Json& robot : status["robots"].items()) {
    if (robot["name"].text() == name) return robot["owner"].text();
  }
  return "";
}

void Branch(Simulation& sim) {
  sim.branch(0.6);
  sim.set_mode("lockstep");
  sim.run();
}

TEST_F(LookedAt, OneThatAControllerDrivesIsStillLookedAtAfterABranch) {
  const auto daemon = ServerProcess::Command({"play", Record("all"), "--paused"});
  auto sim = connect(daemon.server(), {.name = "ana"});
  auto automatic = sim.robot("auto");
  const double before = automatic.get_pose().x;
  sim.seek(9);
  EXPECT_TRUE(Says(ErrorOf([&] { sim.step(1, 0.1); }), "the recording has ended; sim.run() plays it again"));
  Branch(sim);
  auto team = sim.team("mini");
  for (int i = 0; i < 5; ++i) sim.step(1, 60);
  EXPECT_EQ(team.step(std::vector<double>{0.1, 0}, 60).step, 66);
  EXPECT_NE(automatic.get_pose().x, before);
  EXPECT_EQ(OwnerOf(sim, "auto"), "controller diffuse");
  EXPECT_TRUE(Says(ErrorOf([&] { automatic.set_velocity(0.1, 0); }), "controller diffuse"));
  sim.step(1, 60);
  sim.release_robot("auto");
  automatic.set_velocity(0.1, 0);
  sim.step(1, 60);
  EXPECT_EQ(OwnerOf(sim, "auto"), "ana");
}

TEST_F(LookedAt, OneThatIsFreeAfterABranchStepsWithTheProgram) {
  const auto daemon = ServerProcess::Command({"play", Record("all"), "--paused"});
  auto sim = connect(daemon.server(), {.name = "ana"});
  for (int i = 1; i <= 4; ++i) sim.robot("mini_" + std::to_string(i));
  Branch(sim);
  sim.step(3, 60);
  EXPECT_EQ(sim.steps(), 63);
  EXPECT_EQ(OwnerOf(sim, "mini_3"), "ana");
}

TEST_F(LookedAt, ATeamTakesThoseThatTheProgramHasOnlyLookedAt) {
  const auto daemon = ServerProcess::Command({"play", Record("all"), "--paused"});
  auto sim = connect(daemon.server(), {.name = "ana"});
  auto mini = sim.robot("mini_4");
  Branch(sim);
  auto near = sim.robot("mini_2");
  EXPECT_EQ(near.get_pose().forward, 0);
  auto team = sim.team("mini");
  EXPECT_EQ(team.n(), 4u);
  for (int i = 0; i < 3; ++i) team.step(std::vector<double>{0.1, 0}, 60);
  sim.step(1, 60);
  EXPECT_GT(mini.get_wheels().left_speed, 0);
  EXPECT_TRUE(Says(ErrorOf([&] { near.set_velocity(0.1, 0); }), "mini_2 is driven by its team"));
  team.release();
  for (int i = 1; i <= 4; ++i) sim.robot("mini_" + std::to_string(i)).set_velocity(0.05, 0);
  sim.step(1, 60);
  EXPECT_EQ(OwnerOf(sim, "mini_1"), "ana");
  EXPECT_TRUE(Says(ErrorOf([&] { sim.team("mini"); }), "mini_1 is driven by ana"));
}

TEST_F(LookedAt, CommandsOfAControllerThatWereNotRecordedAreAnErrorThatSaysSo) {
  const auto run = read_run(Record("poses"));
  const Error error = ErrorOf([&] { run.commands("auto"); });
  EXPECT_EQ(error.code(), 5);
  EXPECT_EQ(error.text(), "the commands of auto, driven by controller diffuse, were not recorded in " +
                              run.file() + "; record with --record-what poses,controllers");
  EXPECT_EQ(run.commands("mini_1").size(), 1u);
}

TEST_F(LookedAt, CommandsOfAControllerThatWereRecordedAreRead) {
  EXPECT_GT(read_run(Record("poses,controllers")).commands("auto").size(), 1u);
}

TEST_F(LookedAt, OfARobotTakenFromItsControllerAClientsCommandsAreThere) {
  const std::string file = (folder_ / "taken.run").string();
  const std::string write = "cd " + SourceDir() + "/tests/clients/python && python3 -B -c '" +
                            std::string("import run_file as rf; rf.write_taken(\"") + file + "\")'";
  ASSERT_EQ(std::system(write.c_str()), 0);
  const RunRows commands = read_run(file).commands("m");
  EXPECT_EQ(commands.values(), (std::vector<double>{1, 0.01, 2, 0, 3, 3, 2, 0.02, 3, 0, 3, 3}));
}

TEST_F(LookedAt, ARecordingMayHaveANameWithBlanks) {
  const auto daemon = ServerProcess::Fake({});
  auto sim = connect(daemon.server());
  const std::string name = "my lesson ü";
  EXPECT_EQ(sim.record(name), name + ".run");
  Recorded recorded = sim.stop_recording();
  EXPECT_EQ(recorded.name, name + ".run");
  EXPECT_EQ(recorded.url, "http://" + daemon.server() + "/runs/my%20lesson%20%C3%BC.run");
  std::ifstream in(sim.fetch_run(name, (folder_ / "copy.run").string()));
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "/runs/" + name + ".run");
  EXPECT_TRUE(Says(ErrorOf([&] { sim.fetch_run(" "); }), "the name of a recording is a text"));
  sim.load_scenario("!page=0");
  sim.record(name);
  recorded = sim.stop_recording();
  EXPECT_EQ(recorded.name + "," + recorded.url, name + ".run,");
}

TEST_F(LookedAt, PlotRunSaysWhatToWriteAndWhatIsNotThere) {
  const auto code = [&](const std::string& arguments) {
    const std::string command = std::string(CLIENT_PLOT_RUN) + arguments + " > /dev/null 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  EXPECT_EQ(code(""), 2);
  EXPECT_EQ(code(" no.run robot1"), 1);
}

}  // namespace
}  // namespace coopdyn::client
