// SPDX-License-Identifier: MIT
// Absurdly large files are refused quickly, in few words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Repeat(const std::string& text, int count) {
  std::string all;
  all.reserve(text.size() * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::string Numbered(const std::string& before, const std::string& after, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += before + std::to_string(i) + after;
  return all;
}

std::ptrdiff_t Lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

TEST(ReaderLimits, SectionsThatStandTwiceAreSaidAHundredTimes) {
  const std::string messages = Read(Repeat("[B]\n", 100'000)).messages;
  EXPECT_LE(Lines(messages), 102);
  EXPECT_THAT(messages, HasSubstr("test.scenario:2: error: [B] stands here twice"));
  EXPECT_THAT(messages, HasSubstr("more errors"));
  EXPECT_THAT(messages, ::testing::EndsWith("test.scenario:1003: the rest was not read\n"));
}

TEST(ReaderLimits, UnknownWordsInOneSectionAreSaidAHundredTimes) {
  const std::string messages = Read("[FLOOR]\nsize 4 4 0.1\n" + Numbered("word", " 1\n", 100'000)).messages;
  EXPECT_LE(Lines(messages), 102);
  EXPECT_THAT(messages, HasSubstr("unknown word 'word0'"));
}

TEST(ReaderLimits, WrongTargetsAreSaidAHundredTimes) {
  const std::string messages = Read("[TARGET]\n" + Repeat("red x\n", 100'000)).messages;
  EXPECT_LE(Lines(messages), 102);
  EXPECT_THAT(messages, HasSubstr("test.scenario:2: error: 'red': 'x' is not a number"));
}

TEST(ReaderLimits, TheFirstLinesAreKeptThoughOthersAreReadBefore) {
  // [SIMULATION] is read first, at any position.
  const std::string messages =
      Read(Numbered("[BAD_", "]\n", 300) + "[SIMULATION]\nmode fast\n" + "gravity -1\n").messages;
  EXPECT_THAT(messages, ::testing::StartsWith("test.scenario:1: error: [BAD_0]"));
}

TEST(ReaderLimits, TooManySectionsAreSaidOnce) {
  const std::string messages = Read(Numbered("[B", "]\n", 100'010)).messages;
  EXPECT_THAT(messages, HasSubstr("a file has at most 100000 sections"));
  EXPECT_LE(Lines(messages), 103);
}

TEST(ReaderLimits, AWorldIsReadNoFartherThanAScenario) {
  const std::string messages = ReadWorldText(Repeat("[B]\n", 100'000)).messages;
  EXPECT_LE(Lines(messages), 102);
  EXPECT_THAT(messages, HasSubstr("the rest was not read"));
}

TEST(ReaderLimits, ALongValueIsCut) {
  const std::string messages = Read("[FLOOR]\nsize " + std::string(1'000'000, 'x') + "\n").messages;
  EXPECT_LT(messages.size(), 1500u);
}

TEST(ReaderLimits, CopiesAndSwarmsAreCountedTogether) {
  std::string text = "[FLOOR]\nsize 1 1 0.1\n";
  for (int i = 0; i < 50; ++i) {
    const std::string number = std::to_string(i);
    text += "[A_" + number + "]\ntype box\nsize 0.1 0.1 0.1\ncount 100000\n";
    text += "[SWARM_" + number + "]\ntype coopbot\nname s" + number + "_\ncount 100000\n";
  }
  const std::string messages = Read(text).messages;
  EXPECT_THAT(messages, HasSubstr("all copies together are more than 200000"));
  EXPECT_THAT(messages, HasSubstr("all swarms together have more than 200000 robots"));
}

/// The reader's messages for a model that has `inside` in its <model>.
std::string ReadModel(const std::string& inside) {
  const std::string text =
      "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"m\">" + inside +
      "</model></sdf>";
  Diagnostics diagnostics;
  EXPECT_EQ(ReadRobotModelText(text, "model.sdf", "m", diagnostics), nullptr);
  return diagnostics.ToString();
}

TEST(ModelLimits, LinksJointsAndFramesAreCounted) {
  EXPECT_THAT(ReadModel(Numbered("<link name=\"l", "\"/>\n", 20'000)), HasSubstr("at most 300 links"));
  EXPECT_THAT(ReadModel(Numbered("<joint name=\"l", "\"/>\n", 20'000)), HasSubstr("at most 300 joints"));
  EXPECT_THAT(ReadModel(Numbered("<frame name=\"l", "\"/>\n", 20'000)), HasSubstr("at most 300 frames"));
}

TEST(ModelLimits, ElementsOfAnyNameAreCounted) {
  EXPECT_THAT(ReadModel(Repeat("<coopdyn:x/>", 20'000)), HasSubstr("at most 10000 elements"));
}

/// The reader's messages for a world of `inside`.
std::string ReadWorld(const std::string& inside) {
  const TempFolder folder;
  folder.Write("lab.sdf", "<sdf version=\"1.9\"><world name=\"lab\">" + inside + "</world></sdf>");
  RobotLibrary library(SearchPath{{folder.path().string()}});
  Diagnostics diagnostics;
  const auto scenario = LoadScenario((folder.path() / "lab.sdf").string(), library, diagnostics);
  return (scenario == nullptr ? "refused: " : "loads: ") + diagnostics.ToString();
}

TEST(ModelLimits, EachModelOfAWorldHasThem) {
  const std::string still =
      "\"><static>true</static><link name=\"l\"><collision name=\"c\"><geometry><box><size>1 1 1</size></box>"
      "</geometry></collision></link></model>\n";
  EXPECT_THAT(ReadWorld(Numbered("<model name=\"m", still, 1500)), StartsWith("loads: "));
  EXPECT_THAT(ReadWorld("<model name=\"m\">" + Numbered("<link name=\"l", "\"/>\n", 400) + "</model>"),
              HasSubstr("at most 300 links"));
  EXPECT_THAT(ReadWorld(Numbered("<model name=\"m", still, 20'000)), HasSubstr("at most 100000 elements"));
}

TEST(ModelLimits, AttributesOfAnElementAreCounted) {
  EXPECT_THAT(ReadModel("<link name=\"l\" " + Numbered("a:b", "=\"1\" ", 1000) + "/>"),
              HasSubstr("at most 64 attributes"));
}

TEST(ModelLimits, AModelIsNoLongerThanFourMebibytes) {
  EXPECT_THAT(ReadModel(std::string(5u << 20, ' ')), HasSubstr("at most 4 MiB"));
}

TEST(SearchNames, OnlyScenariosAndWorldsAreFound) {
  const TempFolder folder;
  folder.Write(".env", "TOKEN=secret\n");
  folder.Write("notes.txt", "secret\n");
  folder.Write("lesson.scenario", "[FLOOR]\nsize 4 4 0.1\n");
  folder.Write("room.world", "[FLOOR]\nsize 4 4 0.1\n");
  const SearchPath path{{folder.path()}};
  for (const char* name : {".env", "C:.env", "C:notes.txt", "notes.txt", "c:\\.env"}) {
    EXPECT_FALSE(path.FindScenario(name)) << name;
    EXPECT_FALSE(path.FindWorld(name, folder.path())) << name;
  }
  EXPECT_TRUE(path.FindScenario("lesson"));
  EXPECT_TRUE(path.FindScenario("room.world"));
  EXPECT_TRUE(path.FindWorld("room", folder.path()));
  EXPECT_TRUE(path.FindScenario((folder.path() / "notes.txt").string()));  // an explicit path
}

}  // namespace
}  // namespace coopdyn
