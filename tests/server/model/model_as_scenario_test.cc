// SPDX-License-Identifier: MIT
// A robot's model, served directly: a world with only that robot.
#include <gtest/gtest.h>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

constexpr const char* kUrdf =
    "<robot name=\"arm\"><link name=\"base\"/><link name=\"hand\"><inertial><mass value=\"1\"/>"
    "<inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>"
    "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>"
    "<joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child link=\"hand\"/><axis xyz=\"0 0 1\"/>"
    "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";

TEST(ModelAsScenarioTest, AUrdfStandsAloneInAnEmptyWorld) {
  const TempFolder folder;
  folder.Write("my arm.urdf", kUrdf);
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((folder.path() / "my arm.urdf").string(), library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  ASSERT_EQ(scenario->robots.size(), 1u);
  EXPECT_EQ(scenario->robots[0].name, "robot1");
  EXPECT_EQ(scenario->robots[0].model->joints.size(), 1u);
}

TEST(ModelAsScenarioTest, AnSdfModelToo) {
  const TempFolder folder;
  folder.Write("ball.sdf",
               "<?xml version=\"1.0\"?><sdf version=\"1.9\"><model name=\"ball\"><link name=\"l\"><collision "
               "name=\"c\">"
               "<geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link></model></sdf>");
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((folder.path() / "ball.sdf").string(), library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->robots.size(), 1u);
}

TEST(ModelAsScenarioTest, MistakesAreSaidAtTheModelsLines) {
  const TempFolder folder;
  folder.Write("arm.urdf", "<robot name=\"arm\">\n<link/>\n</robot>");
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  EXPECT_EQ(LoadScenario((folder.path() / "arm.urdf").string(), library, diagnostics), nullptr);
  EXPECT_NE(diagnostics.ToString().find("arm.urdf:2: error:"), std::string::npos) << diagnostics.ToString();
}

}  // namespace
}  // namespace coopdyn
