// SPDX-License-Identifier: MIT
#include "server/naming/run_names.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

TEST(RunNames, AnyLettersButNothingThatLeadsElsewhereOrBreaksALine) {
  for (const char* name : {"lesson1.run", "my lesson ü.run", "~'\"%#?.run", "a..b.run", " .run"}) {
    EXPECT_TRUE(IsRunName(name)) << name;
    EXPECT_EQ(RunNameObjection(name), "") << name;
  }
  using namespace std::string_view_literals;
  for (const std::string_view name : {""sv, ".run"sv, "..run"sv, "-x.run"sv, "a/b.run"sv, "a\nb.run"sv,
                                      "a\x7f.run"sv, "a\0b.run"sv, "a\xff.run"sv}) {
    EXPECT_FALSE(IsRunName(name)) << name;
    EXPECT_NE(RunNameObjection(name), "") << name;
  }
}

TEST(RunNames, LaterFilesOfTheLongestNameAreServedToo) {
  const std::string longest(kMaxRunName, 'a');
  EXPECT_EQ(RunNameObjection(longest + ".run"), "");
  EXPECT_NE(RunNameObjection(longest + "b.run"), "");
  EXPECT_TRUE(IsRunName(longest + "-2.run"));
}

TEST(RunNames, OnlyAPageHasRunsAndThatByTheirNames) {
  EXPECT_EQ(RunUrl("http://[::1]:1/", "a b.run"), "http://[::1]:1/runs/a%20b.run");
  EXPECT_EQ(RunUrl("", "a.run"), "");
  EXPECT_EQ(RunUrl("http://[::1]:1/", "a.db"), "");
  EXPECT_EQ(RunUrl("http://[::1]:1/", ".a.run"), "");
}

TEST(PercentCoding, IsThatOfAddresses) {
  EXPECT_EQ(PercentEncode("aZ09-._~ +/\u00fc%"), "aZ09-._~%20%2B%2F%C3%BC%25");
  EXPECT_EQ(PercentDecode("a%20+%2f%C3%bc"), "a +/\u00fc");
  for (const char* wrong : {"%", "%2", "%zz", "a%"}) EXPECT_FALSE(PercentDecode(wrong)) << wrong;
}

TEST(PercentCoding, GoesThereAndBack) {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  EXPECT_EQ(PercentDecode(PercentEncode(all)), all);
}

}  // namespace
}  // namespace coopdyn
