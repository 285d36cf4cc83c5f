// SPDX-License-Identifier: MIT
// The files of `coopdyn new-controller` compile without a warning and drive the robot of their scenario.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "server/app/commands.h"
#include "server/model/readers.h"
#include "tests/server/controllers/swarm.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NewControllerTest : public testing::Test {
 protected:
  NewControllerTest() : folder_(testing::TempDir() + "new_controller_" + std::to_string(getpid())) {
    fs::create_directories(folder_);
  }
  ~NewControllerTest() override { fs::remove_all(folder_); }

  int New(const std::string& name, bool supervisor = false) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = NewController(name, folder_, supervisor);
    out_ = testing::internal::GetCapturedStdout();
    errors_ = testing::internal::GetCapturedStderr();
    return code;
  }

  static void Build(const fs::path& made) {
    const std::string build = "cd '" + made.string() +
                              "' && (cmake -B build -DCMAKE_C_FLAGS='-Werror -Wpedantic' && "
                              "cmake --build build) > build.log 2>&1";
    ASSERT_EQ(std::system(build.c_str()), 0)
        << (std::ostringstream() << std::ifstream(made / "build.log").rdbuf()).str();
  }

  const fs::path folder_;
  std::string out_, errors_;
};

TEST_F(NewControllerTest, ItBuildsWithoutWarningsAndDrivesTheRobotOfItsScenario) {
  ASSERT_EQ(New("my_robot2"), kExitOk);
  EXPECT_THAT(out_, HasSubstr("cmake -B build && cmake --build build"));
  const fs::path made = folder_ / "my_robot2";
  Build(made);

  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((made / "my_robot2.scenario").string(), library, diagnostics);
  ASSERT_TRUE(scenario) << diagnostics.ToString();
  ASSERT_EQ(scenario->robots.size(), 1u);
  EXPECT_EQ(scenario->robots[0].controller.file, (made / "my_robot2.so").string());

  SteadyClock clock;
  WorkerPool pool(1);
  ControllerHost host(TestOptions(), clock, NullLogger(), pool);
  host.Check(*scenario, diagnostics);
  EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.ToString();
  auto frame = std::make_shared<Frame>();
  frame->scene = MakeScene(scenario);
  frame->bodies.resize(frame->scene->body_ids.size());
  frame->channels.resize(frame->scene->channels.size());
  host.Configure(frame);
  for (const StoppedController& stopped : host.TakeStopped()) ADD_FAILURE() << stopped.why;
  std::vector<Setpoint> setpoints(2);
  std::vector<SentMessage> messages;
  host.Step(frame, setpoints, messages);
  EXPECT_GT(setpoints[0].reference, 0);
}

TEST_F(NewControllerTest, ASupervisorBuildsWithoutWarningsAndFitsItsScenario) {
  ASSERT_EQ(New("boss", true), kExitOk);
  const fs::path made = folder_ / "boss";
  Build(made);
  RobotLibrary library(SearchPath{{SourceDir(), fs::path(Sample("diffuse")).parent_path()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((made / "boss.scenario").string(), library, diagnostics);
  ASSERT_TRUE(scenario) << diagnostics.ToString();
  EXPECT_EQ(scenario->simulation.supervisor.file, (made / "boss.so").string());
  SteadyClock clock;
  WorkerPool pool(1);
  ControllerHost host(TestOptions(), clock, NullLogger(), pool);
  host.Check(*scenario, diagnostics);
  EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.ToString();
}

TEST_F(NewControllerTest, ItOverwritesNothing) {
  ASSERT_EQ(New("mine"), kExitOk);
  std::ofstream(folder_ / "mine" / "mine.c") << "my work";
  EXPECT_EQ(New("mine"), kExitErrors);
  EXPECT_THAT(errors_, HasSubstr("mine is there already: choose another name, or another --folder"));
  std::string text;
  std::getline(std::ifstream(folder_ / "mine" / "mine.c"), text);
  EXPECT_EQ(text, "my work");
}

TEST_F(NewControllerTest, ABadNameIsToldWithABetterOne) {
  for (const auto& [name, better] : std::vector<std::pair<std::string, std::string>>{{"My-Robot", "my_robot"},
                                                                                     {"2fast", "fast"},
                                                                                     {"", "my_robot"},
                                                                                     {"../evil", "evil"},
                                                                                     {"a b", "a_b"}}) {
    EXPECT_EQ(New(name), kExitWrongUse) << name;
    EXPECT_THAT(errors_, HasSubstr("a letter first, for example " + better + "\n"));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(NewControllerTest, AFolderThatCannotBeMadeIsSaid) {
  std::ofstream(folder_ / "file") << "";
  testing::internal::CaptureStderr();
  EXPECT_EQ(NewController("mine", folder_ / "file"), kExitErrors);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("mine"));
}

}  // namespace
}  // namespace coopdyn
