// SPDX-License-Identifier: MIT
// Clients that have gone, but whose connections have not told the board yet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The end of a connection, which the test triggers. The check for it locks the board, so the board must not
/// hold its lock.
class ScriptedEnd final : public InputEnd {
 public:
  explicit ScriptedEnd(const CommandBoard& board) : board_(board) {}
  bool come = false;
  int looks = 0;

 private:
  bool HasCome() override {
    ++looks;
    (void)board_.mode();
    return come;
  }

  const CommandBoard& board_;
};

class EndsTest : public CommandBoardTest {
 protected:
  EndsTest() {
    UseRobots({"robot1", "robot2", "robot3"});
    gone_.input_end = end_;
  }

  std::vector<SlotId> all() { return {slot("robot1"), slot("robot2"), slot("robot3")}; }
  /// `gone_` owns robot1, and its end has arrived but is unread.
  void Leave() {
    EXPECT_EQ(board_.Claim(slot("robot1"), gone_).error, Error::kOk);
    end_->come = true;
  }
  std::string OwnerOfRobot1() { return board_.OwnerOf(slot("robot1")); }

  const std::shared_ptr<ScriptedEnd> end_ = std::make_shared<ScriptedEnd>(board_);
  Client gone_{3, "cy", "127.0.0.1:3"};
  const Client team_{5, "flock", "127.0.0.1:5", false, true};
};

TEST_F(EndsTest, ACommandTakesTheRobotInEveryMode) {
  for (const Mode mode : {Mode::kLockstep, Mode::kRealtime, Mode::kFree}) {
    board_.SetMode(mode, now_);
    ++gone_.id;
    const auto end = std::make_shared<ScriptedEnd>(board_);
    gone_.input_end = end;
    board_.Claim(slot("robot1"), gone_);
    end->come = true;
    EXPECT_EQ(board_.Command(slot("robot1"), bob_, Wheels(1, 1), {}, Note("bob")).error, Error::kOk);
    EXPECT_EQ(OwnerOfRobot1(), "bob");
    board_.Release(slot("robot1"), bob_);
  }
}

TEST_F(EndsTest, ReadyTakesTheRobot) {
  Leave();
  EXPECT_EQ(board_.Ready(slot("robot1"), bob_, 1, Note("bob")).error, Error::kOk);
  EXPECT_EQ(OwnerOfRobot1(), "bob");
}

TEST_F(EndsTest, ClaimTakesTheRobot) {
  Leave();
  EXPECT_EQ(board_.Claim(slot("robot1"), bob_).error, Error::kOk);
  EXPECT_EQ(OwnerOfRobot1(), "bob");
}

TEST_F(EndsTest, ATeamTakesTheRobot) {
  Leave();
  EXPECT_EQ(board_.ClaimAll(all(), team_).error, Error::kOk);
  EXPECT_EQ(board_.Team(team_.id), all());
}

TEST_F(EndsTest, ATeamTakesTheRobotByAStep) {
  Leave();
  const std::vector<SlotId> slots = all();
  EXPECT_EQ(board_.StepAll({slots, {}, {}}, team_, 1, Note("team")).error, Error::kOk);
  EXPECT_EQ(board_.Team(team_.id), all());
  RunStep();
  EXPECT_EQ(answers_["team"].size(), 1u);
}

TEST_F(EndsTest, ATeamTakesTheRobotsOfManyWhoHaveGone) {
  std::vector<std::shared_ptr<ScriptedEnd>> ends;
  for (const SlotId slot : all()) {
    Client client{10 + slot, "", "127.0.0.1:" + std::to_string(slot)};
    client.input_end = ends.emplace_back(std::make_shared<ScriptedEnd>(board_));
    board_.Claim(slot, client);
  }
  for (const auto& end : ends) end->come = true;
  EXPECT_EQ(board_.ClaimAll(all(), team_).error, Error::kOk);
  EXPECT_EQ(board_.Team(team_.id), all());
}

TEST_F(EndsTest, ATeamGoneAsAWholeLeavesAllItsRobots) {
  Client old = team_;
  old.id = 6;
  old.name = "herd";
  old.input_end = end_;
  board_.ClaimAll(all(), old);
  end_->come = true;
  EXPECT_EQ(board_.Claim(slot("robot2"), bob_).error, Error::kOk);
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
  EXPECT_EQ(board_.Owners()[0].id, 0u);
  EXPECT_EQ(board_.Owners()[2].id, 0u);
}

TEST_F(EndsTest, WhatIsFreeIsWhatTheGoneHaveLeftToo) {
  Leave();
  board_.Claim(slot("robot2"), ana_);
  EXPECT_EQ(board_.ClaimFree(team_).error, Error::kOk);
  EXPECT_THAT(board_.Team(team_.id), ElementsAre(slot("robot1"), slot("robot3")));
}

TEST_F(EndsTest, ReleasingTuningAndSendingAreNotRefused) {
  Leave();
  EXPECT_EQ(board_.Release(slot("robot1"), bob_).error, Error::kOk);
  EXPECT_EQ(OwnerOfRobot1(), "");
  const auto again = [&](ClientId id) {
    const auto end = std::make_shared<ScriptedEnd>(board_);
    Client client{id, "", "127.0.0.1:9"};
    client.input_end = end;
    board_.Claim(slot("robot1"), client);
    end->come = true;
  };
  again(20);
  EXPECT_EQ(board_.ReleaseAll(all(), team_).error, Error::kOk);
  again(21);
  EXPECT_EQ(board_.MayTune(slot("robot1"), bob_).error, Error::kOk);
  again(22);
  EXPECT_EQ(board_.Send(slot("robot1"), bob_, RobotMessage{}).error, Error::kOk);
  again(23);
  EXPECT_EQ(board_.ClientBeside(slot("robot1"), bob_), "");
}

TEST_F(EndsTest, WhoIsThereKeepsTheRobot) {
  board_.Claim(slot("robot1"), gone_);
  const Verdict verdict = board_.Claim(slot("robot1"), bob_);
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("robot1 is driven by cy"));
  EXPECT_EQ(board_.ClientBeside(slot("robot1"), bob_), "cy");
  board_.ClaimFree(team_);
  EXPECT_EQ(OwnerOfRobot1(), "cy");
  EXPECT_EQ(end_->looks, 3);
}

TEST_F(EndsTest, NobodyLooksUnlessSomebodyIsInTheWay) {
  board_.Claim(slot("robot1"), gone_);
  board_.Command(slot("robot1"), gone_, Wheels(1, 1), {}, Note("cy"));
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  board_.Claim(slot("robot3"), bob_);
  EXPECT_EQ(end_->looks, 0);
}

TEST_F(EndsTest, WhoHasBeenFoundGoneOwnsNothingAgain) {
  Leave();
  board_.Claim(slot("robot1"), bob_);
  EXPECT_EQ(board_.Command(slot("robot1"), gone_, Wheels(1, 1), {}, Note("late")).error, Error::kOwned);
  board_.Release(slot("robot1"), bob_);
  EXPECT_EQ(board_.Command(slot("robot1"), gone_, Wheels(1, 1), {}, Note("late")).error, Error::kOk);
  EXPECT_EQ(OwnerOfRobot1(), "");
}

TEST_F(EndsTest, WhatItHadSentLastStillRuns) {
  board_.Command(slot("robot1"), gone_, Wheels(4, 4), {}, Note("cy"));
  end_->come = true;
  EXPECT_EQ(board_.Claim(slot("robot1"), bob_).error, Error::kOk);
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  board_.Ready(slot("robot3"), bob_, 1, Note("bob"));
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{4, 4}));
  EXPECT_EQ(answers_["cy"].size(), 1u);
}

TEST_F(EndsTest, OnDisconnectActsOnlyIfNobodyHasTakenTheRobot) {
  RobotEntry entry = MakeRobot("robot1");
  entry.on_disconnect = LossPolicy::kDrop;
  UseEntries({entry, MakeRobot("robot2")});
  Leave();
  EXPECT_EQ(board_.ClientBeside(slot("robot1"), bob_), "");  // only asks
  board_.Closed(slot("robot1"), gone_.id);
  EXPECT_TRUE(board_.Owners()[0].dropped);

  const auto end = std::make_shared<ScriptedEnd>(board_);
  Client next{30, "dora", "127.0.0.1:30"};
  next.input_end = end;
  board_.Ready(slot("robot1"), next, 1, Note("dora"));
  board_.Ready(slot("robot2"), bob_, 1, Note("bob"));
  RunStep();
  end->come = true;
  board_.Claim(slot("robot1"), bob_);
  board_.Closed(slot("robot1"), next.id);
  EXPECT_FALSE(board_.Owners()[0].dropped);
  EXPECT_EQ(OwnerOfRobot1(), "bob");
}

}  // namespace
}  // namespace coopdyn
