// SPDX-License-Identifier: MIT
#include "protocol/text_scan.h"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <random>

#include "protocol/codec.h"

namespace coopdyn {
namespace {

std::string Print(double value) {
  std::string text;
  AppendDouble(value, text);
  return text;
}

double Read(std::string_view text) {
  double value = -12345;
  EXPECT_EQ(ReadDouble(text, value), NumberRead::kOk) << text;
  return value;
}

TEST(TextNumbers, RandomDoublesReadBackBitForBit) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 100000; ++round) {
    const double value = std::bit_cast<double>(random());
    if (std::isnan(value)) continue;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(Read(Print(value))), std::bit_cast<std::uint64_t>(value));
  }
}

TEST(TextNumbers, DoublesShowThatTheyAre) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 10000; ++round) {
    const std::string text = Print(std::bit_cast<double>(random()));
    EXPECT_NE(text.find_first_of(".en"), std::string::npos) << text;
  }
  EXPECT_EQ(Print(2), "2.0");
  EXPECT_EQ(Print(-0.0), "-0.0");
  EXPECT_EQ(Print(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(Print(-std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(TextNumbers, AcceptsTheGrammar) {
  EXPECT_EQ(Read("1"), 1);
  EXPECT_EQ(Read("+1."), 1);
  EXPECT_EQ(Read("-.5"), -0.5);
  EXPECT_EQ(Read("1.5e3"), 1500);
  EXPECT_EQ(Read("1.E+3"), 1000);
  EXPECT_EQ(Read(".5e-1"), 0.05);
  EXPECT_EQ(Read("0001"), 1);
  EXPECT_EQ(Read("+iNf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(Read("-INF"), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(Read("-NaN")));
}

TEST(TextNumbers, RefusesEverythingElse) {
  for (const char* text :
       {"",      "+",        "-",      ".",   "+.",  "e5", "1e", "1e+", "1e1.5", "1.2.3", "0x10",
        "1_000", "infinity", "nan(1)", "++1", "+-1", "1 ", " 1", "1f",  "1,5",   "١"}) {
    double value = 0;
    EXPECT_EQ(ReadDouble(text, value), NumberRead::kNotNumber) << text;
  }
}

TEST(TextNumbers, DigitsTooSmallForADoubleGiveZeroAndTooLargeOnesAreRefused) {
  EXPECT_EQ(Read("1e-999"), 0);
  EXPECT_TRUE(std::signbit(Read("-1e-999")));
  EXPECT_EQ(Read("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(Read("1e-99999999999999999999"), 0);
  EXPECT_EQ(Read("0e99999999999999999999"), 0);
  for (const std::string& text : {std::string("1e999"), std::string("-1e309"), "1" + std::string(400, '0'),
                                  std::string("1e99999999999999999999")}) {
    double value = 0;
    EXPECT_EQ(ReadDouble(text, value), NumberRead::kOutOfRange) << text;
  }
}

TEST(TextNumbers, IntegersAreInt32WithoutPoint) {
  std::int32_t value = 0;
  EXPECT_EQ(ReadInt32("-2147483648", value), NumberRead::kOk);
  EXPECT_EQ(value, std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(ReadInt32("+2147483647", value), NumberRead::kOk);
  EXPECT_EQ(value, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(ReadInt32("2147483648", value), NumberRead::kOutOfRange);
  EXPECT_EQ(ReadInt32("-2147483649", value), NumberRead::kOutOfRange);
  EXPECT_EQ(ReadInt32(std::string(1000, '9'), value), NumberRead::kOutOfRange);
  EXPECT_EQ(ReadInt32("1.0", value), NumberRead::kHasPoint);
  EXPECT_EQ(ReadInt32("1e3", value), NumberRead::kHasPoint);
  EXPECT_EQ(ReadInt32("inf", value), NumberRead::kHasPoint);
  EXPECT_EQ(ReadInt32("x", value), NumberRead::kNotNumber);
  EXPECT_EQ(ReadInt32("", value), NumberRead::kNotNumber);
  EXPECT_EQ(ReadInt32("+-1", value), NumberRead::kNotNumber);
}

/// A decimal comma, dots between thousands; the C++ locale, and the C locale where the system has one.
class CommaLocale {
 public:
  CommaLocale() : c_before_(std::setlocale(LC_ALL, nullptr)) {
    class Comma : public std::numpunct<char> {
      char do_decimal_point() const override { return ','; }
      char do_thousands_sep() const override { return '.'; }
      std::string do_grouping() const override { return "\3"; }
    };
    before_ = std::locale::global(std::locale(std::locale(), new Comma));
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
      if (std::setlocale(LC_ALL, name) != nullptr) break;
    }
  }
  ~CommaLocale() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, c_before_.c_str());
  }

 private:
  std::string c_before_;
  std::locale before_;
};

TEST(TextNumbers, TheLocaleDoesNotMatter) {
  const CommaLocale locale;
  EXPECT_EQ(Print(1234567.5), "1234567.5");
  EXPECT_EQ(Read("1234567.5"), 1234567.5);
  double value = 0;
  EXPECT_EQ(ReadDouble("0,5", value), NumberRead::kNotNumber);
  std::string line;
  EncodeText({.error = 0, .text = "", .command = 11111, .params = {123456}, .data = {0.5}}, line);
  EXPECT_EQ(line, "0 \"\" 11111 1 123456 1 0.5\n");
}

TEST(TextNumbers, LongTokensAreCutInMessagesAtACharacter) {
  const std::string quoted = Quoted(std::string(39, 'a') + "€€€");
  EXPECT_EQ(quoted, "'" + std::string(39, 'a') + "…'");
  EXPECT_TRUE(IsCleanUtf8(NotANumber(std::string(100000, '1') + "x")));
}

}  // namespace
}  // namespace coopdyn
