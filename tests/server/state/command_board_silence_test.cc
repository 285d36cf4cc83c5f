// SPDX-License-Identifier: MIT
// Clients that are connected but silent, in real time: who is silent, and the effect of a robot's watchdog.
#include <gtest/gtest.h>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

class SilenceTest : public CommandBoardTest {
 protected:
  /// Robot 1 drives in `mode` at (2, 2); its client says nothing from now on.
  void Drive(const Client& client, std::optional<double> watchdog_s, Mode mode = Mode::kRealtime,
             std::optional<LossPolicy> on_disconnect = {}) {
    RobotEntry entry = MakeRobot("robot1");
    entry.watchdog_s = watchdog_s;
    entry.on_disconnect = on_disconnect;
    UseEntries({entry});
    board_.InputEnded(slot("robot1"), owner().id);
    board_.SetMode(mode, now_);
    board_.Command(slot("robot1"), client, Wheels(2, 2), {}, Note("client"));
    Step();
  }
  /// As the stepping thread does.
  WheelSpeeds Step() {
    board_.StopSilent(now_);
    return RunStep()[0];
  }
  WheelSpeeds StepAfter(double seconds) {
    now_ += static_cast<Nanoseconds>(seconds * 1e9);
    return Step();
  }
  CommandBoard::Owner owner() const { return board_.Owners()[0]; }

  static constexpr WheelSpeeds kDrives = {2, 2}, kStands = {0, 0};
  const Client remote_{5, "", "192.168.1.7:50000", false, false, {}, {}, true};
};

TEST_F(SilenceTest, ASilentClientsRobotStopsOnceAndStaysItsOwn) {
  Drive(ana_, 2);
  EXPECT_EQ(StepAfter(1.99), kDrives);
  EXPECT_EQ(StepAfter(0.01), kStands);
  ASSERT_EQ(board_.LatchedLosses().size(), 1u);
  const LostClient& loss = board_.LatchedLosses()[0];
  EXPECT_EQ(loss.client, "ana");
  EXPECT_EQ(loss.policy, LossPolicy::kStop);
  EXPECT_EQ(loss.silent, 2 * kSecond);
  EXPECT_EQ(owner().id, ana_.id);
  EXPECT_TRUE(owner().silenced);
  EXPECT_EQ(StepAfter(5), kStands);
  EXPECT_TRUE(board_.LatchedLosses().empty()) << "it is told once";
}

TEST_F(SilenceTest, ItsNextCommandDrivesOn) {
  Drive(ana_, 2);
  StepAfter(2);
  board_.NoteHeard(slot("robot1"), ana_, now_);
  board_.Command(slot("robot1"), ana_, Wheels(2, 2), {}, Note("ana"));
  EXPECT_EQ(Step(), kDrives);
  EXPECT_FALSE(owner().silenced);
  EXPECT_EQ(StepAfter(1.9), kDrives);
  EXPECT_EQ(StepAfter(0.1), kStands);
}

TEST_F(SilenceTest, WithoutAWordOnlyClientsOfOtherMachinesAreWatchedForFiveSeconds) {
  Drive(ana_, {});
  EXPECT_EQ(StepAfter(1000), kDrives);
  Drive(remote_, {});
  EXPECT_EQ(StepAfter(4.99), kDrives);
  EXPECT_EQ(StepAfter(0.01), kStands);
  Drive(remote_, 0);
  EXPECT_EQ(StepAfter(1000), kDrives) << "off";
}

TEST_F(SilenceTest, TheScenariosWordHoldsForRobotsThatSayNothing) {
  RobotEntry own = MakeRobot("robot2");
  own.watchdog_s = 0;
  auto scenario = std::make_shared<Scenario>();
  scenario->simulation.watchdog_s = 1;
  scenario->robots = {MakeRobot("robot1"), own};
  scene_ = MakeScene(scenario);
  board_.Configure(*scene_, StepEnd::kLoad, MakeFrame(0), now_);
  board_.SetMode(Mode::kRealtime, now_);
  board_.Command(slot("robot1"), ana_, Wheels(2, 2), {}, Note("ana"));
  board_.Command(slot("robot2"), bob_, Wheels(2, 2), {}, Note("bob"));
  Step();
  EXPECT_EQ(StepAfter(1), kStands);
  EXPECT_EQ(RunStep()[1], kDrives);
}

TEST_F(SilenceTest, OnlyRealTimeIsWatched) {
  for (const Mode mode : {Mode::kLockstep, Mode::kFree}) {
    Drive(ana_, 1, mode);
    EXPECT_FALSE(owner().heard);
    EXPECT_EQ(StepAfter(10), kDrives) << ToString(mode);
  }
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_EQ(Step(), kDrives);
  EXPECT_EQ(StepAfter(0.9), kDrives) << "silence before does not count";
  EXPECT_EQ(StepAfter(0.1), kStands);
}

TEST_F(SilenceTest, APauseDoesNotCount) {
  Drive(ana_, 1);
  now_ += 10 * kSecond;
  board_.RestartWaiting(now_);
  EXPECT_EQ(Step(), kDrives);
  EXPECT_EQ(StepAfter(1), kStands);
}

TEST_F(SilenceTest, AnyRequestOfTheSameProgramIsASignOfLife) {
  const Client reader{7, "ana:reader", "127.0.0.1:7"}, stranger{8, "bob", "127.0.0.1:8"},
      nameless{9, "", "127.0.0.1:9"};
  for (const Client& client : {ana_, reader}) {
    Drive(ana_, 1);
    now_ += kSecond;
    board_.NoteHeard(slot("robot1"), client, now_);
    EXPECT_EQ(Step(), kDrives) << client.name;
    EXPECT_EQ(owner().heard, now_);
  }
  for (const Client& client : {stranger, nameless}) {
    Drive(ana_, 1);
    now_ += kSecond;
    board_.NoteHeard(slot("robot1"), client, now_);
    EXPECT_EQ(Step(), kStands) << client.name;
  }
}

TEST_F(SilenceTest, WithoutANameAProgramIsToldByItsAddressAndAYarpProgramByItsParty) {
  Drive(remote_, {});
  now_ += 5 * kSecond;
  board_.NoteHeard(slot("robot1"), {6, "", "192.168.1.7:50001"}, now_);
  EXPECT_EQ(Step(), kDrives);
  Client stream{10, "", "192.168.1.8:1", false, false, "/walker", {}, true},
      rpc{11, "", "192.168.1.8:2", false, false, "/walker", {}, true};
  Drive(stream, {});
  now_ += 5 * kSecond;
  board_.NoteHeard(slot("robot1"), rpc, now_);
  EXPECT_EQ(Step(), kDrives);
}

TEST_F(SilenceTest, WhoWaitsForItsStepsIsNotSilent) {
  Drive(ana_, 1);
  board_.Command(slot("robot1"), ana_, Wheels(2, 2), 3, Note("ana"));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(StepAfter(1), kDrives);
  EXPECT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(StepAfter(0.9), kDrives);
  EXPECT_EQ(StepAfter(0.1), kStands);
}

TEST_F(SilenceTest, ANewOwnerIsNotAsSilentAsTheOneBefore) {
  Drive(ana_, 1);
  board_.InputEnded(slot("robot1"), ana_.id);
  now_ += 10 * kSecond;
  board_.Command(slot("robot1"), bob_, Wheels(2, 2), {}, Note("bob"));
  EXPECT_EQ(Step(), kDrives);
  EXPECT_EQ(StepAfter(0.9), kDrives);
  Client again = bob_;
  again.id = 12;
  now_ += kSecond;
  EXPECT_EQ(board_.Hello(slot("robot1"), again).displaced, bob_.id);
  EXPECT_EQ(Step(), kDrives);
}

TEST_F(SilenceTest, ARobotThatStandsIsNotStoppedAndIsToldAsSilentAllTheSame) {
  Drive(ana_, 1);
  board_.Command(slot("robot1"), ana_, Wheels(0, 0), {}, Note("ana"));
  Step();
  EXPECT_EQ(StepAfter(10), kStands);
  EXPECT_FALSE(owner().silenced);
  ASSERT_TRUE(owner().heard);
  EXPECT_GE(now_ - *owner().heard, 10 * kSecond);
}

TEST_F(SilenceTest, ARobotThatGoesOnWithoutItsClientGoesOnWithASilentOne) {
  for (const LossPolicy policy : {LossPolicy::kWait, LossPolicy::kHold}) {
    Drive(ana_, 1, Mode::kRealtime, policy);
    EXPECT_EQ(StepAfter(10), kDrives);
  }
  for (const LossPolicy policy : {LossPolicy::kStop, LossPolicy::kDrop}) {
    Drive(ana_, 1, Mode::kRealtime, policy);
    EXPECT_EQ(StepAfter(10), kStands);
    EXPECT_FALSE(owner().dropped);
  }
}

TEST_F(SilenceTest, ATeamIsHeardOnItsOneConnection) {
  Client team = ana_;
  team.is_team = true;
  Drive(team, 1);
  now_ += kSecond;
  board_.NoteHeardAll(bob_.id, now_);
  board_.NoteHeardAll(team.id, now_);
  EXPECT_EQ(Step(), kDrives);
  board_.NoteHeardAll(bob_.id, now_ + kSecond);
  EXPECT_EQ(StepAfter(1), kStands);
}

TEST_F(SilenceTest, AnEditOfTheSceneKeepsWhenItWasHeardAndTakesTheNewWatchdog) {
  Drive(ana_, 0);
  now_ += 3 * kSecond;
  auto scenario = std::make_shared<Scenario>(*scene_->scenario);
  scenario->robots[0].watchdog_s = 4;
  scene_ = MakeScene(scenario);
  board_.Revise(*scene_, {}, MakeFrame(step_), now_);
  EXPECT_EQ(Step(), kDrives);
  EXPECT_EQ(StepAfter(1), kStands);
}

}  // namespace
}  // namespace coopdyn
