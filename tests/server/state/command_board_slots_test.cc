// SPDX-License-Identifier: MIT
// Robots with several actuator modules: each is a separate slot with its own owner.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/server/state/command_board_fixture.h"

namespace coopdyn {
namespace {

/// robot1 has an arm of three joints and a drive.
class SlotsTest : public CommandBoardTest {
 protected:
  SlotsTest() { Use({}); }

  void Use(const std::vector<std::string>& waits_for, StepEnd end = StepEnd::kLoad) {
    auto model = std::make_shared<RobotModel>(*model_);
    model->actuators = {{"arm", {0, 1, 2}, DriveModel{}}, {"motors", {3, 4}, DriveModel{}}};
    RobotEntry robot = MakeRobot("robot1");
    robot.model = model;
    robot.waits_for = waits_for;
    UseEntries({robot, MakeRobot("robot2")}, end);
  }
  SlotId arm() { return board_.FindSlot("robot1", "arm"); }
  SlotId motors() { return board_.FindSlot("robot1", "motors"); }
  Verdict MoveArm(const Client& client, double reference, ControlMode mode = ControlMode::kVelocity) {
    return board_.Command(arm(), client, std::vector<Setpoint>(3, {reference, mode}), {}, Note("arm"));
  }
  std::vector<double> RunOneStep() {
    std::vector<double> references;
    for (const Setpoint& setpoint : board_.Latch(step_ + 1)) references.push_back(setpoint.reference);
    board_.FinishStep(MakeFrame(++step_), now_);
    return references;
  }
  void MakeRobot2Ready() { board_.Ready(slot("robot2"), bob_, 1, Note("robot2")); }
};

TEST_F(SlotsTest, EachModuleIsASlot) {
  EXPECT_NE(arm(), motors());
  EXPECT_EQ(slot("robot1"), arm());                         // its first slot
  EXPECT_EQ(board_.FindSlot("robot1", "distance"), arm());  // drives nothing
}

TEST_F(SlotsTest, CommandsFillTheirOwnChannels) {
  MoveArm(ana_, 7);
  board_.Command(motors(), ana_, Wheels(1, 2), {}, Note("motors"));
  MakeRobot2Ready();
  EXPECT_EQ(RunOneStep(), (std::vector<double>{7, 7, 7, 1, 2, 0, 0}));
}

TEST_F(SlotsTest, TwoClientsMayOwnTwoModulesOfARobot) {
  EXPECT_EQ(MoveArm(ana_, 1).error, Error::kOk);
  EXPECT_EQ(board_.Command(motors(), bob_, Wheels(1, 2), {}, Note("motors")).error, Error::kOk);
  EXPECT_EQ(MoveArm(bob_, 1).error, Error::kOwned);
  EXPECT_EQ(board_.OwnerOf(arm()), "ana");
  EXPECT_EQ(board_.OwnerOf(motors()), "bob");
}

TEST_F(SlotsTest, TheWorldWaitsForEachModuleAndSaysWhich) {
  MakeRobot2Ready();
  MoveArm(ana_, 1);
  EXPECT_FALSE(board_.AllReady());
  const std::vector<Awaited> awaited = board_.Awaiting(now_, 9, nullptr);
  ASSERT_EQ(awaited.size(), 1u);
  EXPECT_EQ(awaited[0].robot, "robot1/motors");
  board_.Ready(motors(), bob_, 1, Note("motors"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(SlotsTest, WhatToDoNamesARobotOnceAndOnlyWhenAllItsModulesHaveClients) {
  board_.Claim(arm(), ana_);
  EXPECT_EQ(board_.Awaiting(now_, 9, nullptr).at(1).cure, "start their programs, or set_mode realtime");
  board_.Claim(motors(), bob_);
  const std::string cure = board_.Awaiting(now_, 9, nullptr).at(2).cure;
  EXPECT_NE(cure.find("set_participants robot1, or"), std::string::npos) << cure;
}

TEST_F(SlotsTest, WaitsForLeavesTheOthersOut) {
  Use({"motors"});
  MakeRobot2Ready();
  board_.Ready(motors(), ana_, 1, Note("motors"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(SlotsTest, StopEndsMotionAndForce) {
  for (const ControlMode mode :
       {ControlMode::kVelocity, ControlMode::kEffort, ControlMode::kPosition, ControlMode::kDirect}) {
    MoveArm(ana_, 3, mode);
    RunOneStep();
    board_.StopAll();
    // A move to a position ends; the reference of a step stays.
    EXPECT_EQ(RunOneStep()[0], mode == ControlMode::kDirect ? 3 : 0) << static_cast<int>(mode);
  }
}

TEST_F(SlotsTest, AResetKeepsEachOwner) {
  MoveArm(ana_, 1);
  board_.Claim(motors(), bob_);
  const SlotId before = motors();
  Use({}, StepEnd::kReset);
  EXPECT_EQ(motors(), before);
  EXPECT_EQ(board_.OwnerOf(arm()), "ana");
  EXPECT_EQ(board_.OwnerOf(motors()), "bob");
}

TEST_F(SlotsTest, TheOwnersListNamesARobotOnce) {
  board_.Claim(motors(), bob_);
  const std::vector<CommandBoard::Owner> owners = board_.Owners();
  ASSERT_EQ(owners.size(), 2u);
  EXPECT_EQ(owners[0].robot, "robot1");
  EXPECT_EQ(owners[0].name, "bob");
}

}  // namespace
}  // namespace coopdyn
