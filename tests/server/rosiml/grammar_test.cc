// SPDX-License-Identifier: MIT
// Messages about invalid words and values.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

TEST(GrammarTest, AnUnknownElementIsAnErrorWithItsLineAndTheNearestWord) {
  EXPECT_HAS(Said("<rosiml version=\"0.8\">\n<simulator frequency=\"100\"/>\n<enviroment/></rosiml>"),
             "x.xml:3: error: unknown element <enviroment> in <rosiml>; did you mean 'environment'?");
}

TEST(GrammarTest, AnUnknownAttributeIsAnErrorWithTheNearestWord) {
  EXPECT_HAS(Said("<rosiml version=\"0.8\"><simulator frequncy=\"100\"/><robots/></rosiml>"),
             "unknown attribute 'frequncy' in <simulator>; did you mean 'frequency'?");
}

TEST(GrammarTest, WhatIsMissingIsSaid) {
  const std::string said = Said(Public("<sphere name=\"b\"><pose/></sphere>"));
  EXPECT_HAS(said, "<sphere> needs <dimension>");
  EXPECT_HAS(said, "<sphere> needs <physics>");
  EXPECT_HAS(Said(Public("", "<robot><body/></robot>")), "<robot> needs the attribute 'name'");
}

TEST(GrammarTest, AllMistakesAreSaidAtOnceByTheirLines) {
  const std::string said = Said(
      "<rosiml version=\"1\">\n<simulator frequency=\"fast\"/>\n<movables>\n"
      "<movable name=\"m\" type=\"busy\"/>\n</movables></rosiml>");
  EXPECT_HAS(said, "x.xml:2: error: 'frequency' in <simulator> is a number from 10 to 2000, not 'fast'");
  EXPECT_HAS(
      said,
      "x.xml:4: error: 'type' in <movable> is one of active, passive, controlled and moving, not 'busy'");
  EXPECT_HAS(said, "x.xml:4: error: <movable> needs <body>");
  EXPECT_LT(said.find("x.xml:2"), said.find("x.xml:4"));
}

TEST(GrammarTest, AnElementThatStandsTwiceIsAnError) {
  EXPECT_HAS(Said("<rosiml version=\"0.8\"><simulator frequency=\"100\"/><simulator "
                  "frequency=\"50\"/><robots/></rosiml>"),
             "<simulator> stands twice in <rosiml>");
}

TEST(GrammarTest, TextBetweenTagsIsAnError) {
  EXPECT_HAS(Said("<rosiml version=\"0.8\"><simulator frequency=\"100\">fast</simulator><robots/></rosiml>"),
             "text between the tags of <simulator>");
}

TEST(GrammarTest, ColoursAreSixDigits) {
  EXPECT_HAS(Said(Public("<pointLightSource x=\"1\" y=\"0\" z=\"1\" colour=\"red\" brightness=\"1\"/>")),
             "is a colour RRGGBB, for example FF8000, not 'red'");
}

TEST(GrammarTest, ARangeIsTheLeastAndTheMost) {
  const auto random = [](const std::string& range) {
    return Said(Paper("<sphere name=\"b\" radius=\"1\"><randomise x=\"" + range + "\"/></sphere>"));
  };
  EXPECT_EQ(random("-1 1"), "");
  EXPECT_HAS(random("2 1"), "is the least and the most, in this order");
  EXPECT_HAS(random("1 2 3"), "is the least and the most, for example");
}

TEST(GrammarTest, AFrequencyBeyondOurStepsIsAnError) {
  EXPECT_HAS(Said("<rosiml version=\"0.8\"><simulator frequency=\"5000\"/><robots/></rosiml>"),
             "'frequency' in <simulator> is a number from 10 to 2000, not '5000'");
}

TEST(GrammarTest, GravityPointsAnywhere) {
  EXPECT_EQ(Said(Public("<gravitation x=\"1\" y=\"0\" z=\"-9\"/>")), "");
  EXPECT_EQ(Said(Public("<gravitation x=\"0\" y=\"0\" z=\"-9\"/>")), "");
  EXPECT_EQ(Said(Public("<gravitation x=\"0\" y=\"0\" z=\"0\"/>")), "");
}

TEST(GrammarTest, ANameThatIsNotThereIsAnErrorWithTheNearestOne) {
  EXPECT_HAS(Said(Public("", Robot(Ball("body"), Motor("type=\"velocity\" mode=\"active\"", "bodi", "")))),
             "there is no object 'bodi' in 'r'; did you mean 'body'?");
}

}  // namespace
}  // namespace coopdyn::rosiml
