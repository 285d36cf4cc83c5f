// SPDX-License-Identifier: MIT
// Worlds and sensors of MuJoCo's files, files for newer versions, and damaged ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/model/mjcf.h"
#include "tests/server/mjcf/mjcf_rig.h"

namespace coopdyn {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string MessagesOf(const std::string& text) {
  return ReadAs("rig.xml", text).messages;
}

TEST(MjcfFilesTest, AWorldHasItsFloorThingsAndRobots) {
  const auto [world, messages] = ReadMjcfWorld(
      Mjcf("<option timestep=\".005\" gravity=\"0 0 -3\"/><worldbody><geom type=\"plane\" size=\"7 8 "
           "1\"/><geom name=\"wall\" "
           "type=\"box\" size=\".1 1 .5\" pos=\"2 0 .5\"/><body name=\"a\" pos=\"0 0 .2\"><freejoint/><geom "
           "size=\".1\"/>" +
           Limb("leg", "<joint name=\"hip\"/>") +
           "</body><body name=\"crate\" pos=\"1 1 1\"><freejoint/><geom "
           "type=\"box\" size=\".1 .1 .1\"/></body></worldbody>"));
  ASSERT_TRUE(world) << messages;
  EXPECT_THAT(world->scenario, AllOf(HasSubstr("size 14 16"), HasSubstr("gravity 3\n"),
                                     HasSubstr("step 0.005"), HasSubstr("[wall]\ntype box"),
                                     HasSubstr("[crate]\ntype box"), HasSubstr("[ROBOT_1]\ntype rig.a")));
  EXPECT_THAT(messages, Not(HasSubstr("ground plane")));
}

TEST(MjcfFilesTest, BodiesThatNeverMoveAreAModelEach) {
  std::string bodies;
  for (int i = 0; i < 400; ++i) {
    const std::string number = std::to_string(i);
    bodies += "<body name=\"b" + number + "\" pos=\"0 0 1\"><geom type=\"box\" size=\".1 .1 .1\" pos=\"" +
              number + " 0 0\"/></body>";
  }
  const auto [world, messages] =
      ReadMjcfWorld(Mjcf("<worldbody><body name=\"map\"><body name=\"side\" pos=\"0 2 0\">" + bodies +
                         "</body></body></worldbody>"));
  ASSERT_TRUE(world) << messages;
  EXPECT_THAT(world->scenario, HasSubstr("[b399]\ntype box"));
}

TEST(MjcfFilesTest, ActuatorsMayStandInAnyOrder) {
  const auto answer =
      ReadMjcfText(Limb("leg", "<joint name=\"hip\"/>") + Limb("arm", "<joint name=\"elbow\"/>"),
                   "<actuator><general joint=\"hip\" dyntype=\"filter\" forcerange=\"-3 3\"/>"
                   "<motor joint=\"elbow\" ctrlrange=\"-2 2\"/></actuator>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_EQ(JointOf(answer, "hip")->max_effort, 3);
  EXPECT_EQ(JointOf(answer, "elbow")->max_effort, 2);
}

TEST(MjcfFilesTest, OfTooManyNumbersTheFirstCount) {
  const auto [robot, messages] = ReadMjcfText(
      "<site name=\"a\"/><site name=\"b\" pos=\"0 0 1\"/>",
      "<tendon><spatial springlength=\"0 1 2\"><site site=\"a\"/><site site=\"b\"/></spatial></tendon>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("'springlength' of <spatial> has more numbers than libmujoco"));
}

TEST(MjcfFilesTest, AnEqualityThatCannotBeReadIsLeftOut) {
  const auto [robot, messages] = ReadMjcfText("<site name=\"a\"/><site name=\"b\" pos=\"0 0 1\"/>",
                                              "<equality><connect site1=\"a\" site2=\"b\"/></equality>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("a <connect> is left out, as libmujoco says: "));
}

/// The scenery of a world of these: a floor, a shelf with its own mask, and `bodies`.
std::string Shelf(const std::string& bodies, const std::string& rest = {}) {
  return Mjcf(
      "<worldbody><geom type=\"plane\" size=\"5 5 1\"/><geom name=\"shelf\" type=\"box\" "
      "size=\".5 .5 .1\" pos=\"0 0 .5\" contype=\"2\" conaffinity=\"2\"/>" +
      bodies + "</worldbody>" + rest);
}

TEST(MjcfFilesTest, WhatTouchesNothingByItsMaskIsOnlyDrawn) {
  const std::string ball = "<body name=\"ball\" pos=\"0 0 1\"><freejoint/><geom size=\".1\"";
  EXPECT_THAT(ReadMjcfWorld(Shelf(ball + "/></body>")).messages, HasSubstr("what only decorates the world"));
  EXPECT_THAT(ReadMjcfWorld(Shelf(ball + " contype=\"3\"/></body>")).messages,
              Not(HasSubstr("what only decorates the world")));
}

TEST(MjcfFilesTest, MasksThatLetSomeThroughAreSaid) {
  const std::string two =
      "<body name=\"a\" pos=\"0 0 1\"><freejoint/><geom size=\".1\"/></body>"
      "<body name=\"b\" pos=\"0 0 2\"><freejoint/><geom size=\".1\" contype=\"2\" "
      "conaffinity=\"2\"/></body>";
  EXPECT_THAT(ReadMjcfWorld(Shelf(two)).messages, HasSubstr("let some geoms through each other"));
}

TEST(MjcfFilesTest, FlagsSwitchOff) {
  const auto answer = ReadMjcfText(
      Limb("leg", "<joint name=\"hip\" range=\"-1 1\" damping=\"1\" stiffness=\"2\" frictionloss=\"3\"/>"),
      "<option><flag contact=\"disable\" passive=\"disable\" limit=\"disable\" "
      "frictionloss=\"disable\"/></option>");
  const JointModel* hip = JointOf(answer, "hip");
  ASSERT_NE(hip, nullptr) << answer.messages;
  EXPECT_FALSE(hip->has_stop());
  EXPECT_FALSE(hip->is_resisted());
  for (const LinkModel& link : answer.robot->links) EXPECT_TRUE(link.collisions.empty()) << link.name;
}

TEST(MjcfFilesTest, AFloorElsewhereIsAtZeroWithAllAboveIt) {
  const auto answer = ReadMjcfWorld(
      Mjcf("<worldbody><geom type=\"plane\" size=\"5 5 1\" pos=\"0 0 -.5\"/><body name=\"ball\" "
           "pos=\"0 0 1\"><freejoint/><geom size=\".1\"/></body></worldbody>"));
  ASSERT_TRUE(answer.world) << answer.messages;
  EXPECT_THAT(answer.messages, HasSubstr("the floor is at z = -0.5 m: here it is at 0"));
  EXPECT_THAT(answer.messages, Not(HasSubstr("no ground plane")));
  EXPECT_THAT(answer.world->scenario, HasSubstr("position 0 0 1."));
}

TEST(MjcfFilesTest, AFluidIsSaid) {
  const auto [robot, messages] = ReadMjcfText("", "<option density=\"1000\"/>");
  EXPECT_THAT(messages, HasSubstr("density and viscosity of <option> are not used"));
}

TEST(MjcfFilesTest, OneRobotAndAFloorIsThatRobotAndTwoAreNamed) {
  const std::string floor = "<worldbody><geom type=\"plane\" size=\"5 5 1\"/></worldbody>";
  const std::string robot = "<worldbody><body name=\"a\"><freejoint/><geom size=\".1\"/></body></worldbody>";
  EXPECT_NE(ReadAs("rig.xml", Mjcf(floor + robot)).robot, nullptr);
  const std::string other = "<worldbody><body name=\"b\"><freejoint/><geom size=\".1\"/></body></worldbody>";
  EXPECT_THAT(MessagesOf(Mjcf(floor + robot + other)),
              HasSubstr("it holds several robots, a and b: name one of them, type rig.xml#a"));
  EXPECT_THAT(MessagesOf(Mjcf(floor)), HasSubstr("nothing in it moves, so it is no robot"));
}

TEST(MjcfFilesTest, SensorsOnSitesAreModules) {
  const auto [robot, messages] = ReadMjcfText(
      "<site name=\"head\" pos=\"0 0 .3\"/><site name=\"toe\"/><camera name=\"eye\" pos=\".1 0 0\"/>",
      "<sensor><gyro site=\"head\"/><accelerometer site=\"head\"/><rangefinder name=\"beam\" "
      "site=\"toe\"/><touch "
      "name=\"skin\" site=\"toe\"/><subtreecom body=\"base\"/></sensor>");
  ASSERT_NE(robot, nullptr) << messages;
  std::string modules;
  for (const ModuleModel& module : robot->modules()) modules += module.name + "=" + module.type + " ";
  EXPECT_THAT(modules, AllOf(HasSubstr("head=imu "), HasSubstr("beam=lidar "), HasSubstr("skin=contact "),
                             HasSubstr("eye=camera ")));
  EXPECT_THAT(messages, HasSubstr("sensors that have no equal here are left out: subtreecom"));
}

TEST(MjcfFilesTest, AnActuatorOnASiteIsAThruster) {
  const auto [robot, messages] = ReadMjcfText(
      "<site name=\"jet\" pos=\".1 0 0\"/>",
      "<actuator><motor name=\"push\" site=\"jet\" gear=\"0 0 2 0 0 0\" ctrlrange=\"0 3\"/></actuator>");
  ASSERT_NE(robot, nullptr) << messages;
  std::string modules;
  for (const ModuleModel& module : robot->modules()) modules += module.name + " ";
  EXPECT_THAT(modules, HasSubstr("thrusters"));
}

TEST(MjcfFilesTest, WhatANewerVersionHasIsLeftOutAndSaid) {
  const auto answer = ReadMjcfText(
      "<frame pos=\"0 0 .1\"><geom size=\".05\" mass=\".5\"/></frame>" +
          Limb("leg", "<joint name=\"hip\" axis=\"0 1 0\" actuatorfrcrange=\"-7 7\" fancy=\"1\"/>"),
      "<option integrator=\"implicitfast\"/><actuator><motor joint=\"hip\" ctrlrange=\"-20 "
      "20\"/></actuator>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_THAT(answer.messages, AllOf(HasSubstr("'fancy' of <joint> is not known to libmujoco"),
                                     HasSubstr("'implicitfast' of 'integrator' of <option> is not known"),
                                     Not(HasSubstr("<frame>"))));
  // A frame keeps its shapes, and the greatest torque.
  EXPECT_NEAR(answer.robot->links[0].mass_kg, 2.5, 1e-9);
  EXPECT_NEAR(JointOf(answer, "hip")->max_effort, 7, 1e-9);
}

TEST(MjcfFilesTest, KeyframesOfSeveralLinesCount) {
  const auto answer =
      ReadMjcfText(Limb("leg", "<joint name=\"hip\" axis=\"0 1 0\"/>"),
                   "<keyframe><key name=\"home\" qpos=\"\n 0 0 1\n  1 0 0 0\n .5\"/></keyframe>");
  const JointModel* hip = JointOf(answer, "hip");
  ASSERT_NE(hip, nullptr) << answer.messages;
  EXPECT_NEAR(hip->start, 0.5, 1e-12);
}

TEST(MjcfFilesTest, AMeshThatIsNowhereIsSaidAndABoxStandsForIt) {
  const auto [robot, messages] = ReadAs(
      "rig.xml",
      Mjcf("<asset><mesh file=\"absent.stl\"/></asset><worldbody><body name=\"base\"><freejoint/><inertial "
           "pos=\"0 0 0\" "
           "mass=\"2\" diaginertia=\".1 .1 .1\"/><geom type=\"mesh\" mesh=\"absent\"/></body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("there is no 'absent.stl'"));
  EXPECT_EQ(robot->links[0].collisions.size(), 1u);
  EXPECT_NEAR(robot->links[0].mass_kg, 2, 1e-12);
}

TEST(MjcfFilesTest, AMeshThatLibmujocoDoesNotReadIsReadByUs) {
  // STL as text.
  const TempFolder folder;
  std::string text = "solid flat\n";
  for (const char* corner : {"1 1 0", "0 1 0"}) {
    text += "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex " + std::string(corner) +
            "\nendloop\nendfacet\n";
  }
  folder.Write("m/flat.stl", text + "endsolid flat\n");
  folder.Write(
      "rig.xml",
      Mjcf("<compiler meshdir=\"m\"/><asset><mesh file=\"flat.stl\"/></asset><worldbody><body "
           "name=\"base\"><freejoint/><inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\".1 .1 .1\"/><geom "
           "type=\"mesh\" mesh=\"flat\" contype=\"0\" conaffinity=\"0\"/><geom "
           "size=\".1\"/></body></worldbody>"));
  const auto [robot, messages] = ReadFile(folder, "rig.xml");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("mesh 'flat' is read by coopdyn itself"));
  EXPECT_EQ(robot->links[0].visuals.size(), 2u);
}

TEST(MjcfFilesTest, IncludesAreReadAndLoopsRefused) {
  const TempFolder folder;
  folder.Write("part.xml", "<mujocoinclude><geom size=\".1\"/></mujocoinclude>");
  folder.Write("rig.xml",
               Mjcf("<worldbody><body><freejoint/><include file=\"part.xml\"/></body></worldbody>"));
  EXPECT_NE(ReadFile(folder, "rig.xml").robot, nullptr);
  folder.Write("rig.xml", "<mujoco>\n<include file=\"rig.xml\"/></mujoco>");
  EXPECT_THAT(ReadFile(folder, "rig.xml").messages, HasSubstr("already included; Element 'include', line 2"));
}

TEST(MjcfFilesTest, DamagedFilesAreErrorsWithTheirLines) {
  EXPECT_THAT(MessagesOf("<mujoco>\n<worldbody><body></worldbody></mujoco>"),
              HasSubstr("error: libmujoco: XML"));
  EXPECT_THAT(MessagesOf(Mjcf("<worldbody>\n<body><freejoint/><geom size=\"-1\"/></body></worldbody>")),
              HasSubstr("line = 3"));
  EXPECT_THAT(MessagesOf(Mjcf("<worldbody><body><freejoint/></body></worldbody>")),
              HasSubstr("error: libmujoco"));
  std::string deep = "<mujoco><worldbody>";
  for (int i = 0; i < 20'000; ++i) deep += "<body>";
  EXPECT_THAT(MessagesOf(deep), HasSubstr("error: libmujoco"));
  EXPECT_THAT(MessagesOf(Mjcf("<worldbody><body><freejoint/><geom size=\"1e300\"/></body></worldbody>")),
              HasSubstr("error: "));
}

TEST(MjcfFilesTest, WhatCameOverASocketIsRefusedByTheReaderItself) {
  const TempFolder folder;
  folder.Write("robots/a/rig.xml",
               Mjcf("<worldbody><body><freejoint/><geom size=\".1\"/></body></worldbody>"));
  EXPECT_NE(ReadFile(folder, "robots/a/rig.xml").robot, nullptr);
  SearchPath path;
  path.uploads = folder.path() / "robots/../robots";
  EXPECT_THAT(ReadFile(folder, "robots/a/rig.xml", path).messages,
              HasSubstr("error: MuJoCo's files that are sent are not read here"));
  Diagnostics diagnostics;
  EXPECT_FALSE(ReadSdfWorld(folder.path() / "robots/a/rig.xml", path, diagnostics));
  EXPECT_THAT(diagnostics.ToString(), HasSubstr("error: MuJoCo's files that are sent are not read here"));
}

TEST(MjcfFilesTest, MeshesWhoseNamesDifferInOddSignsStayTwo) {
  const auto mesh = [](const std::string& name, const std::string& size) {
    return "<mesh name=\"" + name + "\" vertex=\"0 0 0 " + size + " 0 0 0 " + size + " 0 0 0 " + size +
           "\"/>";
  };
  const auto [robot, messages] =
      ReadAs("rig.xml", Mjcf("<asset>" + mesh("a b", ".1") + mesh("a_b", ".3") +
                             "</asset><worldbody><body><freejoint/><geom type=\"mesh\" mesh=\"a b\"/><geom "
                             "type=\"mesh\" mesh=\"a_b\"/></body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].visuals.size(), 2u);
  const auto size = [&](std::size_t i) {
    return std::get<Mesh>(robot->links[0].visuals[i].shape).data->radius_m;
  };
  EXPECT_GT(size(1), 2 * size(0));
}

TEST(MjcfFilesTest, WhatAKilledProcessLeftIsRemovedAndWhatALivingOneHoldsStays) {
  const auto made = [](const std::string& name, const std::string& inside) {
    std::string made_name = (std::filesystem::temp_directory_path() / ("coopdyn-mjcf-" + name)).string();
    const std::filesystem::path folder =
        name.empty() ? ::mkdtemp((made_name += "XXXXXX").data()) : made_name.c_str();
    std::filesystem::create_directory(folder);
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
    std::ofstream(folder / inside) << "a";
    std::filesystem::last_write_time(folder,
                                     std::filesystem::last_write_time(folder) - std::chrono::hours(1));
    return folder;
  };
  constexpr const char* kMark = ".coopdyn-meshes";
  const auto left = made("", kMark), held = made("", kMark);
  // A file of that name by another user.
  const auto other = made("", "thesis.tex"),
             named = made("of" + std::to_string(::getpid()) + "others", kMark);
  const int lock = ::open(held.c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
  { const MeshFolder meshes; }
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(held));
  for (const auto& folder : {other, named}) {
    EXPECT_TRUE(std::filesystem::exists(folder));
    std::filesystem::remove_all(folder);
  }
  ::close(lock);
  { const MeshFolder meshes; }
  EXPECT_FALSE(std::filesystem::exists(held));
}

TEST(MjcfFilesTest, NothingStaysInTheTemporaryFolder) {
  std::filesystem::path path;
  {
    const MeshFolder meshes;
    path = meshes.path();
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(path.empty());
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace coopdyn
