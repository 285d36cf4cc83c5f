// SPDX-License-Identifier: MIT
// One connection that drives many robots, at the level of the board.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_board_fixture.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class TeamTest : public CommandBoardTest {
 protected:
  TeamTest() { UseRobots({"robot1", "robot2", "robot3"}); }

  std::vector<SlotId> slots(const std::vector<std::string>& names) {
    std::vector<SlotId> list;
    for (const std::string& name : names) list.push_back(slot(name));
    return list;
  }
  std::vector<SlotId> all() { return slots({"robot1", "robot2", "robot3"}); }
  Verdict StepAll(const std::vector<std::string>& names, const std::vector<WheelSpeeds>& wheels,
                  const std::vector<std::string>& others = {}) {
    const std::vector<SlotId> named = slots(names), rest = slots(others);
    const std::vector<Setpoint> setpoints = ByChannel(wheels);
    return board_.StepAll({named, setpoints, rest}, team_, 1, Note("team"));
  }

  const Client team_{5, "flock", "127.0.0.1:5", false, true};
  const Client other_team_{6, "herd", "127.0.0.1:6", false, true};
};

TEST_F(TeamTest, OneBatchMakesAllItsRobotsReadyAndIsAnsweredOnce) {
  const Verdict verdict = StepAll({"robot3", "robot1", "robot2"}, {{3, 3}, {1, 1}, {2, 2}});
  EXPECT_EQ(verdict.error, Error::kOk);
  EXPECT_FALSE(verdict.answer_now);
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{1, 1}, {2, 2}, {3, 3}}));
  ASSERT_EQ(answers_["team"].size(), 1u);
  EXPECT_EQ(answers_["team"][0].end, StepEnd::kRan);
  EXPECT_EQ(answers_["team"][0].frame->step, 1u);
  EXPECT_FALSE(board_.AllReady());
}

TEST_F(TeamTest, ABatchIsAnsweredAfterTheStepInRealtimeToo) {
  board_.SetMode(Mode::kRealtime, now_);
  EXPECT_FALSE(StepAll({"robot1"}, {{1, 1}}).answer_now);
  EXPECT_THAT(answers_["team"], IsEmpty());
  RunStep();
  EXPECT_EQ(answers_["team"].size(), 1u);
}

TEST_F(TeamTest, WithoutSetpointsTheyAreKept) {
  StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  RunStep();
  StepAll({"robot1", "robot2", "robot3"}, {});
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{1, 1}, {2, 2}, {3, 3}}));
}

TEST_F(TeamTest, OwnedRobotsThatAreNotNamedKeepTheirsAndCountAsReady) {
  StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  RunStep();
  StepAll({"robot2"}, {{9, 9}}, {"robot1", "robot3"});
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{1, 1}, {9, 9}, {3, 3}}));
}

TEST_F(TeamTest, OthersThatAreNotTheClientsAreLeftAlone) {
  board_.Claim(slot("robot3"), ana_);
  StepAll({"robot1"}, {{1, 1}}, {"robot2", "robot3"});
  EXPECT_FALSE(board_.AllReady());
  EXPECT_THAT(board_.Team(team_.id), ElementsAre(slot("robot1")));
}

TEST_F(TeamTest, ANamedRobotOfSomebodyElseRefusesTheWholeBatch) {
  board_.Claim(slot("robot3"), ana_);
  const Verdict verdict = StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("robot3 is driven by ana"));
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{0, 0}, {0, 0}, {0, 0}}));
  EXPECT_THAT(answers_["team"], IsEmpty());
}

TEST_F(TeamTest, ClaimTakesAllOrNone) {
  board_.Claim(slot("robot2"), ana_);
  const Verdict verdict = board_.ClaimAll(all(), team_);
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("robot2 is driven by ana"));
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
  board_.Release(slot("robot2"), ana_);
  EXPECT_EQ(board_.ClaimAll(all(), team_).error, Error::kOk);
  EXPECT_EQ(board_.Team(team_.id), all());
  EXPECT_EQ(board_.Claim(slot("robot2"), ana_).error, Error::kOwned);
}

TEST_F(TeamTest, ClaimFreeTakesWhatNobodyDrives) {
  RobotEntry still = MakeRobot("robot4");
  const auto model = std::make_shared<RobotModel>();
  model->links.resize(1);
  still.model = model;
  UseEntries({MakeRobot("robot1"), MakeRobot("robot2"), MakeDriven("robot3"), still});
  board_.Claim(slot("robot1"), ana_);
  EXPECT_EQ(board_.ClaimFree(team_).error, Error::kOk);
  EXPECT_THAT(board_.Team(team_.id), ElementsAre(slot("robot2")));
}

TEST_F(TeamTest, ARobotWithoutActuatorsCannotBeClaimed) {
  RobotEntry still = MakeRobot("robot2");
  const auto model = std::make_shared<RobotModel>();
  model->links.resize(1);
  still.model = model;
  UseEntries({MakeRobot("robot1"), still});
  EXPECT_EQ(board_.ClaimAll(slots({"robot1", "robot2"}), team_).error, Error::kNotPossible);
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
}

TEST_F(TeamTest, ReleaseKeepsTheSetpoints) {
  StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  RunStep();
  EXPECT_EQ(board_.ReleaseAll(slots({"robot2"}), team_).error, Error::kOk);
  EXPECT_EQ(board_.Team(team_.id), slots({"robot1", "robot3"}));
  EXPECT_EQ(board_.Claim(slot("robot2"), ana_).error, Error::kOk);
  EXPECT_EQ(RunStep()[1], (WheelSpeeds{2, 2}));
  EXPECT_EQ(board_.ReleaseAll(slots({"robot1", "robot2"}), team_).error, Error::kOwned);
  EXPECT_EQ(board_.Team(team_.id), slots({"robot1", "robot3"}));
}

TEST_F(TeamTest, StopTeamZeroesOnlyItsOwnRobotsAlsoWhatIsStillPending) {
  board_.Command(slot("robot3"), ana_, Wheels(3, 3), {}, Note("ana"));
  StepAll({"robot1", "robot2"}, {{1, 1}, {2, 2}});
  board_.StopTeam(all(), team_);
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{0, 0}, {0, 0}, {3, 3}}));
  EXPECT_EQ(answers_["team"].size(), 1u);
}

TEST_F(TeamTest, HelloTakesOverTheWholeTeamOfThatName) {
  board_.ClaimAll(all(), team_);
  const Client again{8, "flock", "127.0.0.1:8", false, true};
  EXPECT_THAT(board_.HelloAll(again), ElementsAre(team_.id));
  EXPECT_EQ(board_.Team(again.id), all());
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
}

TEST_F(TeamTest, HelloOnARobotTakesNothingFromATeamNorATeamFromARobot) {
  board_.ClaimAll(slots({"robot1", "robot2"}), team_);
  board_.Claim(slot("robot3"), ana_);
  EXPECT_EQ(board_.Hello(slot("robot1"), {9, "flock", "127.0.0.1:9"}).displaced, 0u);
  EXPECT_THAT(board_.HelloAll({10, "ana", "127.0.0.1:10", false, true}), IsEmpty());
  EXPECT_EQ(board_.Team(team_.id), slots({"robot1", "robot2"}));
  EXPECT_EQ(board_.Owners()[2].id, ana_.id);
}

TEST_F(TeamTest, HelloOfAnotherTeamTakesNothing) {
  board_.ClaimAll(all(), team_);
  EXPECT_THAT(board_.HelloAll(other_team_), IsEmpty());
  EXPECT_EQ(board_.Team(team_.id), all());
}

TEST_F(TeamTest, TheNewOwnersFirstStepReplacesTheOldBatch) {
  StepAll({"robot1", "robot2"}, {{1, 1}, {2, 2}});
  board_.InputEndedAll(team_.id);
  board_.ClaimAll(slots({"robot1"}), other_team_);
  board_.StepAll({slots({"robot1"}), {}, {}}, other_team_, 1, Note("herd"));
  EXPECT_THAT(answers_["team"], IsEmpty());  // robot2 still has its command
  board_.Command(slot("robot2"), bob_, Wheels(5, 5), {}, Note("bob"));
  ASSERT_EQ(answers_["team"].size(), 1u);
  EXPECT_EQ(answers_["team"][0].end, StepEnd::kReplaced);
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{0, 0}, {5, 5}, {0, 0}}));
  EXPECT_EQ(answers_["herd"].size(), 1u);
  EXPECT_EQ(answers_["team"].size(), 1u);
}

TEST_F(TeamTest, EndOfInputFreesTheTeamAndItsRequestsStillRun) {
  board_.ClaimAll(all(), team_);
  board_.InputEndedAll(team_.id);
  EXPECT_EQ(board_.Owners()[0].id, 0u);
  EXPECT_EQ(board_.Team(team_.id), all());  // as its last requests still mean
  Client ended = team_;
  ended.input_ended = true;
  const std::vector<Setpoint> setpoints = ByChannel(std::vector<WheelSpeeds>{{1, 1}, {2, 2}, {3, 3}});
  EXPECT_EQ(board_.StepAll({all(), setpoints, {}}, ended, 1, Note("team")).error, Error::kOk);
  EXPECT_EQ(board_.Owners()[0].id, 0u);
  board_.ClosedAll(team_.id);
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
  EXPECT_EQ(ByChannel(RunStep()), setpoints);
}

TEST_F(TeamTest, OnDisconnectActsForEachRobotOnceTheBatchHasRun) {
  RobotEntry stops = MakeRobot("robot1"), drops = MakeRobot("robot2");
  stops.on_disconnect = LossPolicy::kStop;
  drops.on_disconnect = LossPolicy::kDrop;
  UseEntries({stops, drops, MakeRobot("robot3")});
  StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  board_.ClosedAll(team_.id);
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{1, 1}, {2, 2}, {3, 3}}));
  EXPECT_EQ(board_.Awaiting(now_, 9, nullptr).size(), 1u);
  EXPECT_EQ(RunStep(), (std::vector<WheelSpeeds>{{0, 0}, {0, 0}, {3, 3}}));
  EXPECT_TRUE(board_.Owners()[1].dropped);
}

TEST_F(TeamTest, InRealtimeALostTeamThatSaidHelloStopsAndOneWithoutNameDrivesOn) {
  const Client nameless{7, "", "127.0.0.1:7", false, true};
  for (const Client& team : {team_, nameless}) {
    UseRobots({"robot1", "robot2", "robot3"});
    board_.SetMode(Mode::kRealtime, now_);
    const std::vector<SlotId> two = slots({"robot1", "robot3"});
    const std::vector<Setpoint> setpoints = ByChannel(std::vector<WheelSpeeds>{{1, 1}, {3, 3}});
    board_.StepAll({two, setpoints, {}}, team, 1, Note("team"));
    RunStep();
    board_.InputEndedAll(team.id);
    board_.ClosedAll(team.id);
    const bool stops = !team.name.empty();
    EXPECT_EQ(RunStep()[2], (stops ? WheelSpeeds{0, 0} : WheelSpeeds{3, 3}));
    EXPECT_EQ(board_.LatchedLosses().size(), stops ? 2u : 0u);
  }
}

TEST_F(TeamTest, ResetAndLoadEndTheWaitOfABatchAndKeepItsRobots) {
  StepAll({"robot1", "robot2", "robot3"}, {{1, 1}, {2, 2}, {3, 3}});
  UseRobots({"robot1", "robot2", "robot3"}, StepEnd::kReset);
  ASSERT_EQ(answers_["team"].size(), 1u);
  EXPECT_EQ(answers_["team"][0].end, StepEnd::kReset);
  EXPECT_EQ(board_.Team(team_.id), all());
  StepAll({"robot1", "robot2", "robot3"}, {});
  UseRobots({"robot1", "robot7"}, StepEnd::kLoad);
  ASSERT_EQ(answers_["team"].size(), 2u);
  EXPECT_EQ(answers_["team"][1].end, StepEnd::kLoad);
  EXPECT_THAT(board_.Team(team_.id), ElementsAre(slot("robot1")));
}

TEST_F(TeamTest, TheRevisionGrowsWhenATeamChanges) {
  std::uint64_t before = board_.team_revision();
  const auto grew = [&] { return std::exchange(before, board_.team_revision()) < board_.team_revision(); };
  board_.Claim(slot("robot1"), ana_);
  EXPECT_FALSE(grew());
  board_.ClaimAll(slots({"robot2", "robot3"}), team_);
  EXPECT_TRUE(grew());
  StepAll({"robot2", "robot3"}, {});
  RunStep();
  EXPECT_FALSE(grew());
  board_.InputEnded(slot("robot2"), team_.id);
  EXPECT_TRUE(grew());
  UseRobots({"robot1", "robot2"}, StepEnd::kReset);
  EXPECT_TRUE(grew());
}

// --- loaded controllers

class DrivenTest : public TeamTest {
 protected:
  DrivenTest() { UseEntries({MakeRobot("robot1"), MakeDriven("robot2")}); }
};

TEST_F(DrivenTest, AControllerOwnsItsRobot) {
  const std::string says = "owned by controller diffuse";
  EXPECT_THAT(board_.Claim(slot("robot2"), ana_).text, HasSubstr(says));
  const Verdict verdict = board_.Command(slot("robot2"), ana_, Wheels(1, 1), {}, Note("ana"));
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr(says));
  EXPECT_THAT(board_.Ready(slot("robot2"), ana_, 1, Note("ana")).text, HasSubstr(says));
  EXPECT_THAT(board_.ClaimAll(slots({"robot1", "robot2"}), team_).text, HasSubstr(says));
  EXPECT_EQ(board_.Release(slot("robot2"), ana_).error, Error::kOwned);
  EXPECT_EQ(board_.Owners()[1].name, "controller diffuse");
  EXPECT_TRUE(board_.Owners()[1].driven);
  EXPECT_THAT(board_.Team(team_.id), IsEmpty());
}

TEST_F(DrivenTest, ItIsNotWaitedFor) {
  board_.Ready(slot("robot1"), ana_, 1, Note("ana"));
  EXPECT_TRUE(board_.AllReady());
  const std::vector<std::string> both{"robot1", "robot2"};
  EXPECT_EQ(board_.SetParticipants(both, now_).error, Error::kNotPossible);
}

TEST_F(DrivenTest, OnceItsControllerIsUnloadedClientsDriveItAndItIsWaitedFor) {
  board_.SetDriven(1, "", now_);
  EXPECT_EQ(board_.Owners()[1].name, "");
  board_.Ready(slot("robot1"), ana_, 1, Note("ana"));
  EXPECT_FALSE(board_.AllReady());
  EXPECT_EQ(board_.Command(slot("robot2"), bob_, Wheels(2, 2), {}, Note("bob")).error, Error::kOk);
  EXPECT_EQ(RunStep()[1], (WheelSpeeds{2, 2}));
}

TEST_F(DrivenTest, UnloadedWithSyncNoItIsNotWaitedFor) {
  RobotEntry alone = MakeDriven("robot2");
  alone.sync = false;
  UseEntries({MakeRobot("robot1"), alone});
  board_.SetDriven(1, "", now_);
  board_.Ready(slot("robot1"), ana_, 1, Note("ana"));
  EXPECT_TRUE(board_.AllReady());
}

TEST_F(DrivenTest, AControllerThatComesEndsWhatAClientWanted) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), 5, Note("ana"));
  RunStep();
  board_.SetDriven(0, "flock", now_);
  ASSERT_EQ(answers_["ana"].size(), 1u);
  EXPECT_EQ(answers_["ana"][0].end, StepEnd::kReplaced);
  EXPECT_EQ(board_.Owners()[0].name, "controller flock");
  EXPECT_TRUE(board_.AllReady());
  EXPECT_EQ(RunStep()[0], (WheelSpeeds{0, 0}));
}

TEST_F(DrivenTest, ALostClientChangesNothingOfARobotThatAControllerDrivesNow) {
  board_.Command(slot("robot1"), ana_, Wheels(1, 1), {}, Note("ana"));
  RunStep();
  board_.Closed(slot("robot1"), ana_.id);
  board_.SetDriven(0, "diffuse", now_);
  board_.SetMode(Mode::kRealtime, now_);
  RunStep();
  EXPECT_THAT(board_.LatchedLosses(), IsEmpty());
  EXPECT_FALSE(board_.Owners()[0].still_moving);
}

TEST_F(DrivenTest, ResetBringsTheScenariosControllersBack) {
  board_.SetDriven(1, "", now_);
  board_.Claim(slot("robot2"), ana_);
  UseEntries({MakeRobot("robot1"), MakeDriven("robot2")}, StepEnd::kReset);
  EXPECT_EQ(board_.Owners()[1].name, "controller diffuse");
  EXPECT_FALSE(board_.Owners()[1].participates);
}

// --- broadcasts

RobotMessage Values(std::initializer_list<double> values) {
  RobotMessage message;
  for (const double value : values) message.values[message.count++] = value;
  return message;
}

TEST_F(TeamTest, BroadcastsAreLatchedByRobotWhateverTheOrderOfTheirArrival) {
  board_.Send(slot("robot3"), bob_, Values({3}));
  board_.Send(slot("robot1"), ana_, Values({1, 2}));
  board_.Latch(7);
  const std::span<const SentMessage> sent = board_.LatchedMessages();
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].robot, 0u);
  EXPECT_EQ(sent[0].step, 7u);
  EXPECT_EQ(sent[0].message.count, 2u);
  EXPECT_EQ(sent[0].message.values[1], 2);
  EXPECT_EQ(sent[1].robot, 2u);
  board_.FinishStep(MakeFrame(7), now_);
  board_.Latch(8);
  EXPECT_THAT(board_.LatchedMessages(), IsEmpty());
}

TEST_F(TeamTest, TheLastBroadcastBeforeAStepWinsAndMakesNobodyReady) {
  board_.Send(slot("robot1"), ana_, Values({1}));
  EXPECT_EQ(board_.Send(slot("robot1"), bob_, Values({2})).answer_now, true);
  EXPECT_FALSE(board_.AllReady());
  board_.Latch(1);
  ASSERT_EQ(board_.LatchedMessages().size(), 1u);
  EXPECT_EQ(board_.LatchedMessages()[0].message.values[0], 2);
}

TEST_F(TeamTest, StopAllResetAndLoadDropBroadcastsThatWait) {
  for (const StepEnd end : {StepEnd::kReset, StepEnd::kLoad, StepEnd::kRan}) {
    board_.Send(slot("robot2"), ana_, Values({1}));
    if (end == StepEnd::kRan) {
      board_.StopAll();
    } else {
      UseRobots({"robot1", "robot2", "robot3"}, end);
    }
    board_.Latch(1);
    EXPECT_THAT(board_.LatchedMessages(), IsEmpty());
    board_.FinishStep(MakeFrame(1), now_);
    EXPECT_EQ(board_.Send(slot("robot2"), ana_, Values({4})).error, Error::kOk);
    board_.Latch(2);
    ASSERT_EQ(board_.LatchedMessages().size(), 1u);
  }
}

TEST_F(TeamTest, OnlyTheNameThatDrivesARobotSendsForIt) {
  EXPECT_EQ(board_.Send(slot("robot1"), bob_, Values({1})).error, Error::kOk);
  board_.Claim(slot("robot1"), ana_);
  const Verdict verdict = board_.Send(slot("robot1"), bob_, Values({1}));
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("robot1 is driven by ana"));
  EXPECT_EQ(board_.Send(slot("robot1"), {9, "ana", "127.0.0.1:9"}, Values({1})).error, Error::kOk);
  EXPECT_EQ(board_.Send(slot("robot1"), {9, "", "127.0.0.1:9"}, Values({1})).error, Error::kOwned);
}

TEST_F(TeamTest, TwoClientsWithoutANameDoNotShareARobotsBroadcast) {
  const Client nameless{9, "", "127.0.0.1:9"};
  board_.Claim(slot("robot1"), {10, "", "127.0.0.1:10"});
  const Verdict verdict = board_.Send(slot("robot1"), nameless, Values({1}));
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("say hello NAME"));
  board_.Closed(slot("robot1"), 10);
  EXPECT_EQ(board_.Send(slot("robot1"), nameless, Values({1})).error, Error::kOk);
}

TEST_F(DrivenTest, NobodySendsForARobotThatAControllerDrives) {
  const Verdict verdict = board_.Send(slot("robot2"), ana_, Values({1}));
  EXPECT_EQ(verdict.error, Error::kOwned);
  EXPECT_THAT(verdict.text, HasSubstr("owned by controller diffuse"));
}

}  // namespace
}  // namespace coopdyn
