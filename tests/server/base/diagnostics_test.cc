// SPDX-License-Identifier: MIT
#include "server/base/diagnostics.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <string>

namespace coopdyn {
namespace {

TEST(Diagnostics, PrintFileLineAndLevel) {
  Diagnostics diagnostics;
  diagnostics.Error({"a.world", 3}, "no such word");
  diagnostics.Warning({"b.scenario", 0}, "odd");
  EXPECT_EQ(diagnostics.ToString(), "a.world:3: error: no such word\nb.scenario: warning: odd\n");
}

TEST(Diagnostics, WhatIsMendedNotedOrLeftOutIsPrintedAsAWarningAndKeepsItsLevel) {
  Diagnostics diagnostics;
  diagnostics.Mended({"a", 1}, "no mass: 10 g");
  diagnostics.Note({"a", 2}, "it is not drawn");
  diagnostics.LeftOut({"a", 3}, "<kp> in <link>", 3);
  Diagnostics all;
  all.Append(diagnostics);
  EXPECT_EQ(all.ToString(),
            "a:1: warning: no mass: 10 g\na:2: warning: it is not drawn\n"
            "a:3: warning: <kp> in <link> is not used by coopdyn (also 2 more times)\n");
  EXPECT_EQ(all.warnings(), 3);
  ASSERT_EQ(all.all().size(), 3u);
  EXPECT_EQ(all.all()[0].level, Diagnostic::Level::kMended);
  EXPECT_EQ(all.all()[1].level, Diagnostic::Level::kNote);
  EXPECT_EQ(all.all()[2].level, Diagnostic::Level::kWarning);
  EXPECT_EQ(all.all()[2].what, "<kp> in <link>");
  EXPECT_EQ(all.all()[2].count, 3);
}

TEST(Diagnostics, WarningsAreNoErrors) {
  Diagnostics diagnostics;
  diagnostics.Warning({"a", 1}, "odd");
  EXPECT_FALSE(diagnostics.has_errors());
  Diagnostics more;
  more.Error({"a", 2}, "wrong");
  diagnostics.Append(more);
  EXPECT_EQ(diagnostics.errors(), 1);
}

TEST(Diagnostics, KeepTheFirstHundredAndCountTheRest) {
  Diagnostics diagnostics;
  for (int line = 1; line <= 500; ++line) diagnostics.Error({"a", line}, "wrong");
  diagnostics.Warning({"a", 501}, "odd");
  EXPECT_EQ(diagnostics.all().size(), Diagnostics::kMaxKept + 1);
  EXPECT_EQ(diagnostics.errors(), 500);
  EXPECT_EQ(diagnostics.warnings(), 1);
  const std::string text = diagnostics.ToString();
  EXPECT_NE(text.find("a:100: error: wrong\nand 400 more errors, 1 more warning\n"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("a:101"), std::string::npos);
}

TEST(Diagnostics, KeepTheFirstLinesOfTheirFileWhateverWasFoundFirst) {
  Diagnostics diagnostics("a");
  diagnostics.Error({"b", 1}, "elsewhere");
  for (int line = 300; line >= 1; --line) diagnostics.Error({"a", line}, "wrong");
  EXPECT_EQ(diagnostics.all().front().where.line, 1);
  EXPECT_EQ(diagnostics.all().back().where.line, 100);
  EXPECT_EQ(diagnostics.errors(), 301);
}

TEST(Diagnostics, WhatMattersIsKeptRatherThanNotes) {
  Diagnostics diagnostics;
  for (int line = 1; line <= 5000; ++line) diagnostics.Note({"a", line}, "looks");
  for (int line = 1; line <= 150; ++line) diagnostics.Warning({"b", line}, "odd");
  EXPECT_LT(diagnostics.all().size(), 5000u);
  EXPECT_EQ(std::ranges::count(diagnostics.all(), Diagnostic::Level::kWarning, &Diagnostic::level), 150);
  EXPECT_NE(diagnostics.ToString().find("and 5050 more warnings\n"), std::string::npos);
}

TEST(Diagnostics, AnErrorIsKeptRatherThanAWarning) {
  Diagnostics diagnostics;
  for (int line = 1; line <= 300; ++line) diagnostics.Warning({"a", line}, "odd");
  diagnostics.Error({"a", 301}, "wrong");
  diagnostics.Warning({"a", 302}, "odd");
  const std::string text = diagnostics.ToString();
  EXPECT_NE(text.find("a:99: warning: odd\na:301: error: wrong\nand 202 more warnings\n"), std::string::npos)
      << text;
}

TEST(Diagnostics, AppendedOnesAreCountedToo) {
  Diagnostics first, second;
  for (int line = 1; line <= 150; ++line) first.Error({"a", line}, "wrong");
  for (int line = 1; line <= 150; ++line) second.Error({"b", line}, "wrong");
  first.Append(second);
  EXPECT_EQ(first.errors(), 300);
  EXPECT_EQ(first.all().size(), Diagnostics::kMaxKept);
}

TEST(Diagnostics, SayWhereAReaderGaveUp) {
  Diagnostics diagnostics;
  int line = 1;
  while (!diagnostics.StopAt({"a", line})) diagnostics.Error({"a", line++}, "wrong");
  EXPECT_LT(line, 2000);
  EXPECT_TRUE(diagnostics.ToString().ends_with("a:" + std::to_string(line) + ": the rest was not read\n"));
}

TEST(Diagnostics, ShowNothingThatDrivesATerminal) {
  Diagnostics diagnostics;
  diagnostics.Error({"a\x1b[2J\n", 1}, "unknown word '\x1b[31m" + std::string(5000, 'x') + "'");
  const std::string text = diagnostics.ToString();
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_LT(text.size(), 1200u);
  EXPECT_EQ(text.find('\n'), text.size() - 1);
}

}  // namespace
}  // namespace coopdyn
