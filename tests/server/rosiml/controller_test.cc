// SPDX-License-Identifier: MIT
// <controller> of the public grammar as a loaded controller.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

/// An experiment whose robot has a motor or none, and this controller.
std::string Controlled(const std::string& controller, bool has_motor = true) {
  std::string robot = Robot(Ball("a") + Ball("b", "<pose x=\"1\" z=\"1\"/>"),
                            has_motor ? Motor("type=\"velocity\" mode=\"active\"", "a", "b") : "");
  robot.insert(robot.find("</robot>"), controller);
  return Public("", robot);
}

/// The translation and its messages if controllers of these names exist.
std::string MadeWith(const std::string& xml, const std::string& names, Diagnostics& diagnostics) {
  const auto has = [&](const std::string& name) {
    return (" " + names + " ").find(" " + name + " ") != std::string::npos;
  };
  const auto made = Translate(xml, "x.xml", "x.", diagnostics, has);
  EXPECT_TRUE(made) << diagnostics.ToString();
  return made ? made->scenario.text : "";
}

TEST(RosimlControllerTest, TheModuleIsALoadedControllerAndItsParametersAreOptions) {
  Diagnostics diagnostics;
  const std::string scenario =
      MadeWith(Controlled("<controller module=\"Wave\"><parameter name=\"phase shift\" value=\"-0.5\"/>"
                          "<parameter name=\"Gain\" value=\"2\"/><parameter name=\"debug\" value=\"true\"/>"
                          "</controller>"),
               "Wave", diagnostics);
  EXPECT_HAS(scenario, "controller Wave phase_shift=-0.5 gain=2 debug=1\n");
  EXPECT_HAS_NOT(diagnostics.ToString(), "controller");
}

TEST(RosimlControllerTest, ALibraryMayBeCalledAsThere) {
  Diagnostics diagnostics;
  EXPECT_HAS(MadeWith(Controlled("<controller module=\"Wave\"/>"), "libYarsControllerWave", diagnostics),
             "controller libYarsControllerWave\n");
}

TEST(RosimlControllerTest, ParametersThatAreNoNumbersAreLeftOut) {
  Diagnostics diagnostics;
  const std::string scenario = MadeWith(
      Controlled(
          "<controller module=\"Wave\"><parameter name=\"file\" value=\"a.csv\"/><parameter name=\"1\" "
          "value=\"1\"/><parameter name=\"a b\" value=\"1\"/><parameter name=\"a_b\" "
          "value=\"2\"/></controller>"),
      "Wave", diagnostics);
  EXPECT_HAS(scenario, "controller Wave a_b=1\n");
  for (const char* name : {"file", "1", "a_b"})
    EXPECT_HAS(diagnostics.ToString(), "the parameter '" + std::string(name) + "' is left out");
}

TEST(RosimlControllerTest, ClientsDriveTheRobotIfThereIsNoneOrItHasNoMotors) {
  Diagnostics none, tcp, passive;
  EXPECT_HAS_NOT(MadeWith(Controlled("<controller module=\"Wave\"/>"), "Other", none), "\ncontroller");
  EXPECT_HAS(none.ToString(), "there is no Wave.so beside the experiment or on the search path");
  EXPECT_HAS_NOT(MadeWith(Controlled("<controller module=\"TCPIP\"/>"), "TCPIP", tcp), "\ncontroller");
  EXPECT_HAS_NOT(tcp.ToString(), "TCPIP");
  EXPECT_HAS_NOT(MadeWith(Controlled("<controller module=\"Wave\"/>", false), "Wave", passive),
                 "\ncontroller");
  EXPECT_HAS(passive.ToString(), "the robot has no motors");
}

TEST(RosimlControllerTest, ThePortOfAClientByTcpIsThatOfTheChannel) {
  const auto model_with = [](const std::string& module) {
    return Made(Controlled("<controller module=\"" + module +
                           "\"><parameter name=\"port\" value=\"9500\"/>"
                           "<parameter name=\"debug\" value=\"false\"/></controller>"))
        .models.front()
        .sdf.text;
  };
  EXPECT_HAS(model_with("TCPIP"), "<coopdyn:channel steps=\"10\" port=\"9500\">");
  EXPECT_HAS_NOT(model_with("Wave"), "port=");
}

TEST(RosimlControllerTest, AWrongPortIsToldAtItsLine) {
  for (const char* port : {"0", "65536", "95.5", "-1", "nine", ""}) {
    EXPECT_HAS(Said(Controlled("<controller module=\"TCPIP\">\n<parameter name=\"port\" value=\"" +
                               std::string(port) + "\"/></controller>")),
               "x.xml:2: error: the port must be a whole number from 1 to 65535, not '" + std::string(port));
  }
}

}  // namespace
}  // namespace coopdyn::rosiml
