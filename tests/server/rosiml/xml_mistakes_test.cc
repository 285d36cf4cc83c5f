// SPDX-License-Identifier: MIT
// Messages about a text that is not XML: in words, all together.
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

const std::string kBegin = "<rosiml version=\"1\">\n<movables>\n";
const std::string kEnd = "</movables>\n</rosiml>\n";

TEST(XmlMistakesTest, AnElementWithoutEndIsNamedWithItsLine) {
  EXPECT_EQ(Said(kBegin + "<movable name=\"m\">\n" + kEnd),
            "x.xml:4: error: <movable> of line 3 has no end: write </movable> before </movables>\n");
  EXPECT_EQ(Said("<rosiml version=\"1\">\n<movables/>\n"),
            "x.xml:1: error: <rosiml> has no end: write </rosiml>\n");
}

TEST(XmlMistakesTest, AnEndOfAnotherNameIsSaidAndTheRestIsRead) {
  EXPECT_EQ(Said(kBegin + "<movable name=\"m\">\n</movabel>\n<body x=1/>\n" + kEnd),
            "x.xml:4: error: </movabel> stands where <movable> of line 3 ends: write </movable>\n"
            "x.xml:5: error: the value of 'x' in <body> stands in quotes: write x=\"1\"\n");
  EXPECT_HAS(Said("<rosiml/>\n</rosiml>"), "x.xml:2: error: </rosiml> ends nothing: remove it");
}

TEST(XmlMistakesTest, AnAttributeIsANameAndAValueInQuotes) {
  EXPECT_HAS(Said(kBegin + "<pose x/>\n" + kEnd),
             "x.xml:3: error: 'x' in <pose> has no value: write x=\"…\"");
  EXPECT_HAS(Said(kBegin + "<pose x=\"1/>\n" + kEnd),
             "x.xml:3: error: the value of 'x' in <pose> has no end: write a \" behind it");
  EXPECT_HAS(Said(kBegin + "<pose x=\"1\" x=\"2\"/>\n" + kEnd),
             "x.xml:3: error: 'x' in <pose> stands twice: keep one");
  EXPECT_HAS(Said(kBegin + "<pose =\"1\"/>\n" + kEnd), "x.xml:3: error: '=' in <pose> is out of place");
  EXPECT_HAS(Said(kBegin + "<pose x=\"1\"\n" + kEnd), "x.xml:3: error: <pose> has no end: write > or />");
}

TEST(XmlMistakesTest, EachEntityThatIsNotDefinedIsAnError) {
  EXPECT_EQ(Said(kBegin + "<movable name=\"&foo;\"/>\n&bar;\n<movable name=\"a&b\"/>\n" + kEnd),
            "x.xml:3: error: the entity '&foo;' is not defined: write out what it stands for; there are "
            "&amp; &lt; &gt; &quot; and &apos;\n"
            "x.xml:4: error: the entity '&bar;' is not defined: write out what it stands for; there are "
            "&amp; &lt; &gt; &quot; and &apos;\n"
            "x.xml:5: error: a & by itself is no XML: write &amp;\n");
}

TEST(XmlMistakesTest, EntitiesOfXmlAndThoseInCommentsAreNone) {
  EXPECT_EQ(
      Said(Paper("<!-- &foo; --><sphere name=\"&lt;&#228;&#xE4;&apos;&quot;&gt;&amp;\" radius=\"1\"/>")), "");
  EXPECT_HAS(Said(Paper("<sphere name=\"&#xG;\" radius=\"1\"/>")), "the entity '&#xG;' is not defined");
}

TEST(XmlMistakesTest, ACommentWithoutEndIsSaid) {
  EXPECT_HAS(Said(kBegin + "<!-- no end\n" + kEnd),
             "x.xml:3: error: what begins with <!-- has no end: write -->");
}

TEST(XmlMistakesTest, WhatStandsBehindTheExperimentIsAnError) {
  EXPECT_HAS(Said(Paper("") + "\n<rosiml/>"), "x.xml:2: error: <rosiml> stands behind </rosiml>");
  EXPECT_EQ(Said(Paper("") + "\n<x/>"),
            "x.xml:2: error: <x> stands behind </rosiml>: all of an experiment stands before it\n");
  EXPECT_EQ(Said(Paper("") + "\n\nand more <x/>"), "x.xml:3: error: text behind </rosiml>: remove it\n");
}

}  // namespace
}  // namespace coopdyn::rosiml
