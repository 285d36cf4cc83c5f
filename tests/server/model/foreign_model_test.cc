// SPDX-License-Identifier: MIT
// Models made for other programs: URDF, older SDF, includes and Gazebo's plug-ins; and hostile ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <variant>

#include "tests/cpu.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string UrdfInertia(const std::string& mass = "1", const std::string& moment = "0.01") {
  return "<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + moment + "\" iyy=\"" + moment +
         "\" izz=\"" + moment + "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n";
}
std::string UrdfBox(const std::string& name) {
  return "<link name=\"" + name + "\">" + UrdfInertia() +
         "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>\n";
}

TEST(UrdfTest, LinksStandWhereTheirJointsPutThem) {
  const auto [robot, messages] = ReadUrdf(UrdfBox("base") + UrdfBox("arm") +
                                          "<joint name=\"turn\" type=\"revolute\"><origin xyz=\"0 0 0.3\" "
                                          "rpy=\"0 0 1.5708\"/><parent link=\"base\"/>"
                                          "<child link=\"arm\"/><axis xyz=\"1 0 0\"/><limit lower=\"-1\" "
                                          "upper=\"2\" effort=\"5\" velocity=\"3\"/></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 1u);
  const JointModel& joint = robot->joints[0];
  EXPECT_EQ(joint.name, "turn");
  EXPECT_NEAR((joint.axis_R - Vector3::UnitY()).norm(), 0, 1e-4);
  EXPECT_EQ(joint.lower, -1);
  EXPECT_EQ(joint.max_effort, 5);
  // The model reaches 0.1 m below its origin, so it is placed that much higher.
  EXPECT_NEAR(robot->links[1].X_RL.p.z(), 0.4, 1e-9);
  EXPECT_NEAR(robot->height_m, 0.5, 1e-9);
  EXPECT_THAT(messages, HasSubstr("0.1 m below its origin"));
}

TEST(UrdfTest, AMimicOfNothingIsLeftOutWithItsLine) {
  const auto [robot, messages] = ReadUrdf(UrdfBox("base") + UrdfBox("arm") +
                                          "<joint name=\"turn\" type=\"continuous\"><parent link=\"base\"/>"
                                          "<child link=\"arm\"/>\n<mimic joint=\"tun\"/></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints.size(), 1u);
  EXPECT_TRUE(robot->couplings.empty());
  EXPECT_THAT(messages,
              HasSubstr("rig.urdf:7: warning: <mimic> of joint 'turn' names no joint of this robot: 'tun'"));
}

TEST(UrdfTest, JointsThatFollowAFixedOneAreFixed) {
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& leader) {
    return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/>" +
           (leader.empty() ? "" : "<mimic joint=\"" + leader + "\"/>") + "</joint>\n";
  };
  const auto [robot, messages] =
      ReadUrdf(UrdfBox("base") + UrdfBox("a") + UrdfBox("b") + UrdfBox("c") + UrdfBox("d") +
               joint("second", "continuous", "base", "c", "first") +
               joint("first", "continuous", "base", "b", "held") + joint("held", "fixed", "base", "a", "") +
               joint("free", "continuous", "base", "d", ""));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 1u);
  EXPECT_EQ(robot->joints[0].name, "free");
  EXPECT_THAT(messages, HasSubstr("joint 'first' follows the fixed joint 'held': it is taken as fixed"));
  EXPECT_THAT(messages, HasSubstr("joint 'second' follows the fixed joint 'first'"));
}

TEST(UrdfTest, ALinkCalledWorldIsTheWorld) {
  const auto [robot, messages] = ReadUrdf(
      "<link name=\"world\"/>\n" + UrdfBox("base") +
      "<joint name=\"hold\" type=\"fixed\"><parent link=\"world\"/><child link=\"base\"/></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
}

TEST(UrdfTest, AJointMayBeCalledLikeALink) {
  const auto [robot, messages] = ReadUrdf(UrdfBox("base") + UrdfBox("arm") +
                                          "<joint name=\"arm\" type=\"continuous\"><origin xyz=\"0 0 0.5\"/>"
                                          "<parent link=\"base\"/><child link=\"arm\"/></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].name, "arm");
  EXPECT_EQ(robot->links[1].name, "arm");
  EXPECT_NEAR(robot->links[1].X_RL.p.z() - robot->links[0].X_RL.p.z(), 0.5, 1e-12);
}

TEST(ForeignModelTest, LinksThatHangOnNoJointMoveOnTheirOwn) {
  const auto [robot, messages] =
      ReadSdf(SdfLink("a", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("b", "1 0 0.1 0 0 0", kSdfBox) +
              SdfLink("c", "2 0 0.1 0 0 0", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links.size(), 3u);
  EXPECT_TRUE(robot->has_limbs());
  EXPECT_THAT(messages,
              HasSubstr("warning: no joint leads from link 'a' to 'b' and 'c': they move on their own"));
}

TEST(ForeignModelTest, ASensorCalledLikeAnotherGetsANameOfItsOwn) {
  const auto [robot, messages] = ReadSdf(
      "<link name=\"l\"><inertial><mass>1</mass></inertial><collision name=\"c\"><geometry>" + kSdfBox +
      "</geometry></collision><sensor name=\"s\" type=\"imu\"/>\n<sensor name=\"s\" type=\"imu\"/>"
      "<sensor name=\"s_2\" type=\"imu\"/></link>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages,
              HasSubstr("model.sdf:3: warning: another <sensor> here is called 's': this one is called "
                        "'s_3'"));
  EXPECT_NE(robot->Find<ImuModel>(2), nullptr);
}

TEST(ForeignModelTest, EndlessFrictionAndLimitsAreNumbers) {
  const auto [robot, messages] = ReadSdf(
      "<link name=\"a\"><inertial><mass>1</mass></inertial><collision name=\"c\"><geometry>" + kSdfBox +
      "</geometry><surface><friction><ode><mu>inf</mu><mu2>-1</mu2></ode></friction></surface></collision>"
      "</link>" +
      SdfLink("b", "0 0 1 0 0 0", kSdfBox) +
      "<joint name=\"j\" type=\"revolute\"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz><limit>"
      "<lower>-inf</lower><upper>Infinity</upper><effort>5</effort><velocity>+Inf</velocity></limit></axis>"
      "</joint>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions[0].friction, 1000);
  EXPECT_FALSE(robot->joints[0].has_stop());
  EXPECT_THAT(messages, HasSubstr("<mu2> below 0 is taken as 1000"));
  EXPECT_EQ(ReadSdf("<link name=\"a\"><inertial><mass>nan</mass></inertial></link>").robot, nullptr);
}

TEST(UrdfTest, AJointWithoutItsLinkIsAnError) {
  const auto [robot, messages] = ReadUrdf(UrdfBox("base") +
                                          "<joint name=\"turn\" type=\"continuous\"><parent link=\"base\"/>"
                                          "<child link=\"arm\"/></joint>\n");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("needs <child link=\"…\"/> that names a link, not 'arm'"));
}

TEST(ForeignModelTest, AJointMayBeCalledLikeALinkOrWorld) {
  const std::string joints =
      "<joint name=\"arm\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz>"
      "<limit><effort>1</effort><velocity>1</velocity></limit></axis></joint>\n"
      "<joint name=\"world\" type=\"fixed\"><parent>world</parent><child>base</child></joint>\n";
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0 0.5 0 0 0", kSdfBox) + joints);
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->joints[0].name, "arm");
  EXPECT_TRUE(robot->fixed_base);
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(again->joints[0].name, "arm");
}

TEST(ForeignModelTest, ALinkCalledWorldIsTheWorld) {
  const auto [robot, messages] =
      ReadSdf("<link name=\"world\"><inertial><mass>1</mass></inertial></link>\n" +
              SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) +
              "<joint name=\"hold\" type=\"fixed\"><parent>world</parent><child>base</child></joint>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
  EXPECT_EQ(robot->links.size(), 1u);
  EXPECT_THAT(messages, HasSubstr("model.sdf:2: warning: the link 'world' is the world itself"));
}

TEST(UrdfTest, WhatGazeboSaysOfALinkIsUsedOrReported) {
  const auto [robot, messages] =
      ReadUrdf("<link name=\"base\">" + UrdfInertia() +
               "<visual><geometry><box size=\"1 1 1\"/></geometry></visual>"
               "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>\n"
               "<gazebo "
               "reference=\"base\">\n<material>Gazebo/Red</material>\n<mu1>0.3</mu1>\n<maxVel>0.1</"
               "maxVel>\n</gazebo>\n"
               "<gazebo reference=\"bse\">\n<mu1>1</mu1></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].visuals.at(0).color.r, 1);
  EXPECT_EQ(robot->links[0].visuals.at(0).color.g, 0);
  EXPECT_EQ(robot->links[0].collisions.at(0).friction, 0.3);
  EXPECT_THAT(messages,
              HasSubstr("rig.urdf:7: warning: <maxVel> in <gazebo reference> is not used by coopdyn\n"));
  EXPECT_THAT(messages, HasSubstr("rig.urdf:9: warning: <gazebo reference=\"bse\"> names no link or joint"));
}

TEST(ForeignModelTest, APoseModuleIsThereWithoutOurElements) {
  const auto [robot, messages] = ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->modules().size(), 1u);
  EXPECT_EQ(robot->modules()[0].name, "pose");
}

TEST(ForeignModelTest, WhatIsSoAnywayIsNoWarning) {
  const auto read = [](const std::string& in_link, const std::string& in_model) {
    std::string link = SdfLink("base", "0 0 0.1 0 0 0", kSdfBox);
    link.insert(link.find("</link>"), in_link);
    return ReadSdf(link + in_model).messages;
  };
  const std::string as_here =
      read("<gravity>true</gravity><kinematic>0</kinematic>", "<self_collide>0</self_collide>");
  EXPECT_THAT(as_here, Not(HasSubstr("is not used")));
  const std::string other =
      read("<gravity>0</gravity><kinematic>1</kinematic>", "<self_collide>1</self_collide>");
  for (const char* name : {"gravity", "kinematic", "self_collide"})
    EXPECT_THAT(other, HasSubstr("<" + std::string(name) + ">"));
}

TEST(ForeignModelTest, WhatIsNotUsedIsAWarningWithItsLine) {
  const auto [robot, messages] = ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) +
                                         "<plugin filename=\"libfoo.so\" name=\"foo\"/>\n<banana/>\n");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("warning: plug-in 'libfoo.so' is not used by coopdyn"));
  EXPECT_THAT(messages, HasSubstr("warning: <banana> in <model> is not used by coopdyn"));
}

TEST(ForeignModelTest, AnAxisOfSdf14IsInTheModelsFrame) {
  const std::string model =
      SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0 0.4 0 0 1.5708", kSdfBox) +
      "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>1 0 "
      "0</xyz></axis></joint>";
  const auto old = ReadSdf(model, "1.4").robot, newer = ReadSdf(model, "1.6").robot;
  ASSERT_TRUE(old != nullptr && newer != nullptr);
  EXPECT_NEAR((old->joints[0].axis_R - Vector3::UnitX()).norm(), 0, 1e-9);
  EXPECT_NEAR((newer->joints[0].axis_R - Vector3::UnitY()).norm(), 0, 1e-4);
}

TEST(ForeignModelTest, TheDeclarationMayStandBehindAComment) {
  const auto [robot, messages] = ReadAs(
      "model.sdf", "<!-- of\nus -->\n<?xml version=\"1.0\"?>\n<sdf version=\"1.6\"><model name=\"rig\">\n" +
                       SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + "<wrong/></model></sdf>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("model.sdf:7: warning: <wrong>"));
}

TEST(ForeignModelTest, APoseMayHaveLines) {
  const auto [robot, messages] = ReadSdf(SdfLink("base", "\n 0 0 0.1\n 0 0 0.5\n", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR((robot->links.at(0).X_RL.q * Vector3::UnitX()).y(), std::sin(0.5), 1e-12);
}

TEST(ForeignModelTest, ThePoseIsInTheFirstSixNumbers) {
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0.3 0.4 0 0 0 0", kSdfBox) +
              "<joint name=\"j\" type=\"ball\"><parent>base</parent><child>arm</child></joint>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR((robot->links.at(1).X_RL.p - Vector3(0, 0.3, 0.4)).norm(), 0, 1e-12);
  EXPECT_THAT(messages, HasSubstr("warning: <pose> has more than 6 numbers: the first 6 count"));
}

TEST(ForeignModelTest, AJointWithoutAxisTurnsAboutZ) {
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0.3 0.4 0 0 0", kSdfBox) +
              "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child></joint>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR((robot->joints.at(0).axis_R - Vector3::UnitZ()).norm(), 0, 1e-12);
  EXPECT_THAT(messages, HasSubstr("warning: joint 'j' has no <axis>: it is 0 0 1"));
}

TEST(ForeignModelTest, AShapeRelativeToNothingStandsInItsLink) {
  const auto [robot, messages] = ReadSdf(
      "<link name=\"base\"><collision name=\"c\">\n<pose relative_to=\"hull\">0 0 0.3 "
      "0 0 0</pose><geometry>" +
          kSdfBox + "</geometry></collision></link>",
      "1.8");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR(robot->links.at(0).collisions.at(0).X_LG.p.z(), 0.3, 1e-12);
  EXPECT_THAT(messages, HasSubstr("[hull] in graph.: the pose counts from its own link"));
}

TEST(ForeignModelTest, ColoursAboveOneAreOne) {
  const auto [robot, messages] =
      ReadSdf("<link name=\"base\"><visual name=\"v\"><geometry>" + kSdfBox +
              "</geometry><material>\n<diffuse>200 0.5 1.1 1</diffuse></material></visual></link>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages,
              HasSubstr("model.sdf:3: warning: <diffuse> has numbers above 1: they are taken as 1"));
}

TEST(ForeignModelTest, AnEmptyPoseIsTheFrameItself) {
  std::string hand = SdfLink("hand", "", kSdfBox);
  hand.replace(hand.find("<pose></pose>"), 13, "<pose relative_to=\"base\"/>");
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + hand +
                  "<joint name=\"j\" type=\"revolute\"><pose/><parent>base</parent><child>hand</child><axis>"
                  "<xyz>0 0 1</xyz></axis></joint>",
              "1.9");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 2u);
  EXPECT_NEAR((robot->links[1].X_RL.p - robot->links[0].X_RL.p).norm(), 0, 1e-9);
}

TEST(ForeignModelTest, AttributesWithoutNumberAreRefusedBeforeTheyAreCompared) {
  const auto read = [](std::size_t count) {
    std::string attributes;
    for (std::size_t i = 0; i < count; ++i) attributes += " a" + std::to_string(i) + "=\"1\"";
    EXPECT_THAT(ReadSdf("<link" + attributes + "/>").messages,
                HasSubstr("model.sdf:2: error: a robot's model has at most 64 attributes of one element"));
  };
  ExpectLinear(read, 3000);
}

TEST(ForeignModelTest, AControllerPlugInGivesAllItsJointsMotors) {
  constexpr const char* kNamed = "<joint_name>j</joint_name><joint_name>k</joint_name>";
  const auto joint = [](const std::string& name, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"revolute\"><parent>base</parent><child>" + child +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  };
  for (const std::string named : {kNamed, ""}) {  // without names it moves all joints
    const auto [robot, messages] =
        ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("a", "0 0 0.5 0 0 0", kSdfBox) +
                SdfLink("b", "0 0 0.9 0 0 0", kSdfBox) + joint("j", "a") + joint("k", "b") +
                "<plugin filename=\"gz-sim-joint-trajectory-controller-system\" "
                "name=\"gz::sim::systems::JointTrajectoryController\">" +
                named + "</plugin>\n");
    ASSERT_NE(robot, nullptr) << messages;
    ASSERT_EQ(robot->actuators.size(), 1u) << named;
    EXPECT_EQ(robot->actuators[0].joints.size(), 2u) << named;
  }
}

TEST(ForeignModelTest, RollingFrictionOfBulletIsNotUsedWhereGazeboIsMeant) {
  const auto wheel = [](const std::string& plugin) {
    return ReadSdf(
        "<link name='ball'><pose>0 0 0.1 0 0 "
        "0</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01"
        "</iyy><izz>0.01</izz></inertia></inertial><collision name='c'><geometry><sphere><radius>0.1</radius>"
        "</sphere></geometry><surface><friction><bullet><rolling_friction>0.1</rolling_friction></bullet>"
        "</friction></surface></collision></link>\n" +
        plugin);
  };
  const auto alone = wheel(""), made = wheel("<plugin name='p' filename='libgazebo_ros_p3d.so'/>\n");
  ASSERT_NE(alone.robot, nullptr) << alone.messages;
  ASSERT_NE(made.robot, nullptr) << made.messages;
  EXPECT_EQ(alone.robot->links[0].collisions[0].rolling_friction_m, 0.1);
  EXPECT_EQ(made.robot->links[0].collisions[0].rolling_friction_m, 0);
}

TEST(ForeignModelTest, AStaticModelStandsFixed) {
  const auto [robot, messages] = ReadSdf("<static>1</static>" + SdfLink("base", "0 0 1 0 0 0", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
}

TEST(ForeignModelTest, PointsAndEndlessFloorsCollideAtTheNearestSizeThatMayBe) {
  const auto [robot, messages] =
      ReadSdf(SdfLink("point", "0 0 1 0 0 0", "<sphere><radius>0</radius></sphere>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(std::get<Sphere>(robot->links[0].collisions[0].shape).radius_m, 1e-4);
  EXPECT_THAT(messages, HasSubstr("it collides with the nearest size that may be"));
  const auto negative = ReadSdf(SdfLink("point", "0 0 1 0 0 0", "<sphere><radius>-1</radius></sphere>"));
  EXPECT_EQ(negative.robot, nullptr);
}

TEST(ForeignModelTest, AMassOfNearlyNothingIsNoMass) {
  const auto [robot, messages] = ReadSdf(
      "<link name=\"l\"><inertial><mass>4e-15</mass><inertia><ixx>1e-27</ixx><iyy>1e-27</iyy><izz>1e-27</izz>"
      "</inertia></inertial><collision name=\"c\"><geometry>" +
      kSdfBox + "</geometry></collision></link>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].mass_kg, 0.01);
  EXPECT_THAT(messages, HasSubstr("it gets 10 g"));
}

TEST(UrdfTest, ABaseWithoutMassHasThatOfWhatIsFixedToIt) {
  const auto hold = [](const std::string& parent, const std::string& child) {
    return "<joint name=\"" + child + "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" +
           child + "\"/></joint>\n";
  };
  const auto [robot, messages] =
      ReadUrdf("<link name=\"footprint\"/><link name=\"base\"/>" + UrdfBox("trunk") +
               hold("footprint", "base") + hold("base", "trunk"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 1u);
  EXPECT_EQ(robot->links[0].mass_kg, 1);
  EXPECT_NEAR(robot->links[0].inertia_kg_m2.x(), 0.01, 1e-12);
  EXPECT_THAT(messages, Not(HasSubstr("10 g")));
}

TEST(ForeignModelTest, ASensorInTheWrongPlaceIsLeftOut) {
  const auto [robot, messages] =
      ReadSdf("<link name=\"l\"><sensor name=\"ft\" type=\"force_torque\"/>" +
              SdfLink("", "0 0 1 0 0 0", kSdfBox).substr(std::string("<link name=\"\">").size()));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("<sensor type=\"force_torque\"> in <link> is not used by coopdyn"));
}

TEST(ForeignModelTest, AutoInertiaIsThatOfTheShapesByTheirDensities) {
  // Two cubes of 0.2 m, 0.4 m apart: 8 kg by the link's density, and 4 kg by its own.
  const std::string cube = "<geometry>" + kSdfBox + "</geometry>";
  const std::string shapes = "<collision name=\"a\">" + cube + "</collision>" +
                             "<collision name=\"b\"><pose>0.4 0 0 0 0 0</pose><density>500</density>" + cube +
                             "</collision></link>";
  const auto [robot, messages] =
      ReadSdf("<link name=\"l\"><pose>0 0 1 0 0 0</pose><inertial auto=\"true\"/>" + shapes, "1.11");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  const LinkModel& link = robot->links[0];
  EXPECT_NEAR(link.mass_kg, 12, 1e-9);
  EXPECT_NEAR(link.X_LI.p.x(), 0.4 / 3, 1e-9);
  const double own = 12 * 0.04 / 6, across = own + 8 * 4 / 12.0 * 0.16;
  EXPECT_NEAR(link.inertia_kg_m2.minCoeff(), own, 1e-9);
  EXPECT_NEAR(link.inertia_kg_m2.maxCoeff(), across, 1e-9);

  const auto dense =
      ReadSdf("<link name=\"l\"><inertial auto=\"true\"><density>2000</density></inertial>" + shapes, "1.11");
  ASSERT_NE(dense.robot, nullptr) << dense.messages;
  EXPECT_NEAR(dense.robot->links[0].mass_kg, 20, 1e-9);
}

TEST(ForeignModelTest, AutoInertiaOfASolidIsItsClosedForm) {
  struct Solid {
    const char* geometry;
    double volume_m3;
    Vector3 moments_m2;  // for 1 kg, about the centre of mass
    double z_m;          // height of the centre of mass
  };
  const double pi = std::numbers::pi;
  const double r = 0.3, h = 0.8, ends = 4 * r / (4 * r + 3 * h);
  const double capsule =
      (1 - ends) * (r * r / 4 + h * h / 12) + ends * (0.4 * r * r + h * h / 4 + 3.0 / 8 * h * r);
  for (const Solid& one :
       {Solid{"<box><size>0.2 0.4 0.6</size></box>", 0.048, Vector3(0.52, 0.4, 0.2) / 12, 0},
        Solid{"<sphere><radius>0.3</radius></sphere>", 4.0 / 3 * pi * 0.027, Vector3::Constant(0.4 * 0.09),
              0},
        Solid{"<cylinder><radius>0.3</radius><length>0.8</length></cylinder>",
              pi * 0.09 * 0.8,
              {(3 * 0.09 + 0.64) / 12, (3 * 0.09 + 0.64) / 12, 0.045},
              0},
        Solid{"<capsule><radius>0.3</radius><length>0.8</length></capsule>",
              pi * 0.09 * (0.8 + 0.4),
              {capsule, capsule, 0.09 * ((1 - ends) / 2 + 0.4 * ends)},
              0},
        Solid{"<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>", 4.0 / 3 * pi * 0.006,
              Vector3(0.13, 0.1, 0.05) / 5, 0},
        Solid{"<cone><radius>0.3</radius><length>0.8</length></cone>",
              pi * 0.09 * 0.8 / 3,
              {3.0 / 80 * (4 * 0.09 + 0.64), 3.0 / 80 * (4 * 0.09 + 0.64), 0.027},
              -0.2}}) {
    const auto [robot, messages] = ReadSdf(
        "<link name=\"l\"><pose>0 0 2 0 0 0</pose><inertial auto=\"true\"/><collision name=\"c\"><pose>0.5 0 "
        "0 0 0 "
        "0</pose><density>300</density><geometry>" +
            std::string(one.geometry) + "</geometry></collision></link>",
        "1.11");
    ASSERT_NE(robot, nullptr) << messages;
    const LinkModel& link = robot->links[0];
    const double mass_kg = 300 * one.volume_m3;
    EXPECT_NEAR(link.mass_kg, mass_kg, 1e-9 * mass_kg) << one.geometry;
    EXPECT_NEAR((link.X_LI.p - Vector3(0.5, 0, one.z_m)).norm(), 0, 1e-9) << one.geometry;
    const Matrix3 R = link.X_LI.q.toRotationMatrix();
    const Matrix3 inertia = R * link.inertia_kg_m2.asDiagonal() * R.transpose();
    const Matrix3 wanted = (mass_kg * one.moments_m2).asDiagonal();
    EXPECT_NEAR((inertia - wanted).norm(), 0, 1e-9 * mass_kg) << one.geometry;
  }
}

TEST(ForeignModelTest, ACollisionOfAnUnknownTypeOfMeshIsABoxOfTheInertia) {
  const TempFolder folder;
  folder.Write("a.vtk", "# vtk DataFile Version 2.0\n");
  const std::string mesh = "<mesh><uri>a.vtk</uri></mesh>";
  const std::string link = SdfLink("l", "0 0 1 0 0 0", mesh);
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\">" + link.substr(0, link.find("</link>")) +
                                "<visual name=\"v\"><geometry>" + mesh +
                                "</geometry></visual></link></model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Box>(robot->links[0].collisions[0].shape));
  EXPECT_TRUE(robot->links[0].visuals.empty());
  EXPECT_THAT(messages, AllOf(HasSubstr("warning: mesh 'a.vtk': meshes are read from .stl"),
                              HasSubstr("until then a box that has the link's inertia collides"),
                              HasSubstr("(it is not drawn)")));
  SearchPath strict;
  strict.is_strict = true;
  EXPECT_EQ(ReadFile(folder, "model.sdf", strict).robot, nullptr);
}

TEST(ForeignModelTest, XacroThatCameOverASocketIsNotExpanded) {
  const TempFolder folder;
  folder.Write("a.urdf", "<robot name=\"r\"><xacro:include filename=\"/etc/hostname\"/></robot>");
  SearchPath path;
  path.uploads = folder.path();
  EXPECT_THAT(ReadFile(folder, "a.urdf", path).messages,
              HasSubstr("xacro that is sent is not expanded here"));
}

TEST(IncludeTest, ANestedCopyHasItsOwnNames) {
  const TempFolder folder;
  folder.Write("part.sdf", "<sdf version=\"1.6\"><model name=\"part\">" +
                               SdfLink("rod", "0 0 0.5 0 0 0", kSdfBox) + "</model></sdf>");
  const auto part = [](const std::string& name, const std::string& x) {
    return "<include><uri>part.sdf</uri><name>" + name + "</name><pose>" + x + " 0 0 0 0 0</pose></include>" +
           "<joint name=\"to_" + name + "\" type=\"fixed\"><parent>base</parent><child>" + name +
           "::rod</child></joint>";
  };
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"two\">" +
                                SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + part("a", "1") + part("b", "2") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 1u);
  ASSERT_EQ(robot->links[0].collisions.size(), 3u);
  EXPECT_NEAR(robot->links[0].X_LI.p.x(), 1, 1e-9);  // of three equal masses at 0, 1 and 2 m
}

TEST(IncludeTest, AFileMayHoldAnIncludeAlone) {
  const TempFolder folder;
  folder.Write("part/model.sdf", "<sdf version=\"1.9\"><model name=\"part\">\n" +
                                     SdfLink("body", "0 0 0.1 0 0 0", kSdfBox) + "</model></sdf>");
  const std::string include = "<include><uri>part</uri></include>";
  folder.Write("robot.sdf", "<sdf version=\"1.4\">" + include + "</sdf>");
  folder.Write("outer.sdf", "<sdf version=\"1.9\"><include><uri>robot.sdf</uri></include></sdf>");
  for (const char* file : {"robot.sdf", "outer.sdf"}) {
    const auto [robot, messages] = ReadFile(folder, file);
    ASSERT_NE(robot, nullptr) << messages;
    ASSERT_EQ(robot->links.size(), 1u);
    EXPECT_EQ(robot->links[0].name, "body");
  }
}

TEST(IncludeTest, AModelThatIncludesItselfIsAnError) {
  const TempFolder folder;
  folder.Write(
      "model.sdf",
      "<sdf version=\"1.6\"><model name=\"me\"><include><uri>model.sdf</uri></include></model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("does a model include itself?"));
}

TEST(IncludeTest, NothingOutsideTheFolderIsRead) {
  const TempFolder outside, folder;
  outside.Write("secret.sdf", "<sdf version=\"1.6\"><model name=\"s\">" +
                                  SdfLink("l", "0 0 1 0 0 0", kSdfBox) + "</model></sdf>");
  std::filesystem::create_symlink(outside.path() / "secret.sdf", folder.path() / "link.sdf");
  const std::string up = std::filesystem::relative(outside.path() / "secret.sdf", folder.path()).string();
  for (const std::string& uri : {std::string("link.sdf"), up, (outside.path() / "secret.sdf").string(),
                                 "file://" + (outside.path() / "secret.sdf").string()}) {
    folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\"><include><uri>" + uri +
                                  "</uri></include></model></sdf>");
    const auto [robot, messages] = ReadFile(folder, "model.sdf");
    EXPECT_EQ(robot, nullptr) << uri;
    EXPECT_THAT(messages, HasSubstr("lies outside the model's folder and the search path")) << uri;
  }
}

TEST(HostileModelTest, ZeroInertiaIsReplacedAndSaid) {
  const auto [robot, messages] =
      ReadUrdf("<link name=\"base\">" + UrdfInertia("2", "0") +
               "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("rig.urdf:2: warning: the inertia of link 'base'"));
  EXPECT_NEAR(robot->links[0].inertia_kg_m2.x(), 0.4 * 2 * 0.01, 1e-12);
}

TEST(HostileModelTest, NegativeMassOrInertiaIsAnErrorWithItsLine) {
  for (const auto& [mass, moment] : {std::pair("-1", "0.01"), {"1", "-0.01"}}) {
    const auto [robot, messages] = ReadUrdf("\n<link name=\"base\">" + UrdfInertia(mass, moment) + "</link>");
    EXPECT_EQ(robot, nullptr);
    EXPECT_THAT(messages, HasSubstr("rig.urdf:3: error: the "));
  }
}

TEST(HostileModelTest, NotANumberIsAnErrorWithItsLine) {
  const auto [robot, messages] = ReadUrdf("<link name=\"base\">\n" + UrdfInertia("nan") + "</link>");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("rig.urdf:3: error: <mass> needs finite numbers, not 'nan'"));
}

TEST(HostileModelTest, ALoopOfFixedJointsIsAnError) {
  const auto joint = [](const std::string& a, const std::string& b) {
    return "<joint name=\"" + a + b + "\" type=\"fixed\"><parent>" + a + "</parent><child>" + b +
           "</child></joint>";
  };
  const auto [robot, messages] =
      ReadSdf(SdfLink("a", "0 0 1 0 0 0", kSdfBox) + SdfLink("b", "0 0 1 0 0 0", kSdfBox) + joint("a", "b") +
              joint("b", "a"));
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("hangs in a loop of fixed joints: remove one of them"));
}

TEST(HostileModelTest, AnXmlBombIsNotExpanded) {
  const auto [robot, messages] =
      ReadAs("model.sdf",
             "<!DOCTYPE s [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">"
             "<!ENTITY c SYSTEM \"file:///etc/passwd\">]>\n<sdf version=\"1.6\"><model name=\"&b;&c;\">" +
                 SdfLink("l", "0 0 1 0 0 0", kSdfBox) + "</model></sdf>");
  EXPECT_THAT(messages, Not(HasSubstr("root:")));
  if (robot != nullptr) {
    EXPECT_LT(robot->text.size(), 5000u);
  }
}

TEST(ModelPathTest, AScenarioMayNameAModelByItsPath) {
  const TempFolder folder;
  folder.Write("mine.urdf", "<robot name=\"rig\">" + UrdfBox("base") + "</robot>");
  folder.Write("a.scenario", "[ROBOT_1]\ntype mine.urdf\nposition 0 0\n");
  RobotLibrary library(SearchPath{});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((folder.path() / "a.scenario").string(), library, diagnostics);
  ASSERT_NE(scenario, nullptr) << diagnostics.ToString();
  EXPECT_EQ(scenario->robots.at(0).model->type, "mine.urdf");
  EXPECT_THAT(Read("[ROBOT_1]\ntype ../mine.urdf\nposition 0 0\n", true).messages,
              HasSubstr("over a socket"));
}

}  // namespace
}  // namespace coopdyn
