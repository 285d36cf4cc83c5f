// SPDX-License-Identifier: MIT
// Malicious texts: one error each, immediately.

#include "tests/cpu.h"
#include "tests/server/rosiml/made.h"

namespace coopdyn::rosiml {
namespace {

std::string Times(int count, const std::string& text) {
  std::string out;
  for (int i = 0; i < count; ++i) out += text;
  return out;
}

TEST(HostileTest, ADoctypeIsRefused) {
  EXPECT_HAS(
      Said("<?xml version=\"1.0\"?>\n<!-- <!DOCTYPE> -->\n<!DOCTYPE a [<!ENTITY b \"bb\">]>\n<rosiml/>"),
      "x.xml:3: error: a DOCTYPE and entities are not read");
}

TEST(HostileTest, ADeclarationFurtherInsideIsRefused) {
  EXPECT_HAS(
      Said("<rosiml version=\"0.8\"><!ENTITY b \"bb\"><simulator frequency=\"100\"/><robots/></rosiml>"),
      "a declaration <!…> is not read");
}

TEST(HostileTest, GarbageIsNoXml) {
  EXPECT_HAS(Said("<rosiml <<<"), "<rosiml> has no end: write > or />");
  EXPECT_HAS(Said(""), "an experiment starts with <rosiml");
  EXPECT_HAS(Said("<html/>"), "an experiment starts with <rosiml");
}

TEST(HostileTest, TenMegabytesAreRefusedUnread) {
  EXPECT_HAS(Said(std::string(10u << 20, 'x')), "at most 4 MiB");
}

TEST(HostileTest, ElementsWithoutNumberAreRefused) {
  EXPECT_HAS(Said("<rosiml version=\"1\">" + Times(60'000, "<a/>") + "</rosiml>"), "at most 50000 elements");
}

TEST(HostileTest, MistakesWithoutNumberEnd) {
  EXPECT_HAS(Said("<rosiml version=\"1\">" + Times(40'000, "<a/>\n") + "</rosiml>"), "error");
}

TEST(HostileTest, AttributesWithoutNumberAreRefusedBeforeTheyAreParsed) {
  const auto with = [](int count) {
    std::string attributes;
    for (int i = 0; i < count; ++i) attributes += " a" + std::to_string(i) + "=\"1\"";
    return Said("<rosiml version=\"1\">\n<simulator" + attributes + "/></rosiml>");
  };
  EXPECT_EQ(with(100'000), "x.xml:2: error: <simulator> has more than 100 attributes\n");
  EXPECT_HAS(with(101), "more than 100 attributes");
  EXPECT_HAS_NOT(with(100), "more than 100 attributes");
}

TEST(HostileTest, AnElementOfAttributesWithoutQuotesEnds) {
  EXPECT_HAS(Said("<rosiml " + Times(1'000'000, "a=1 ")), "and 100 more errors");
}

TEST(HostileTest, SignsThatAreNoEntitiesEnd) {
  const std::string said = Said("<rosiml version=\"1\">" + Times(1'000'000, "&\n") + "</rosiml>");
  EXPECT_HAS(said, "x.xml:100: error: a & by itself is no XML");
  EXPECT_HAS(said, "the rest was not read");
}

std::string Numbered(int count, const std::string& before, const std::string& behind) {
  std::string out;
  for (int i = 0; i < count; ++i) out.append(before).append(std::to_string(i)).append(behind);
  return out;
}

/// The mistakes of a text. Fails if reading takes much longer than for another text of this size on this
/// machine.
std::string SaidAtOnce(const std::string& xml) {
  const std::string plain = "<rosiml version=\"1\">" +
                            Times(static_cast<int>(xml.size() / 24), "<macro name=\"a\"></macro>\n") +
                            "</rosiml>";
  const double plain_s = Cpu_s([&plain] { Said(plain); });
  std::string said;
  constexpr double kTimes = 50;
  EXPECT_LT(Cpu_s([&] { said = Said(xml); }), kTimes * plain_s);
  return said;
}

TEST(HostileTest, WrongNamesOfManyTakeNoTime) {
  const std::string name(50, 'n'), wrong(60, 'x');
  const std::string objects =
      Numbered(4000, "<object name=\"" + name, "\" mass=\"1\"><sphere radius=\"0.1\"/></object>\n");
  const std::string connectors =
      Numbered(20'000, "<connector type=\"fixed\" source=\"" + wrong + "\" name=\"c", "\"/>\n");
  EXPECT_HAS(SaidAtOnce(Paper("", "<movable name=\"m\" type=\"active\"><body>" + objects + connectors +
                                      "</body></movable>")),
             "there is no object '" + wrong + "' in 'm'; known are");
  EXPECT_HAS(SaidAtOnce(Public(Times(20'000, "<macro name=\"a\" ref=\"" + wrong + "\"/>\n"), "",
                               Numbered(20'000, "<macro name=\"" + name, "\"></macro>"))),
             "there is no macro '" + wrong + "'; known are");
}

TEST(HostileTest, AScoreOfNamesWithoutNumberIsAnError) {
  EXPECT_HAS(Said("<rosiml version=\"1\"><movables/>\n<score kind=\"distance\" of=\"" + Times(100'000, "a,") +
                  "\"/></rosiml>"),
             "x.xml:2: error: 'of' in <score> has at most 1000 names");
}

TEST(HostileTest, ParametersWithoutNumberAreAnError) {
  EXPECT_HAS(Said(Paper("", "<movable name=\"m\" type=\"controlled\"><controller library=\"a\">" +
                                Numbered(2000, "<parameter value=\"1\" name=\"p", "\"/>") +
                                "</controller><body><object name=\"a\" mass=\"1\"><sphere "
                                "radius=\"0.1\"/></object></body></movable>")),
             "a controller has at most 1000 parameters");
}

TEST(HostileTest, ElementsInsideEachOtherWithoutEndAreRefused) {
  EXPECT_HAS(
      Said(Paper("", "<movable name=\"m\" type=\"active\"><body>" + Times(20'000, "<compound name=\"c\">") +
                         Times(20'000, "</compound>") + "</body></movable>")),
      "elements stand more than 90 deep in each other");
}

TEST(HostileTest, NumbersThatAreNoneOrHugeAreErrors) {
  for (const char* number : {"nan", "inf", "-inf", "1e400", "1e30", "0x10", "", "1,5", "1 2"}) {
    const std::string pose = "<pose x=\"" + std::string(number) + "\"/>";
    EXPECT_HAS(Said(Public(Ball("b", pose))), "error: 'x' in <pose> is") << number;
  }
}

TEST(HostileTest, TwoNamesAlikeAreAnError) {
  EXPECT_HAS(Said(Public("", Robot(Ball("a") + Ball("a")))), "there are two objects 'a' in 'r'");
}

TEST(HostileTest, ThingsOfOneNameGetTwo) {
  const std::string text = Made(Public(Ball("a") + Ball("A") + Ball("floor") + Ball("ä"))).scenario.text;
  for (const char* name : {"[a]", "[A_2]", "[m_floor]", "[m__]"}) EXPECT_HAS(text, name);
}

TEST(HostileTest, ThousandsOfThingsOfOneSimpleNameTakeNoTime) {
  std::string balls;  // names are cut after 40 characters
  for (int i = 0; i < 4000; ++i) balls += Ball(std::string(40, 'a') + std::to_string(i));
  EXPECT_HAS(Made(Public(balls)).scenario.text, "[" + std::string(40, 'a') + "_4000]");
}

TEST(HostileTest, RobotsWithoutNumberAreAnError) {
  const std::string robot = "<capsule name=\"c\"><dimension radius=\"1\" height=\"1\"/><physics/></capsule>";
  std::string robots;
  for (int i = 0; i < 400; ++i) robots += std::string(robot).insert(15, std::to_string(i));
  EXPECT_HAS(Said(Public(robots)), "at most 300 robots");
}

TEST(HostileTest, AMacroThatUsesItselfIsAnError) {
  EXPECT_HAS(Said(Public("<macro name=\"x\" ref=\"m\"/>", "",
                         "<macro name=\"m\"><macro name=\"y\" ref=\"m\"/></macro>")),
             "does one use itself?");
}

TEST(HostileTest, MacrosThatMultiplyAreAnError) {
  std::string macros = "<macro name=\"m0\">" + Ball("b") + "</macro>";
  for (int i = 1; i < 9; ++i) {
    macros += "<macro name=\"m" + std::to_string(i) + "\">";
    for (int use = 0; use < 20; ++use)
      macros += "<macro name=\"x" + std::to_string(use) + "_\" ref=\"m" + std::to_string(i - 1) + "\"/>";
    macros += "</macro>";
  }
  EXPECT_HAS(Said(Public("<macro name=\"x\" ref=\"m8\"/>", "", macros)), "at most 10000 bodies");
}

TEST(HostileTest, MacrosOfNothingThatMultiplyAreAnError) {
  std::string macros = "<macro name=\"m0\"></macro>";
  for (int i = 1; i < 9; ++i) {
    const std::string use = "<macro name=\"x\" ref=\"m" + std::to_string(i - 1) + "\"/>";
    macros += "<macro name=\"m" + std::to_string(i) + "\">" + Times(20, use) + "</macro>";
  }
  EXPECT_HAS(Said(Public("<macro name=\"x\" ref=\"m8\"/>", "", macros)), "more than 10,000 times");
}

TEST(HostileTest, AJointOfABodyWithItselfIsAnError) {
  EXPECT_HAS(Said(Public("", Robot(Ball("a"), Motor("type=\"angular\" mode=\"active\"", "a", "a")))),
             "the joint 'j' joins a body with itself");
}

TEST(HostileTest, ARingOfJointsIsOneRobot) {
  std::string joints;
  const std::pair<const char*, const char*> ring[] = {{"a", "b"}, {"b", "c"}, {"c", "a"}};
  for (const auto& [from, to] : ring) {
    std::string joint = Motor("type=\"angular\" mode=\"active\"", from, to);
    joint.replace(joint.find("\"j\""), 3, "\"" + std::string(from) + to + "\"");
    joints += joint;
  }
  const Translation made = Made(Public("", Robot(Ball("a") + Ball("b") + Ball("c"), joints)));
  ASSERT_EQ(made.models.size(), 1u);
  EXPECT_EQ(made.models[0].sdf.lines.size(),
            static_cast<std::size_t>(
                std::count(made.models[0].sdf.text.begin(), made.models[0].sdf.text.end(), '\n')));
}

TEST(HostileTest, TextInNamesStaysOutOfWhatIsWritten) {
  const Translation made = Made(Public("", Robot(Ball("a&quot;/&gt;&#10;[ROBOT_9]"))));
  EXPECT_HAS_NOT(made.models.at(0).sdf.text, "[ROBOT_9]");
  EXPECT_HAS(made.models.at(0).sdf.text, "<link name=\"a_____ROBOT_9_\">");
}

TEST(HostileTest, AControllerCannotBringLinesOfItsOwn) {
  const std::string xml =
      "<movable name=\"m\" type=\"controlled\"><controller library=\"a&#10;[SET]\"/><body><object name=\"a\" "
      "mass=\"1\"><pose z=\"1\"/><sphere radius=\"0.1\"/></object></body></movable>";
  EXPECT_HAS(Said(Paper("", xml)), "is no name of letters, digits and _");
}

}  // namespace
}  // namespace coopdyn::rosiml
