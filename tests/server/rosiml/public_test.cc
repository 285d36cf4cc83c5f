// SPDX-License-Identifier: MIT
// The grammar 0.8 of the public YARS.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

TEST(PublicTest, AFrequencyIsAStep) {
  EXPECT_HAS(Made(Public("")).scenario.text, "step 10ms\n");
}

TEST(PublicTest, IterationsAndTheSeedAreDurationAndSeed) {
  const std::string xml =
      "<rosiml version=\"0.8.41\"><simulator frequency=\"200\"><control iterations=\"1000\" "
      "seed=\"100000\"/></simulator>"
      "<robots/></rosiml>";
  const std::string text = Made(xml).scenario.text;
  EXPECT_HAS(text, "duration 5\n");
  EXPECT_HAS(text, "seed 100000\n");
}

TEST(PublicTest, ABoxIsWidthDepthHeight) {
  const std::string xml = Public(
      "<box name=\"wall 1\"><dimension width=\"3\" depth=\"2\" height=\"1\"/><physics><mass "
      "kg=\"0\"/></physics></box>");
  EXPECT_HAS(Made(xml).scenario.text, "[wall_1]\ntype box\nsize 3 2 1\n");
}

TEST(PublicTest, AnglesAreDegreesUnlessTheySayRad) {
  EXPECT_HAS(Made(Public(Ball("b", "<pose z=\"1\" gamma=\"90\"/>"))).scenario.text,
             "orientation 0 0 1.570796326795\n");
  EXPECT_HAS(Made(Public(Ball("b", "<pose z=\"1\" gamma=\"0.5\" type=\"rad\"/>"))).scenario.text,
             "orientation 0 0 0.5\n");
}

TEST(PublicTest, AThingWithoutMassStandsFixed) {
  EXPECT_HAS_NOT(Made(Public(Ball("b", "<pose z=\"1\"/>", "0"))).scenario.text, "mass");
  EXPECT_HAS(Made(Public(Ball("b", "<pose z=\"1\"/>", "2.5"))).scenario.text, "mass 2.5\n");
}

TEST(PublicTest, FrictionWithTheGroundIsTheThingsOwn) {
  // Of two frictions the lesser counts here, in YARS their product; YARS's ground has 1.
  const std::string text = Made(Public(Ball("b"))).scenario.text;
  EXPECT_HAS(text, "[FLOOR]\nsize 20 20\nfriction 1000\n");
  EXPECT_HAS(text, "friction 0\n");
}

TEST(PublicTest, ALightIsALampWithItsColourAndPower) {
  const std::string text =
      Made(Public(
               "<pointLightSource name=\"l\" x=\"1\" y=\"2\" z=\"3\" colour=\"FF0000\" brightness=\"0.5\"/>"))
          .scenario.text;
  EXPECT_HAS(text, "[LIGHT_1]\nposition 1 2 3\ncolor 1.0000 0.0000 0.0000\npower 0.5\n");
}

TEST(PublicTest, AMacroIsWrittenOutAtEachUse) {
  const std::string text = Made(Public("<macro name=\"a_\" ref=\"m\"><pose x=\"1\"/></macro><macro "
                                       "name=\"b_\" ref=\"m\"><pose x=\"2\"/></macro>",
                                       "", "<macro name=\"m\">" + Ball("ball") + "</macro>"))
                               .scenario.text;
  EXPECT_HAS(text, "[a_ball]\ntype sphere\nsize 0.2\nposition 1 0 1\n");
  EXPECT_HAS(text, "[b_ball]\ntype sphere\nsize 0.2\nposition 2 0 1\n");
}

TEST(PublicTest, ThePoseOfARobotMovesAllItsBodies) {
  const Translation made = Made(Public("", Robot(Ball("a"), "", "", "<pose x=\"3\" gamma=\"90\"/>")));
  EXPECT_HAS(made.scenario.text, "type x.r\nname r\nposition 3 0 0.9\norientation 0 0 1.570796326795\n");
  EXPECT_HAS(made.models.at(0).sdf.text, "<pose>0 0 0.1 0 0 0</pose>");
}

TEST(PublicTest, ARobotInTheGroundIsPutOnIt) {
  const std::string xml = Public("", Robot(Ball("a", "<pose z=\"0.05\"/>")));
  EXPECT_HAS(Said(xml), "'r' stands 50 mm in the ground");
  EXPECT_HAS(Made(xml).scenario.text, "position 0 0 0\n");
}

TEST(PublicTest, ACompositeIsOneBodyWithTheMassOfItsParts) {
  const std::string composite = "<composite name=\"c\"><geometry>" + Ball("p", "<pose x=\"1\"/>", "1") +
                                Ball("q", "<pose x=\"-1\"/>", "3") +
                                "</geometry><pose z=\"1\"/><physics/></composite>";
  const std::string sdf = Made(Public("", Robot(composite))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "<mass>4</mass>");
  EXPECT_HAS(sdf, "<inertial><pose>-0.5 0 0 0 0 0</pose>");
}

TEST(PublicTest, AJointMayNameAPartOfAComposite) {
  const std::string composite =
      "<composite name=\"c\"><geometry>" + Ball("part") + "</geometry><physics/></composite>";
  const std::string sdf =
      Made(Public("", Robot(composite + Ball("b"), Motor("type=\"angular\" mode=\"active\"", "b", "part"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "<parent>c</parent><child>b</child>");
}

TEST(PublicTest, ABodyWithoutMassFixesTheRobotToTheWorld) {
  const std::string sdf = Made(Public("", Robot(Ball("a", "<pose z=\"1\"/>", "0")))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "type=\"fixed\"><parent>world</parent><child>a</child>");
}

TEST(PublicTest, AHingeTurnsAboutXOfItsPoseInTheSource) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const std::string sdf = Made(Public("", Robot(two, Motor("type=\"angular\" mode=\"active\"", "a", "b",
                                                           "<pose z=\"0.5\" gamma=\"90\"/>"))))
                              .models.at(0)
                              .sdf.text;
  EXPECT_HAS(sdf, "<parent>a</parent><child>b</child><pose>0 0 -0.5 0 0 0</pose>");
  EXPECT_HAS(sdf, "<xyz expressed_in=\"__model__\">0 1 0</xyz>");
}

TEST(PublicTest, AnAngleIsThatOfTheDestinationAndAVelocityThatOfTheSource) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const auto axis_of = [&](const std::string& type) {
    const std::string sdf =
        Made(Public("", Robot(two, Motor("type=\"" + type + "\" mode=\"active\"", "a", "b"))))
            .models.at(0)
            .sdf.text;
    const std::size_t at = sdf.find("__model__\">") + 11;
    return sdf.substr(at, sdf.find('<', at) - at);
  };
  EXPECT_EQ(axis_of("angular"), "1 0 0");
  EXPECT_EQ(axis_of("velocity"), "-1 0 0");
}

TEST(PublicTest, ADeflectionIsInDegreesOfAHingeAndInMetresOfASlider) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const std::string limits = "<pose/><deflection min=\"-90\" max=\"45\"/>";
  const std::string hinge =
      Made(Public("", Robot(two, Motor("type=\"angular\" mode=\"active\"", "a", "b", limits))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(hinge, "<lower>-1.5707963267948966</lower><upper>0.7853981633974483</upper>");
  const std::string slider =
      Made(Public("", Robot(two, Motor("type=\"positional\" mode=\"active\"", "a", "b",
                                       "<pose/><deflection min=\"-0.5\" max=\"0.25\"/>", "slider"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(slider, "type=\"prismatic\"");
  EXPECT_HAS(slider, "<lower>-0.5</lower><upper>0.25</upper><effort>2</effort><velocity>5</velocity>");
}

TEST(PublicTest, AJointWithoutADestinationHangsOnTheWorld) {
  const std::string sdf =
      Made(Public("", Robot(Ball("a"), Motor("type=\"angular\" mode=\"active\"", "a", ""))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "<parent>world</parent><child>a</child>");
}

TEST(PublicTest, APassiveJointHasFrictionAndNoMotor) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const std::string sdf =
      Made(Public("", Robot(two, Motor("type=\"angular\" mode=\"passive\" friction=\"0.3\"", "a", "b"))))
          .models.at(0)
          .sdf.text;
  EXPECT_HAS(sdf, "<friction>0.3</friction>");
  EXPECT_HAS_NOT(sdf, "<effort>");
}

/// A vehicle with wheels of this radius, the right one larger by a factor.
std::string Vehicle(double larger = 0) {
  const auto wheel = [](const std::string& name, double y, double radius) {
    return "<sphere name=\"" + name + "\"><dimension radius=\"" + std::to_string(radius) + "\"/><pose y=\"" +
           std::to_string(y) + "\" z=\"" + std::to_string(radius) +
           "\"/><physics><friction value=\"1\"/></physics></sphere>";
  };
  std::string motors = Motor("type=\"velocity\" mode=\"active\"", "left", "b", "<pose gamma=\"90\"/>") +
                       Motor("type=\"velocity\" mode=\"active\"", "right", "b", "<pose gamma=\"90\"/>");
  motors.replace(motors.rfind("\"j\""), 3, "\"k\"");
  return Robot(
      Ball("b", "<pose z=\"0.2\"/>") + wheel("left", 0.1, 0.05) + wheel("right", -0.1, 0.05 + larger), motors,
      "", "<pose x=\"1\" gamma=\"30\"/>");
}

TEST(PublicTest, TwoWheelsOnOneAxleAreADrive) {
  const Translation made = Made(Public("", Vehicle()));
  EXPECT_HAS(made.models.at(0).sdf.text, "<coopdyn:drive left_joint=\"j\" right_joint=\"k\"/>");
  EXPECT_HAS(made.scenario.text, "position 1 0 0\norientation 0 0 0.523598775598\n");
}

TEST(PublicTest, UnequalWheelsAreTwoMotors) {
  EXPECT_HAS_NOT(Made(Public("", Vehicle(0.01))).models.at(0).sdf.text, "coopdyn:drive");
}

TEST(PublicTest, AProximitySensorLooksAlongItsZ) {
  const std::string sensor =
      "<proximity name=\"p\"><object name=\"a\"/><pose x=\"0.1\" beta=\"90\"/><distance meter=\"0.5\"/>"
      "<openingAngles x=\"20\" y=\"5\"/></proximity>";
  EXPECT_HAS(Made(Public("", Robot(Ball("a"), "", sensor))).models.at(0).sdf.text,
             "<coopdyn:beam link=\"a\" pose=\"0.1 0 0 0 0 0\" max_range=\"0.5\" opening_deg=\"40\" "
             "opening_up_deg=\"10\" rays=\"5\"/>");
}

TEST(PublicTest, AProximitySensorIsTurnedAboutItsAxisToo) {
  const std::string sensor =
      "<proximity name=\"p\"><object name=\"a\"/><pose/><distance meter=\"0.5\"/>"
      "<openingAngles x=\"0\" y=\"0\"/></proximity>";
  // Upwards, with y to its left: up is then -x.
  EXPECT_HAS(Made(Public("", Robot(Ball("a"), "", sensor))).models.at(0).sdf.text,
             "pose=\"0 0 0 0 -1.570796326795 0\" max_range=\"0.5\" opening_deg=\"0\" opening_up_deg=\"0\" "
             "rays=\"1\"/>");
}

TEST(PublicTest, AProximitySensorOfALimbIsTheSame) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const std::string sensor =
      "<proximity name=\"p\"><object name=\"b\"/><pose beta=\"90\"/><distance meter=\"0.5\"/>"
      "<openingAngles x=\"20\" y=\"5\"/></proximity>";
  EXPECT_HAS(Made(Public("", Robot(two, Motor("type=\"angular\" mode=\"active\"", "a", "b"), sensor)))
                 .models.at(0)
                 .sdf.text,
             "<coopdyn:beam link=\"b\" pose=\"0 0 0 0 0 0\" max_range=\"0.5\" opening_deg=\"40\" "
             "opening_up_deg=\"10\" rays=\"5\"/>");
}

TEST(PublicTest, ProximitySensorsStayInTheirOrder) {
  const auto sensor = [](const std::string& gamma, const std::string& meter) {
    return "<proximity name=\"p" + meter + "\"><object name=\"a\"/><pose beta=\"90\" gamma=\"" + gamma +
           "\"/><distance meter=\"" + meter + "\"/><openingAngles x=\"1\" y=\"1\"/></proximity>";
  };
  const std::string sdf =
      Made(Public("", Robot(Ball("a"), "", sensor("90", "1") + sensor("0", "2") + sensor("-90", "3"))))
          .models.at(0)
          .sdf.text;
  EXPECT_LT(sdf.find("max_range=\"1\""), sdf.find("max_range=\"2\""));
  EXPECT_LT(sdf.find("max_range=\"2\""), sdf.find("max_range=\"3\""));
  EXPECT_HAS_NOT(sdf, "type=\"distance\"");
}

TEST(PublicTest, SharpSensorsCamerasAndAmbientLightAreModules) {
  const std::string sensors =
      "<sharpGP2D12_37 name=\"near\"><object name=\"a\"/><pose beta=\"90\"/></sharpGP2D12_37>"
      "<sharpDM2Y3A003K0F name=\"wide\"><object name=\"a\"/><pose beta=\"90\"/></sharpDM2Y3A003K0F>"
      "<camera name=\"eye\"><object name=\"a\"/><pose beta=\"90\"/><openingAngles x=\"45\" "
      "y=\"45\"/></camera>"
      "<ambientLight name=\"day\"/>";
  const std::string sdf = Made(Public("", Robot(Ball("a"), "", sensors))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "<coopdyn:infrared name=\"near\" preset=\"gp2d12\"><coopdyn:eye link=\"a\"");
  EXPECT_HAS(sdf, "<coopdyn:infrared name=\"wide\" preset=\"dm2y3a003k0f\">");
  EXPECT_HAS(sdf,
             "<coopdyn:camera name=\"eye\" link=\"a\" pose=\"0 0 0 0 0 0\" width=\"320\" "
             "height=\"320\" fov_deg=\"90\"/>");
  EXPECT_HAS(sdf, "<coopdyn:light name=\"day\"><coopdyn:eye lamps=\"false\"/></coopdyn:light>");
  EXPECT_HAS(sdf, "<coopdyn:module type=\"light\" name=\"day\"/>");
}

TEST(PublicTest, LightAndContactSensorsAreModules) {
  const std::string sensors =
      "<ldr name=\"eye\" opening=\"45\"><object name=\"a\"/><pose/><colour value=\"FF0000\"/></ldr>"
      "<binaryContact name=\"Foot 1\"><object name=\"a\"/></binaryContact>";
  const std::string sdf = Made(Public("", Robot(Ball("a"), "", sensors))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "<coopdyn:module type=\"light\" name=\"light\"/>");
  EXPECT_HAS(sdf, "opening_deg=\"90\" color=\"1.0000 0.0000 0.0000\"/>");
  EXPECT_HAS(sdf, "<coopdyn:contact name=\"foot_1\" links=\"a\"/>");
}

TEST(PublicTest, WhatIsNotSimulatedYetIsSaidOnceAndTheRestLoads) {
  const std::string two = Ball("a", "<pose z=\"1\"/>", "0") + Ball("b", "<pose z=\"2\"/>");
  const std::string xml = Public("", Robot(two, "", "<feedback name=\"m\"/><feedback name=\"n\"/>"));
  const std::string said = Said(xml);
  EXPECT_HAS(said, "warning: <feedback> is not simulated yet");
  EXPECT_HAS(said, "(2 in this file)");
  EXPECT_EQ(Made(xml).models.size(), 2u);  // its bodies are separate
}

/// A muscle between two balls; `more` are its components.
std::string MuscleOf(const std::string& more) {
  const auto anchor = [](const std::string& name, const std::string& attributes, const std::string& pose) {
    return "<" + name + attributes + "><sphere name=\"" + name + "\"><dimension radius=\"0.01\"/>" + pose +
           "<physics/></sphere></" + name + ">";
  };
  return "<muscle name=\"m\"><source name=\"a\"/><destination name=\"b\"/>" +
         anchor("srcAnchor", "", "<pose z=\"-0.1\"/>") +
         anchor("dstAnchor", " coordinateSystem=\"global\"", "<pose z=\"1.5\"/>") + "<force max=\"2\"/>" +
         more + "</muscle>";
}

TEST(PublicTest, TheFirstOfTwoValuesLimitsTheMotor) {
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  const std::string text =
      Public("", Robot(two, Motor("type=\"force and velocity\" mode=\"active\"", "a", "b")));
  EXPECT_HAS(Made(text).models.at(0).sdf.text,
             "<coopdyn:motor name=\"j_force\" joint=\"j\" mode=\"limit\" internal=\"0 2\"/>");
  EXPECT_EQ(Said(text), "");
}

std::string FilteredPlace(const std::string& filter) {
  return Public("", Robot(Ball("a"), "",
                          "<position name=\"p\"><object name=\"a\"/><mapping min=\"-1\" max=\"1\"/><domain "
                          "min=\"-5\" max=\"5\"/><coordinates x=\"true\" y=\"false\" z=\"false\"/>" +
                              filter + "</position>"));
}

TEST(PublicTest, AFilterIsThatOfItsValue) {
  EXPECT_HAS(Made(FilteredPlace("<filter module=\"mean\"><parameter name=\"steps\" value=\"4\"/></filter>"))
                 .models.at(0)
                 .sdf.text,
             "external=\"-1 1\" filter=\"mean\" filter_steps=\"4\"/>");
}

TEST(PublicTest, AFilterThatNobodyKnowsIsLeftOut) {
  const std::string text = FilteredPlace("<filter module=\"wavelet\"/>");
  EXPECT_HAS(Said(text),
             "warning: there is no filter 'wavelet' here: it is left out; there are mean and median");
  EXPECT_HAS_NOT(Made(text).models.at(0).sdf.text, "filter=");
}

TEST(PublicTest, AMuscleHoldsItsBodiesTogether) {
  const std::string two = Ball("a", "<pose z=\"2\"/>", "0") + Ball("b", "<pose z=\"1\"/>");
  const std::string xml = Public(
      "", Robot(two, MuscleOf("<lengthComponent optimalLength=\"1\" w=\"1.5\" c=\"5\" use=\"true\"/>"
                              "<velocityComponent maxVelocity=\"-3.5\" N=\"1.4\" K=\"6\" use=\"true\"/>")));
  EXPECT_EQ(Said(xml), "");
  const Translation made = Made(xml);
  ASSERT_EQ(made.models.size(), 1u);
  EXPECT_HAS(made.models[0].sdf.text,
             "<coopdyn:muscle name=\"m\" from=\"a\" from_point=\"0 0 -0.1\" to=\"b\" to_point=\"0 0 0.5\" "
             "max_force_n=\"2\" optimal_length_m=\"1\" width=\"1.5\" c=\"5\" max_velocity_m_s=\"3.5\" "
             "eccentric=\"1.4\" curvature=\"6\"/>");
  EXPECT_HAS(made.models[0].sdf.text, "<coopdyn:motor name=\"m\" joint=\"m\" mode=\"pwm\" internal=\"0 1\"");
  EXPECT_HAS_NOT(made.scenario.text, "sockets no");
}

TEST(PublicTest, APartOfAMuscleThatIsNotUsedIsLeftOut) {
  const std::string two = Ball("a", "<pose z=\"2\"/>", "0") + Ball("b", "<pose z=\"1\"/>");
  EXPECT_HAS(
      Made(Public("",
                  Robot(two, MuscleOf("<lengthComponent optimalLength=\"1\" w=\"1.5\" c=\"5\" use=\"false\"/>"
                                      "<velocityComponent maxVelocity=\"-3.5\" N=\"1.4\" K=\"6\" "
                                      "use=\"false\"/>"))))
          .models.at(0)
          .sdf.text,
      "c=\"5\" use_length=\"false\" use_velocity=\"false\"/>");
}

TEST(PublicTest, AMeshIsAFileBesideTheExperiment) {
  const std::string mesh =
      "<ply name=\"m\" filename=\"a&amp;b.ply\" convex=\"true\"><pose z=\"1\"/><physics>"
      "<mass kg=\"3\"/></physics></ply>";
  for (const std::string& xml : {Public("", Robot(mesh)), Public(mesh)}) {
    const auto models = Made(xml).models;
    ASSERT_EQ(models.size(), 1u);
    EXPECT_HAS(models[0].sdf.text, "<mesh><uri>a&amp;b.ply</uri></mesh>");
    EXPECT_HAS(models[0].sdf.text, "<inertial coopdyn:solid=\"true\"><pose>0 0 0 0 0 0</pose><mass>3</mass>");
    EXPECT_EQ(models[0].mesh_files, std::vector<std::string>{"a&b.ply"});
  }
}

/// A joint of six axes from a to b, or from b to the world.
std::string Generic(const std::string& axes, bool to_world = false,
                    const std::string& words = "spring=\"true\"") {
  return "<generic name=\"g\" " + words + "><source name=\"" + (to_world ? "b" : "a") + "\"/>" +
         (to_world ? "" : "<destination name=\"b\"/>") + "<pose/>" + axes + "</generic>";
}

std::string GenericAxis(const std::string& name, const std::string& attributes, const std::string& inside) {
  return "<" + name + " " + attributes + "><force max=\"20\"/><velocity max=\"0.5\"/>" + inside + "</" +
         name + ">";
}

TEST(PublicTest, AGenericJointHasTheAxesWithADeflection) {
  const std::string axes =
      "<rotational>" +
      GenericAxis("x", "type=\"angular\" mode=\"active\"", "<deflection min=\"-90\" max=\"45\"/>") +
      GenericAxis("z", "type=\"angular\" mode=\"passive\" friction=\"0.3\"",
                  "<deflection min=\"1\" max=\"-1\"/>") +
      GenericAxis("y", "type=\"angular\" mode=\"passive\"", "") + "</rotational><translational>" +
      GenericAxis("y", "type=\"positional\" mode=\"passive\"",
                  "<deflection min=\"-0.1\" max=\"0.2\"/><spring stiffness=\"50\" damping=\"2\"/>") +
      "</translational>";
  const std::string two = Ball("a", "<pose z=\"1\"/>", "0") + Ball("b", "<pose z=\"2\"/>");
  const std::string sdf = Made(Public("", Robot(two, Generic(axes)))).models.at(0).sdf.text;
  EXPECT_HAS(sdf,
             "<coopdyn:six_axis name=\"g\" parent=\"a\" child=\"b\" relative_to=\"__model__\" pose=\"0 0 1 0 "
             "0 0\">");
  const std::size_t y = sdf.find(
      "<coopdyn:axis name=\"y\" lower=\"-0.1\" upper=\"0.2\" damping=\"2\" rest=\"0\" "
      "stiffness=\"50\"/>");
  const std::size_t rz = sdf.find("<coopdyn:axis name=\"rz\" xyz=\"0 0 -1\" friction=\"0.3\"/>");
  const std::size_t rx = sdf.find(
      "<coopdyn:axis name=\"rx\" xyz=\"-1 0 0\" lower=\"-1.5707963267948966\" "
      "upper=\"0.7853981633974483\" max_effort=\"20\" max_velocity=\"0.5\"/>");
  EXPECT_TRUE(y < rz && rz < rx && rx != std::string::npos) << sdf;
  EXPECT_HAS_NOT(sdf, "\"ry\"");
}

TEST(PublicTest, AGenericJointSeenFromItsDestinationTurnsTheOtherWayRound) {
  const std::string axes =
      "<rotational>" +
      GenericAxis("x", "type=\"angular\" mode=\"active\"", "<deflection min=\"-9\" max=\"9\"/>") +
      "</rotational><translational>" +
      GenericAxis("z", "type=\"positional\" mode=\"passive\"", "<deflection min=\"0\" max=\"1\"/>") +
      "</translational>";
  const std::string two = Ball("a", "<pose z=\"1\"/>") + Ball("b", "<pose z=\"2\"/>", "0");
  const std::string sdf = Made(Public("", Robot(two, Generic(axes)))).models.at(0).sdf.text;
  EXPECT_HAS(sdf, "parent=\"b\" child=\"a\"");
  const std::size_t rx = sdf.find("name=\"rx\" lower"), z = sdf.find("name=\"z\" xyz=\"0 0 -1\" lower=\"0\"");
  EXPECT_TRUE(rx < z && z != std::string::npos) << sdf;
  const std::string bound = Made(Public("", Robot(Ball("b"), Generic(axes, true)))).models.at(0).sdf.text;
  EXPECT_HAS(bound, "parent=\"world\" child=\"b\"");
  EXPECT_HAS(bound, "name=\"rx\" xyz=\"-1 0 0\"");
}

TEST(PublicTest, AGenericAxisThatCannotMoveAsItSaysIsSaid) {
  const std::string axes =
      "<rotational>" + GenericAxis("x", "type=\"angular\" mode=\"active\"", "") + "</rotational>";
  const std::string two = Ball("a") + Ball("b", "<pose z=\"2\"/>");
  EXPECT_HAS(Said(Public("", Robot(two, Generic(axes)))),
             "warning: the axis 'rx' of 'g' is locked, as an axis without <deflection> is");
}

TEST(PublicTest, ACapsuleInTheEnvironmentIsARobotWithoutSockets) {
  const std::string text = Made(Public("<capsule name=\"c\"><dimension radius=\"0.1\" height=\"1\"/><pose "
                                       "z=\"1\"/><physics/></capsule>"))
                               .scenario.text;
  EXPECT_HAS(text, "[ROBOT_1]\ntype x.c\nname c\nposition 0 0 0.4\n");
  EXPECT_HAS(text, "sockets no\n");
}

TEST(PublicTest, EachLineKnowsWhereItWasWritten) {
  const Translation made = Made("<rosiml version=\"0.8\">\n<simulator frequency=\"100\"/>\n<environment>\n" +
                                Ball("b") + "\n</environment>\n<robots/>\n</rosiml>");
  const std::size_t at = made.scenario.text.find("[b]");
  const auto line = static_cast<std::size_t>(std::count(
      made.scenario.text.begin(), made.scenario.text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  EXPECT_EQ(made.scenario.lines.at(line), 4);
}

}  // namespace
}  // namespace coopdyn::rosiml
