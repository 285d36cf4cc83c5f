// SPDX-License-Identifier: MIT
#include "server/yarp/bottle.h"

#include <gtest/gtest.h>

#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

Bottle Parsed(std::string_view text) {
  const std::optional<Bottle> bottle = ParseBottle(text);
  EXPECT_TRUE(bottle) << text;
  return bottle.value_or(Bottle());
}

std::string Bytes(std::string_view text, YarpDialect dialect = YarpDialect::k3) {
  std::string bytes;
  EncodeBottle(Parsed(text), dialect, bytes);
  return bytes;
}

// The bytes of real programs.
TEST(Bottle, WritesTheBytesOfYarp3) {
  EXPECT_EQ(
      Bytes("1 2.5 \"hello\" (3 4)"),
      Hex("00010000 04000000 01000000 01000000 0a000000 0000000000000440 04000000 05000000 'hello' 01010000 "
          "02000000 03000000 04000000"));
}

TEST(Bottle, WritesTheBytesOfYarp4) {
  EXPECT_EQ(Bytes("1 2.5", YarpDialect::k4),
            Hex("00010000 02000000 01000000 01000000 14000000 0000000000000440"));
}

TEST(Bottle, ItemsOfOneTypeShareTheirTag) {
  EXPECT_EQ(Bytes("get encs"), Hex("04010000 02000000 03000000 'get' 04000000 'encs'"));
  EXPECT_EQ(Bytes("[get] [axes]"), Hex("09010000 02000000 'get_' 'axes'"));
  EXPECT_EQ(Bytes("1.0", YarpDialect::k4), Hex("14010000 01000000 000000000000f03f"));
}

TEST(Bottle, EveryKindOfValueReadsBack) {
  const std::string text =
      "[set] [pos] true false 5000000000 {1 2 255} \"\" \"a \\\"q\\\" b\" ((1) (2.0 x)) 1000.0 -0.0 16 "
      "[null]";
  for (const YarpDialect dialect : {YarpDialect::k3, YarpDialect::k4}) {
    YarpDialect found = dialect;
    const std::optional<Bottle> read = DecodeBottle(Bytes(text, dialect), found);
    ASSERT_TRUE(read);
    EXPECT_EQ(BottleText(*read), text);
  }
}

TEST(Bottle, NumbersTellTheDialect) {
  YarpDialect dialect = YarpDialect::k3;
  EXPECT_TRUE(DecodeBottle(Bytes("1 2.5", YarpDialect::k4), dialect));
  EXPECT_EQ(dialect, YarpDialect::k4);
  EXPECT_TRUE(DecodeBottle(Bytes("1 a", YarpDialect::k3), dialect));  // without numbers: unknown
  EXPECT_EQ(dialect, YarpDialect::k4);
  EXPECT_TRUE(DecodeBottle(Bytes("1 2.5 x", YarpDialect::k3), dialect));
  EXPECT_EQ(dialect, YarpDialect::k3);
}

TEST(Bottle, SmallWholeNumbersAndOldStringsAreRead) {
  YarpDialect dialect = YarpDialect::k3;
  EXPECT_EQ(DecodeBottle(Hex("00010000 03000000 20000000 ff 40000000 feff 04000000 02000000 'a_'"), dialect),
            Parsed("-1 -2 a"));
}

TEST(Bottle, EveryPieceOfABottleIsRefused) {
  const std::string whole = Bytes("1 2.5 hello (3 4) {1 2}");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    YarpDialect dialect = YarpDialect::k3;
    EXPECT_FALSE(DecodeBottle(whole.substr(0, size), dialect)) << size;
  }
  YarpDialect dialect = YarpDialect::k3;
  EXPECT_FALSE(DecodeBottle(whole + "x", dialect));
}

TEST(Bottle, HugeCountsAndSizesAreRefused) {
  YarpDialect dialect = YarpDialect::k3;
  EXPECT_FALSE(DecodeBottle(Hex("00010000 ffffff7f"), dialect));
  EXPECT_FALSE(DecodeBottle(Hex("00010000 ffffffff"), dialect));
  EXPECT_FALSE(DecodeBottle(Hex("04010000 01000000 ffffff7f"), dialect));
  EXPECT_FALSE(DecodeBottle(Hex("04010000 01000000 ffffffff"), dialect));
}

TEST(Bottle, DeepNestingIsRefused) {
  std::string bytes = Hex("00010000 01000000");
  for (int i = 0; i < 100; ++i) bytes += Hex("00010000 01000000");
  bytes += Hex("01000000 01000000");
  YarpDialect dialect = YarpDialect::k3;
  EXPECT_FALSE(DecodeBottle(bytes, dialect));
  EXPECT_FALSE(ParseBottle(std::string(100, '(') + std::string(100, ')')));
}

TEST(Bottle, TextIsReadAsYarpDoes) {
  const Bottle bottle = Parsed("set_velocity 0.2,-5 1e3 0x10 inf a(b)");
  ASSERT_EQ(bottle.size(), 8u);
  EXPECT_EQ(bottle[0], BottleValue{std::string("set_velocity")});
  EXPECT_EQ(bottle[1], BottleValue{0.2});
  EXPECT_EQ(bottle[2], BottleValue{std::int32_t{-5}});
  EXPECT_EQ(bottle[3], BottleValue{1000.0});
  EXPECT_EQ(bottle[4], BottleValue{std::int32_t{16}});
  EXPECT_NE(bottle[5].As<double>(), nullptr);
  EXPECT_EQ(bottle[6], BottleValue{std::string("a")});
}

bool IsOpen(std::string_view text) {
  OpenBottle bottle;
  for (const char c : text) bottle.Take(c);
  return bottle.open();
}

TEST(Bottle, UnfinishedTextIsRefused) {
  for (const char* text : {"(1 2", "\"abc", "{1", "1 (2 (3)"}) {
    EXPECT_FALSE(ParseBottle(text)) << text;
    EXPECT_TRUE(IsOpen(text)) << text;
  }
  EXPECT_FALSE(IsOpen("1 (2) \")\""));
}

TEST(Bottle, StringsThatLookLikeOtherThingsAreQuoted) {
  for (const char* text : {"", "true", "12", "-a", ".5", "inf", "a b", "[ok]", "/robot1"}) {
    const Bottle bottle{{std::string(text)}};
    EXPECT_EQ(BottleText(bottle).front(), '"') << text;
    EXPECT_EQ(Parsed(BottleText(bottle)), bottle) << text;
  }
  EXPECT_EQ(BottleText({{std::string("set_velocity")}}), "set_velocity");
}

TEST(Bottle, StringsAndVocabsAreTheSameWord) {
  EXPECT_EQ(Parsed("[get]")[0].word(), "get");
  EXPECT_EQ(Parsed("get")[0].word(), "get");
  EXPECT_EQ(Parsed("1")[0].word(), "");
}

}  // namespace
}  // namespace coopdyn
