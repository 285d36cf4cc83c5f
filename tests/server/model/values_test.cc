// SPDX-License-Identifier: MIT
#include "server/model/values.h"

#include <gtest/gtest.h>

#include <numbers>

namespace coopdyn {
namespace {

TEST(ParseNumberTest, UnitsStandRightBehindTheNumber) {
  EXPECT_DOUBLE_EQ(ParseNumber("90deg", Quantity::kAngle).value, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(ParseNumber("1.5rad", Quantity::kAngle).value, 1.5);
  EXPECT_DOUBLE_EQ(ParseNumber("20cm", Quantity::kLength).value, 0.2);
  EXPECT_DOUBLE_EQ(ParseNumber("5mm", Quantity::kLength).value, 0.005);
  EXPECT_DOUBLE_EQ(ParseNumber("2M", Quantity::kLength).value, 2);
  EXPECT_DOUBLE_EQ(ParseNumber("500g", Quantity::kMass).value, 0.5);
  EXPECT_DOUBLE_EQ(ParseNumber("10ms", Quantity::kTime).value, 0.01);
  EXPECT_DOUBLE_EQ(ParseNumber("-1e-3", Quantity::kPlain).value, -0.001);
  EXPECT_DOUBLE_EQ(ParseNumber("+.5", Quantity::kPlain).value, 0.5);
}

TEST(ParseNumberTest, UnitOfAnotherQuantityIsAnError) {
  EXPECT_EQ(ParseNumber("20kg", Quantity::kLength).error,
            "'20kg' is not a number with a known unit; units here are m, cm and mm");
  EXPECT_EQ(ParseNumber("2m", Quantity::kPlain).error,
            "'2m' is not a number with a known unit; no unit belongs here");
}

TEST(ParseNumberTest, CommaWithoutSpaceShowsBothReadings) {
  EXPECT_EQ(ParseNumber("0,5", Quantity::kLength).error,
            "'0,5' can be read in two ways: write 0.5 for one number, or 0 5 for two");
  EXPECT_NE(ParseNumber("1,2,3", Quantity::kLength).error.find("1 2 3"), std::string::npos);
}

TEST(ParseNumberTest, NothingNonFinitePasses) {
  for (const char* word :
       {"nan", "inf", "-inf", "+inf", "infinity", "nan(1)", "1e999", "-1e999", "INF", "NaN"}) {
    EXPECT_FALSE(ParseNumber(word, Quantity::kPlain).error.empty()) << word;
    EXPECT_FALSE(ParsePlain(word)) << word;
  }
}

TEST(ParseNumberTest, WordsAreNoNumbers) {
  for (const char* word : {"", "x", "0x10", "--1", "+-1", "1.2.3", "1e", ".", "+", "12 3"}) {
    EXPECT_FALSE(ParseNumber(word, Quantity::kPlain).error.empty()) << word;
  }
}

TEST(FormatNumberTest, ShortAndWithAPoint) {
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(20), "20");
  EXPECT_EQ(FormatNumber(100000), "100000");
  EXPECT_EQ(FormatNumber(0.15 * 3), "0.45");
}

TEST(DidYouMeanTest, FindsSlips) {
  const std::vector<std::string> words = {"position", "orientation", "mass"};
  EXPECT_EQ(Nearest("positon", words), "position");
  EXPECT_EQ(Nearest("MAS", words), "mass");
  EXPECT_EQ(Nearest("oreintation", words), "orientation");
  EXPECT_EQ(Nearest("colour", words), "");
  EXPECT_EQ(Nearest("Orient", words), "orientation");
  EXPECT_EQ(Nearest("or", words), "");
  EXPECT_EQ(DidYouMean("xyzzy", words), "; known are position, orientation and mass");
}

}  // namespace
}  // namespace coopdyn
