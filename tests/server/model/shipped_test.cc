// SPDX-License-Identifier: MIT
// Shipped files load without messages; lessons for one robot can be solved; the examples of docs/formats.md
// are valid files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <tuple>

#include "server/model/scenario.h"
#include "server/model/swarm.h"
#include "tests/server/model/read_text.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = SourceDir();

/// The shipped files, and placeholders for the controllers, which the build makes elsewhere.
class ShippedLibrary {
 public:
  ShippedLibrary() : library_(SearchPath{{SourceDir(), folder_.path()}}) {
    for (const char* name : {"aggregate", "attractor", "braitenberg", "diffuse", "flock", "formation",
                             "reach", "referee", "squat", "transport", "tripod", "trot", "walk"}) {
      folder_.Write(std::string("controllers/") + name + ".so", "");
    }
  }
  RobotLibrary& library() { return library_; }

 private:
  TempFolder folder_;
  RobotLibrary library_;
};

ReadResult LoadShipped(const std::string& name) {
  static ShippedLibrary shipped;
  Diagnostics diagnostics;
  auto scenario = LoadScenario(name, shipped.library(), diagnostics);
  return {scenario, diagnostics.ToString()};
}

std::vector<std::string> FilesIn(const std::string& folder, const std::string& extension) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(kSource / folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(ShippedTest, EveryScenarioLoadsWithoutDiagnostics) {
  const std::vector<std::string> files = FilesIn("scenarios", ".scenario");
  EXPECT_GE(files.size(), 8u);
  for (const std::string& file : files) {
    EXPECT_EQ(LoadShipped(file).messages, "");
    // Also by its bare name.
    EXPECT_NE(LoadShipped(fs::path(file).stem().string()).scenario, nullptr) << file;
  }
}

TEST(ShippedTest, EveryWorldLoadsWithoutDiagnostics) {
  const std::vector<std::string> files = FilesIn("worlds", ".world");
  EXPECT_GE(files.size(), 8u);
  for (const std::string& file : files) EXPECT_EQ(LoadShipped(file).messages, "");
}

TEST(ShippedTest, NamesAreListedSorted) {
  EXPECT_THAT(
      ShippedRobots().path().ScenarioNames(),
      ::testing::ElementsAre(
          "aggregate50", "arena20", "ball", "box_maze", "braitenberg", "classroom", "cluttered", "corridor",
          "crowd200", "diffuse100", "dog", "double_pendulum", "empty", "fig4", "flock50", "formation",
          "formation_loaded", "lamps", "lightseeker", "maze", "octavio4", "octavio6", "octavio8", "pendulum",
          "race", "reach", "runbot", "seeker", "soccer", "squat", "swarm100", "swarm1000", "swarm5000",
          "transport", "transport_loaded", "triangle", "triangle_loaded", "tripod", "trot", "walk", "wall"));
}

TEST(ShippedTest, RobotsStartClearOfEverything) {
  for (const std::string& file : FilesIn("scenarios", ".scenario")) {
    const auto scenario = LoadShipped(file).scenario;
    ASSERT_NE(scenario, nullptr);
    for (std::size_t i = 0; i < scenario->robots.size(); ++i) {
      const RobotEntry& robot = scenario->robots[i];
      const Vector3& p = robot.X_WR.p;
      for (const WorldObject& object : scenario->objects) {
        if (object.name.ends_with("_bar")) continue;  // lies on robots
        EXPECT_GT(DistanceToShadow(object, p.x(), p.y()), robot.model->footprint_radius_m)
            << file << object.name;
      }
      double nearest_m = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < i; ++j) {
        const Vector3& q = scenario->robots[j].X_WR.p;
        nearest_m = std::min(nearest_m, std::hypot(p.x() - q.x(), p.y() - q.y()));
      }
      EXPECT_GT(nearest_m, 2 * robot.model->footprint_radius_m) << file;
    }
  }
}

// So that a robot of 0.36 m with 0.4 m on either side passes everywhere; things at a wall leave no gap.
TEST(ShippedTest, PassagesOfLessonsAreWide) {
  constexpr double kPassage_m = 1.2;
  for (const char* name : {"empty", "corridor", "box_maze", "cluttered", "fig4", "classroom"}) {
    const auto scenario = LoadShipped(name).scenario;
    ASSERT_NE(scenario, nullptr);
    ASSERT_EQ(scenario->robots.size(), 1u);
    const Vector3 target = scenario->targets.at(0).p_WT;
    EXPECT_EQ(scenario->targets[0].color_name, "red");
    for (const WorldObject& object : scenario->objects) {
      EXPECT_GT(DistanceToShadow(object, target.x(), target.y()), 0.5) << name;
      // Along the edge of the shadow of each other thing (except walls).
      if (object.name.starts_with("WALL")) continue;
      for (const WorldObject& other : scenario->objects) {
        if (&other == &object) continue;
        double gap = 1e9;
        const double reach = HalfExtents(object.shape, object.X_WO.q).head<2>().norm();
        for (double x = -reach; x <= reach; x += 0.02) {
          for (double y = -reach; y <= reach; y += 0.02) {
            const Vector3 q = object.X_WO.p + Vector3(x, y, 0);
            if (DistanceToShadow(object, q.x(), q.y()) > 0) continue;
            gap = std::min(gap, DistanceToShadow(other, q.x(), q.y()));
          }
        }
        const bool at_wall =
            other.name.starts_with("WALL") && (gap < 0.03 || std::string_view(name) == "classroom");
        EXPECT_TRUE(at_wall || gap > kPassage_m - 0.03)
            << gap << " " << name << " " << object.name << " " << other.name;
      }
    }
  }
}

TEST(ShippedTest, ClassroomIsTheFirstLesson) {
  const auto scenario = LoadShipped("classroom").scenario;
  ASSERT_NE(scenario, nullptr);
  EXPECT_EQ(scenario->simulation.mode, Mode::kRealtime);
  ASSERT_EQ(scenario->robots.size(), 1u);
  EXPECT_EQ(scenario->robots[0].name, "robot1");
  ASSERT_EQ(scenario->targets.size(), 1u);
  const Vector3 from = scenario->robots[0].X_WR.p, to = scenario->targets[0].p_WT;
  EXPECT_LT((to - from).norm(), 4);
  // The straight path is free by more than the metre at which the hello program slows down.
  for (double t = 0; t <= 1; t += 0.01) {
    const Vector3 p = from + t * (to - from);
    for (const WorldObject& object : scenario->objects) {
      EXPECT_GT(DistanceToShadow(object, p.x(), p.y()), 1 + 0.18) << object.name;
    }
  }
}

TEST(ShippedTest, FormationIsAnInvertedVBeforeItsTarget) {
  const auto scenario = LoadShipped("formation").scenario;
  ASSERT_NE(scenario, nullptr);
  ASSERT_EQ(scenario->robots.size(), 5u);
  EXPECT_EQ(scenario->simulation.mode, Mode::kLockstep);
  for (int i = 1; i < 5; ++i) {
    const Vector3 p = scenario->robots[static_cast<std::size_t>(i)].X_WR.p - scenario->robots[0].X_WR.p;
    EXPECT_DOUBLE_EQ(p.x(), -std::abs(p.y()));
  }
}

TEST(ShippedTest, ArenaHasTwentyRobotsWithSockets) {
  const auto scenario = LoadShipped("arena20").scenario;
  ASSERT_NE(scenario, nullptr);
  EXPECT_EQ(scenario->robots.size(), 20u);
  for (const RobotEntry& robot : scenario->robots) EXPECT_TRUE(robot.sockets);
}

TEST(ShippedTest, SwarmsAreOnePerSquareMetreAndTheCrowdIsDenser) {
  for (const auto& [name, count, area_m2] :
       {std::tuple("swarm100", 100u, 100.0), std::tuple("diffuse100", 100u, 100.0),
        std::tuple("swarm1000", 1000u, 1024.0), std::tuple("swarm5000", 5000u, 5041.0),
        std::tuple("crowd200", 200u, 60.0625)}) {
    const auto scenario = LoadShipped(name).scenario;
    ASSERT_NE(scenario, nullptr);
    EXPECT_EQ(scenario->robots.size(), count);
    EXPECT_EQ(scenario->robots[0].fidelity, Fidelity::kRolling);
    // Between the walls, which are 0.1 m thick and stand on the floor's edge.
    EXPECT_NEAR((scenario->floor.length_m - 0.2) * (scenario->floor.width_m - 0.2), area_m2, 1e-6);
    EXPECT_EQ(scenario->objects.size(), 4u);
    EXPECT_EQ(scenario->robots[0].participates(), std::string_view(name) == "swarm100");
  }
}

/// The fenced blocks of docs/formats.md whose language is `language`.
std::vector<std::string> Examples(const std::string& language) {
  std::ifstream stream(kSource / "docs/formats.md");
  std::vector<std::string> blocks;
  std::string line;
  bool inside = false;
  while (std::getline(stream, line)) {
    if (inside && line == "```") {
      inside = false;
    } else if (inside) {
      blocks.back() += line + "\n";
    } else if (line == "```" + language) {
      inside = true;
      blocks.emplace_back();
    }
  }
  return blocks;
}

TEST(FormatsDocTest, EveryWorldLoads) {
  const std::vector<std::string> examples = Examples("world");
  EXPECT_GE(examples.size(), 2u);
  for (const std::string& example : examples) EXPECT_EQ(ReadWorldText(example).messages, "") << example;
}

TEST(FormatsDocTest, EveryScenarioLoads) {
  const std::vector<std::string> examples = Examples("scenario");
  EXPECT_GE(examples.size(), 4u);
  for (const std::string& example : examples) EXPECT_EQ(Read(example).messages, "") << example;
}

TEST(FormatsDocTest, EveryRobotLoads) {
  const std::vector<std::string> examples = Examples("xml");
  EXPECT_GE(examples.size(), 1u);
  for (const std::string& example : examples) {
    const TempFolder folder;
    Diagnostics diagnostics;
    EXPECT_NE(ReadRobotModel(folder.Write("small/model.sdf", example), SearchPath{}, diagnostics), nullptr);
    EXPECT_EQ(folder.Strip(diagnostics.ToString()), "");
  }
}

}  // namespace
}  // namespace coopdyn
