// SPDX-License-Identifier: MIT
// The syntax shared by both files: products of editors and habits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/text_file.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

/// The only object of `text`, which must be valid.
WorldObject Only(const std::string& text) {
  const auto [world, messages] = ReadWorldText(text);
  EXPECT_EQ(messages, "") << text;
  EXPECT_EQ(world.objects.size(), 1u) << text;
  return world.objects.empty() ? WorldObject() : world.objects[0];
}

TEST(FormTest, EqualsSignOrColonMayFollowAKey) {
  for (const char* text :
       {"[B]\ntype=box\nsize = 1 2 3\nposition =0 0 4\n", "[B]\ntype: box\nsize:1 2 3\nposition : 0 0 4\n"}) {
    EXPECT_EQ(Only(text).X_WO.p.z(), 4);
    EXPECT_EQ(std::get<Box>(Only(text).shape).size_m, Vector3(1, 2, 3));
  }
}

TEST(FormTest, CommaWithASpaceSeparatesNumbers) {
  EXPECT_EQ(Only("[B]\ntype box\nsize 1, 2, 3\nposition 1 , 2 , 3\n").X_WO.p, Vector3(1, 2, 3));
}

TEST(FormTest, CommaWithoutASpaceIsAnErrorThatShowsBothReadings) {
  const std::string messages = ReadWorldText("[B]\ntype box\nsize 1 1 1\nposition 0,5 1\n").messages;
  EXPECT_EQ(
      messages,
      "test.world:4: error: 'position': '0,5' can be read in two ways: write 0.5 for one number, or 0 5 for "
      "two\n");
}

TEST(FormTest, CommaWithNothingBehindIsAnError) {
  EXPECT_THAT(ReadWorldText("[B]\ntype box\nsize 1, 1, 1,\nposition 0 0\n").messages,
              HasSubstr("missing after ','"));
  EXPECT_THAT(ReadWorldText("[B]\ntype box\nsize 1, , 1 1\nposition 0 0\n").messages,
              HasSubstr("missing before ','"));
}

TEST(FormTest, WordsAreCaseInsensitive) {
  EXPECT_EQ(Only("[Wall_1]\nTYPE Box\nSize 1 2 3\nPosition 0 0 9\n").name, "Wall_1");
}

TEST(FormTest, CommentsStartALineOrFollowASpace) {
  EXPECT_EQ(
      Only("# one\n; two\n[B] # three\ntype box ; four\n\t# five\nsize 1 1 1 #six\nposition 0 0 7\t;seven\n")
          .X_WO.p.z(),
      7);
}

TEST(FormTest, WindowsAndOldMacLineEnds) {
  EXPECT_EQ(Only("[B]\r\ntype box\r\nsize 1 1 1\r\nposition 0 0 7\r\n").X_WO.p.z(), 7);
  EXPECT_EQ(Only("[B]\rtype box\rsize 1 1 1\rposition 0 0 7\r").X_WO.p.z(), 7);
  EXPECT_THAT(ReadWorldText("\r\n\r\n[B]\r\nbad 1\r\n").messages,
              HasSubstr("test.world:4: error: unknown word 'bad'"));
}

TEST(FormTest, TabsAndSpacesSeparate) {
  EXPECT_EQ(Only("\t[ B ]\n \ttype\t\tbox\nsize\t1\t1  1\nposition\t 0 0\t7 \t\n").X_WO.p.z(), 7);
}

TEST(FormTest, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(Only("\xEF\xBB\xBF[B]\ntype box\nsize 1 1 1\nposition 0 0 7\n").X_WO.p.z(), 7);
}

TEST(FormTest, Latin1BecomesUtf8) {
  const auto [world, messages] =
      ReadWorldText("# m\xF3vel\n[M\xD3VEL]\ntype box\nsize 1 1 1\nposition 0 0\n");
  EXPECT_EQ(messages, "");
  EXPECT_EQ(world.objects.at(0).name, "M\xC3\x93VEL");
  EXPECT_THAT(world.text, HasSubstr("m\xC3\xB3vel"));
}

TEST(FormTest, Utf16IsNamed) {
  EXPECT_THAT(ReadWorldText(std::string("\xFF\xFE[\0F\0", 6)).messages, HasSubstr("save it as UTF-8"));
  EXPECT_THAT(ReadWorldText(std::string("[F]\n\0\n", 6)).messages,
              HasSubstr("test.world:2: error: there is a NUL"));
}

TEST(FormTest, UnknownWordsAreErrorsWithDidYouMean) {
  EXPECT_EQ(ReadWorldText("[B]\ntype box\nsize 1 1 1\npositon 1 1\nposition 0 0\n").messages,
            "test.world:4: error: unknown word 'positon' in [B]; did you mean 'position'?\n");
}

TEST(FormTest, DuplicateKeysAreErrors) {
  EXPECT_EQ(ReadWorldText("[B]\ntype box\nsize 1 1 1\nposition 0 0\nsize 2 2 2\n").messages,
            "test.world:5: error: 'size' stands twice in [B] (first in line 3): keep one\n");
  EXPECT_THAT(ReadWorldText("[B]\ntype box\nsize 1 1 1\nposition 0 0\ncolor red\ncolour red\n").messages,
              HasSubstr("stands twice"));
}

TEST(FormTest, RepeatedSectionsAreErrors) {
  const std::string box = "type box\nsize 1 1 1\nposition 0 0\n";
  EXPECT_THAT(ReadWorldText("[B_1]\n" + box + "[b_1]\n" + box).messages,
              HasSubstr("test.world:5: error: [b_1] stands here twice (first in line 1)"));
  EXPECT_EQ(ReadWorldText("[B]\n" + box + "[B_1]\n" + box).messages, "");
}

TEST(FormTest, BrokenHeadersAreErrors) {
  EXPECT_THAT(ReadWorldText("[B\ntype box\nsize 1 1 1\nposition 0 0\n").messages,
              HasSubstr(":1: error: ']' is missing"));
  EXPECT_THAT(ReadWorldText("[]\n").messages, HasSubstr(":1: error: a section's name"));
  EXPECT_THAT(ReadWorldText("[A B]\n").messages, HasSubstr(":1: error: a section's name"));
  EXPECT_THAT(ReadWorldText("[B] x\n").messages, HasSubstr(":1: error: nothing may follow"));
  EXPECT_THAT(ReadWorldText("size 1 1\n").messages, HasSubstr(":1: error: 'size' stands before the first"));
  EXPECT_THAT(ReadWorldText("[B]\n= 1\n").messages, HasSubstr(":2: error: a line starts with a word"));
}

TEST(FormTest, TenThousandSectionsAreRead) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) {
    text += "[W_" + std::to_string(i) + "]\ntype box\nsize 1 1 1\nposition " + std::to_string(i) + " 0\n";
  }
  EXPECT_EQ(ReadWorldText(text).world.objects.size(), 10'000u);
}

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) lines.push_back(TakeLine(text));
  return lines;
}

TEST(TakeLineTest, AnyLineEnd) {
  EXPECT_THAT(LinesOf("a\nb\r\nc\rd"), ::testing::ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(LinesOf("a\n\n"), ::testing::ElementsAre("a", ""));
  EXPECT_TRUE(LinesOf("").empty());
}

}  // namespace
}  // namespace coopdyn
