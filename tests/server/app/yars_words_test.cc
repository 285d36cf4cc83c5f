// SPDX-License-Identifier: MIT
// The options of YARS as those of coopdyn serve.
#include "server/app/yars_words.h"

#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using Words = std::vector<std::string>;

YarsWords Read(const Words& words) {
  return ReadYarsWords(words);
}

TEST(YarsWordsTest, AnExperimentRunsAsFastAsItGoesAndWaitsForItsPrograms) {
  EXPECT_EQ(Read({"--xml", "a.xml"}).serve,
            (Words{"a.xml", "--channel-quits", "--mode", "lockstep", "--speed", "0"}));
}

TEST(YarsWordsTest, TheFileMayStandAlone) {
  EXPECT_EQ(Read({"a.xml"}).serve.front(), "a.xml");
  EXPECT_EQ(Read({"-d", "a.xml"}).serve.front(), "a.xml");
  EXPECT_EQ(Read({"-"}).serve.front(), "/dev/stdin");
}

TEST(YarsWordsTest, IterationsAreSteps) {
  const Words serve = Read({"--iterations", "1000", "-"}).serve;
  EXPECT_EQ(Words(serve.end() - 2, serve.end()), (Words{"--steps", "1000"}));
  const Words faster = Read({"--simfreq", "200", "--iterations=1000", "a.xml"}).serve;
  EXPECT_EQ(Words(faster.end() - 4, faster.end()), (Words{"--step", "0.005", "--steps", "1000"}));
}

TEST(YarsWordsTest, RealtimeMayHaveAFactor) {
  EXPECT_EQ(Read({"a.xml", "--realtime"}).serve,
            (Words{"a.xml", "--channel-quits", "--mode", "realtime", "--speed", "1"}));
  EXPECT_EQ(Read({"--realtime=2", "a.xml"}).serve.back(), "2");
  EXPECT_EQ(Read({"--realtime", "a.xml"}).serve.back(), "1");
  EXPECT_NE(Read({"--realtime=0", "a.xml"}).error, "");
}

TEST(YarsWordsTest, OptionsOfYarsBecomeOurs) {
  const Words serve =
      Read({"--xml", "a.xml", "--nogui", "--seed", "7", "--printComPortsToFile", "ports"}).serve;
  EXPECT_EQ(Words(serve.begin() + 6, serve.end()),
            (Words{"--no-render", "--no-http", "--seed", "7", "--channel-ports-to", "ports"}));
}

TEST(YarsWordsTest, WhatChangesNothingIsSaid) {
  const YarsWords read = Read({"a.xml", "--textures", "folder", "--captureVideo"});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.notes.size(), 2u);
}

TEST(YarsWordsTest, WrongWordsSayWhatToWrite) {
  EXPECT_NE(Read({}).error.find("--xml experiment.xml"), std::string::npos);
  EXPECT_NE(Read({"a.xml", "--sed", "7"}).error.find("did you mean"), std::string::npos);
  EXPECT_NE(Read({"a.xml", "b.xml"}).error, "");
  EXPECT_NE(Read({"a.xml", "--seed"}).error.find("needs a value"), std::string::npos);
}

}  // namespace
}  // namespace coopdyn
