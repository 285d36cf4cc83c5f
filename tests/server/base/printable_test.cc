// SPDX-License-Identifier: MIT
#include "server/base/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace coopdyn {
namespace {

TEST(Printable, LeavesWordsOfAnyLanguage) {
  EXPECT_EQ(Printable("Größe 20 µm, 机器人"), "Größe 20 µm, 机器人");
}

TEST(Printable, ReplacesControlsAndLineEnds) {
  EXPECT_EQ(Printable("a\x1b[31m\r\n\tb\x7f"), "a?[31m???b?");
  EXPECT_EQ(Printable("\xc2\x9b"), "?");  // CSI in one character
}

TEST(Printable, ReplacesWhatTurnsOrHidesText) {
  EXPECT_EQ(Printable("a\u202Eb\u2066c\u200Bd\uFEFF"), "a?b?c?d?");
}

TEST(Printable, ReplacesWhatIsNoUtf8) {
  EXPECT_EQ(Printable("gr\xfc\xdf"), "gr??");
  EXPECT_EQ(Printable("\xc3"), "?");
  EXPECT_EQ(Printable("\xc0\xaf"), "??");
}

TEST(Printable, CutsBetweenCharactersAndSaysHowLongItWas) {
  EXPECT_EQ(Printable("abcdef", 3), "abc… (6 bytes)");
  EXPECT_EQ(Printable("aßß", 4), "aß… (5 bytes)");
  EXPECT_EQ(Printable("abc", 3), "abc");
}

TEST(Printable, LinesStayLines) {
  EXPECT_EQ(PrintableLines("a\nb\x1b\n"), "a\nb?\n");
}

}  // namespace
}  // namespace coopdyn
