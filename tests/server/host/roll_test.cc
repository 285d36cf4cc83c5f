// SPDX-License-Identifier: MIT
#include "server/host/roll.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

/// Digits that count up, so that every PIN and link differs.
RandomDigits Counting() {
  auto next = std::make_shared<int>(1000);
  const auto digits = [next](std::size_t count) {
    std::string text = std::to_string((*next)++);
    text.insert(0, count - text.size(), '0');
    return text;
  };
  return {digits, digits};
}

Roll Read(std::string_view text, std::string* errors = nullptr) {
  Diagnostics diagnostics;
  Roll roll = ReadRoll(text, "c.csv", Counting(), diagnostics);
  if (errors != nullptr) *errors = diagnostics.ToString();
  return roll;
}

TEST(Roll, ColumnsMayStandInAnyOrderAndLackPins) {
  const Roll roll = Read("group,name\r\n2,Ana Lima\r\n\r\n,Ben\r\n");
  ASSERT_EQ(roll.entries().size(), 2);
  EXPECT_EQ(roll.entries()[0].seat, "ana-lima");
  EXPECT_EQ(roll.entries()[0].name, "Ana Lima");
  EXPECT_EQ(roll.entries()[0].group, "2");
  EXPECT_EQ(roll.entries()[0].pin, "1000");
  EXPECT_EQ(roll.entries()[1].seat, "ben");
  EXPECT_NE(roll.entries()[1].link, roll.entries()[0].link);
}

TEST(Roll, SpreadsheetsOfOtherCountriesSeparateBySemicolons) {
  EXPECT_EQ(Read("name;pin\nAna;7305\n").entries().at(0).pin, "7305");
}

TEST(Roll, QuotedFieldsHoldCommasQuotesAndLines) {
  const Roll roll = Read("name,pin\n\"Lima, \"\"Ana\"\"\",7305\n\"two\nlines\",1234\n");
  ASSERT_EQ(roll.entries().size(), 2);
  EXPECT_EQ(roll.entries()[0].name, "Lima, \"Ana\"");
  EXPECT_EQ(roll.entries()[1].seat, "two-lines");
}

TEST(Roll, WhatItWritesItReadsAgain) {
  const Roll roll = Read("name,pin,group\n\"Lima, Ana\",7305,\"a\"\"b\"\n");
  const Roll again = Read(roll.ToCsv());
  EXPECT_EQ(again.ToCsv(), roll.ToCsv());
  EXPECT_EQ(again.entries().at(0).link, roll.entries().at(0).link);
}

TEST(Roll, AListThatComesAgainKeepsPinsAndLinks) {
  const Roll before = Read("name,pin\nAna,\nBen,1234\nCleo,5555\n");
  Diagnostics diagnostics;
  const RandomDigits other{[](std::size_t n) { return std::string(n, 'f'); },
                           [](std::size_t n) { return std::string(n, '9'); }};
  const Roll again =
      ReadRoll("name,pin\nBen,1234\nAna,\nCleo,6666\nDan,\n", "c.csv", other, diagnostics, before);
  EXPECT_EQ(again.Find("ana")->pin, before.Find("ana")->pin);
  EXPECT_EQ(again.Find("ana")->link, before.Find("ana")->link);
  EXPECT_EQ(again.Find("ben")->link, before.Find("ben")->link);
  EXPECT_NE(again.Find("cleo")->link, before.Find("cleo")->link);  // another PIN, another link
  EXPECT_EQ(again.Find("dan")->pin, "9999");
}

TEST(Roll, AllMistakesAreReportedWithTheirLines) {
  std::string errors;
  Read("name,pin\nAna,12\nBen,1234,x\nCleo,7305\n,\n", &errors);
  EXPECT_NE(errors.find("c.csv:2: error: a PIN has 4 to 16 letters or digits"), std::string::npos) << errors;
  EXPECT_NE(errors.find("c.csv:3: error: this line has 3 fields"), std::string::npos) << errors;
  EXPECT_NE(errors.find("c.csv:5: error: a student needs a name"), std::string::npos) << errors;
}

TEST(Roll, AListWithoutNamesOfColumnsIsRefused) {
  std::string errors;
  EXPECT_TRUE(Read("Ana,7305\n", &errors).entries().empty());
  EXPECT_NE(errors.find("the first line names the columns"), std::string::npos) << errors;
}

TEST(Roll, AQuoteThatIsNotClosedIsReported) {
  std::string errors;
  Read("name,pin\n\"Ana,7305\nBen,1234\n", &errors);
  EXPECT_NE(errors.find("a quote is not closed"), std::string::npos) << errors;
}

TEST(Roll, TwoStudentsOfOneNameHaveTwoSeats) {
  const Roll roll = Read("name\nAna\nAna\n");
  EXPECT_EQ(roll.entries().at(1).seat, "ana2");
}

TEST(Roll, StudentsOfOneNameAreToldApartByTheirPin) {
  const Roll roll = Read("name,pin\nAna Lima,7305\nAna Lima,1234\nBen,1234\n");
  EXPECT_EQ(roll.FindNamed("ana lima", "1234")->seat, "ana-lima2");
  EXPECT_EQ(roll.FindNamed("Ana Lima", "7305")->seat, "ana-lima");
  EXPECT_EQ(roll.FindNamed("ana-lima2", "1234")->seat, "ana-lima2");
  EXPECT_EQ(roll.FindNamed("Ana Lima", "0000")->seat, "ana-lima");
  EXPECT_EQ(roll.FindNamed("Cleo", "1234"), nullptr);
}

TEST(Roll, NamesWithoutLatinLettersAreFoundAsTheyAreWritten) {
  const Roll roll = Read("name,pin\n李明,7305\nليلى,1234\n");
  EXPECT_EQ(roll.FindNamed("李明", "7305")->seat, "student");
  EXPECT_EQ(roll.FindNamed("ليلى", "1234")->seat, "student2");
  EXPECT_EQ(roll.FindNamed("王芳", "7305"), nullptr);
  EXPECT_EQ(roll.FindNamed("", "7305"), nullptr);
}

TEST(Roll, ASeatTwiceIsRefused) {
  std::string errors;
  Read("seat,name\nana,Ana\nana,Other\n", &errors);
  EXPECT_NE(errors.find("c.csv:3: error: the seat ana is there already"), std::string::npos) << errors;
}

TEST(Roll, ALinkIsASecretOfOneSeat) {
  std::string errors;
  Read("name,link\nAna,x\nBen,0123456789abcdef;a\nCleo,0123456789abcdef\nDan,0123456789abcdef\n", &errors);
  EXPECT_NE(errors.find("c.csv:2: error: a link has 16 to 64 letters and digits"), std::string::npos)
      << errors;
  EXPECT_NE(errors.find("c.csv:3: error: a link has 16"), std::string::npos) << errors;
  EXPECT_EQ(errors.find("c.csv:4"), std::string::npos) << errors;
  EXPECT_NE(errors.find("c.csv:5: error: this is the link of cleo"), std::string::npos) << errors;
}

TEST(Roll, EmptyColumnsOfASpreadsheetAreNoMistakeAndMillionsAreRefused) {
  std::string errors;
  EXPECT_EQ(Read("name,,\nAna,,\n", &errors).entries().size(), 1);
  EXPECT_EQ(errors, "");
  Read(std::string(2'000'000, ','), &errors);
  EXPECT_NE(errors.find("there are 2000001 columns"), std::string::npos) << errors;
}

TEST(Roll, ANewPinMakesTheOldLinkInvalid) {
  Roll roll = Read("name,pin\nAna,7305\n");
  const std::string link = roll.entries()[0].link;
  EXPECT_EQ(roll.SetPin("ana", "", Counting()), "");
  EXPECT_NE(roll.entries()[0].link, link);
  EXPECT_NE(roll.SetPin("anna", "", Counting()).find("did you mean ana?"), std::string::npos);
}

TEST(Roll, AClassHasAtMostAFewHundredSeats) {
  const Roll roll = NumberedRoll(static_cast<int>(Roll::kMaxSeats) + 5, Counting());
  EXPECT_EQ(roll.entries().size(), Roll::kMaxSeats);
}

TEST(SeatName, HoldsNoAccentsBlanksOrSlashes) {
  EXPECT_EQ(SeatNameFor("Ana Müller"), "ana-muller");
  EXPECT_EQ(SeatNameFor("  José  Peña/Groß "), "jose-pena-gross");
  EXPECT_EQ(SeatNameFor("../etc"), "etc");
  EXPECT_EQ(SeatNameFor("李明"), "student");
  EXPECT_EQ(SeatNameError(SeatNameFor(std::string(200, 'x'))), "");
}

TEST(SeatName, IsSafeInAFolderAndAnAddress) {
  for (const char* bad : {"", "..", "a/b", "Ana", "-a", "a b", "a%2f", "\xff"})
    EXPECT_NE(SeatNameError(bad), "") << bad;
  for (const char* good : {"ana", "7", "team_2", "a-b"}) EXPECT_EQ(SeatNameError(good), "") << good;
}

}  // namespace
}  // namespace coopdyn
