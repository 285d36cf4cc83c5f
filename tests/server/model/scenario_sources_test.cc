// SPDX-License-Identifier: MIT
// A scenario carries the texts of all files that it names: read again from these alone, it is the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "tests/server/model/read_text.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kFloor = "[FLOOR]\nsize 12 9\ncolor white\n";

/// All data of a scenario, numbers bit for bit.
class Portrait {
 public:
  explicit Portrait(const Scenario& scenario) {
    Add(scenario.name, scenario.file, scenario.text, scenario.world.file, scenario.world.text);
    Add(scenario.floor);
    Add(scenario.world.scattered.size());
    for (const WorldObject& object : scenario.world.objects) Add(object);
    for (const WorldObject& object : scenario.objects) Add(object);
    for (const Target& t : scenario.targets) Add(t.id.value, t.color_name, t.color, t.p_WT, t.where);
    for (const RobotEntry& robot : scenario.robots) Add(robot);
    for (const SwarmEntry& s : scenario.swarms) Add(s.name, s.section, s.first, s.count, s.where);
    const SimulationOptions& o = scenario.simulation;
    Add(static_cast<int>(o.mode.value_or(Mode::kRealtime)), o.step.value_or(-1), o.substeps.value_or(-1));
    Add(o.seed, o.speed.value_or(-7), o.duration_s.value_or(-1), o.g_W.x(), o.g_W.y(), o.g_W.z(),
        o.watchdog_s.value_or(-1));
    for (const SourceText& source : scenario.sources) Add(source.kind, source.name, source.file, source.text);
  }
  const std::string& text() const { return text_; }

 private:
  template <typename... T>
    requires(sizeof...(T) > 1)
  void Add(const T&... values) {
    (Add(values), ...);
    text_ += "\n";
  }
  void Add(const std::string& value) { text_ += value + "|"; }
  void Add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    Add(std::to_string(bits));
  }
  template <typename T>
    requires std::is_integral_v<T>
  void Add(T value) {
    Add(std::to_string(value));
  }
  void Add(const Vector3& v) { Add(v.x(), v.y(), v.z()); }
  void Add(const Pose& pose) { Add(pose.p, pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()); }
  void Add(const Color& color) { Add(color.r, color.g, color.b); }
  void Add(const SourceLine& where) { Add(where.file, where.line); }
  void Add(const Shape& shape) {
    if (const auto* box = std::get_if<Box>(&shape)) Add(box->size_m);
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) Add(cylinder->radius_m, cylinder->length_m);
    if (const auto* sphere = std::get_if<Sphere>(&shape)) Add(sphere->radius_m);
    Add(shape.index());
  }
  void Add(const Floor& f) { Add(f.length_m, f.width_m, f.height_m, f.color, f.friction, f.where); }
  void Add(const WorldObject& o) { Add(o.name, o.shape, o.X_WO, o.mass_kg, o.color, o.friction, o.where); }
  void Add(const LinkShape& s) { Add(s.shape, s.X_LG, s.color, s.friction, s.takes_robot_color); }
  void Add(const RobotModel& model) {
    Add(model.type, model.file, model.text, model.footprint_radius_m, model.height_m);
    for (const LinkModel& link : model.links) {
      Add(link.name, link.X_RL, link.mass_kg, link.X_LI, link.inertia_kg_m2);
      for (const LinkShape& shape : link.collisions) Add(shape);
      for (const LinkShape& shape : link.visuals) Add(shape);
    }
    for (const JointModel& j : model.joints) {
      Add(j.name, j.parent, j.child, j.p_RJ, j.axis_R, j.max_effort);
    }
    for (const ActuatorModel& actuator : model.actuators) {
      Add(actuator.module);
      for (const int joint : actuator.joints) Add(joint);
    }
    if (const DriveModel* drive = model.drive())
      Add(drive->wheel_radius_m, drive->track_m, drive->max_wheel_speed_rad_s, drive->max_torque_nm);
    for (const SectorModel& s : model.sectors()) {
      Add(s.X_RS, s.bearing_rad, s.opening_rad, s.rays, s.max_range_m, s.noise_stddev_m);
    }
    if (const auto* target = model.Find<TargetModel>()) Add(target->max_range_m, target->see_through);
    if (const auto* near = model.Find<NeighboursModel>()) Add(near->range_m, near->loss, near->delay_steps);
    if (const auto* compass = model.Find<CompassModel>()) Add(compass->noise_stddev_rad);
    for (const ModuleModel& module : model.modules()) Add(module.type, module.name);
  }
  void Add(const RobotEntry& robot) {
    Add(robot.id.value, robot.name, robot.X_WR, robot.color, robot.sync, robot.deadline_s.value_or(-1));
    for (const std::string& name : robot.waits_for) Add(name);
    Add(static_cast<int>(robot.on_deadline),
        robot.on_disconnect ? static_cast<int>(*robot.on_disconnect) : -1, robot.watchdog_s.value_or(-1),
        static_cast<int>(robot.fidelity), robot.controller.name, robot.controller.file, robot.sockets,
        robot.where);
    for (const auto& [name, value] : robot.controller.options) Add(name, value);
    Add(*robot.model);
  }

  std::string text_;
};

std::shared_ptr<const Scenario> LoadFrom(const SearchPath& path, const std::string& name,
                                         std::optional<std::uint64_t> seed = std::nullopt) {
  RobotLibrary library(path);
  Diagnostics diagnostics;
  auto scenario = LoadScenario(name, library, diagnostics, false, seed);
  EXPECT_EQ(diagnostics.ToString(), "");
  return scenario != nullptr ? scenario : std::make_shared<Scenario>();
}

std::string Messages(const std::string& text, const std::string& file, RobotLibrary& library,
                     bool by_socket = false) {
  Diagnostics diagnostics;
  const bool refused = ReadScenario(text, file, library, by_socket, diagnostics) == nullptr;
  EXPECT_EQ(refused, diagnostics.has_errors());
  return diagnostics.ToString();
}

/// Checks that `scenario`, read again from its own texts without any files, is the same.
void ExpectCarriesAll(const Scenario& scenario) {
  ASSERT_NE(scenario.text, "");
  RobotLibrary library(SearchPath{}, scenario.sources);
  Diagnostics diagnostics;
  const auto again = ReadScenario(scenario.text, scenario.file, library, scenario.file.empty(), diagnostics,
                                  scenario.simulation.seed);
  EXPECT_EQ(diagnostics.ToString(), "");
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(Portrait(*again).text(), Portrait(scenario).text());
}

std::vector<std::string> SourceNames(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const SourceText& source : scenario.sources) names.push_back(source.kind + " " + source.name);
  return names;
}

const SearchPath kShipped{{SourceDir()}};

TEST(ScenarioSourcesTest, AWorldAndTheModelOfFiveRobotsAreCarriedOnceEach) {
  const auto classroom = LoadFrom(kShipped, "classroom");
  EXPECT_THAT(SourceNames(*classroom), ElementsAre("world classroom.world", "robot coopbot"));
  EXPECT_THAT(classroom->sources[0].file, HasSubstr("worlds/classroom.world"));
  EXPECT_EQ(classroom->sources[0].text, classroom->world.text);
  EXPECT_THAT(classroom->sources[1].file, HasSubstr("coopbot/model.sdf"));
  EXPECT_EQ(classroom->sources[1].text, classroom->robots[0].model->text);
  ExpectCarriesAll(*classroom);
}

TEST(ScenarioSourcesTest, ASwarmStandsAtTheSamePlaces) {
  const TempFolder folder;
  const std::string file = folder.Write("mixed.scenario",
                                        "[WORLD]\nfile cluttered.world\n[CRATE]\ntype box\nsize 0.2 0.2 0.2\n"
                                        "count 9\n[SWARM_1]\ntype minibot\ncount 40\n[ROBOT_1]\ntype single\n"
                                        "position 0 0\n[TARGET]\nred 1 2\n");
  const auto scenario = LoadFrom(kShipped, file, 4711);
  EXPECT_EQ(scenario->robots.size(), 41u);
  EXPECT_THAT(SourceNames(*scenario), ElementsAre("world cluttered.world", "robot coopbot", "robot minibot"));
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, AWorldInAnotherFolderIsNamedAsTheScenarioDoes) {
  const TempFolder folder;
  folder.Write("halls/big.world", kFloor + "[WALL]\ntype box\nsize 1 1 1\nposition 2 2\n");
  const std::string file = folder.Write("lessons/one.scenario",
                                        "[WORLD]\nfile ../halls/big\n[ROBOT_1]\ntype single\nposition 0 0\n");
  const auto scenario = LoadFrom(kShipped, file);
  EXPECT_THAT(SourceNames(*scenario), ElementsAre("world ../halls/big", "robot coopbot"));
  EXPECT_EQ(folder.Strip(scenario->sources[0].file), "halls/big.world");
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, AWorldByAbsolutePathNeedsItsFileNoMore) {
  std::shared_ptr<const Scenario> scenario;
  {
    const TempFolder folder;
    const std::string world = folder.Write("big.world", "\xEF\xBB\xBF" + kFloor);
    const std::string file =
        folder.Write("one.scenario", "[WORLD]\nfile " + world + "\n[ROBOT_1]\ntype single\nposition 5 4\n");
    scenario = LoadFrom(kShipped, file);
    EXPECT_EQ(scenario->sources[0].name, world);
  }
  EXPECT_EQ(scenario->sources[0].text, kFloor);
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, ATeamIsCarriedAsTheModelThatItMeans) {
  const TempFolder folder;
  const std::string file = folder.Write("team.scenario", "[ROBOT_1]\ntype TEAM2\nposition 1 0\n");
  const auto scenario = LoadFrom(kShipped, file);
  EXPECT_EQ(scenario->robots.size(), 2u);
  EXPECT_THAT(SourceNames(*scenario), ElementsAre("robot transporter"));
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, AWorldAsAScenarioIsItsOwnText) {
  const TempFolder folder;
  const std::string file =
      folder.Write("heap.world",
                   "[FLOOR]\nsize 5 5\nangles deg\n[CRATE]\ntype box\nsize 0.4 0.3 0.2\nmass 1\ncount 7\n"
                   "[WALL]\ntype box\nsize 1 0.1 1\nposition 1 1\norientation 30\n");
  const auto scenario = LoadFrom(kShipped, file, 3);
  EXPECT_EQ(scenario->objects.size(), 8u);
  EXPECT_TRUE(scenario->sources.empty());
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, ATextThatCameBySocketIsTheSameAgain) {
  Diagnostics diagnostics;
  const auto scenario = ReadScenario("[WORLD]\nfile corridor\n[ROBOT_1]\ntype single\nposition 0 0\n",
                                     "(text)", ShippedRobots(), true, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_THAT(SourceNames(*scenario), ElementsAre("world corridor", "robot coopbot"));
  ExpectCarriesAll(*scenario);
}

TEST(ScenarioSourcesTest, EveryShippedScenarioWithoutControllersCarriesAll) {
  int count = 0;
  for (const std::string& name : kShipped.ScenarioNames()) {
    RobotLibrary& library = ShippedRobots();
    Diagnostics diagnostics;
    const auto scenario = LoadScenario(name, library, diagnostics);
    if (scenario == nullptr || scenario->robots.size() > 1000)
      continue;  // a controller that is not built here
    SCOPED_TRACE(name);
    ExpectCarriesAll(*scenario);
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST(ScenarioSourcesTest, EmbeddedTextsComeBeforeFiles) {
  const TempFolder folder;
  folder.Write("hall.world", kFloor);
  folder.Write("robots/coopbot/model.sdf", "<sdf version=\"1.9\"><model name=\"broken\"/></sdf>");
  Diagnostics diagnostics;
  const std::string model = ShippedRobots().Get("coopbot", {}, diagnostics)->text;
  RobotLibrary library(SearchPath{{folder.path()}},
                       {{"world", "hall.world", "elsewhere/hall.world", "[FLOOR]\nsize 3 3\n"},
                        {"robot", "coopbot", "elsewhere/model.sdf", model}});
  const auto scenario = ReadScenario("[WORLD]\nfile hall.world\n[ROBOT_1]\ntype single\nposition 0 0\n",
                                     (folder.path() / "a.scenario").string(), library, false, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->floor.length_m, 3);
  EXPECT_EQ(scenario->world.file, "elsewhere/hall.world");
  EXPECT_EQ(scenario->robots[0].model->file, "elsewhere/model.sdf");
  EXPECT_EQ(scenario->robots[0].model->type, "coopbot");
}

TEST(ScenarioSourcesTest, MistakesAreSaidByTheFileThatTheTextCameFrom) {
  RobotLibrary library(SearchPath{}, {{"world", "hall", "halls/hall.world", "[FLOOR]\nsize 3 3\nsise 4\n"},
                                      {"robot", "thing", "robots/thing/model.sdf", "<sdf>\n<model\n</sdf>"}});
  const std::string messages =
      Messages("[WORLD]\nfile hall\n[ROBOT_1]\ntype thing\nposition 0 0\n", "a.scenario", library);
  EXPECT_THAT(messages, HasSubstr("halls/hall.world:3: error: "));
  EXPECT_THAT(messages, HasSubstr("robots/thing/model.sdf:2: error: not well-formed XML"));
}

TEST(ScenarioSourcesTest, ABrokenEmbeddedModelIsSaidOnce) {
  RobotLibrary library(SearchPath{}, {{"robot", "thing", "thing/model.sdf", "no XML"}});
  const std::string messages = Messages(
      "[ROBOT_1]\ntype thing\nposition 0 0\n[ROBOT_2]\ntype thing\nposition 2 0\n", "a.scenario", library);
  EXPECT_EQ(std::count(messages.begin(), messages.end(), '\n'), 1) << messages;
}

TEST(ScenarioSourcesTest, WhatIsNotEmbeddedIsLookedForOnThePathAndSuggestedFromBoth) {
  RobotLibrary library(SearchPath{}, {{"robot", "walker", "walker/model.sdf", "<sdf/>"}});
  EXPECT_THAT(Messages("[ROBOT_1]\ntype wolker\nposition 0 0\n", "a.scenario", library),
              HasSubstr("unknown robot type 'wolker'; did you mean 'walker'?"));
  EXPECT_THAT(Messages("[WORLD]\nfile walker\n", "a.scenario", library),
              HasSubstr("there is no world 'walker'"));
  // The kind is part of the name; a path received by socket is refused unless the file is embedded.
  EXPECT_THAT(Messages("[WORLD]\nfile /etc/walker.world\n", "", library, true),
              HasSubstr("by the bare name"));
}

TEST(ScenarioSourcesTest, AModelThatNamesOtherFilesIsReadWithoutThem) {
  Diagnostics none;
  const std::string model = ShippedRobots().Get("coopbot", {}, none)->text;
  for (const std::string from : {"<box>", "<link"}) {
    std::string text = model;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    text.insert(at, from == "<box>" ? "<mesh><uri>hull.dae</uri></mesh>"
                                    : "<include><uri>file://wheel</uri></include>");
    Diagnostics diagnostics;
    ReadRobotModelText(text, "a/model.sdf", "a", diagnostics);
    EXPECT_THAT(diagnostics.ToString(), HasSubstr("this model came without"));
  }
}

}  // namespace
}  // namespace coopdyn
