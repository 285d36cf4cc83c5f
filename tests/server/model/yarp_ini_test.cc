// SPDX-License-Identifier: MIT
// .ini files of YARP's plug-ins for Gazebo, and boards of several files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "server/model/yarp_ini.h"

namespace coopdyn::yarp_inis {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Strings = std::vector<std::string>;

std::vector<YarpBoard> BoardsOf(const Strings& texts, Strings& left_out) {
  std::vector<YarpIni> inis;
  for (const std::string& text : texts) inis.push_back(ParseYarpIni(text));
  return YarpBoardsOf(inis, left_out);
}
std::vector<YarpBoard> BoardsOf(const Strings& texts) {
  Strings left_out;
  auto boards = BoardsOf(texts, left_out);
  EXPECT_THAT(left_out, IsEmpty());
  return boards;
}

TEST(YarpIniTest, ADeviceIsABoardOfItsJoints) {
  const auto boards =
      BoardsOf({"disableImplicitNetworkWrapper\r\n"
                "yarpDeviceName torso_hardware_device\r\n"
                "#jointNames list\r\n"
                "jointNames yaw roll pitch  # three\r\n"
                "[POSITION_CONTROL]\r\nkp 1 2 3\r\n"});
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_EQ(boards[0].name, "torso");
  EXPECT_THAT(boards[0].joints, ElementsAre("yaw", "roll", "pitch"));
}

TEST(YarpIniTest, AWrapperNamesTheBoardWithoutTheRobot) {
  const auto boards =
      BoardsOf({"[include \"robot.ini\"]\n[WRAPPER]\nname /${gazeboYarpPluginsRobotName}/head\n"
                "joints 2\nnetworks ( neck )\nneck 0 1 0 1\n[neck]\njointNames (a b)\n"
                "name neck\n"});
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_EQ(boards[0].name, "head");
  EXPECT_THAT(boards[0].joints, ElementsAre("a", "b"));
}

TEST(YarpIniTest, ABoardHasPartsOfDevicesInTheOrderOfTheBoard) {
  const auto boards =
      BoardsOf({"[WRAPPER]\nname /r/arm\nnetworks (upper hand)\nhand 2 3 1 2\nupper 0 1 0 1\n"
                "[hand]\njointNames h0 h1 h2\n[upper]\njointNames u0 u1\n"});
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_THAT(boards[0].joints, ElementsAre("u0", "u1", "h1", "h2"));
}

TEST(YarpIniTest, ADeviceMayStandInAnotherFile) {
  Strings left_out;
  const auto boards =
      BoardsOf({"[WRAPPER]\nname /r/upper\nnetworks (upper)\nupper 0 1 0 1\n[upper]\njointNames u0 u1\n",
                "[WRAPPER]\nname /r/arm\nnetworks (upper hand)\nupper 0 1 0 1\nhand 2 2 0 0\n"
                "[hand]\njointNames h0\n"},
               left_out);
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_EQ(boards[0].name, "arm");
  EXPECT_EQ(boards[0].ini, 1u);
  EXPECT_THAT(boards[0].joints, ElementsAre("u0", "u1", "h0"));
  EXPECT_THAT(left_out, ElementsAre("upper"));  // the wider board has its joints
}

TEST(YarpIniTest, CoupledJointsAreThereThemselves) {
  const auto boards =
      BoardsOf({"[WRAPPER]\nname /r/hand\nnetworks (fingers)\nfingers 0 0 0 0\n"
                "[COUPLING]\nicub_hand (0 1) (both)\n[fingers]\njointNames f0 f1\n"});
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_THAT(boards[0].joints, ElementsAre("f0", "f1"));
}

TEST(YarpIniTest, WrongRangesTakeWhatIsThere) {
  const auto boards =
      BoardsOf({"[WRAPPER]\nname /r/a\nnetworks (d)\nd 0 9 1 99\n[d]\njointNames j0 j1 j2\n"});
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_THAT(boards[0].joints, ElementsAre("j1", "j2"));
  EXPECT_THAT(
      BoardsOf({"[WRAPPER]\nname /r/a\nnetworks (d)\nd 0 -1 nan 1e99\n[d]\njointNames j0\n"})[0].joints,
      ElementsAre("j0"));
}

TEST(YarpIniTest, WhatSaysNothingMakesNoBoard) {
  for (const char* text :
       {"", "[", "[]", "]", "[WRAPPER]\nname\nnetworks\n", "jointNames", "()\n\"\n", "\xff\xfe"}) {
    Strings left_out;
    EXPECT_THAT(BoardsOf({text}, left_out), IsEmpty()) << text;
  }
}

TEST(YarpIniTest, ALongTextHasNoMoreJointsThanARobot) {
  std::string text = "[d]\njointNames";
  for (int i = 0; i < 20000; ++i) text += " j" + std::to_string(i);
  text += "\n[WRAPPER]\nnetworks";
  for (int i = 0; i < 20000; ++i) text += " d";
  EXPECT_EQ(BoardsOf({text + "\n"})[0].joints.size(), 300u);
}

TEST(YarpIniTest, AnyBytesAreRead) {
  const std::string good =
      "[WRAPPER]\nname /r/a\nnetworks (d e)\nd 0 1 0 1\n[d]\njointNames j0 j1\n[COUPLING]\nx (0) (1)\n";
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int k = 0; k < 5; ++k) text[random() % text.size()] = static_cast<char>(random());
    Strings left_out;
    for (const YarpBoard& board : BoardsOf({text, good}, left_out)) EXPECT_FALSE(board.joints.empty());
  }
}

}  // namespace
}  // namespace coopdyn::yarp_inis
