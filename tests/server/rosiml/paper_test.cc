// SPDX-License-Identifier: MIT
// RoSiML as described in the YARS paper.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

/// A movable with an object and further content of its body.
std::string Movable(const std::string& attributes, const std::string& more = "",
                    const std::string& before = "") {
  return "<movable name=\"m\" " + attributes + ">" + before +
         "<body><object name=\"a\" mass=\"2\"><pose z=\"0.5\"/><sphere radius=\"0.5\"/></object>" + more +
         "</body></movable>";
}

std::string Connector(const std::string& type, const std::string& inside = "") {
  return "<object name=\"b\" mass=\"1\"><pose z=\"2\"/><sphere radius=\"0.2\"/></object>"
         "<connector name=\"j\" type=\"" +
         type + "\" source=\"a\" destination=\"b\">" + inside + "</connector>";
}

TEST(PaperTest, ARandomisedPoseIsDrawnAtEachReset) {
  const std::string text =
      Made(Paper("<box name=\"crate\" width=\"1\" depth=\"1\" height=\"1\"><pose z=\"0.5\"/>"
                 "<randomise x=\"-2 2\" y=\"1\" gamma=\"-90 90\" mass=\"1 2\"/></box>"))
          .scenario.text;
  EXPECT_HAS(text,
             "[RANDOM]\ncrate.position uniform -2 2 1 0.5\ncrate.orientation 0 0 uniform -90deg 90deg\n"
             "crate.mass uniform 1 2\n");
}

TEST(PaperTest, TheAmbientLightCanBeRandomised) {
  const std::string text =
      Made(Paper("<ambient value=\"0.5\"><randomise value=\"0 1\"/></ambient>")).scenario.text;
  EXPECT_HAS(text, "ambient_light 0.5\n");
  EXPECT_HAS(text, "SIMULATION.ambient_light uniform 0 1\n");
}

TEST(PaperTest, ALampCanBeRandomised) {
  EXPECT_HAS(Made(Paper("<light x=\"1\" y=\"2\" z=\"3\"><randomise x=\"0 4\"/></light>")).scenario.text,
             "LIGHT_1.position uniform 0 4 2 3\n");
}

TEST(PaperTest, AnObjectOfSeveralShapesMovesAsOne) {
  const Translation made = Made(
      Paper("<object name=\"table\" mass=\"3\"><pose z=\"1\"/><box width=\"1\" depth=\"1\" height=\"0.1\"/>"
            "<cylinder radius=\"0.05\" height=\"0.9\"><pose z=\"-0.5\"/></cylinder><randomise x=\"-1 "
            "1\"/></object>"));
  ASSERT_EQ(made.models.size(), 1u);
  EXPECT_HAS(made.models[0].sdf.text, "<mass>3</mass>");
  EXPECT_HAS(made.scenario.text, "ROBOT_1.position uniform -1 1 0 0.05\n");
}

TEST(PaperTest, AnActiveMovableHasSocketsAndAPassiveOneHasNone) {
  const std::string motor = Connector("hinge", "<drive maxForce=\"1\" maxVelocity=\"2\"/>");
  EXPECT_HAS_NOT(Made(Paper("", Movable("type=\"active\"", motor))).scenario.text, "sockets no");
  const Translation passive = Made(Paper("", Movable("type=\"passive\"", motor)));
  EXPECT_HAS(passive.scenario.text, "sockets no");
  EXPECT_HAS_NOT(passive.models.at(0).sdf.text, "<effort>");
}

TEST(PaperTest, AControlledMovableNamesItsController) {
  const std::string text =
      Made(
          Paper("",
                Movable(
                    "type=\"controlled\"", "",
                    "<controller library=\"wander\"><parameter name=\"speed\" value=\"0.2\"/></controller>")))
          .scenario.text;
  EXPECT_HAS(text, "controller wander speed=0.2\n");
}

TEST(PaperTest, AControlledMovableNeedsAController) {
  EXPECT_HAS(Said(Paper("", Movable("type=\"controlled\""))), "needs <controller library=\"NAME\"/>");
}

/// An experiment with a ball called "red ball" and these scores.
std::string Scored(const std::string& scores) {
  const std::string text = Paper(
      "<light name=\"lamp\" x=\"1\" y=\"0\" z=\"1\"/><sphere name=\"red ball\" radius=\"0.1\" mass=\"1\"/>",
      Movable("type=\"active\""));
  return text.substr(0, text.rfind("</rosiml>")) + scores + "</rosiml>";
}

TEST(PaperTest, AScoreSaysWhatARunIsWorth) {
  EXPECT_HAS(
      Made(Scored("<score kind=\"reach\" name=\"is there\" of=\"m, red ball\" target=\"lamp\" within=\"0.5\" "
                  "until=\"&gt;= 2\" limit=\"60\"/><score kind=\"upright\" tilt=\"30\" until=\"all\"/>"))
          .scenario.text,
      "[SCORE_1]\nkind reach\nname is_there\nwithin 0.5\nlimit 60\nuntil >= 2\nof m red_ball\ntarget "
      "LIGHT_1\n"
      "[SCORE_2]\nkind upright\ntilt 30deg\nuntil all\n");
}

TEST(PaperTest, AScoreCanBeOfAnObject) {
  const auto scored = [](const std::string& of) {
    std::string text = Scored("<score kind=\"distance\" of=\"" + of + "\"/>");
    return text.insert(text.find("</body>"),
                       "<object name=\"left foot\" mass=\"1\"><sphere radius=\"1\"/></object>");
  };
  EXPECT_HAS(Made(scored("m/left foot")).scenario.text, "of m/left_foot\n");
  EXPECT_HAS(Said(scored("m/left foo")), "which is no object of 'm'; did you mean 'left foot'?");
}

TEST(PaperTest, WhatAScoreNamesIsThere) {
  EXPECT_HAS(
      Said(Scored("<score kind=\"distance\" of=\"red bal\"/>")),
      "x.xml:1: error: <score> names 'red bal', which is no movable, thing or light; did you mean 'red "
      "ball'?");
  EXPECT_HAS(Said(Scored("<score kind=\"reach\" target=\"lmap\"/>")), "did you mean 'lamp'?");
}

TEST(PaperTest, AScoresUntilIsAComparison) {
  EXPECT_HAS(Said(Scored("<score kind=\"time\" until=\"3\"/>")),
             "x.xml:1: error: 'until' in <score> is 'all' or a comparison such as '>= 3'");
  EXPECT_HAS(Said(Scored("<score kind=\"time\" until=\"&gt;= 3&#10;[ROBOT_2]\"/>")),
             "error: 'until' in <score>");
  EXPECT_HAS(Said(Scored("<score kind=\"tim\"/>")), "did you mean 'time'?");
}

TEST(PaperTest, NeighboursAreSeen) {
  const std::string with =
      "<object name=\"c\" mass=\"1\"><sphere radius=\"1\"/><neighbours name=\"Others\" range=\"3\"/>"
      "</object><connector name=\"k\" type=\"fixed\" source=\"a\" destination=\"c\"/>";
  const std::string sdf = Made(Paper("", Movable("type=\"active\"", with))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "<coopdyn:neighbours name=\"others\" range=\"3\"/>");
  EXPECT_HAS(sdf, "<coopdyn:module type=\"neighbours\" name=\"others\"/>");
}

TEST(PaperTest, AMovingMovableHasMotorsForForcesAndTorquesOnItsBody) {
  const Translation made = Made(Paper(
      "", Movable("type=\"moving\"", "",
                  "<force max=\"5\"><mapping min=\"-1\" max=\"1\"/></force><torque max=\"0.2\"/>"
                  "<controller library=\"pilot\"><parameter name=\"gain\" value=\"2\"/></controller>")));
  const std::string sdf = made.models.at(0).sdf.text;
  EXPECT_HAS(sdf, "<coopdyn:thruster name=\"force_x\" link=\"a\" direction=\"1 0 0\" max_force_n=\"5\"/>");
  EXPECT_HAS(sdf,
             "<coopdyn:thruster name=\"torque_z\" link=\"a\" direction=\"0 0 1\" max_torque_nm=\"0.2\"/>");
  EXPECT_HAS(sdf,
             "<coopdyn:motor name=\"force_y\" joint=\"force_y\" mode=\"effort\" internal=\"-5 5\" "
             "external=\"-1 1\"/>");
  EXPECT_HAS(sdf,
             "<coopdyn:motor name=\"torque_x\" joint=\"torque_x\" mode=\"effort\" internal=\"-0.2 0.2\"/>");
  EXPECT_HAS(made.scenario.text, "controller pilot gain=2\n");
}

TEST(PaperTest, AMovingMovableSaysHowMuchPushesIt) {
  EXPECT_HAS(Said(Paper("", Movable("type=\"moving\""))),
             "error: a movable of type 'moving' needs <force max=\"…\"/> (N) or <torque max=\"…\"/> (N m)");
}

TEST(PaperTest, OnlyAMovingMovableIsPushed) {
  EXPECT_HAS(Said(Paper("", Movable("type=\"active\"", "", "<force max=\"5\"/>"))),
             "error: only a movable of type 'moving' has a <force>");
}

TEST(PaperTest, AValueIsFilteredAfterItsNoise) {
  const auto with = [](const std::string& filter) {
    return Paper(
        "", Movable("type=\"active\"", Connector("hinge",
                                                 "<drive maxForce=\"1\" maxVelocity=\"2\"/><read "
                                                 "what=\"velocity\"><noise kind=\"gauss\" sigma=\"0.1\"/>" +
                                                     filter + "</read>")));
  };
  EXPECT_HAS(Made(with("<filter kind=\"lowPass\" time=\"0.2\"/>")).models.at(0).sdf.text,
             "noise_sigma=\"0.1\" filter=\"low_pass\" filter_time_s=\"0.2\"/>");
  EXPECT_HAS(Said(with("<filter kind=\"lowPass\"/>")),
             "error: the filter lowPass needs its time constant 'time'");
  EXPECT_HAS(Said(with("<filter kind=\"mean\" steps=\"0\"/>")), "error: the filter mean needs 'steps'");
  EXPECT_HAS(Said(with("<filter kind=\"wavelet\"/>")),
             "'kind' in <filter> is one of mean, median and lowPass");
}

TEST(PaperTest, AMotorTellsItsEnergy) {
  const auto read = [](const std::string& drive) {
    return Paper("", Movable("type=\"active\"", Connector("hinge", drive + "<read what=\"energy\"/>")));
  };
  EXPECT_HAS(Made(read("<drive maxForce=\"1\" maxVelocity=\"2\"/>")).models.at(0).sdf.text,
             "<coopdyn:value name=\"j_energy\" joint=\"j\" of=\"energy\"/>");
  EXPECT_HAS(Said(read("")), "warning: only a joint with a motor tells its energy");
}

TEST(PaperTest, CompoundsCarryPosesAndConnectors) {
  const std::string sdf =
      Made(
          Paper("",
                Movable(
                    "type=\"active\"",
                    "<compound name=\"leg\"><pose x=\"1\"/><object name=\"foot\" mass=\"1\"><pose z=\"0.2\"/>"
                    "<sphere radius=\"0.2\"/></object><connector name=\"hip\" type=\"hinge\" source=\"a\" "
                    "destination=\"foot\"/></compound>")))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "<link name=\"foot\">\n<pose>1 0 0.2 0 0 0</pose>");
  EXPECT_HAS(sdf, "<joint name=\"hip\" type=\"revolute\"><parent>a</parent><child>foot</child>");
}

TEST(PaperTest, APositionIsHowTheDestinationTurnsAgainstTheSource) {
  const std::string sdf =
      Made(Paper("",
                 Movable("type=\"active\"", Connector("hinge", "<drive maxForce=\"1\" maxVelocity=\"2\"/>"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "<parent>a</parent><child>b</child>");
  EXPECT_HAS(sdf, ">1 0 0</xyz><limit><effort>1</effort><velocity>2</velocity></limit>");
}

TEST(PaperTest, SpringsAndDampersWorkOnAConnector) {
  const std::string sdf =
      Made(Paper("", Movable("type=\"active\"",
                             Connector("slider",
                                       "<spring stiffness=\"30\" rest=\"0.1\"/><damper value=\"2\"/>"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(
      sdf,
      "<damping>2</damping><spring_reference>0.1</spring_reference><spring_stiffness>30</spring_stiffness>");
}

TEST(PaperTest, AConnectorOfSeveralAxesIsAChain) {
  const auto sdf = [](const std::string& type, const std::string& axes) {
    return Made(Paper("", Movable("type=\"active\"", Connector(type, axes)))).models.at(0).sdf.text;
  };
  EXPECT_HAS(sdf("universal", ""),
             "<coopdyn:axis name=\"rx\"/>\n<coopdyn:axis name=\"ry\"/>\n</coopdyn:six_axis>");
  const std::string wheel =
      sdf("hinge2",
          "<axis name=\"ry\"><drive maxForce=\"3\" maxVelocity=\"9\"/></axis>"
          "<axis name=\"x\"><spring stiffness=\"400\" rest=\"0.1\"/><damper value=\"30\"/>"
          "<limit min=\"-0.1\" max=\"0.1\"/></axis>");
  EXPECT_HAS(wheel,
             "<coopdyn:axis name=\"x\" lower=\"-0.1\" upper=\"0.1\" damping=\"30\" rest=\"0.1\" "
             "stiffness=\"400\"/>\n<coopdyn:axis name=\"rx\"/>\n<coopdyn:axis name=\"ry\" max_effort=\"3\" "
             "max_velocity=\"9\"/>\n");
  EXPECT_HAS(sdf("sixAxis", "<axis name=\"rz\"><limit min=\"-90\" max=\"90\"/></axis><axis name=\"x\"/>"),
             "<coopdyn:axis name=\"rz\" lower=\"-1.5707963267948966\" upper=\"1.5707963267948966\"/>\n"
             "<coopdyn:axis name=\"x\"/>\n");
}

TEST(PaperTest, WhatAConnectorOfSeveralAxesCannotHaveIsAnError) {
  const auto said = [](const std::string& type, const std::string& inside) {
    return Said(Paper("", Movable("type=\"active\"", Connector(type, inside))));
  };
  EXPECT_HAS(said("universal", "<axis name=\"z\"/>"), "type 'universal' has no further axis 'z'");
  EXPECT_HAS(said("hinge2", "<axis name=\"rx\"/><axis name=\"rx\"/>"), "has no further axis 'rx'");
  EXPECT_HAS(said("hinge2", "<spring stiffness=\"1\"/>"),
             "<spring> of a connector of type 'hinge2' stands in");
  EXPECT_HAS(said("hinge2", "<drive maxForce=\"1\" maxVelocity=\"1\"/>"),
             "only a hinge, a slider or an <axis>");
  EXPECT_HAS(said("hinge", "<axis name=\"rx\"/>"), "only a connector of type universal, hinge2 or sixAxis");
}

TEST(PaperTest, AComplexHingeIsAJointWithADriveTrain) {
  const std::string inside =
      "<pwm duty=\"0.5\" noLoadSpeed=\"20\" stallTorque=\"0.1\"/><pwm duty=\"1\" noLoadSpeed=\"50\" "
      "stallTorque=\"0.2\" stallCurrent=\"3\"/><rotor inertia=\"1e-6\" ratio=\"10\" efficiency=\"0.8\"/>"
      "<backlash gap=\"2\"/><coupling stiffness=\"30\" damping=\"0.1\" preload=\"0.2\"/>"
      "<friction value=\"0.1\" static=\"0.3\" threshold=\"0.01\"/><read what=\"current\"/>";
  const std::string xml = Paper("", Movable("type=\"active\"", Connector("complexHinge", inside)));
  EXPECT_EQ(Said(xml), "");
  const std::string sdf = Made(xml).models.at(0).sdf.text;
  EXPECT_HAS(sdf,
             "<coopdyn:drivetrain ratio=\"10\" efficiency=\"0.8\" rotor_inertia_kg_m2=\"1e-06\" "
             "backlash_deg=\"2\" stiffness_nm_rad=\"30\" damping_nms_rad=\"0.1\" preload_nm=\"0.2\" "
             "static_friction_nm=\"0.3\" dynamic_friction_nm=\"0.1\" stiction_speed_rad_s=\"0.01\">");
  EXPECT_HAS(sdf,
             "<coopdyn:pwm duty=\"1\" no_load_speed_rad_s=\"50\" stall_torque_nm=\"0.2\" "
             "stall_current_a=\"3\"/>");
}

TEST(PaperTest, AComplexHingeWithoutATableHasTheMotorOfItsDrive) {
  const std::string sdf =
      Made(Paper("", Movable("type=\"active\"", Connector("complexHinge",
                                                          "<drive maxForce=\"4\" maxVelocity=\"5\"/>"
                                                          "<rotor ratio=\"10\"/>"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "duty=\"1\" no_load_speed_rad_s=\"50\" stall_torque_nm=\"0.4\"");
  EXPECT_HAS(sdf, "<limit><effort>4</effort><velocity>5</velocity></limit>");
}

TEST(PaperTest, AComplexHingeWithoutAMotorIsAPlainHinge) {
  const std::string xml =
      Paper("", Movable("type=\"active\"", Connector("complexHinge", "<friction value=\"0.1\"/>")));
  EXPECT_HAS(Said(xml), "has neither <drive> nor <pwm>: it is a hinge without a motor");
  EXPECT_HAS_NOT(Made(xml).models.at(0).sdf.text, "drivetrain");
}

TEST(PaperTest, OnlyAComplexHingeHasADriveTrain) {
  EXPECT_HAS(Said(Paper("", Movable("type=\"active\"", Connector("hinge", "<backlash gap=\"1\"/>")))),
             "only a connector of type 'complexHinge' has a <backlash>");
}

TEST(PaperTest, SensorsAreChildrenOfAnObject) {
  const std::string sdf =
      Made(
          Paper("",
                "<movable name=\"m\" type=\"active\"><body><object name=\"a\" mass=\"1\"><pose z=\"1\"/>"
                "<sphere radius=\"0.1\"/><proximity name=\"p\" range=\"2\" opening=\"30\" rays=\"7\" "
                "noise=\"0.01\"/>"
                "<compass name=\"north\"/><imu name=\"imu\"/><sharp name=\"ir\" model=\"gp2d12\"/>"
                "<camera name=\"eye\" width=\"64\" height=\"48\" opening=\"70\"/></object></body></movable>"))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "opening_deg=\"30\" opening_up_deg=\"30\" rays=\"7\" noise_stddev=\"0.01\"/>");
  for (const char* module : {"\"compass\" name=\"north\"", "\"imu\" name=\"imu\"", "\"infrared\" name=\"ir\"",
                             "\"camera\" name=\"eye\""})
    EXPECT_HAS(sdf, std::string("<coopdyn:module type=") + module);
}

TEST(PaperTest, APatternSaysHowAProximitySensorLooks) {
  const auto made = [](const std::string& sensor) {
    return Made(Paper("",
                      "<movable name=\"m\" type=\"active\"><body><object name=\"a\" mass=\"1\"><pose "
                      "z=\"1\"/><sphere radius=\"0.1\"/>" +
                          sensor + "</object></body></movable>"))
        .models.at(0)
        .sdf.text;
  };
  const std::string common = "<proximity name=\"p\" range=\"2\" opening=\"30\" ";
  EXPECT_HAS(made(common + "rays=\"3\"/>"),
             "max_range=\"2\" opening_deg=\"30\" opening_up_deg=\"30\" rays=\"3\"/>");
  EXPECT_HAS(made(common + "pattern=\"cross\" openingUp=\"10\"/>"), "opening_up_deg=\"10\" rays=\"5\"/>");
  EXPECT_HAS(made(common + "pattern=\"cone\"/>"), "max_range=\"2\" opening_deg=\"30\"/>");
  EXPECT_HAS(made(common + "pattern=\"fan\"/>"), "<coopdyn:sector pose=\"0 0 0.1 0 0 0\" max_range=\"2\"");
}

TEST(PaperTest, LightSensorsHaveColoursAndThatOfTheAmbientLightIsAModule) {
  const std::string sdf =
      Made(Paper("",
                 "<movable name=\"m\" type=\"active\"><body><object name=\"a\" mass=\"1\"><pose z=\"1\"/>"
                 "<sphere radius=\"0.1\"/><ldr name=\"red\" opening=\"60\" colour=\"FF0000\"/>"
                 "<ambientLight name=\"day\"/><sharp name=\"ir\" model=\"dm2y3a003k0f\"/></object></body>"
                 "</movable>"))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "opening_deg=\"60\" color=\"1.0000 0.0000 0.0000\"/>");
  EXPECT_HAS(sdf, "<coopdyn:light name=\"day\"><coopdyn:eye lamps=\"false\"/></coopdyn:light>");
  EXPECT_HAS(sdf, "<coopdyn:infrared name=\"ir\" preset=\"dm2y3a003k0f\">");
}

}  // namespace
}  // namespace coopdyn::rosiml
