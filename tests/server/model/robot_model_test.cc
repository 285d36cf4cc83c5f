// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "tests/server/model/read_text.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kDegree = std::numbers::pi / 180;
const std::filesystem::path kCoopbot = std::filesystem::path(SourceDir()) / "robots/coopbot/model.sdf";

std::string CoopbotText() {
  std::ifstream stream(kCoopbot);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The reader's messages for the shipped robot with `from` replaced by `to`; empty if the model is valid.
std::string ReadChanged(const std::string& from, const std::string& to) {
  std::string text = CoopbotText();
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  const TempFolder folder;
  Diagnostics diagnostics;
  const auto model = ReadRobotModel(folder.Write("robot/model.sdf", text), SearchPath{}, diagnostics);
  EXPECT_EQ(model == nullptr, diagnostics.has_errors());
  return folder.Strip(diagnostics.ToString());
}

/// The line of the shipped model that first contains `text`.
std::string LineOf(const std::string& text) {
  const std::string all = CoopbotText();
  const auto at = all.find(text);
  return std::to_string(1 + std::count(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

std::shared_ptr<const RobotModel> Coopbot() {
  Diagnostics diagnostics;
  auto model = ReadRobotModel(kCoopbot, SearchPath{}, diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return model;
}

TEST(CoopbotTest, LoadsWithoutDiagnostics) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->type, "coopbot");
  ASSERT_EQ(robot->links.size(), 3u);
  EXPECT_EQ(robot->links[0].name, "chassis");
  EXPECT_EQ(robot->joints.size(), 2u);
}

TEST(CoopbotTest, WheelsTouchTheFloorUnderTheAxle) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_DOUBLE_EQ(robot->drive()->wheel_radius_m, 0.075);
  EXPECT_DOUBLE_EQ(robot->drive()->track_m, 0.28);
  for (const auto& [joint, y] : {std::pair(robot->drive_actuator()->joints[0], 0.14),
                                 std::pair(robot->drive_actuator()->joints[1], -0.14)}) {
    const JointModel& wheel = robot->joints[static_cast<std::size_t>(joint)];
    EXPECT_LT((wheel.p_RJ - Vector3(0, y, 0.075)).norm(), 1e-12);
    EXPECT_LT((wheel.axis_R - Vector3(0, 1, 0)).norm(), 1e-12);
    EXPECT_EQ(wheel.parent, 0);
  }
}

TEST(CoopbotTest, WheelCylindersLieAlongTheAxle) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  const LinkModel& wheel = robot->links[1];
  const Pose X_RG = wheel.X_RL * wheel.collisions.at(0).X_LG;
  EXPECT_NEAR((X_RG.q * Vector3::UnitZ()).y(), 1, 1e-12);
}

TEST(CoopbotTest, ElevenSectorsAdjoinFromRightToLeft) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  const std::vector<SectorModel> sectors = robot->sectors();
  ASSERT_EQ(sectors.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    const SectorModel& sensor = sectors[i];
    EXPECT_NEAR(sensor.bearing_rad, (-100 + 20.0 * static_cast<double>(i)) * kDegree, 1e-12);
    EXPECT_NEAR(sensor.opening_rad, 20 * kDegree, 1e-12);
    EXPECT_EQ(sensor.rays, 5);
    EXPECT_EQ(sensor.max_range_m, 4);
  }
}

TEST(CoopbotTest, RangesStartOnTheChassisSurface) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  const LinkShape& body = robot->links[0].collisions.at(0);
  const auto& cylinder = std::get<Cylinder>(body.shape);
  for (const SectorModel& sensor : robot->sectors()) {
    EXPECT_NEAR(sensor.X_RS.p.head<2>().norm(), cylinder.radius_m, 1e-12);
    EXPECT_LT(std::abs(sensor.X_RS.p.z() - body.X_LG.p.z()), cylinder.length_m / 2);
    EXPECT_NEAR(Heading(sensor.X_RS.q), sensor.bearing_rad, 1e-12);
    EXPECT_NEAR(std::atan2(sensor.X_RS.p.y(), sensor.X_RS.p.x()), sensor.bearing_rad, 1e-12);
  }
}

TEST(CoopbotTest, FootprintIsItsChassis) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  EXPECT_NEAR(robot->footprint_radius_m, 0.18, 1e-12);
  EXPECT_NEAR(robot->height_m, 0.26, 1e-12);
}

// With the weight on wheels and casters alike, the wheels carry half of it.
TEST(CoopbotTest, StartsWithoutSlippingOrTipping) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  double mass = 0, moment = 0;
  for (const LinkModel& link : robot->links) {
    mass += link.mass_kg;
    moment += link.mass_kg * (link.X_RL * link.X_LI.p).z();
  }
  const double height = moment / mass;
  const double force = 2 * robot->drive()->max_torque_nm / robot->drive()->wheel_radius_m;
  const double acceleration = force / mass;
  EXPECT_LT(0.5 / acceleration, 0.3);                   // time to 0.5 m/s [s]
  EXPECT_LT(force, 0.6 * mass * 9.81 / 2);              // traction at mu 1, with margin
  EXPECT_LT(acceleration * height, 0.3 * 9.81 * 0.14);  // a caster's load changes by less than a third
}

TEST(CoopbotTest, HasFourModulesInTheOrderOfPorts) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  std::string names;
  for (const ModuleModel& module : robot->modules()) names += module.name + " ";
  EXPECT_EQ(names, "motors distance target pose ");
  EXPECT_TRUE(robot->has_actuators());
}

TEST(CoopbotTest, BodyTakesTheRobotsColour) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  int coloured = 0;
  for (const LinkShape& visual : robot->links[0].visuals) coloured += visual.takes_robot_color ? 1 : 0;
  EXPECT_EQ(coloured, 2);
}

TEST(CoopbotTest, CastersHaveNoFriction) {
  const auto robot = Coopbot();
  ASSERT_NE(robot, nullptr);
  int casters = 0;
  for (const LinkShape& collision : robot->links[0].collisions) {
    if (!std::holds_alternative<Sphere>(collision.shape)) continue;
    ++casters;
    EXPECT_EQ(collision.friction, 0);
    EXPECT_NEAR(collision.X_LG.p.z(), std::get<Sphere>(collision.shape).radius_m, 1e-12);
  }
  EXPECT_EQ(casters, 2);
}

TEST(RobotModelTest, UnknownElementIsNamedWithItsLine) {
  EXPECT_EQ(ReadChanged("<mass>9</mass>", "<mass>9</mass><masss>9</masss>"),
            "robot/model.sdf:" + LineOf("<mass>9") +
                ": error: unknown element <masss> in <inertial>; did you mean 'mass'?\n");
}

TEST(RobotModelTest, UnknownAttributeIsNamed) {
  EXPECT_THAT(ReadChanged("<collision name=\"body\">", "<collision name=\"body\" colour=\"red\">"),
              HasSubstr(": error: unknown attribute 'colour' of <collision>"));
}

TEST(RobotModelTest, NonFiniteNumbersAreErrors) {
  for (const char* value : {"nan", "inf", "1e999", "abc", ""}) {
    EXPECT_THAT(ReadChanged("<mass>9</mass>", std::string("<mass>") + value + "</mass>"),
                HasSubstr("robot/model.sdf:" + LineOf("<mass>9") + ": error: <mass>"))
        << value;
  }
  EXPECT_THAT(ReadChanged("<pose>0 0 0.09 0 0 0</pose>", "<pose>0 0 nan 0 0 0</pose>"),
              HasSubstr("finite numbers"));
  EXPECT_THAT(ReadChanged("<velocity>14<", "<velocity>inf<"), HasSubstr("finite numbers"));
}

TEST(RobotModelTest, APoseWithAttributesHasNumbersThatCanBeRead) {
  for (const char* pose :
       {"<pose degrees=\"true\">0 0 0.09 0 0 4.9e-324</pose>", "<pose degrees=\"true\">0 0 0.09</pose>",
        "<pose rotation_format=\"quat_xyzw\">0 0 0.09 0 0 0</pose>"}) {
    const std::string pose_line = LineOf("<pose>0 0 0.09 0 0 0</pose>");
    const std::string said = ReadChanged("<pose>0 0 0.09 0 0 0</pose>", pose);
    EXPECT_THAT(said, StartsWith("robot/model.sdf:" + pose_line + ": error: <pose> cannot be '0 0 0.09"));
  }
}

TEST(RobotModelTest, MassMustBePositive) {
  EXPECT_THAT(ReadChanged("<mass>9</mass>", "<mass>-9</mass>"), HasSubstr("error:"));
  EXPECT_THAT(ReadChanged("<mass>9</mass>", "<mass>0</mass>"), HasSubstr("error:"));
}

TEST(RobotModelTest, InertiaMustBeThatOfABody) {
  EXPECT_THAT(ReadChanged("<izz>0.1152</izz>", "<izz>5</izz>"), HasSubstr("error:"));
  EXPECT_THAT(ReadChanged("<izz>0.1152</izz>", "<izz>-1</izz>"), HasSubstr("error:"));
}

TEST(RobotModelTest, OnlyASolidNeedsNoInertia) {
  const std::string text = CoopbotText();
  const std::size_t begin = text.find("<inertial>"), end = text.find("</inertial>", begin);
  const auto said = [&](const std::string& solid) {
    return ReadChanged(text.substr(begin, end - begin), "<inertial" + solid + "><mass>9</mass>");
  };
  EXPECT_EQ(said(" coopdyn:solid=\"true\""), "");
  EXPECT_THAT(said(" coopdyn:solid=\"false\""), HasSubstr("needs <inertia>"));
}

TEST(RobotModelTest, OtherShapesAreErrors) {
  EXPECT_THAT(
      ReadChanged("<sphere><radius>0.025</radius></sphere>", "<polyline><height>1</height></polyline>"),
      HasSubstr("the shape <polyline> is not supported: use <box>, <cylinder>, <sphere>, <capsule>, "
                "<ellipsoid>, <cone>, <plane>, <mesh> or <heightmap>"));
}

TEST(RobotModelTest, TwoSensorsOfOneNameInALinkAreAnErrorWithItsLine) {
  const std::string sensor = "<sensor name=\"s\" type=\"imu\"/>";
  EXPECT_THAT(ReadChanged("<link name=\"chassis\">", "<link name=\"chassis\">" + sensor + sensor),
              testing::ContainsRegex(":[0-9]+: error: another <sensor> here is called 's'"));
}

TEST(RobotModelTest, WhatIsNotUsedDrawsAWarning) {
  EXPECT_THAT(ReadChanged("<link name=\"chassis\">", "<link name=\"chassis\"><gravity>true</gravity>"),
              HasSubstr(": warning: <gravity> in <link> is not used by coopdyn"));
}

TEST(RobotModelTest, WheelsMustTouchTheFloor) {
  EXPECT_THAT(ReadChanged("0 0.14 0.075 -90", "0 0.14 0.08 -90"),
              HasSubstr("must touch the floor z = 0 at x = 0"));
}

TEST(RobotModelTest, AxisMustPointLeft) {
  EXPECT_THAT(ReadChanged("\"__model__\">0 1 0<", "\"__model__\">0 -1 0<"), HasSubstr("must point left"));
}

TEST(RobotModelTest, DriveNamesItsJoints) {
  EXPECT_THAT(ReadChanged("left_joint=\"left_wheel_joint\"", "left_joint=\"left_wheel_jiont\""),
              HasSubstr("there is no joint 'left_wheel_jiont'; did you mean 'left_wheel_joint'?"));
}

TEST(RobotModelTest, NothingReachesBelowTheFloor) {
  EXPECT_THAT(ReadChanged("<pose>0.14 0 0.025 0 0 0</pose>", "<pose>0.14 0 0.02 0 0 0</pose>"),
              HasSubstr("reaches 5 mm below the floor"));
}

TEST(RobotModelTest, LinksHangOnTheChassis) {
  EXPECT_THAT(ReadChanged("<parent>chassis</parent>", "<parent>right_wheel</parent>"), ::testing::Eq(""));
  EXPECT_THAT(
      ReadChanged("</model>",
                  "<link name=\"loose\"><inertial><mass>1</mass><inertia/></inertial></link></model>"),
      HasSubstr("link 'loose' hangs on no joint"));
}

TEST(RobotModelTest, OurElementsAreChecked) {
  EXPECT_THAT(ReadChanged("<coopdyn:drive", "<coopdyn:drvie"), HasSubstr("did you mean 'coopdyn:drive'?"));
  EXPECT_THAT(ReadChanged("rays=\"5\"", "ray=\"5\""),
              HasSubstr("unknown attribute 'ray'; did you mean 'rays'?"));
  EXPECT_THAT(ReadChanged("max_range=\"4\"", "max_range=\"-4\""),
              HasSubstr("'max_range' must be a number from"));
  EXPECT_THAT(ReadChanged("<coopdyn:module type=\"pose\"/>", "<coopdyn:module type=\"poes\"/>"),
              HasSubstr("unknown module type 'poes'; did you mean 'pose'?"));
  EXPECT_THAT(ReadChanged("<coopdyn:module type=\"pose\"/>", "<coopdyn:module type=\"motors\" name=\"m2\"/>"),
              HasSubstr("two modules of type 'motors'"));
  EXPECT_THAT(ReadChanged("coopdyn:color=\"robot\"", "coopdyn:color=\"red\""),
              HasSubstr("can only be \"robot\""));
}

TEST(RobotModelTest, BrokenXmlHasALine) {
  EXPECT_THAT(ReadChanged("</model>", ""), HasSubstr("not well-formed XML"));
  EXPECT_THAT(ReadChanged("version=\"1.9\" xmlns", "version=\"1.2\" xmlns"),
              HasSubstr("write version=\"1.9\""));
}

// The console belongs to the program: all output of libsdformat becomes diagnostics.
TEST(RobotModelTest, PrintsNothing) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  ReadChanged("<mass>9</mass>", "<mass>abc</mass>");
  ReadChanged("<child>left_wheel</child>", "<child>nobody</child>");
  ReadChanged("type=\"revolute\"", "type=\"revolut\"");
  ReadChanged("<link name=\"left_wheel\">", "<link name=\"chassis\">");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(RobotLibraryTest, ParsesAModelOnce) {
  Diagnostics diagnostics;
  const auto first = ShippedRobots().Get("coopbot", {"x", 1}, diagnostics);
  EXPECT_EQ(ShippedRobots().Get("coopbot", {"x", 1}, diagnostics), first);
  EXPECT_EQ(ShippedRobots().Get("coopbt", {"x", 1}, diagnostics), nullptr);
  EXPECT_THAT(
      diagnostics.ToString(),
      HasSubstr("x:1: error: unknown robot type 'coopbt'; did you mean 'coopbot'? (a robot of your own is a "
                "folder robots/coopbt in a folder that --scenarios or COOPDYN_PATH names)"));
}

TEST(RobotLibraryTest, TypesAreBareNames) {
  Diagnostics diagnostics;
  EXPECT_EQ(ShippedRobots().Get("../robots/coopbot", {"x", 1}, diagnostics), nullptr);
  EXPECT_TRUE(diagnostics.has_errors());
}

const std::string kPoseModule = "<coopdyn:module type=\"pose\"/>";

/// The reader's messages for the shipped robot with more elements before its last module.
std::string WithElements(const std::string& elements) {
  return ReadChanged(kPoseModule, elements + kPoseModule);
}

TEST(NeighboursTest, ElementAndModuleAreRead) {
  std::string text = CoopbotText();
  text.replace(text.find(kPoseModule), kPoseModule.size(),
               "<coopdyn:neighbours range=\"1.5\" message_range=\"0.5\" loss=\"0.25\" delay_steps=\"3\" "
               "distance_noise_stddev=\"0.01\" bearing_noise_stddev_deg=\"2\"/>"
               "<coopdyn:module type=\"neighbours\"/>" +
                   kPoseModule);
  const TempFolder folder;
  Diagnostics diagnostics;
  const auto robot = ReadRobotModel(folder.Write("robot/model.sdf", text), SearchPath{}, diagnostics);
  ASSERT_NE(robot, nullptr) << diagnostics.ToString();
  const auto* neighbours = robot->Find<NeighboursModel>();
  ASSERT_NE(neighbours, nullptr);
  EXPECT_EQ(neighbours->range_m, 1.5);
  EXPECT_EQ(neighbours->message_range_m, 0.5);
  EXPECT_EQ(neighbours->loss, 0.25);
  EXPECT_EQ(neighbours->delay_steps, 3);
  EXPECT_EQ(neighbours->distance_noise_stddev_m, 0.01);
  EXPECT_DOUBLE_EQ(neighbours->bearing_noise_stddev_rad, 2 * kDegree);
  ASSERT_EQ(robot->modules().size(), 5u);
  EXPECT_EQ(robot->modules().back().type, "neighbours");
}

TEST(NeighboursTest, RobotsWithoutHaveNone) {
  EXPECT_EQ(Coopbot()->Find<NeighboursModel>(), nullptr);
}

TEST(NeighboursTest, ElementAndModuleNeedEachOther) {
  EXPECT_THAT(WithElements("<coopdyn:neighbours range=\"1\"/>"), HasSubstr("needs its module: write"));
  EXPECT_THAT(WithElements("<coopdyn:module type=\"neighbours\"/>"),
              HasSubstr("needs <coopdyn:neighbours range=\"1\"/>"));
}

TEST(NeighboursTest, BadValuesAreErrors) {
  const std::string module = "<coopdyn:module type=\"neighbours\"/>";
  for (const char* attributes :
       {"", "range=\"0\"", "range=\"-1\"", "range=\"nan\"", "range=\"1\" loss=\"1.1\"",
        "range=\"1\" delay_steps=\"100\"", "range=\"1\" delay_steps=\"0.5\"", "range=\"1\" delay=\"1\""}) {
    EXPECT_THAT(WithElements("<coopdyn:neighbours " + std::string(attributes) + "/>" + module),
                HasSubstr("error: <coopdyn:neighbours>:"))
        << attributes;
  }
}

/// The shipped robot with more elements before its last module.
std::shared_ptr<const RobotModel> CoopbotWith(const std::string& elements) {
  std::string text = CoopbotText();
  text.replace(text.find(kPoseModule), kPoseModule.size(), elements + kPoseModule);
  const TempFolder folder;
  Diagnostics diagnostics;
  auto robot = ReadRobotModel(folder.Write("robot/model.sdf", text), SearchPath{}, diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return robot;
}

TEST(SensorsTest, AModuleWithoutAnElementHasTheUsualSensor) {
  const auto robot = CoopbotWith("<coopdyn:module type=\"compass\" name=\"north\"/>");
  ASSERT_NE(robot, nullptr);
  ASSERT_NE(robot->Find<CompassModel>(), nullptr);
  EXPECT_EQ(robot->Find<CompassModel>()->noise_stddev_rad, 0);
  EXPECT_EQ(robot->modules().back().name, "north");
  EXPECT_EQ(robot->modules().back().type, "compass");
}

TEST(SensorsTest, SeveralOfOneTypeTakeTheElementOfTheirNameOrTheOneWithout) {
  const auto robot = CoopbotWith(
      "<coopdyn:compass name=\"b\" noise_stddev_deg=\"10\"/><coopdyn:compass noise_stddev_deg=\"1\"/>"
      "<coopdyn:module type=\"compass\" name=\"a\"/><coopdyn:module type=\"compass\" name=\"b\"/>"
      "<coopdyn:module type=\"compass\" name=\"c\"/>");
  ASSERT_NE(robot, nullptr);
  std::string names;
  for (const ModuleModel& module : robot->modules()) names += module.name + " ";
  EXPECT_EQ(names, "motors distance target pose a b c ");
  EXPECT_DOUBLE_EQ(robot->Find<CompassModel>(0)->noise_stddev_rad, 1 * kDegree);
  EXPECT_DOUBLE_EQ(robot->Find<CompassModel>(1)->noise_stddev_rad, 10 * kDegree);
  EXPECT_DOUBLE_EQ(robot->Find<CompassModel>(2)->noise_stddev_rad, 1 * kDegree);
  EXPECT_EQ(robot->Find<CompassModel>(3), nullptr);
  EXPECT_EQ(robot->NumberOf(robot->sensors.size() - 1), 2u);
}

TEST(SensorsTest, TwoDistanceModulesHaveSectorsOfTheirOwn) {
  const auto robot = CoopbotWith(
      "<coopdyn:distance_sensors name=\"rear\" radius=\"0.18\" height=\"0.1\" max_range=\"1\">"
      "<coopdyn:sector bearing_deg=\"180\"/></coopdyn:distance_sensors>"
      "<coopdyn:module type=\"distance\" name=\"rear\"/>");
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->modules()[2].name, "rear") << "after the other of its type";
  EXPECT_EQ(robot->Find<DistanceModel>(0)->sectors.size(), 11u);
  ASSERT_EQ(robot->Find<DistanceModel>(1)->sectors.size(), 1u);
  EXPECT_EQ(robot->sector_count(), 12u);
  EXPECT_EQ(robot->sectors().back().max_range_m, 1);
}

TEST(SupportTest, ElementAndModuleAreRead) {
  const auto robot = CoopbotWith(
      "<coopdyn:support link=\"left_wheel\" height=\"0.3\" noise_stddev=\"0.01\" "
      "angle_noise_stddev_deg=\"2\"/><coopdyn:module type=\"support\"/>");
  const auto* support = robot->Find<SupportModel>();
  ASSERT_NE(support, nullptr);
  EXPECT_EQ(support->link, "left_wheel");
  EXPECT_EQ(support->height_m, 0.3);
  EXPECT_EQ(support->noise_stddev_m, 0.01);
  EXPECT_DOUBLE_EQ(support->angle_noise_stddev_rad, 2 * kDegree);
  EXPECT_EQ(robot->modules().back().type, "support");
}

TEST(SupportTest, ItsLinkAndItsElementAreNeeded) {
  const std::string module = "<coopdyn:module type=\"support\"/>";
  EXPECT_THAT(WithElements("<coopdyn:support link=\"left_weel\" height=\"0.3\"/>" + module),
              HasSubstr("there is no link 'left_weel'; did you mean 'left_wheel'?"));
  EXPECT_THAT(WithElements("<coopdyn:support height=\"0.3\"/>" + module), HasSubstr("'link'"));
  EXPECT_THAT(WithElements("<coopdyn:support link=\"left_wheel\"/>" + module), HasSubstr("'height'"));
  EXPECT_THAT(WithElements(module), HasSubstr("needs <coopdyn:support"));
}

TEST(SensorsTest, MistakesAreNamed) {
  EXPECT_THAT(WithElements("<coopdyn:compass/>"), HasSubstr("write <coopdyn:module type=\"compass\"/>"));
  EXPECT_THAT(WithElements("<coopdyn:module type=\"compass\"/><coopdyn:compass name=\"north\"/>"),
              HasSubstr("write <coopdyn:module type=\"compass\" name=\"north\"/>"));
  EXPECT_THAT(WithElements("<coopdyn:compass/><coopdyn:compass/><coopdyn:module type=\"compass\"/>"),
              HasSubstr("stands here twice"));
  EXPECT_THAT(WithElements("<coopdyn:module type=\"compass\"/><coopdyn:module type=\"compass\"/>"),
              HasSubstr("two modules 'compass'"));
  EXPECT_THAT(WithElements("<coopdyn:compass noise=\"1\"/><coopdyn:module type=\"compass\"/>"),
              HasSubstr("unknown attribute 'noise'"));
  EXPECT_THAT(WithElements("<coopdyn:compass noise_stddev_deg=\"-1\"/><coopdyn:module type=\"compass\"/>"),
              HasSubstr("must be a number from 0 to 180"));
  EXPECT_THAT(WithElements("<coopdyn:compas/>"), HasSubstr("did you mean 'coopdyn:compass'?"));
  std::string many;
  for (int i = 0; i < 101; ++i)
    many += "<coopdyn:module type=\"compass\" name=\"c" + std::to_string(i) + "\"/>";
  EXPECT_THAT(WithElements(many), HasSubstr("at most 100 modules"));
}

}  // namespace
}  // namespace coopdyn
