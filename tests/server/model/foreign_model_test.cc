// SPDX-License-Identifier: MIT
// Models made for other programs: URDF, older SDF, includes, meshes and Gazebo's plug-ins; and hostile ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "server/geometry/mesh.h"
#include "tests/cpu.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct ForeignAnswer {
  std::shared_ptr<const RobotModel> robot;
  std::string messages;
};

ForeignAnswer ReadFile(const TempFolder& folder, const std::string& name, const SearchPath& path = {}) {
  Diagnostics diagnostics;
  ForeignAnswer answer;
  answer.robot = ReadRobotModel(folder.path() / name, path, diagnostics);
  answer.messages = diagnostics.ToString();
  return answer;
}
ForeignAnswer ReadAs(const std::string& name, const std::string& text) {
  const TempFolder folder;
  folder.Write(name, text);
  return ReadFile(folder, name);
}
ForeignAnswer ReadUrdf(const std::string& inside) {
  return ReadAs("rig.urdf", "<robot name=\"rig\">\n" + inside + "</robot>");
}
ForeignAnswer ReadSdf(const std::string& inside, const std::string& version = "1.6") {
  return ReadAs("model.sdf",
                "<sdf version=\"" + version + "\"><model name=\"rig\">\n" + inside + "</model></sdf>");
}

std::string UrdfInertia(const std::string& mass = "1", const std::string& moment = "0.01") {
  return "<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + moment + "\" iyy=\"" + moment +
         "\" izz=\"" + moment + "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>\n";
}
std::string UrdfBox(const std::string& name) {
  return "<link name=\"" + name + "\">" + UrdfInertia() +
         "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>\n";
}
std::string SdfLink(const std::string& name, const std::string& pose, const std::string& geometry) {
  return "<link name=\"" + name + "\"><pose>" + pose +
         "</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></"
         "inertial>\n"
         "<collision name=\"c\"><geometry>" +
         geometry + "</geometry></collision></link>\n";
}
const std::string kSdfBox = "<box><size>0.2 0.2 0.2</size></box>";

/// A cube from 0 to 1 m as an .obj file.
const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

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
  // It reaches 0.1 m below its origin, so it stands that much higher.
  EXPECT_NEAR(robot->links[1].X_RL.p.z(), 0.4, 1e-9);
  EXPECT_NEAR(robot->height_m, 0.5, 1e-9);
  EXPECT_THAT(messages, HasSubstr("0.1 m below its origin"));
}

TEST(UrdfTest, AMimicOfNothingIsAnErrorWithItsLine) {
  const auto [robot, messages] = ReadUrdf(UrdfBox("base") + UrdfBox("arm") +
                                          "<joint name=\"turn\" type=\"continuous\"><parent link=\"base\"/>"
                                          "<child link=\"arm\"/>\n<mimic joint=\"tun\"/></joint>\n");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages,
              HasSubstr("rig.urdf:7: error: <mimic> of joint 'turn' names no joint of this robot: 'tun'"));
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
  const auto [robot, messages] = ReadUrdf(
      "<link name=\"base\">" + UrdfInertia() +
      "<visual><geometry><box size=\"1 1 1\"/></geometry></visual>"
      "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision></link>\n"
      "<gazebo "
      "reference=\"base\">\n<material>Gazebo/Red</material>\n<mu1>0.3</mu1>\n<kp>1e6</kp>\n</gazebo>\n"
      "<gazebo reference=\"bse\">\n<mu1>1</mu1></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].visuals.at(0).color.r, 1);
  EXPECT_EQ(robot->links[0].visuals.at(0).color.g, 0);
  EXPECT_EQ(robot->links[0].collisions.at(0).friction, 0.3);
  EXPECT_THAT(messages,
              HasSubstr("rig.urdf:7: warning: <kp> in <gazebo reference> is not used by coopdyn\n"));
  EXPECT_THAT(messages, HasSubstr("rig.urdf:9: warning: <gazebo reference=\"bse\"> names no link or joint"));
}

TEST(ForeignModelTest, APoseModuleIsThereWithoutOurElements) {
  const auto [robot, messages] = ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->modules().size(), 1u);
  EXPECT_EQ(robot->modules()[0].name, "pose");
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

TEST(ForeignModelTest, ADriveOfGazeboHasAModuleAndItsOriginUnderTheAxle) {
  const auto wheel = [](const std::string& name, double y) {
    return SdfLink(name, "0.1 " + std::to_string(y) + " 0.05 -1.570796326794897 0 0",
                   "<cylinder><radius>0.05</radius><length>0.02</length></cylinder>") +
           "<joint name=\"" + name + "_j\" type=\"revolute\"><parent>base</parent><child>" + name +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  };
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + wheel("left", 0.2) + wheel("right", -0.2) +
              "<plugin filename=\"libgazebo_ros_diff_drive.so\" name=\"d\"><leftJoint>left_j</leftJoint>"
              "<rightJoint>right_j</rightJoint><wheelTorque>3</wheelTorque></plugin>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  EXPECT_NEAR(robot->drive()->track_m, 0.4, 1e-9);
  EXPECT_NEAR(robot->drive()->wheel_radius_m, 0.05, 1e-9);
  EXPECT_EQ(robot->drive()->max_torque_nm, 3);
  EXPECT_NEAR(robot->links[0].X_RL.p.x(), -0.1, 1e-9);
  EXPECT_EQ(robot->modules()[0].type, "motors");
}

TEST(ForeignModelTest, AllWheelsOfADriveOfGazeboTurn) {
  const auto wheel = [](const std::string& name, double x, double y) {
    return SdfLink(name, std::to_string(x) + " " + std::to_string(y) + " 0.05 -1.570796326794897 0 0",
                   "<cylinder><radius>0.05</radius><length>0.02</length></cylinder>") +
           "<joint name=\"" + name + "_j\" type=\"revolute\"><parent>base</parent><child>" + name +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  };
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.15 0 0 0", kSdfBox) + wheel("a", 0.1, 0.2) + wheel("b", 0.1, -0.2) +
              wheel("c", -0.1, 0.2) + wheel("d", -0.1, -0.2) +
              "<plugin filename=\"gz-sim-diff-drive-system\" name=\"gz::sim::systems::DiffDrive\">"
              "<left_joint>a_j</left_joint><left_joint>c_j</left_joint><right_joint>b_j</right_joint>"
              "<right_joint>d_j</right_joint></plugin>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_NE(robot->drive(), nullptr) << messages;
  ASSERT_EQ(robot->couplings.size(), 2u) << messages;
  EXPECT_EQ(robot->joints[static_cast<std::size_t>(robot->couplings[0].follower)].name, "c_j");
  EXPECT_EQ(robot->joints[static_cast<std::size_t>(robot->couplings[0].leader)].name, "a_j");
  EXPECT_EQ(robot->couplings[0].multiplier, 1);
}

TEST(ForeignModelTest, AMotorOfManyRoundsHasTheMostAndIsSaid) {
  const auto with = [](const std::string& limit) {
    return ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("arm", "0 0 0.4 0 0 0", kSdfBox) +
                   "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis>"
                   "<xyz>0 0 1</xyz><limit>" +
                   limit + "</limit></axis></joint>");
  };
  const auto [fast, said] = with("<effort>50000</effort><velocity>50000</velocity>");
  ASSERT_NE(fast, nullptr) << said;
  EXPECT_EQ(fast->actuators.size(), 1u) << said;
  EXPECT_EQ(fast->joints[0].max_velocity, 1e4);
  EXPECT_THAT(said, HasSubstr("<velocity> of joint 'j' is 50000: its motor has 10000 at most"));
  EXPECT_THAT(with("<effort>0</effort><velocity>1</velocity>").messages,
              HasSubstr("<effort> of joint 'j' is 0: it has no motor and moves freely"));
}

TEST(ForeignModelTest, AColladaFileStandsWhateverAxisItCallsUp) {
  for (const std::string up : {"Y_UP", "Z_UP"}) {
    const TempFolder folder;
    folder.Write(
        "part.dae",
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><up_axis>" +
            up +
            "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array "
            "id=\"a\" count=\"12\">0 0 0 0.2 0 0 0 0.4 0 0 0 0.6</float_array><technique_common><accessor "
            "source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
            "type=\"float\"/><param name=\"Z\" "
            "type=\"float\"/></accessor></technique_common></source><vertices "
            "id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"4\"><input "
            "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 2 1 0 1 3 0 3 2 1 2 "
            "3</p></triangles></mesh>"
            "</geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
            "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>"
            "<instance_visual_scene url=\"#s\"/></scene></COLLADA>");
    folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"rig\">" +
                                  SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>part.dae</uri></mesh>") +
                                  "</model></sdf>");
    const auto [robot, messages] = ReadFile(folder, "model.sdf");
    ASSERT_NE(robot, nullptr) << messages;
    double low_m = 1, high_m = -1;
    for (const Vector3& v : std::get<Mesh>(robot->links[0].collisions[0].shape).data->vertices) {
      low_m = std::min(low_m, v.z());
      high_m = std::max(high_m, v.z());
    }
    EXPECT_NEAR(high_m - low_m, 0.6, 1e-6) << up;
  }
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
  const auto joint = [](const std::string& name, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"revolute\"><parent>base</parent><child>" + child +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  };
  const auto [robot, messages] =
      ReadSdf(SdfLink("base", "0 0 0.1 0 0 0", kSdfBox) + SdfLink("a", "0 0 0.5 0 0 0", kSdfBox) +
              SdfLink("b", "0 0 0.9 0 0 0", kSdfBox) + joint("j", "a") + joint("k", "b") +
              "<plugin filename=\"gz-sim-joint-trajectory-controller-system\" "
              "name=\"gz::sim::systems::JointTrajectoryController\"><joint_name>j</joint_name>"
              "<joint_name>k</joint_name></plugin>\n");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->actuators.size(), 1u);
  EXPECT_EQ(robot->actuators[0].joints.size(), 2u);
}

TEST(ForeignModelTest, AStaticModelStandsFixed) {
  const auto [robot, messages] = ReadSdf("<static>1</static>" + SdfLink("base", "0 0 1 0 0 0", kSdfBox));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
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

TEST(MeshTest, WhatMovesCollidesByItsHull) {
  const TempFolder folder;
  folder.Write("cube.obj", kCube);
  folder.Write("model.sdf",
               "<sdf version=\"1.6\"><model name=\"m\">" +
                   SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>cube.obj</uri><scale>1 1 2</scale></mesh>") +
                   "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkShape& shape = robot->links[0].collisions.at(0);
  const MeshData& data = *std::get<Mesh>(shape.shape).data;
  EXPECT_NEAR(data.volume_m3, 2, 1e-9);
  EXPECT_EQ(data.vertices.size(), 8u);
  EXPECT_NEAR((shape.X_LG.p - Vector3(0.5, 0.5, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR(robot->height_m, 2, 1e-6);
  EXPECT_NEAR(robot->footprint_radius_m, std::sqrt(2.0), 1e-6);
}

TEST(MeshTest, ARecordedTextGivesTheSameModelWithoutFiles) {
  const TempFolder folder;
  folder.Write("cube.obj", kCube);
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\">" +
                                SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>cube.obj</uri></mesh>") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "m", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(std::get<Mesh>(again->links[0].collisions[0].shape).data->id,
            std::get<Mesh>(robot->links[0].collisions[0].shape).data->id);
  EXPECT_EQ(again->text, robot->text);
}

TEST(MeshTest, ACentredPartIsTheSameInARecordedText) {
  const TempFolder folder;
  std::string cube = kCube;
  for (std::size_t at = 0; (at = cube.find("v 0", at)) != std::string::npos; ++at)
    cube.replace(at, 3, at == 0 ? "v 1e-13" : "v 0.1234567");
  folder.Write("cube.obj", "g part\n" + cube);
  folder.Write(
      "model.sdf",
      "<sdf version=\"1.9\"><model name=\"rig\">" +
          SdfLink("l", "0 0 1 0 0 0",
                  "<mesh><uri>cube.obj</uri><submesh><name>part</name><center>true</center></submesh>"
                  "</mesh>") +
          "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  const LinkShape &before = robot->links[0].collisions.at(0), &after = again->links[0].collisions.at(0);
  EXPECT_EQ(before.X_LG.p, after.X_LG.p);
  EXPECT_NEAR(before.X_LG.p.norm(), 0, 1e-6);
  EXPECT_EQ(std::get<Mesh>(before.shape).data->vertices, std::get<Mesh>(after.shape).data->vertices);
  EXPECT_EQ(robot->meshes.at(0)->triangles, again->meshes.at(0)->triangles);
  EXPECT_EQ(robot->meshes.at(0)->inertia_m5, again->meshes.at(0)->inertia_m5);
}

TEST(MeshTest, AMissingMeshIsAnErrorWithItsLine) {
  const auto [robot, messages] =
      ReadSdf(SdfLink("l", "0 0 0 0 0 0", "\n<mesh><uri>model://rig/none.stl</uri></mesh>"));
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("model.sdf:4: error: mesh: there is no 'model://rig/none.stl'"));
}

TEST(MeshTest, TenMillionTrianglesAreRefusedUnread) {
  const TempFolder folder;
  std::string header(84, ' ');
  const std::uint32_t count = 10'000'000;
  header.replace(80, 4, reinterpret_cast<const char*>(&count), 4);
  folder.Write("big.stl", header);
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\">" +
                                SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>big.stl</uri></mesh>") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("the mesh has 10000000 triangles, at most 200000 are taken: simplify it"));
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
