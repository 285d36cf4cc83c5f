// SPDX-License-Identifier: MIT
// The report of coopdyn check on models made for other programs.
#include "server/app/check_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/json.hpp>
#include <fstream>

#include "protocol/json_text.h"
#include "tests/server/base/temp_folder.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kLink =
    "<inertial><mass value=\"1\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\"/></inertial>"
    "<collision><geometry><box size=\"0.2 0.4 0.1\"/></geometry></collision>";

std::string Link(const std::string& name) {
  return "<link name=\"" + name + "\">" + kLink + "</link>\n";
}

class CheckReportTest : public testing::Test {
 protected:
  CheckReport Report(const std::string& text, const std::string& name = "a.urdf") {
    const std::string file = (folder_.path() / name).string();
    std::ofstream(file, std::ios::binary) << text;
    SearchPath path;
    RobotLibrary robots(path);
    Diagnostics diagnostics;
    const Checked checked = CheckFile(file, robots, diagnostics);
    return MakeReport(file, checked, diagnostics, path, "");
  }
  CheckReport Robot(const std::string& parts) {
    return Report("<robot name=\"r\">\n" + parts + "</robot>\n");
  }

  TempFolder folder_;
};

std::ptrdiff_t LinesOf(const std::string& page) {
  return std::ranges::count(page, '\n');
}

TEST_F(CheckReportTest, AModelOfWhichNothingIsLostRuns) {
  const CheckReport report = Robot(Link("base"));
  EXPECT_EQ(report.verdict, CheckVerdict::kRuns);
  EXPECT_EQ(report.format, "URDF");
  EXPECT_EQ(report.name, "r");
  EXPECT_TRUE(report.left_out.empty());
}

TEST_F(CheckReportTest, WhatIsMendedIsNoLoss) {
  const CheckReport report = Robot(
      "<link name=\"base\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>");
  EXPECT_EQ(report.verdict, CheckVerdict::kRuns);
  ASSERT_EQ(report.mended.size(), 2u);  // no mass, and below the floor
  EXPECT_THAT(report.mended[0].what + report.mended[1].what, HasSubstr("it gets 10 g"));
}

TEST_F(CheckReportTest, LooksAreNoLoss) {
  const CheckReport report = Robot(Link("base") +
                                   "<gazebo reference=\"base\"><maxVel>0.1</maxVel></gazebo><material "
                                   "name=\"m\"><texture filename=\"t.png\"/></material>");
  EXPECT_EQ(report.verdict, CheckVerdict::kRuns);
  EXPECT_FALSE(report.harmless.empty());
}

TEST_F(CheckReportTest, WhatIsLeftOutIsALossWithItsLineAndTheReason) {
  const CheckReport report =
      Robot(Link("base") + "<gazebo><plugin filename=\"libfoo.so\" name=\"f\"/></gazebo>\n");
  EXPECT_EQ(report.verdict, CheckVerdict::kRunsWithLosses);
  ASSERT_EQ(report.left_out.size(), 1u);
  EXPECT_EQ(report.left_out[0].what, "plug-in 'libfoo.so'");
  EXPECT_EQ(report.left_out[0].where.line, 3);
  EXPECT_FALSE(report.left_out[0].why.empty());
}

TEST_F(CheckReportTest, WhatIsAlikeIsToldOnce) {
  std::string parts = Link("base");
  for (const char* name : {"a", "b", "c"}) {
    parts += Link(name) + "<joint name=\"j" + name +
             "\" type=\"revolute\"><parent link=\"base\"/><child link=\"" + name +
             "\"/><limit lower=\"-1\" upper=\"1\" effort=\"0\" velocity=\"1\"/></joint>\n";
  }
  const CheckReport report = Robot(parts);
  ASSERT_EQ(report.left_out.size(), 1u);
  EXPECT_EQ(report.left_out[0].count, 3);
  EXPECT_EQ(report.left_out[0].why, "nothing can drive it here");
}

TEST_F(CheckReportTest, TwoPlugInsAreTwo) {
  const CheckReport report =
      Robot(Link("base") +
            "<gazebo><plugin filename=\"liba.so\" name=\"a\"/><plugin filename=\"libb.so\" "
            "name=\"b\"/><plugin filename=\"liba.so\" name=\"c\"/></gazebo>");
  ASSERT_EQ(report.left_out.size(), 2u);
  EXPECT_EQ(report.left_out[0].count, 2);
  EXPECT_EQ(report.left_out[1].what, "plug-in 'libb.so'");
}

TEST_F(CheckReportTest, WhatCannotBeReadWillNotRun) {
  const CheckReport report = Robot("<link name=\"base\"><inertial><mass value=\"-1\"/></inertial></link>");
  EXPECT_EQ(report.verdict, CheckVerdict::kWillNotRun);
  EXPECT_FALSE(report.errors.empty());
  EXPECT_FALSE(report.drive.has_value());
}

TEST_F(CheckReportTest, AModelWithoutLinksWillNotRun) {
  const CheckReport report = Robot("");
  EXPECT_EQ(report.verdict, CheckVerdict::kWillNotRun);
  EXPECT_THAT(PageOf(report, false), HasSubstr("a.urdf: will not run"));
}

TEST_F(CheckReportTest, MissingFilesAreJoinedByTheirPackageWithACommand) {
  const std::string mesh = "<collision><geometry><mesh filename=\"package://my_hands/";
  const CheckReport report = Robot(
      "<link name=\"base\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>" +
      mesh + "a.stl\"/></geometry></collision>" + mesh + "b.stl\"/></geometry></collision></link>");
  EXPECT_EQ(report.verdict, CheckVerdict::kRunsWithLosses);
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].what, "package my_hands");
  EXPECT_EQ(report.missing[0].count, 2);
  EXPECT_THAT(report.missing[0].bring, HasSubstr("sudo apt install ros-$ROS_DISTRO-my-hands"));
}

TEST_F(CheckReportTest, ManyHarmlessFindingsHideNoLoss) {
  std::string parts = Link("base");
  // Each is a separate finding, unlike elements of one name.
  for (int i = 0; i < 150; ++i) {
    const std::string name = "my_led_" + std::to_string(i);
    parts += "<gazebo><plugin filename=\"" + name + ".so\" name=\"" + name + "\"/></gazebo>\n";
  }
  ASSERT_GT(Robot(parts).harmless.size(), 100u);
  const std::string last = "<gazebo><plugin filename=\"libfoo.so\" name=\"f\"/></gazebo>";
  EXPECT_EQ(Robot(parts).verdict, CheckVerdict::kRuns);
  const CheckReport report = Robot(parts + last);
  ASSERT_EQ(report.left_out.size(), 1u) << PageOf(report, true);
  EXPECT_EQ(report.left_out[0].what, "plug-in 'libfoo.so'");
}

constexpr const char* kTwoModels =
    "<sdf version=\"1.9\"><world name=\"w\"><model name=\"box\"><static>1</static><link name=\"l\"/></model>"
    "<include><uri>\n  model://nowhere_1\n</uri></include>"
    "<include><uri>\n  model://nowhere_2\n</uri></include></world></sdf>";

TEST_F(CheckReportTest, ModelsThatAreNotFoundAreNamedEachEvenWithLineBreaks) {
  const CheckReport report = Report(kTwoModels, "w.sdf");
  ASSERT_EQ(report.missing.size(), 2u);
  EXPECT_EQ(report.missing[1].what, "model nowhere_2");
  ASSERT_EQ(report.left_out.size(), 2u);
  EXPECT_EQ(report.left_out[0].what, "model 'model://nowhere_1' is not found");
}

TEST_F(CheckReportTest, AModelThatIsThereWithoutAFileIsNotToBeFetched) {
  std::filesystem::create_directories(folder_.path() / "hand");
  std::ofstream(folder_.path() / "hand/model.sdf") << "<sdf version=\"1.9\"/>";
  const CheckReport report = Robot(
      "<link name=\"base\"><visual><geometry><mesh filename=\"model://hand/a.stl\"/></geometry></visual>" +
      std::string(kLink) + "</link>");
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_EQ(report.missing[0].what, "files of model://hand");
  EXPECT_EQ(report.missing[0].bring, "it is there without a.stl");
}

TEST_F(CheckReportTest, ThePageCutsNoCommand) {
  const std::string url = "https://fuel.gazebosim.org/1.0/" + std::string(120, 'a') + "/models/b";
  CheckReport report;
  report.left_out.push_back({{"a.sdf", 3},
                             "there is no '" + url +
                                 "' in the cache of Gazebo (looked for in /a, /b): coopdyn "
                                 "fetches nothing; write gz fuel download -u '" +
                                 url + "', or copy it",
                             "",
                             1});
  EXPECT_THAT(PageOf(report, false), Not(HasSubstr("download -u")));
  EXPECT_THAT(PageOf(report, false), HasSubstr("coopdyn fetches nothing …\n"));
  EXPECT_THAT(PageOf(report, true), HasSubstr("download -u '" + url + "', or copy it\n"));
}

TEST_F(CheckReportTest, ScriptsOfMaterialsAreNotMissed) {
  const CheckReport report = Report(
      "<sdf version=\"1.6\"><model name=\"m\"><link name=\"base\"><visual name=\"v\"><geometry><box><size>1 "
      "1 1</size></box></geometry>"
      "<material><script><uri>file://media/m.material</uri><name>Gazebo/Red</name></script></material></"
      "visual></link></model></sdf>",
      "m.sdf");
  EXPECT_FALSE(report.mended.empty());
  EXPECT_TRUE(report.missing.empty());
}

TEST_F(CheckReportTest, NamesOfPackagesAreNoCommands) {
  const CheckReport report = Robot(
      "<link name=\"base\"><visual><geometry><mesh "
      "filename=\"package://a;reboot/m.stl\"/></geometry></visual>" +
      std::string(kLink) + "</link>");
  ASSERT_EQ(report.missing.size(), 1u);
  EXPECT_THAT(report.missing[0].bring, Not(HasSubstr("reboot")));
}

TEST_F(CheckReportTest, AWorldOfOthersTellsWhichRobotsItHasAndDrivesOne) {
  const CheckReport report = Report(
      "<sdf version=\"1.9\"><world name=\"lab\"><wind/><model name=\"ground\"><static>1</static><link "
      "name=\"l\"><collision name=\"c\">"
      "<geometry><plane><size>10 10</size></plane></geometry></collision></link></model>"
      "<model name=\"cart\"><link name=\"base\"><inertial><mass>1</mass></inertial><collision "
      "name=\"c\"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>"
      "</collision></link><link name=\"arm\"><pose>0 0 0.2 0 0 "
      "0</pose><inertial><mass>1</mass></inertial></link>"
      "<joint name=\"j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>0 0 "
      "1</xyz><limit><effort>5</effort><velocity>1</velocity></limit></axis></joint>"
      "</model></world></sdf>",
      "lab.sdf");
  EXPECT_EQ(report.format, "SDF 1.9");
  EXPECT_EQ(report.name, "lab");
  EXPECT_EQ(report.verdict, CheckVerdict::kRunsWithLosses) << PageOf(report, true);
  ASSERT_EQ(report.robots.size(), 1u);
  EXPECT_EQ(report.robots[0].name, "cart");
  EXPECT_THAT(PageOf(report, false), HasSubstr("Joints:\n  joint j: hinge"));
  EXPECT_EQ(JsonOf(report).at("joints").at(0).at("name"), "j");
  ASSERT_TRUE(report.drive.has_value());
  EXPECT_THAT(report.drive->python,
              HasSubstr("r = sim.robot('cart'); j = r.joints('joints')\nj.set_positions("));
}

TEST_F(CheckReportTest, EachRobotOfAWorldHasItsJointsModulesAndLines) {
  const auto cart = [](const std::string& name, const std::string& y, const std::string& sensor) {
    const std::string body =
        "<inertial><mass>1</mass></inertial><collision name=\"c\"><geometry><box><size>0.2 "
        "0.2 0.2</size></box></geometry></collision>";
    return "<model name=\"" + name + "\"><pose>0 " + y + " 0.1 0 0 0</pose><link name=\"base\">" + body +
           sensor + "</link><link name=\"arm\"><pose>0 0 0.3 0 0 0</pose>" + body + "</link><joint name=\"" +
           name +
           "_j\" type=\"revolute\"><parent>base</parent><child>arm</child><axis><xyz>0 0 "
           "1</xyz><limit><effort>5</effort><velocity>1</velocity></limit></axis></joint></model>";
  };
  const CheckReport report = Report(
      "<sdf version=\"1.9\"><world name=\"lab\"><include><uri>model://ground_plane</uri></include>" +
          cart("ann", "0", "") + cart("ben", "2", "<sensor name=\"eye\" type=\"imu\"/>") + "</world></sdf>",
      "lab.sdf");
  const boost::json::object object = JsonOf(report);
  EXPECT_FALSE(object.contains("joints"));
  const boost::json::array& robots = object.at("robots").as_array();
  ASSERT_EQ(robots.size(), 2u);
  EXPECT_EQ(robots.at(1).at("name"), "ben");
  EXPECT_EQ(robots.at(1).at("joints").at(0).at("name"), "ben_j");
  EXPECT_THAT(JsonText(robots.at(1).at("modules")), HasSubstr("eye"));
  EXPECT_THAT(std::string(robots.at(1).at("drive").at("python").as_string()), HasSubstr("sim.robot('ben')"));
  EXPECT_THAT(PageOf(report, false),
              HasSubstr("ben: 1 of 1 joint has a motor; modules joints, pose and eye\n"));
}

TEST_F(CheckReportTest, ADamagedFileIsStillCalledWhatItIs) {
  EXPECT_EQ(Report("<mujoco><worldbody></mujoco>", "a.xml").format, "MJCF");
  EXPECT_EQ(Report("<robot><link></robot>", "b.sdf").format, "URDF");
  EXPECT_EQ(Report("<sdf><model></sdf>", "c.sdf").format, "SDF");
}

TEST_F(CheckReportTest, WhatStartsDeepInsideSomethingFixedIsALoss) {
  const auto ball = [](const std::string& pose) {
    return "<model name=\"ball\"><pose>" + pose +
           " 0 0 0</pose><link name=\"l\"><inertial><mass>1</mass><inertia>"
           "<ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial><collision "
           "name=\"c\"><geometry><sphere><radius>"
           "0.1</radius></sphere></geometry></collision></link></model>";
  };
  const std::string start =
      "<sdf version=\"1.9\"><world name=\"w\"><include><uri>model://ground_plane</uri></include><model "
      "name=\"block\"><static>1</static><pose>0 0 1 0 0 0</pose><link name=\"l\"><collision "
      "name=\"c\"><geometry>"
      "<box><size>2 2 2</size></box></geometry></collision></link></model>";
  EXPECT_EQ(Report(start + ball("0 1.05 1") + "</world></sdf>", "w.sdf").verdict, CheckVerdict::kRuns);
  const CheckReport report = Report(start + ball("0 0 1") + "</world></sdf>", "w.sdf");
  EXPECT_EQ(report.verdict, CheckVerdict::kRunsWithLosses);
  ASSERT_EQ(report.left_out.size(), 1u);
  EXPECT_THAT(report.left_out[0].what, HasSubstr("ball starts 1.1 m inside block"));
}

TEST_F(CheckReportTest, AScenarioHasNoPage) {
  const CheckReport report = Report("[FLOOR]\nsize 4 4\n", "a.scenario");
  EXPECT_FALSE(report.has_page);
  EXPECT_EQ(report.verdict, CheckVerdict::kRuns);
  EXPECT_EQ(report.format, "scenario");
}

TEST_F(CheckReportTest, ThePageOfALargeModelStaysAPage) {
  std::string parts = Link("base");
  std::string parent = "base";
  for (int i = 0; i < 250; ++i) {
    const std::string name = "link" + std::to_string(i);
    parts += Link(name) + "<joint name=\"joint" + std::to_string(i) +
             "\" type=\"continuous\"><parent link=\"base\"/><child link=\"" + name +
             "\"/><axis xyz=\"0 0 1\"/><limit effort=\"1\" velocity=\"1\"/></joint>\n<gazebo reference=\"" +
             name + "\"><odd" + std::to_string(i) + ">1</odd" + std::to_string(i) + "></gazebo>\n";
  }
  const CheckReport report = Robot(parts);
  ASSERT_NE(report.verdict, CheckVerdict::kWillNotRun) << PageOf(report, true);
  EXPECT_LE(LinesOf(PageOf(report, false)), 50);
  EXPECT_GT(LinesOf(PageOf(report, true)), 250);
}

TEST_F(CheckReportTest, NamesCannotSteerATerminalOrFillAPage) {
  const std::string nasty = "a&#x202e;b&#xa;c" + std::string(20000, 'x');
  std::string parts = "<link name=\"base\">" + std::string(kLink) + "</link>" + "<link name=\"" + nasty +
                      "\">" + kLink + "</link><joint name=\"" + nasty +
                      "j\" type=\"continuous\"><parent link=\"base\"/><child link=\"" + nasty +
                      "\"/><axis xyz=\"0 0 1\"/><limit effort=\"1\" velocity=\"1\"/></joint>";
  const CheckReport report = Robot(parts);
  const std::string page = PageOf(report, false);
  EXPECT_LE(LinesOf(page), 50);
  EXPECT_LT(page.size(), 8000u);
  EXPECT_THAT(page, Not(HasSubstr("\u202e")));
}

TEST_F(CheckReportTest, JsonHasTheFieldsThatAreDocumented) {
  const CheckReport report = Robot(Link("base") + Link("tip") +
                                   "<joint name=\"j\" type=\"revolute\"><origin xyz=\"0 0 0.1\"/><parent "
                                   "link=\"base\"/><child link=\"tip\"/>"
                                   "<limit lower=\"-1\" upper=\"1\" effort=\"2\" velocity=\"1\"/></joint>"
                                   "<gazebo><plugin filename=\"libfoo.so\" name=\"f\"/></gazebo>");
  const boost::json::value read = boost::json::parse(JsonText(JsonOf(report)));
  const boost::json::object& object = read.as_object();
  EXPECT_EQ(object.at("format"), "URDF");
  EXPECT_EQ(object.at("verdict"), "runs with losses");
  EXPECT_EQ(object.at("links"), 2);
  EXPECT_EQ(object.at("mass_kg").to_number<double>(), 2);
  EXPECT_NEAR(object.at("size_m").at(1).to_number<double>(), 0.4, 1e-9);
  EXPECT_EQ(object.at("joints").at(0).at("name"), "j");
  EXPECT_EQ(object.at("joints").at(0).at("motor"), true);
  EXPECT_EQ(object.at("modules").at(1).at("type"), "pose");
  EXPECT_EQ(object.at("left_out").at(0).at("what"), "plug-in 'libfoo.so'");
  EXPECT_THAT(std::string(object.at("drive").at("python").as_string()), HasSubstr("import coopdyn"));
  for (const char* name : {"file", "name", "mended", "harmless", "errors", "missing"})
    EXPECT_TRUE(object.contains(name)) << name;
}

}  // namespace
}  // namespace coopdyn
