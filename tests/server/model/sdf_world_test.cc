// SPDX-License-Identifier: MIT
// SDF worlds as scenarios: their models, includes, floor and physics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {
namespace sdf_world {

using ::testing::HasSubstr;
using ::testing::Not;

class SdfWorldTest : public ::testing::Test {
 protected:
  /// The scenario of a world that contains `inside`; messages() returns the messages.
  std::shared_ptr<const Scenario> Load(const std::string& inside) {
    const std::string ground = "<include><uri>model://ground_plane</uri></include>";
    return LoadText("<sdf version=\"1.9\"><world name=\"lab\">" + ground + "\n" + inside + "</world></sdf>");
  }
  std::shared_ptr<const Scenario> LoadText(const std::string& text) {
    folder_.Write("lab.sdf", text);
    SearchPath path{{folder_.path().string()}};
    path.is_strict = is_strict_;
    RobotLibrary library(path);
    Diagnostics diagnostics;
    auto scenario = LoadScenario((folder_.path() / "lab.sdf").string(), library, diagnostics);
    messages_ = diagnostics.ToString();
    return scenario;
  }
  void MakeStrict() { is_strict_ = true; }
  const TempFolder& folder() const { return folder_; }
  const std::string& messages() const { return messages_; }

 private:
  TempFolder folder_;
  bool is_strict_ = false;
  std::string messages_;
};

std::string Link(const std::string& name, const std::string& pose, const std::string& size = "0.2 0.2 0.2") {
  const std::string box = "<geometry><box><size>" + size + "</size></box></geometry>";
  return "<link name=\"" + name + "\"><pose>" + pose +
         "</pose><inertial><mass>2</mass><inertia><ixx>0.0133</ixx><iyy>0.0133</iyy><izz>0.0133</izz></"
         "inertia>"
         "</inertial><collision name=\"c\">" +
         box + "</collision><visual name=\"v\">" + box + "</visual></link>\n";
}
std::string Model(const std::string& name, const std::string& inside,
                  const std::string& pose = "0 0 0 0 0 0") {
  return "<model name=\"" + name + "\"><pose>" + pose + "</pose>" + inside + "</model>\n";
}
const std::string kArm =
    Link("base", "0 0 0.1 0 0 0") + Link("arm", "0 0 0.4 0 0 0") +
    "<joint name=\"turn\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>"
    "<limit><effort>1</effort><velocity>1</velocity></limit></axis></joint>\n";

TEST_F(SdfWorldTest, APlaneThatIsTurnedIsNoFloor) {
  for (const auto& [pose, normal] : {std::pair("0 0 0 1.5707963 0 0", "0 0 1"), {"0 0 0 0 0 0", "0 1 0"}}) {
    const auto scenario = LoadText(
        "<sdf version=\"1.9\"><world name=\"lab\"><model name=\"wall\"><static>true</static><pose>" +
        std::string(pose) + "</pose><link name=\"l\"><collision name=\"c\"><geometry><plane><normal>" +
        normal + "</normal><size>20 30</size></plane></geometry></collision></link></model></world></sdf>");
    ASSERT_NE(scenario, nullptr) << messages();
    EXPECT_THAT(messages(), HasSubstr("the world has no ground plane"));
  }
}

TEST_F(SdfWorldTest, WhatYieldsUnderItsWeightIsARobotAndWhatIsStifferAThing) {
  const auto crate = [](const std::string& kp) {
    std::string link = Link("l", "0 0 0.1 0 0 0");
    const std::string box = "</box></geometry>";
    return link.insert(link.find(box) + box.size(),
                       "<surface><contact><ode><kp>" + kp + "</kp><kd>1</kd></ode></contact></surface>");
  };
  const auto scenario = Load(Model("stiff", crate("1e7")) + Model("soft", crate("1e5"), "2 0 0 0 0 0") +
                             Model("slab", "<static>true</static>" + crate("1e5"), "0 2 0 0 0 0") +
                             Model("foam", "<static>true</static>" + crate("1e4"), "0 4 0 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  ASSERT_EQ(scenario->objects.size(), 2u);
  EXPECT_EQ(scenario->objects[0].name, "stiff");
  EXPECT_EQ(scenario->objects[1].name, "slab");
  ASSERT_EQ(scenario->robots.size(), 2u);
  EXPECT_EQ(scenario->robots[0].model->links[0].collisions.at(0).contact_stiffness_n_m, 1e5);
  EXPECT_TRUE(scenario->robots[1].model->fixed_base);
}

TEST_F(SdfWorldTest, AModelWithoutLinksIsLeftOut) {
  const auto scenario =
      Load("<model name=\"fog\"><static>true</static></model>" + Model("crate", Link("l", "0 0 1 0 0 0")));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), HasSubstr("lab.sdf:2: warning: model 'fog' has no link: it is left out"));
}

TEST_F(SdfWorldTest, EmptyLinesMayStandBeforeIt) {
  EXPECT_NE(LoadText("\n<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"><world name=\"lab\"/></sdf>"), nullptr)
      << messages();
}

TEST_F(SdfWorldTest, ItsPlugInsAreToldOnce) {
  Load(
      "<plugin filename=\"gz-sim-physics-system\" name=\"gz::sim::systems::Physics\"/>\n"
      "<plugin filename=\"gz-sim-sensors-system\" name=\"gz::sim::systems::Sensors\"/>\n"
      "<plugin filename=\"gz-sim-buoyancy-system\" name=\"gz::sim::systems::Buoyancy\"/>\n");
  EXPECT_THAT(messages(), HasSubstr("plug-in 'gz-sim-buoyancy-system' is not used by coopdyn: no water"));
  EXPECT_THAT(messages(),
              HasSubstr("lab.sdf:2: warning: what these plug-ins give is there anyway, sensors as "
                        "their <sensor> says: gz::sim::systems::Physics, "
                        "gz::sim::systems::Sensors\n"));
}

TEST_F(SdfWorldTest, WhatHasJointsIsARobotAndWhatIsSimpleAThing) {
  const auto scenario =
      Load(Model("left arm", kArm, "1 2 0 0 0 1.5") + Model("right", kArm, "3 0 0 0 0 0") +
           Model("wall", "<static>true</static>" + Link("l", "0 0 0.5 0 0 0"), "0 4 0 0 0 0") +
           Model("crate", Link("l", "0 0 0.1 0 0 0"), "0 -2 0 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  ASSERT_EQ(scenario->robots.size(), 2u);
  EXPECT_EQ(scenario->robots[0].name, "left_arm");
  EXPECT_NEAR((scenario->robots[0].X_WR.p - Vector3(1, 2, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR(scenario->robots[0].X_WR.q.angularDistance(FromRollPitchYaw(0, 0, 1.5)), 0, 1e-9);
  EXPECT_EQ(scenario->robots[1].name, "right");
  ASSERT_EQ(scenario->objects.size(), 2u);
  EXPECT_EQ(scenario->objects[0].mass_kg, 0);
  EXPECT_NEAR(scenario->objects[0].X_WO.p.z(), 0.5, 1e-9);
  EXPECT_EQ(scenario->objects[1].mass_kg, 2);
}

/// A model that is one shape of 1 kg.
std::string Solid(const std::string& name, const std::string& shape, const std::string& inertial) {
  return Model(name,
               "<link name=\"l\"><inertial><mass>1</mass>" + inertial +
                   "</inertial><collision name=\"c\"><geometry>" + shape + "</geometry></collision></link>",
               "0 0 1 0 0 0");
}
std::string Moments(const std::string& x, const std::string& y, const std::string& z) {
  return "<inertia><ixx>" + x + "</ixx><iyy>" + y + "</iyy><izz>" + z + "</izz></inertia>";
}
const std::string kBall = "<sphere><radius>0.1</radius></sphere>";  // solid: 0.004
const std::string kCan = "<cylinder><radius>0.1</radius><length>0.6</length></cylinder>";

TEST_F(SdfWorldTest, AMassThatIsNotTheSolidsCounts) {
  const auto scenario =
      Load(Solid("hollow", kBall, Moments("0.006667", "0.006667", "0.006667")) +
           Solid("shifted", kBall, "<pose>0.05 0 0 0 0 0</pose>" + Moments("0.004", "0.004", "0.004")) +
           Solid("shifted_only", kBall, "<pose>0 0 -0.05 0 0 0</pose>") +
           Solid("heavy_end", kCan, "<pose>0 0 0.2 0 0 0</pose>" + Moments("0.01", "0.01", "0.005")));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), Not(HasSubstr("moments of inertia")));
  EXPECT_TRUE(scenario->objects.empty());
  ASSERT_EQ(scenario->robots.size(), 4u);
  EXPECT_EQ(scenario->robots[0].name, "hollow");
  EXPECT_NEAR(scenario->robots[0].model->links[0].inertia_kg_m2.x(), 0.006667, 1e-9);
  EXPECT_NEAR(scenario->robots[1].model->links[0].X_LI.p.x(), 0.05, 1e-9);
}

TEST_F(SdfWorldTest, TheMassOfTheSolidMakesAThing) {
  const auto scenario =
      Load(Solid("plain", kBall, "") + Solid("ball", kBall, Moments("0.004", "0.004", "0.0041")) +
           Solid("near", kBall, "<pose>0.001 0 0 0 0 0</pose>" + Moments("0.004", "0.004", "0.004")) +
           Solid("can", kCan, Moments("0.0325", "0.0325", "0.005")) +
           Solid("lying", kCan, "<pose>0 0 0 1.5707963 0 0</pose>" + Moments("0.0325", "0.005", "0.0325")) +
           Model("wall", "<static>true</static>" + Link("l", "0 0 0.5 0 0 0"), "0 4 0 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), Not(HasSubstr("moments of inertia")));
  EXPECT_TRUE(scenario->robots.empty());
  EXPECT_EQ(scenario->objects.size(), 6u);
}

TEST_F(SdfWorldTest, MomentsThatAThingCannotHaveAreReported) {
  const auto scenario = Load(
      Solid("ball", kBall, Moments("1", "1", "1")) + Solid("tube", kCan, Moments("0.035", "0.035", "0.01")) +
      Solid("turned", kCan, "<pose>0 0 0 1.5707963 0 0</pose>" + Moments("0.0325", "0.0325", "0.005")));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(scenario->objects.size(), 3u);
  EXPECT_TRUE(scenario->robots.empty());
  EXPECT_THAT(
      messages(),
      HasSubstr("lab.sdf:2: warning: the moments of inertia of model 'ball', 1 1 1, are not used: it is "
                "a thing, with those of the uniform solid, 0.004 0.004 0.004; a scenario with "
                "[ROBOT_1] type lab.sdf#ball uses them; likewise 2 other models\n"));
  const auto file = folder().Write("tube.scenario", "[ROBOT_1]\ntype lab.sdf#tube\nposition 0 0 1\n");
  RobotLibrary library(SearchPath{});
  Diagnostics diagnostics;
  const auto as_robot = LoadScenario(file, library, diagnostics);
  ASSERT_NE(as_robot, nullptr) << diagnostics.ToString();
  EXPECT_NEAR(as_robot->robots.at(0).model->links[0].inertia_kg_m2.minCoeff(), 0.01, 1e-9);
}

TEST_F(SdfWorldTest, RoundThingsRollAsTheFileSays) {
  const auto scenario = Load(Solid("ball", kBall, "") + Solid("can", kCan, ""));
  ASSERT_NE(scenario, nullptr) << messages();
  ASSERT_EQ(scenario->objects.size(), 2u);
  for (const WorldObject& object : scenario->objects) EXPECT_EQ(object.rolling_friction_m, 0);
}

TEST_F(SdfWorldTest, AWorldWithoutAGroundPlaneIsToldWhatToWrite) {
  LoadText("<sdf version=\"1.9\">\n<world name=\"lab\">" + Model("arm", kArm) + "</world></sdf>");
  EXPECT_THAT(messages(),
              HasSubstr("lab.sdf:2: warning: the world has no ground plane, and gets a floor of 100 x "
                        "100 m at z = 0: write <include><uri>model://ground_plane</uri></include>"));
}

TEST_F(SdfWorldTest, BodiesThatNoJointHoldsTogetherAreThingsAndRobotsOfTheirOwn) {
  const auto scenario = Load(
      Model("set", Link("cube", "0 3 0.1 0 0 0") + kArm + Link("block", "0 -3 0.1 0 0 0"), "1 0 0 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  ASSERT_EQ(scenario->robots.size(), 1u);
  EXPECT_EQ(scenario->robots[0].name, "m_set");  // [SET] is a reserved section
  ASSERT_EQ(scenario->objects.size(), 2u);
  EXPECT_EQ(scenario->objects[0].name, "m_set_cube");
  EXPECT_NEAR((scenario->objects[0].X_WO.p - Vector3(1, 3, 0.1)).norm(), 0, 1e-9);
  EXPECT_EQ(scenario->objects[1].name, "m_set_block");
}

TEST_F(SdfWorldTest, WhatJointsHoldTogetherInAnyOrderIsOneRobot) {
  const auto joint = [](const std::string& child) {
    return "<joint name=\"" + child + "_j\" type=\"ball\"><parent>base</parent><child>" + child +
           "</child></joint>";
  };
  const auto scenario =
      Load(Model("hand", Link("base", "0 0 0.1 0 0 0") + Link("left", "0 1 0.1 0 0 0") +
                             Link("right", "0 -1 0.1 0 0 0") + joint("left") + joint("right")));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  EXPECT_EQ(scenario->robots.size(), 1u);
  EXPECT_TRUE(scenario->objects.empty());
}

TEST_F(SdfWorldTest, SeveralModelsInAFileAreAWorld) {
  const auto scenario = LoadText("<sdf version=\"1.6\">" + Model("one", kArm, "1 0 0 0 0 0") +
                                 Model("two", kArm, "3 0 0 0 0 0") + "</sdf>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  ASSERT_EQ(scenario->robots.size(), 2u);
  EXPECT_EQ(scenario->robots[1].name, "two");
  EXPECT_NEAR(scenario->robots[1].X_WR.p.x(), 3, 1e-9);
}

TEST_F(SdfWorldTest, AnyModelOfAFileIsARobotsTypeByItsName) {
  LoadText("<sdf version=\"1.6\">" + Model("one", kArm) + Model("two", Link("l", "0 0 0.1 0 0 0")) +
           "</sdf>");
  const auto file = folder().Write("mine.scenario", "[ROBOT_1]\ntype lab.sdf#two\nposition 0 0\n");
  RobotLibrary library(SearchPath{});
  Diagnostics diagnostics;
  EXPECT_NE(LoadScenario(file, library, diagnostics), nullptr) << diagnostics.ToString();
  folder().Write("mine.scenario", "[ROBOT_1]\ntype ./lab.sdf\nposition 0 0\n");
  EXPECT_EQ(LoadScenario(file, library, diagnostics), nullptr);
  EXPECT_THAT(diagnostics.ToString(),
              HasSubstr("a robot's file holds one <model>, and this one 2: name one of them, "
                        "type lab.sdf#one, or serve the file itself"));
}

TEST_F(SdfWorldTest, WhatOverlapsIsPushedOutAndAThingInTheFloorIsPutOnIt) {
  const auto scenario = Load(Model("crate", Link("l", "0 0 0 0 0 0"), "0 -2 0 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_TRUE(scenario->simulation.overlaps);
  EXPECT_EQ(scenario->objects.at(0).where.line, 2);  // of the world, whose second line defines the crate
  EXPECT_NEAR(scenario->objects.at(0).X_WO.p.z(), 0.1, 1e-9);
  EXPECT_THAT(messages(), HasSubstr("model 'crate' stands 0.1 m below the floor: it is put on the floor"));
}

TEST_F(SdfWorldTest, AModelInTheAirStaysThere) {
  const auto scenario = Load(Model("kite",
                                   Link("a", "0 0 0 0 0 0") + Link("b", "0 0 0.4 0 0 0") +
                                       "<joint name=\"j\" type=\"ball\"><parent>a</parent>"
                                       "<child>b</child></joint>",
                                   "0 0 3 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), Not(HasSubstr("on the floor")));
  const RobotEntry& robot = scenario->robots.at(0);
  EXPECT_NEAR((robot.X_WR * robot.model->links[0].X_RL).p.z(), 3, 1e-9);
}

TEST_F(SdfWorldTest, AModelBelowTheFloorIsPutOnIt) {
  const auto scenario = Load(Model("sunk", kArm, "0 0 -0.25 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(
      messages(),
      HasSubstr("lab.sdf:2: warning: model 'sunk' stands 0.25 m below the floor: it is put on the floor"));
  EXPECT_EQ(scenario->robots.at(0).X_WR.p.z(), 0);
}

/// A moving body with a mesh, 0.4 m wide and 0.6 m high about its origin.
std::string Rock(const TempFolder& folder) {
  folder.Write("rock.obj",
               "v -0.2 -0.2 -0.3\nv 0.2 -0.2 -0.3\nv 0.2 0.2 -0.3\nv -0.2 0.2 -0.3\nv -0.2 -0.2 0.3\n"
               "v 0.2 -0.2 0.3\nv 0.2 0.2 0.3\nv -0.2 0.2 0.3\n"
               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  return "<link name=\"l\"><inertial><mass>1</mass></inertial><collision name=\"c\"><geometry><mesh>"
         "<uri>rock.obj</uri></mesh></geometry></collision></link>";
}

TEST_F(SdfWorldTest, AMeshStandsWhereItsModelsOriginIs) {
  const auto scenario = Load(Model("rock", Rock(folder()), "1 2 1.5 0 0 0.5") +
                             Model("tilted", Rock(folder()), "4 2 1 3.141592653589793 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  const RobotEntry& rock = scenario->robots.at(0);
  EXPECT_NEAR((rock.X_WR.p - Vector3(1, 2, 1.5)).norm(), 0, 1e-9);
  EXPECT_NEAR((rock.X_WR * rock.model->links[0].X_RL).p.z(), 1.5, 1e-9);
  EXPECT_NEAR((scenario->robots.at(1).X_WR.p - Vector3(4, 2, 1)).norm(), 0, 1e-9);
}

TEST_F(SdfWorldTest, AMeshBelowTheFloorIsPutOnIt) {
  const auto scenario = Load(Model("rock", Rock(folder()), "0 0 0.1 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_NEAR(scenario->robots.at(0).X_WR.p.z(), 0.3, 1e-6);
  EXPECT_THAT(messages(), HasSubstr("model 'rock' stands 0.2 m below the floor: it is put on the floor"));
}

TEST_F(SdfWorldTest, ARecordedModelOfAWorldHasTheSameOrigin) {
  const auto scenario = Load(Model("rock", Rock(folder()), "0 0 1 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  const RobotModel& model = *scenario->robots.at(0).model;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(model.text, "lab.sdf", "rock", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->links[0].X_RL.p, model.links[0].X_RL.p);
  EXPECT_EQ(again->text, model.text);
}

TEST_F(SdfWorldTest, AModelOfAWorldHasItsOriginInAScenario) {
  folder().Write("a.scenario", "[ROBOT_1]\ntype \"lab.sdf#rock\"\nposition 0 0 1\n");
  ASSERT_NE(Load(Model("rock", Rock(folder()), "0 0 1 0 0 0")), nullptr) << messages();
  RobotLibrary library(SearchPath{{folder().path().string()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((folder().path() / "a.scenario").string(), library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  const RobotEntry& rock = scenario->robots.at(0);
  EXPECT_NEAR((rock.X_WR * rock.model->links[0].X_RL).p.z(), 1, 1e-9);
}

TEST_F(SdfWorldTest, TheGroundPlaneIsTheFloorAndPhysicsHasItsStepAndGravity) {
  const auto scenario = Load(
      "<gravity>0 0 -3.7</gravity><physics type=\"ode\"><max_step_size>0.002</max_step_size></physics>\n" +
      Model("ground",
            "<static>true</static><link name=\"l\"><collision name=\"c\"><geometry><plane>"
            "<normal>0 0 1</normal><size>40 20</size></plane></geometry></collision></link>") +
      Model("arm", kArm));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(scenario->floor.length_m, 40);
  EXPECT_EQ(scenario->floor.width_m, 20);
  EXPECT_TRUE(scenario->objects.empty());
  EXPECT_EQ(scenario->simulation.g_W, Vector3(0, 0, -3.7));
  EXPECT_EQ(scenario->simulation.step, Nanoseconds{2'000'000});
}

TEST_F(SdfWorldTest, GravityMayBeNoneOrPointAnywhere) {
  const auto none = Load("<gravity>0 0 0</gravity>" + Model("arm", kArm));
  ASSERT_NE(none, nullptr) << messages();
  EXPECT_EQ(none->simulation.g_W, Vector3::Zero());
  const auto up = Load("<gravity>0 0 2</gravity>" + Model("arm", kArm));
  ASSERT_NE(up, nullptr) << messages();
  EXPECT_EQ(up->simulation.g_W, Vector3(0, 0, 2));
  const auto aside = Load("<gravity>1 -0.5 -9</gravity>" + Model("arm", kArm));
  ASSERT_NE(aside, nullptr) << messages();
  EXPECT_EQ(aside->simulation.g_W, Vector3(1, -0.5, -9));
}

TEST_F(SdfWorldTest, ABallThatBouncesIsAThing) {
  const std::string ball =
      "<link name=\"l\"><inertial><mass>1</mass></inertial><collision "
      "name=\"c\"><geometry><sphere><radius>0.1"
      "</radius></sphere></geometry><surface><bounce><restitution_coefficient>0.7</restitution_coefficient>"
      "</bounce></surface></collision></link>";
  const auto scenario = Load(Model("ball", ball, "0 0 1 0 0 0"));
  ASSERT_NE(scenario, nullptr) << messages();
  ASSERT_EQ(scenario->objects.size(), 1u);
  EXPECT_EQ(scenario->objects[0].restitution, 0.7);
}

TEST_F(SdfWorldTest, GazebosSunAndGroundPlaneNeedNoFiles) {
  const auto scenario =
      Load("<include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>\n" +
           Model("arm", kArm));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
}

TEST_F(SdfWorldTest, AnIncludedLightIsAWarning) {
  folder().Write(
      "lamp/model.sdf",
      "<sdf version=\"1.9\"><light type=\"point\" name=\"lamp\"><pose>0 0 3 0 0 0</pose></light></sdf>");
  const auto scenario = Load("<include><uri>model://lamp</uri></include>\n" + Model("arm", kArm));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), HasSubstr("lab.sdf:2: warning: <include>: 'model://lamp' is a light"));
}

TEST_F(SdfWorldTest, IncludesHaveTheirOwnNamesAndPoses) {
  folder().Write("arm/model.sdf", "<sdf version=\"1.9\">" + Model("arm", kArm) + "</sdf>");
  const auto scenario = Load(
      "<include><uri>model://arm</uri></include><include><uri>model://arm</uri><name>second</name>"
      "<pose>0 5 0 0 0 0</pose></include>\n");
  ASSERT_NE(scenario, nullptr) << messages();
  ASSERT_EQ(scenario->robots.size(), 2u);
  EXPECT_EQ(scenario->robots[0].name, "arm");
  EXPECT_EQ(scenario->robots[1].name, "second");
  EXPECT_EQ(scenario->robots[1].X_WR.p.y(), 5);
}

TEST_F(SdfWorldTest, AMissingIncludeIsLeftOutAndSaidWithItsLine) {
  const std::string world = Model("arm", kArm) + "<include><uri>model://nowhere</uri></include>\n";
  const auto scenario = Load(world);
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(scenario->robots.size(), 1u);
  EXPECT_THAT(messages(), HasSubstr("warning: <include>: there is no 'model://nowhere'"));
  EXPECT_THAT(messages(), HasSubstr("until then it is left out"));
  MakeStrict();
  EXPECT_EQ(Load(world), nullptr);
  EXPECT_THAT(messages(), HasSubstr("error: <include>: there is no 'model://nowhere'"));
}

TEST_F(SdfWorldTest, AWorldOfWhichNothingIsThereIsAnError) {
  EXPECT_EQ(Load("<include><uri>model://nowhere</uri></include>\n"), nullptr);
  EXPECT_THAT(messages(), HasSubstr("error: nothing that this world includes is there"));
}

TEST_F(SdfWorldTest, SeveralIncludesInAFileAreAWorld) {
  folder().Write("arm/model.sdf", "<sdf version=\"1.9\">" + Model("arm", kArm) + "</sdf>");
  const auto scenario = LoadText(
      "<sdf version=\"1.9\"><include><uri>model://arm</uri></include>\n<include><uri>model://arm</uri>"
      "<name>second</name><pose>0 5 0 0 0 0</pose></include></sdf>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(scenario->robots.size(), 2u);
}

TEST_F(SdfWorldTest, PosesMayBeInDegreesQuaternionsAndRelativeToModelsAndFrames) {
  const auto model = [](const std::string& name, const std::string& pose) {
    return "<model name=\"" + name + "\">" + pose + kArm + "</model>\n";
  };
  const auto scenario =
      Load(model("turned", "<pose degrees=\"true\">1 2 0 0 0 90</pose>") +
           model("quat", "<pose rotation_format=\"quat_xyzw\">0 8 0 0 0 0.70710678 0.70710678</pose>") +
           "<frame name=\"f\" attached_to=\"turned\"><pose>1 0 0 0 0 0</pose></frame>" +
           model("behind", "<pose relative_to=\"f\">2 0 0 0 0 0</pose>"));
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  ASSERT_EQ(scenario->robots.size(), 3u);
  EXPECT_NEAR(Heading(scenario->robots[0].X_WR.q), std::numbers::pi / 2, 1e-6);
  EXPECT_NEAR(Heading(scenario->robots[1].X_WR.q), std::numbers::pi / 2, 1e-6);
  EXPECT_NEAR((scenario->robots[2].X_WR.p - Vector3(1, 5, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR(Heading(scenario->robots[2].X_WR.q), std::numbers::pi / 2, 1e-6);
}

TEST_F(SdfWorldTest, APosePlacesTheFrameThatIsNamed) {
  // X_WM = X_WF X_MF^-1, for a link, for a frame in a nested model, and for one that an include names.
  folder().Write("part/model.sdf", "<sdf version=\"1.9\">" + Model("part", kArm) + "</sdf>");
  const std::string turned = "<pose>5 0 0 0 0 1.5707963267948966</pose>";
  const auto scenario = Load(
      "<model name=\"a\" placement_frame=\"arm\"><pose>1 2 3 0 0 0</pose>" + kArm + "</model>" +
      "<model name=\"b\" placement_frame=\"inner::f\">" + turned + kArm +
      "<model name=\"inner\"><pose>1 0 0 0 0 0</pose><frame name=\"f\" attached_to=\"l\"><pose>0 0 -0.1 0 0 "
      "1.5707963267948966</pose></frame>" +
      Link("l", "0 1 0.1 0 0 0") +
      "</model><joint name=\"j\" "
      "type=\"fixed\"><parent>base</parent><child>inner::l</child></joint></model>" +
      "<include><uri>model://part</uri><placement_frame>arm</placement_frame><pose>0 9 3 0 0 "
      "0</pose></include>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(messages(), "");
  ASSERT_EQ(scenario->robots.size(), 3u);
  EXPECT_NEAR((scenario->robots[0].X_WR.p - Vector3(1, 2, 2.6)).norm(), 0, 1e-9);
  EXPECT_NEAR((scenario->robots[1].X_WR.p - Vector3(4, -1, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR(Heading(scenario->robots[1].X_WR.q), 0, 1e-9);
  EXPECT_NEAR((scenario->robots[2].X_WR.p - Vector3(0, 9, 2.6)).norm(), 0, 1e-9);
}

TEST_F(SdfWorldTest, APlacementFrameThatIsNowhereIsSaid) {
  const auto scenario =
      Load("<model name=\"a\" placement_frame=\"hand\"><pose>1 2 0 0 0 0</pose>" + kArm + "</model>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), HasSubstr("placement_frame 'hand' names nothing in model 'a': <pose> places the "
                                    "model's own frame"));
  EXPECT_NEAR((scenario->robots[0].X_WR.p - Vector3(1, 2, 0)).norm(), 0, 1e-9);
}

TEST_F(SdfWorldTest, FramesThatNameEachOtherAreSaid) {
  const auto scenario = Load(
      "<frame name=\"a\" attached_to=\"b\"/><frame name=\"b\" attached_to=\"a\"/>"
      "<model name=\"arm\"><pose relative_to=\"a\">0 0 0 0 0 0</pose>" +
      kArm + "</model>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_THAT(messages(), HasSubstr("warning: there is no model or frame"));
}

TEST_F(SdfWorldTest, LooseLinksNeedNoCanonicalOne) {
  const auto scenario = Load("<model name=\"two\" canonical_link=\"b\">" + Link("a", "0 0 0.5 0 0 0") +
                             Link("b", "2 0 0.5 0 0 0") + "</model>");
  ASSERT_NE(scenario, nullptr) << messages();
  EXPECT_EQ(scenario->objects.size(), 2u);
}

TEST_F(SdfWorldTest, ACanonicalLinkThatIsNoneIsMendedOrAnErrorIfStrict) {
  const std::string model = "<model name=\"a\" canonical_link=\"hand\">" + kArm + "</model>";
  EXPECT_NE(Load(model), nullptr) << messages();
  EXPECT_THAT(messages(), HasSubstr("warning: canonical_link of model 'a' names no link of it: 'hand': its "
                                    "first link is taken"));
  MakeStrict();
  EXPECT_EQ(Load(model), nullptr);
  EXPECT_THAT(messages(), HasSubstr("error: canonical_link of model 'a' names no link of it: 'hand'"));
}

TEST_F(SdfWorldTest, AMissingIncludeIsSaidOnce) {
  const std::string include = "<include><uri>model://nowhere</uri></include>\n";
  EXPECT_NE(Load(Model("arm", kArm) + include + include), nullptr);
  EXPECT_EQ(messages().find("nowhere"), messages().rfind("nowhere")) << messages();
}

}  // namespace sdf_world
}  // namespace
}  // namespace coopdyn
