// SPDX-License-Identifier: MIT
// The options of YARS, translated to those of coopdyn serve.
#include "server/app/yars_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace coopdyn {
namespace {

using Words = std::vector<std::string>;

YarsWords Read(const Words& words) {
  return ReadYarsWords(words);
}

TEST(YarsWordsTest, AnExperimentRunsAsFastAsItGoesAndWaitsForItsPrograms) {
  EXPECT_EQ(Read({"--xml", "a.xml"}).serve,
            (Words{"a.xml", "--channel-quits", "--any-port", "--mode", "lockstep", "--speed", "0"}));
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
            (Words{"a.xml", "--channel-quits", "--any-port", "--mode", "realtime", "--speed", "1"}));
  EXPECT_EQ(Read({"--realtime=2", "a.xml"}).serve.back(), "2");
  EXPECT_EQ(Read({"--realtime", "a.xml"}).serve.back(), "1");
  EXPECT_NE(Read({"--realtime=0", "a.xml"}).error, "");
}

TEST(YarsWordsTest, OptionsOfYarsBecomeOurs) {
  const Words serve =
      Read({"--xml", "a.xml", "--nogui", "--seed", "7", "--printComPortsToFile", "ports"}).serve;
  EXPECT_EQ(Words(serve.begin() + 7, serve.end()),
            (Words{"--no-render", "--no-http", "--seed", "7", "--channel-ports-to", "ports"}));
}

TEST(YarsWordsTest, AGivenPortIsTheOnlyOne) {
  const Words serve = Read({"a.xml", "--port", "12000"}).serve;
  EXPECT_EQ(std::ranges::count(serve, "--any-port"), 0);
}

TEST(YarsWordsTest, DebugMayHaveALevel) {
  for (const auto& [words, level] : {std::pair(Words{"--debug", "a.xml"}, "debug"),
                                     {{"a.xml", "--debug"}, "debug"},
                                     {{"a.xml", "--debug", "info"}, "info"},
                                     {{"a.xml", "--debug=silent"}, "off"}}) {
    const YarsWords read = Read(words);
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(Words(read.serve.end() - 2, read.serve.end()), (Words{"--log-level", level}));
  }
  EXPECT_EQ(Read({"a.xml", "--debug=loud"}).error, "--debug takes debug, info or silent, not loud");
}

// From the public YARS's --help; --noctrl and --config would change much.
TEST(YarsWordsTest, NoOptionOfYarsIsWrong) {
  for (const Words& option : std::vector<Words>{{"--textures", "a"},
                                                {"--lib", "a"},
                                                {"--iterations", "5"},
                                                {"--writeConfig"},
                                                {"--simfreq", "100"},
                                                {"--seed", "1"},
                                                {"--ctrlfreq", "25"},
                                                {"--realtime"},
                                                {"--texture"},
                                                {"--synched"},
                                                {"--nogui"},
                                                {"--trace"},
                                                {"--follow"},
                                                {"--osd"},
                                                {"--geometry", "a"},
                                                {"--pause"},
                                                {"--captureName", "a"},
                                                {"--captureFrameRate", "5"},
                                                {"--captureDirectory", "a"},
                                                {"--capture"},
                                                {"--vcodec", "a"},
                                                {"--framesDirectory", "a"},
                                                {"--debug", "info"},
                                                {"--silent"},
                                                {"--cr"},
                                                {"--printTime"},
                                                {"--printRobotConfiguration"},
                                                {"--printConfig"},
                                                {"--printKeyboardShortcuts"},
                                                {"--log", "a"}}) {
    Words words = {"--xml", "a.xml"};
    words.insert(words.end(), option.begin(), option.end());
    EXPECT_EQ(Read(words).error, "") << option.front();
  }
}

TEST(YarsWordsTest, WhatYarsTellsInsteadOfARunIsTold) {
  for (const char* option : {"--help", "--version", "--license", "--list", "--export=xsd"}) {
    const YarsWords read = Read({option});
    EXPECT_EQ(read.error, "") << option;
    EXPECT_NE(read.told, "") << option;
  }
  EXPECT_NE(Read({"--xml", "a.xml", "--list", "follow"}).told, "");
}

TEST(YarsWordsTest, WhatChangesNothingIsSaid) {
  const YarsWords read = Read({"a.xml", "--textures", "folder", "--captureVideo"});
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.notes.size(), 2u);
}

TEST(YarsWordsTest, WhatWouldChangeMuchIsAnErrorThatSaysWhatToWrite) {
  EXPECT_NE(Read({"a.xml", "--noctrl"}).error.find("--set ROBOT_1.controller="), std::string::npos);
  EXPECT_NE(Read({"--config", "b.cfg", "a.xml"}).error.find("coopdyn serve FILE --config OPTIONS"),
            std::string::npos);
  EXPECT_NE(YarsHelp().find("--noctrl and --config are errors"), std::string::npos);
}

TEST(YarsWordsTest, AWrongNumberIsToldByTheOptionThatWasWritten) {
  for (const char* number : {"abc", "0", "-1", "1.5", "2000000000", ""}) {
    EXPECT_EQ(
        Read({"a.xml", "--iterations", number}).error,
        std::string("--iterations must be a whole number of steps from 1 to 1,000,000,000, not ") + number);
  }
  for (const char* number : {"abc", "0", "9.9", "2001", "1e9"}) {
    EXPECT_EQ(Read({"a.xml", "--simfreq", number}).error,
              std::string("--simfreq must be from 10 to 2000 steps a second, not ") + number);
  }
  const Words most = Read({"a.xml", "--iterations", "1000000000"}).serve;
  EXPECT_EQ(most.back(), "1000000000");
}

TEST(YarsWordsTest, AStepIsRoundedAsThatOfAnExperiment) {
  const YarsWords read = Read({"a.xml", "--simfreq", "33"});
  EXPECT_EQ(read.serve.back(), "0.030303");
  ASSERT_EQ(read.notes.size(), 1u);
  EXPECT_NE(read.notes.front().find("it is 30303 µs"), std::string::npos);
  EXPECT_EQ(Read({"a.xml", "--simfreq", "10"}).serve.back(), "0.1");
  EXPECT_EQ(Read({"a.xml", "--simfreq", "2000"}).serve.back(), "0.0005");
}

TEST(YarsWordsTest, WrongWordsSayWhatToWrite) {
  EXPECT_NE(Read({}).error.find("--xml experiment.xml"), std::string::npos);
  EXPECT_NE(Read({"a.xml", "--sed", "7"}).error.find("did you mean"), std::string::npos);
  EXPECT_NE(Read({"a.xml", "b.xml"}).error, "");
  EXPECT_NE(Read({"a.xml", "--seed"}).error.find("needs a value"), std::string::npos);
}

}  // namespace
}  // namespace coopdyn
