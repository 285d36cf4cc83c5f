// SPDX-License-Identifier: MIT
// Saved states and resets of the stepper.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/server/physics/stepper_restore_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;

TEST_F(StepperRestoreTest, ItGoesOnBitForBitFromAnyState) {
  for (const bool driven : {false, true}) {
    Begin(driven);
    std::vector<SavedStatePtr> saved;
    std::vector<std::uint64_t> hashes;
    for (int k = 0; k < 60; ++k) {
      saved.push_back(Save());
      hashes.push_back(Step());
    }
    for (const std::size_t at : {0u, 1u, 13u, 14u, 59u, 30u}) {
      EXPECT_EQ(Do(edit::Restore{saved[at]}).error, Error::kOk);
      EXPECT_EQ(now().step, at);
      const auto again = Steps(60 - static_cast<int>(at));
      EXPECT_TRUE(std::equal(again.begin(), again.end(), hashes.begin() + static_cast<std::ptrdiff_t>(at)))
          << at << (driven ? " driven" : "");
    }
  }
}

TEST_F(StepperRestoreTest, AStateWhoseScoresDoNotFitIsRefused) {
  Begin();
  Steps(3);
  SavedState state = *Save();
  state.scores = {1, 2, 3};
  const std::uint64_t before = StateHash(now());
  const EditResult result = Do(edit::Restore{std::make_shared<SavedState>(state)});
  EXPECT_EQ(result.error, Error::kNotPossible);
  EXPECT_EQ(result.text, "this state cannot be restored: its scores do not match the scenario's");
  EXPECT_EQ(StateHash(now()), before);
}

TEST_F(StepperRestoreTest, AResetEqualsAFreshStart) {
  for (const bool driven : {false, true}) {
    Begin(driven);
    const std::uint64_t start = StateHash(now());
    const auto hashes = Steps(40);
    for (int k = 0; k < 50; ++k) {
      Steps(k % 3);
      const EditResult reset = Do(edit::Reset{});
      EXPECT_EQ(reset.frame->step, 0u);
      EXPECT_EQ(StateHash(*reset.frame), start);
    }
    EXPECT_EQ(Steps(40), hashes);
  }
}

TEST_F(StepperRestoreTest, WhatExplodedBeforeAResetIsRemembered) {
  Begin();
  Step();
  SavedState state = *Save();
  auto frame = std::make_shared<Frame>();
  frame->step = state.frame->step;
  frame->time = state.frame->time;
  frame->seed = state.frame->seed;
  frame->scene = state.frame->scene;
  frame->bodies = state.frame->bodies;
  frame->channels = state.frame->channels;
  frame->commanded = state.frame->commanded;
  frame->bodies[0].v_WB = {0, 500, 0};
  state.frame = frame;
  Do(edit::Restore{std::make_shared<SavedState>(state)});
  Step();
  Save();  // an edit publishes the status
  EXPECT_EQ(control_.status().frozen, std::vector<std::string>{"robot1"});
  EXPECT_TRUE(control_.status().frozen_before.empty());
  Do(edit::Reset{});
  EXPECT_TRUE(control_.status().frozen.empty());
  EXPECT_EQ(control_.status().frozen_before, std::set<std::string>{"robot1"});
}

TEST_F(StepperRestoreTest, AResetKeepsTheSeedUnlessAnotherIsGiven) {
  Begin();
  EXPECT_EQ(Do(edit::Reset{7}).frame->seed, 7u);
  EXPECT_EQ(Do(edit::Reset{}).frame->seed, 7u);
  EXPECT_EQ(Do(edit::Reset{1}).frame->seed, 1u);
}

TEST_F(StepperRestoreTest, EachNewBeginningIsAnEpoch) {
  Begin();
  std::uint64_t epoch = now().epoch;
  const SavedStatePtr saved = Save();
  const EditAction restore = edit::Restore{saved}, reset = edit::Reset{};
  for (const EditAction& anew : {restore, reset, restore, restore}) {
    Do(anew);
    EXPECT_EQ(now().epoch, epoch + 1);
    Step();
    EXPECT_EQ(now().epoch, epoch + 1);
    ++epoch;
  }
}

TEST_F(StepperRestoreTest, WhoWaitsIsToldOfTheReset) {
  Begin();
  const SavedStatePtr saved = Save();
  std::vector<StepEnd> ends;
  const auto note = [&ends](const StepResult& result) {
    ends.push_back(result.end);
    EXPECT_EQ(result.frame->step, 0u);
  };
  for (const EditAction& anew : {EditAction(edit::Restore{saved}), EditAction(edit::Reset{})}) {
    board_.Command(board_.FindSlot("robot1"), ana_, Wheels(1, 1), {}, note);
    board_.Ready(board_.FindSlot("robot3"), bob_, 5, note);
    board_.WaitSteps(9, note);
    Do(anew);
    EXPECT_THAT(ends, ElementsAre(StepEnd::kReset, StepEnd::kReset, StepEnd::kReset));
    ends.clear();
  }
}

TEST_F(StepperRestoreTest, SetPointsInForceAreRestored) {
  Begin();
  Steps(5);
  const WheelSpeeds in_force = SetpointOf(now(), 0);
  ASSERT_NE(in_force, WheelSpeeds{});
  const SavedStatePtr saved = Save();
  Do(edit::Reset{});
  Keep();
  EXPECT_EQ(SetpointOf(now(), 0), WheelSpeeds{});
  Do(edit::Restore{saved});
  Keep();
  EXPECT_EQ(SetpointOf(now(), 0), in_force);
}

TEST_F(StepperRestoreTest, WhatEditsHaveChangedSinceTheStepIsSavedToo) {
  Begin();
  Steps(5);
  Do(edit::StopAll{});
  Do(edit::SetStep{4'000'000});
  const SavedStatePtr saved = Save();
  const std::uint64_t next = Keep();
  EXPECT_EQ(SetpointOf(now(), 0), WheelSpeeds{});
  const Nanoseconds time = now().time;
  Do(edit::SetStep{kDefaultStep});
  Steps(3);
  Do(edit::Restore{saved});
  EXPECT_EQ(StateHash(now()), StateHash(*saved->frame));
  EXPECT_EQ(Keep(), next);
  EXPECT_EQ(now().time, time);
}

TEST_F(StepperRestoreTest, AReleasedRobotStaysReleasedInItsState) {
  Begin(true);
  Steps(2);
  Do(edit::UnloadController{"robot2"});
  const SavedStatePtr saved = Save();
  const auto hashes = Steps(10);
  Do(edit::Reset{});
  EXPECT_TRUE(OwnerOf("robot2").driven);
  Do(edit::Restore{saved});
  EXPECT_FALSE(OwnerOf("robot2").driven);
  EXPECT_TRUE(OwnerOf("robot2").participates);
  EXPECT_EQ(Steps(10), hashes);
}

TEST_F(StepperRestoreTest, AStateWhoseControllersCannotBeRestoredIsRefusedAndTheRunGoesOn) {
  Begin(true);
  Steps(3);
  const SavedStatePtr early = Save();
  Steps(4);
  const SavedStatePtr present = Save();
  const auto hashes = Steps(5);
  Do(edit::Restore{present});
  driver_.refused = early->controllers;
  const EditResult result = Do(edit::Restore{early});
  EXPECT_EQ(result.error, Error::kNotPossible);
  EXPECT_THAT(
      result.text,
      testing::HasSubstr("this state cannot be restored: the loaded controllers reject the saved state"));
  EXPECT_EQ(Steps(5), hashes);
}

TEST_F(StepperRestoreTest, ControllersLostByARefusedRestoreAreToldAsFailed) {
  Begin(true);
  Steps(3);
  const SavedStatePtr early = Save();
  Steps(4);
  Do(edit::SetJournal{&journal_});
  journal_.Take();
  driver_.refuses_all = true;
  const EditResult result = Do(edit::Restore{early});
  EXPECT_EQ(result.error, Error::kNotPossible);
  EXPECT_EQ(result.text,
            "this state cannot be restored: the loaded controllers reject the saved state; the current "
            "controllers are lost too; robot2 stands now: reset or load a scenario");
  EXPECT_EQ(now().step, 7u);
  EXPECT_EQ(OwnerOf("robot2").name, "controller count (stopped)");
  ASSERT_EQ(control_.stopped().size(), 1u);
  EXPECT_EQ(control_.stopped().at("robot2").by, "controller");
  EXPECT_EQ(control_.stopped().at("robot2").step, 7u);
  EXPECT_EQ(control_.events().back().text, "robot2 stands: controller count crashed");
  EXPECT_THAT(journal_.Take(),
              ElementsAre("note 7 error", "input 7 controller_stopped robot2 controller count crashed"));
  Do(edit::Restore{early});
  EXPECT_EQ(control_.events().size(), 1u) << "it is no news";
}

TEST_F(StepperRestoreTest, IfAskedToARunWhoseControllersAreLostEnds) {
  options_.stop_on_controller_failure = true;
  Begin(true);
  Steps(3);
  bool told = false;
  stepper_->set_on_ended([&told] { told = true; });
  driver_.refuses_all = true;
  Do(edit::Restore{Save()});
  EXPECT_TRUE(told);
  EXPECT_EQ(control_.end(), RunEnd::kController);
  EXPECT_EQ(control_.status().state, RunState::kEnded);
}

TEST_F(StepperRestoreTest, WarningsOfAStateAreEvents) {
  Begin();
  auto state = std::make_shared<SavedState>(*Save());
  state->warning = "one\ntwo";
  Do(edit::Restore{state});
  const std::vector<Event> events = control_.events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].level + " " + events[0].text, "warning one");
  EXPECT_EQ(events[1].text, "two");
}

TEST_F(StepperRestoreTest, AStateWithoutItsControllersIsRefused) {
  Begin(true);
  Steps(3);
  auto without = std::make_shared<SavedState>(*Save());
  without->controllers.clear();
  const auto hashes = Steps(5);
  const SavedStatePtr after = Save();
  const EditResult result = Do(edit::Restore{without});
  EXPECT_EQ(result.error, Error::kNotPossible);
  EXPECT_THAT(result.text, testing::HasSubstr("the states of its controllers were not saved"));
  EXPECT_EQ(StateHash(*after->frame), hashes.back());
  EXPECT_EQ(Save()->controllers, after->controllers) << "the run is as it was";
}

TEST_F(StepperRestoreTest, AStepperDoesNotStartFromAStateWhoseControllersCannotBeRestored) {
  Begin(true);
  Steps(3);
  const SavedStatePtr saved = Save();
  driver_.refused = saved->controllers;
  const auto other = MakeStepper(clock_, options_, {nullptr, &driver_});
  Diagnostics diagnostics;
  EXPECT_FALSE(other->StartFrom(saved, diagnostics));
  EXPECT_THAT(diagnostics.ToString(), testing::HasSubstr("the run cannot continue from there"));
}

TEST_F(StepperRestoreTest, AStoppedControllerIsToldAgainOfItsState) {
  driver_.fails_after = 3;
  Begin(true);
  Steps(6);
  EXPECT_EQ(OwnerOf("robot2").name, "controller count (stopped)");
  const SavedStatePtr saved = Save();
  const auto hashes = Steps(5);
  driver_.fails_after = 1'000'000;
  Do(edit::Reset{});
  EXPECT_EQ(OwnerOf("robot2").name, "controller count");
  Do(edit::Restore{saved});
  EXPECT_EQ(OwnerOf("robot2").name, "controller count (stopped)");
  EXPECT_EQ(Steps(5), hashes);
}

TEST_F(StepperRestoreTest, ParticipantsAndOwnersAreKept) {
  Begin();
  const SavedStatePtr saved = Save();
  Step();
  Do(edit::SetParticipants{{"robot1"}});
  for (const EditAction& anew : {EditAction(edit::Restore{saved}), EditAction(edit::Reset{})}) {
    Do(anew);
    EXPECT_TRUE(OwnerOf("robot1").participates);
    EXPECT_FALSE(OwnerOf("robot3").participates);
    EXPECT_EQ(OwnerOf("robot3").name, "bob");
  }
}

TEST_F(StepperRestoreTest, AStateOfAnotherScenarioIsPutInForce) {
  Begin();
  Steps(12);
  const SavedStatePtr saved = Save();
  const auto hashes = Steps(20);
  Do(edit::Load{Read("[ROBOT_1]\ntype coopbot\nname alone\nposition 0 0\n")});
  ASSERT_EQ(now().scene->robots.size(), 1u);
  EXPECT_EQ(Do(edit::Restore{saved}).error, Error::kOk);
  EXPECT_EQ(now().step, 12u);
  EXPECT_EQ(Steps(20), hashes);
}

TEST_F(StepperRestoreTest, AStepperStartsFromAState) {
  Begin(true);
  Steps(12);
  const SavedStatePtr saved = Save();
  const auto hashes = Steps(20);
  stepper_ = MakeStepper(clock_, {}, {nullptr, &driver_});
  Diagnostics diagnostics;
  ASSERT_TRUE(stepper_->StartFrom(saved, diagnostics)) << diagnostics.ToString();
  EXPECT_EQ(Steps(20), hashes);
}

TEST_F(StepperRestoreTest, TheScenariosStepLengthHoldsFromTheFirstFrameOn) {
  Begin(true, "[SIMULATION]\nstep 4ms\n");
  EXPECT_EQ(now().step_length, 4'000'000);
  const SavedStatePtr saved = Save();
  Step();
  EXPECT_EQ(now().time, 4'000'000);
  Do(edit::Reset{});
  EXPECT_EQ(now().step_length, 4'000'000);
  Do(edit::Restore{saved});
  Step();
  EXPECT_EQ(now().time, 4'000'000);
  EXPECT_THAT(driver_.lengths, ElementsAre(4'000'000, 4'000'000)) << "what controllers are told";
}

TEST_F(StepperRestoreTest, ARunThatHadEndedGoesOnFromAnEarlierState) {
  options_.duration_s = 0.05;
  Begin();
  const SavedStatePtr saved = Save();
  Steps(5);
  EXPECT_EQ(control_.status().state, RunState::kEnded);
  Do(edit::Restore{saved});
  Steps(5);
  EXPECT_EQ(now().step, 5u);
  EXPECT_EQ(control_.status().state, RunState::kEnded);
}

}  // namespace
}  // namespace coopdyn
