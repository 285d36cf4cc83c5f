// SPDX-License-Identifier: MIT
// All mistakes are reported together, each once: values beyond limits, duplicate names, misspelt words.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

/// A movable of the paper's grammar from line 4 on, and scores.
std::string Lines(const std::string& environment, const std::string& object, const std::string& scores = "") {
  return "<rosiml version=\"1\">\n<environment>" + environment +
         "</environment>\n<movables>\n<movable name=\"m\" type=\"active\"><body>\n" + object +
         "</body></movable>\n</movables>\n" + scores + "</rosiml>\n";
}

std::string Object(const std::string& name, const std::string& sensors = "") {
  return "<object name=\"" + name + "\" mass=\"1\"><pose z=\"1\"/><sphere radius=\"0.1\"/>\n" + sensors +
         "</object>\n";
}

TEST(MistakesTest, AnAngleBeyondItsLimitIsToldInDegrees) {
  EXPECT_EQ(Said(Lines("", Object("a"), "<score kind=\"upright\" tilt=\"500\"/>\n")),
            "x.xml:9: error: 'tilt' in <score> is a number from 0 to 180, not '500'\n");
}

TEST(MistakesTest, LimitsAreToldWithTheValue) {
  EXPECT_EQ(Said(Lines("<sphere name=\"s\" radius=\"5e3\" mass=\"1e9\"/>",
                       Object("a", "<proximity name=\"p\" range=\"1\" opening=\"9\" rays=\"1000000\"/>\n"))),
            "x.xml:2: error: 'radius' in <sphere> is a number above 0, at most 1000, not '5e3'\n"
            "x.xml:2: error: 'mass' in <sphere> is a number from 0 to 1000000, not '1e9'\n"
            "x.xml:6: error: 'rays' in <proximity> is a whole number from 1 to 1000, not '1000000'\n");
  EXPECT_HAS(Said(Public(Ball("b", "<pose x=\"1e6\"/>", "1e9"))),
             "'kg' in <mass> is a number from 0 to 1000000");
  EXPECT_HAS(Said(Public(Ball("b", "<pose x=\"1e6\"/>"))),
             "'x' in <pose> is a number from -100000 to 100000");
  EXPECT_HAS(Said(Lines("<sphere name=\"s\" radius=\"0.1\" friction=\"-1\"/>", Object("a"))),
             "'friction' in <sphere> is a number, 0 or more, not '-1'");
}

TEST(MistakesTest, AFrequencyBeyondItsLimitIsOneMistake) {
  std::string text = Lines("", Object("a"));
  text.insert(text.find("<environment>"), "<simulator frequency=\"1e9\" controllerFrequency=\"7\"/>");
  EXPECT_EQ(Said(text),
            "x.xml:2: error: 'frequency' in <simulator> is a number from 10 to 2000, not '1e9'\n");
  const std::string robot = Robot(Ball("a")).replace(0, 16, "<robot name=\"r\">");
  EXPECT_EQ(
      Said("<rosiml version=\"0.8.41\"><simulator frequency=\"0\"/><robots>" + robot + "</robots></rosiml>"),
      "x.xml:1: error: 'frequency' in <simulator> is a number from 10 to 2000, not '0'\n");
}

TEST(MistakesTest, TwoThingsOrMovablesOfOneNameAreAnError) {
  EXPECT_EQ(Said(Lines("\n<sphere name=\"s\" radius=\"1\"/>\n<sphere name=\"s\" radius=\"1\"/>\n"
                       "<light name=\"m\" x=\"0\" y=\"0\" z=\"9\"/>",
                       Object("a"))),
            "x.xml:4: error: the name 's' stands in line 3, too: give one another name\n"
            "x.xml:7: error: the name 'm' stands in line 5, too: give one another name\n");
  EXPECT_HAS(Said(Public(Ball("a") + Ball("a"))), "the name 'a' stands in line 1, too");
  EXPECT_HAS(Said(Public("", Robot(Ball("a")) + Robot(Ball("a")))), "the name 'r' stands in line 1, too");
}

TEST(MistakesTest, TwoSensorsJointsOrScoresOfOneNameAreAnError) {
  const std::string compass = "<compass name=\"c\"/>\n", score = "<score kind=\"time\" name=\"t\"/>\n",
                    joint = "<connector name=\"j\" type=\"fixed\" source=\"a\" destination=\"b\"/>\n";
  EXPECT_EQ(Said(Lines("", Object("a", compass) + Object("b", compass) + joint + joint, score + score)),
            "x.xml:9: error: the name 'c' stands in line 6, too: give one another name\n"
            "x.xml:12: error: the name 'j' stands in line 11, too: give one another name\n"
            "x.xml:16: error: the name 't' stands in line 15, too: give one another name\n");
  const std::string contact = "<binaryContact name=\"c\"><object name=\"a\"/></binaryContact>";
  EXPECT_HAS(Said(Public("", Robot(Ball("a"), "", contact + contact))), "the name 'c' stands in line 1, too");
  EXPECT_HAS(Said(Public(
                 "", Robot(Ball("a") + Ball("b"), Motor("type=\"velocity\" mode=\"active\"", "a", "b") +
                                                      Motor("type=\"velocity\" mode=\"active\"", "a", "b")))),
             "the name 'j' stands in line 1, too");
}

TEST(MistakesTest, AMisspeltWordIsReadAsItIsMeant) {
  std::string text = Lines(
      "",
      Object("a") + Object("b") + "<connector name=\"j\" type=\"fixed\" source=\"a\" destination=\"b\"/>\n",
      "<score kind=\"distance\" of=\"m/b\"/>");
  text.replace(text.find("<object name=\"b\""), 16, "<object nmae=\"b\"");
  text.replace(text.find("<movables>"), 10, "<movabels>");
  text.replace(text.find("</movables>"), 11, "</movabels>");
  EXPECT_EQ(Said(text),
            "x.xml:3: error: unknown element <movabels> in <rosiml>; did you mean 'movables'?\n"
            "x.xml:7: error: unknown attribute 'nmae' in <object>; did you mean 'name'?\n");
}

TEST(MistakesTest, AnElementInAWrongPlaceIsToldWhereItStands) {
  std::string text = Public("");
  text.insert(text.find("<environment>"), "<control iterations=\"5\"/>");
  EXPECT_HAS(Said(text), "unknown element <control> in <rosiml>: it stands in <simulator>");
}

TEST(MistakesTest, WhatNamesSomethingWithAMistakeIsNoOtherMistake) {
  EXPECT_EQ(Said(Lines("<sphere name=\"s\" radius=\"0\"/>", "<object name=\"a\" mass=\"x\"/>\n",
                       "<score kind=\"reach\" of=\"m/b\" target=\"s\"/>")),
            "x.xml:2: error: 'radius' in <sphere> is a number above 0, not '0'\n"
            "x.xml:5: error: 'mass' in <object> is a number from 0 to 1000000, not 'x'\n"
            "x.xml:5: error: <object> needs a shape: <box>, <sphere>, <cylinder> or <capsule>\n");
}

}  // namespace
}  // namespace coopdyn::rosiml
