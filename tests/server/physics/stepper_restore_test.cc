// SPDX-License-Identifier: MIT
// Saved states, resets and journals, as the stepper makes them. No threads: edits are applied and steps run
// by the test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "server/model/readers.h"
#include "server/physics/stepper.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Writes down what it is told, as texts.
class Journal final : public RunJournal {
 public:
  void Begin(const SavedStatePtr& state) override {
    states.push_back(state);
    log.push_back("begin " + std::to_string(state->frame->step));
  }
  bool WantsKeyframe(std::uint64_t step) override {
    asked.push_back(step);
    return step % 3 == 0;
  }
  void Step(const FramePtr& frame, Mode mode, bool keyframe, std::vector<std::byte> controllers) override {
    frames.push_back(frame);
    std::string line = "step " + std::to_string(frame->step) + " " + ToString(mode);
    if (keyframe) line += " key " + std::to_string(controllers.size());
    EXPECT_TRUE(keyframe || controllers.empty());
    log.push_back(line);
  }
  void Input(RunInput input) override {
    log.push_back("input " + std::to_string(input.step) + " " + input.action +
                  (input.detail.empty() ? "" : " " + input.detail));
  }
  void Note(Event event) override { log.push_back("note " + std::to_string(event.step) + " " + event.level); }
  std::vector<std::string> Take() { return std::exchange(log, {}); }

  std::vector<std::string> log;
  std::vector<SavedStatePtr> states;
  std::vector<FramePtr> frames;
  std::vector<std::uint64_t> asked;
};

/// Turns the wheels of its robots by how often it was asked, which is its state.
class Counting final : public ControllerDriver {
 public:
  void Check(const Scenario&, Diagnostics&) override {}
  void Configure(const FramePtr& frame) override {
    count_ = 0;
    unloaded_.clear();
    stopped_ = fails_at_start;
    told_ = !stopped_;
    lengths.push_back(frame->step_length);
  }
  void Step(const FramePtr& frame, std::span<Setpoint> setpoints, std::vector<SentMessage>&) override {
    ++count_;
    if (frame->step == fails_after) told_ = !(stopped_ = true);
    for (std::size_t i = 0; i < setpoints.size(); ++i) {
      if (frame->scene->robots[i].entry.controller.empty() || unloaded_.contains(static_cast<int>(i)))
        continue;
      const double speed = stopped_ ? 0 : 0.5 * (count_ % 8);
      setpoints[i] = {speed, 2 - speed};
    }
  }
  void Unload(int robot) override { unloaded_.insert(robot); }
  std::vector<std::byte> Save() const override {
    std::vector<std::byte> bytes = {static_cast<std::byte>(count_), static_cast<std::byte>(stopped_)};
    for (const int robot : unloaded_) bytes.push_back(static_cast<std::byte>(robot));
    return bytes;
  }
  bool Restore(const FramePtr& /*frame*/, std::span<const std::byte> saved) override {
    count_ = static_cast<int>(saved[0]);
    stopped_ = static_cast<int>(saved[1]) != 0;
    told_ = !stopped_;
    unloaded_.clear();
    for (const std::byte robot : saved.subspan(2)) unloaded_.insert(static_cast<int>(robot));
    return true;
  }
  std::vector<int> Unloaded() const override { return {unloaded_.begin(), unloaded_.end()}; }
  void Stop(int, const std::string&) override { stopped_ = true; }
  std::vector<StoppedController> TakeStopped() override {
    if (std::exchange(told_, true)) return {};
    return {{"robot2", "controller count crashed"}};
  }
  PhaseTimes times() const override { return {}; }
  double child_cpu_s() const override { return 0; }

  bool fails_at_start = false;
  std::uint64_t fails_after = 1'000'000;
  std::vector<Nanoseconds> lengths;

 private:
  int count_ = 0;
  bool stopped_ = false, told_ = true;
  std::set<int> unloaded_;
};

constexpr const char* kRobots =
    "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\ndeadline 1s\non_deadline stop\n"
    "[ROBOT_2]\ntype coopbot\nname robot2\nposition 0 2\n"
    "[ROBOT_3]\ntype coopbot\nname robot3\nposition 0 4\n";

class StepperRestoreTest : public testing::Test {
 protected:
  static std::shared_ptr<const Scenario> Read(const std::string& text) {
    static RobotLibrary robots(SearchPath{{COOPDYN_SOURCE_DIR}});
    Diagnostics diagnostics;
    auto scenario = ReadScenario(text, "test.scenario", robots, false, diagnostics);
    EXPECT_NE(scenario, nullptr) << diagnostics.ToString();
    return scenario;
  }
  /// robot1 and robot3 are driven by clients, robot2 by a controller if `driven`.
  void Begin(bool driven = false, const std::string& more = "") {
    auto scenario = std::make_shared<Scenario>(*Read(kRobots + more));
    if (driven) scenario->robots[1].controller = {"count", "count.so", {}, {"test.scenario", 9}};
    options_.mode = Mode::kLockstep;
    stepper_ = std::make_unique<Stepper>(Stepper::Boards{frames_, board_, edits_, control_, bell_}, clock_,
                                         NullLogger(), options_, StepHelpers{nullptr, &driver_});
    Diagnostics diagnostics;
    ASSERT_TRUE(stepper_->Start(scenario, diagnostics)) << diagnostics.ToString();
  }
  /// Applies an edit. Nothing steps meanwhile, as nobody has commanded anything.
  EditResult Do(EditAction action) {
    EditResult result;
    stepper_->TakeOver({std::move(action), [&result](const EditResult& done) { result = done; }});
    return result;
  }
  SavedStatePtr Save() { return Do(edit::Save{}).saved; }
  const Frame& now() { return *frames_.Latest(); }

  /// A step in which robot1 and robot3 are commanded as their step number says; returns the hash after it.
  std::uint64_t Step() {
    const double wave = static_cast<double>(now().step % 7);
    board_.Command(board_.FindSlot("robot1"), ana_, {wave, 2}, {}, [](const StepResult&) {});
    if (now().step % 3 == 0) {
      board_.Command(board_.FindSlot("robot3"), bob_, {1, wave}, {}, [](const StepResult&) {});
    } else {
      board_.Ready(board_.FindSlot("robot3"), bob_, 1, [](const StepResult&) {});
    }
    if (!IsDriven("robot2")) Keep("robot2");
    return StateHash(now());
  }
  /// A step in which nobody commands anything new.
  std::uint64_t Keep() {
    for (const char* robot : {"robot1", "robot3", "robot2"}) {
      if (!IsDriven(robot)) Keep(robot);
    }
    return StateHash(now());
  }
  std::vector<std::uint64_t> Steps(int count) {
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < count; ++i) hashes.push_back(Step());
    return hashes;
  }
  void Keep(const char* robot) {
    board_.Ready(board_.FindSlot(robot), robot == std::string("robot3") ? bob_ : ana_, 1,
                 [](const StepResult&) {});
  }
  bool IsDriven(const std::string& robot) { return OwnerOf(robot).driven; }
  CommandBoard::Owner OwnerOf(const std::string& robot) {
    for (const CommandBoard::Owner& owner : board_.Owners()) {
      if (owner.robot == robot) return owner;
    }
    return {};
  }

  ManualClock clock_;
  Doorbell bell_;
  FrameBoard frames_;
  CommandBoard board_;
  EditQueue edits_{bell_};
  RunControl control_;
  Counting driver_;
  Journal journal_;
  RunOptions options_;
  std::unique_ptr<Stepper> stepper_;
  const Client ana_{1, "ana", "a"}, bob_{2, "bob", "b"};
};

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
  for (const bool restore : {true, false, true, true}) {
    Do(restore ? EditAction(edit::Restore{saved}) : EditAction(edit::Reset{}));
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
  for (const bool restore : {true, false}) {
    board_.Command(board_.FindSlot("robot1"), ana_, {1, 1}, {}, note);
    board_.Ready(board_.FindSlot("robot3"), bob_, 5, note);
    board_.WaitSteps(9, note);
    Do(restore ? EditAction(edit::Restore{saved}) : EditAction(edit::Reset{}));
    EXPECT_THAT(ends, ElementsAre(StepEnd::kReset, StepEnd::kReset, StepEnd::kReset));
    ends.clear();
  }
}

TEST_F(StepperRestoreTest, SetPointsInForceAreRestored) {
  Begin();
  Steps(5);
  const Setpoint in_force = now().robots[0].setpoint_rad_s;
  ASSERT_NE(in_force, Setpoint{});
  const SavedStatePtr saved = Save();
  Do(edit::Reset{});
  Keep();
  EXPECT_EQ(now().robots[0].setpoint_rad_s, Setpoint{});
  Do(edit::Restore{saved});
  Keep();
  EXPECT_EQ(now().robots[0].setpoint_rad_s, in_force);
}

TEST_F(StepperRestoreTest, WhatEditsHaveChangedSinceTheStepIsSavedToo) {
  Begin();
  Steps(5);
  Do(edit::StopAll{});
  Do(edit::SetStep{4'000'000});
  const SavedStatePtr saved = Save();
  const std::uint64_t next = Keep();
  EXPECT_EQ(now().robots[0].setpoint_rad_s, Setpoint{});
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
  for (const bool restore : {true, false}) {
    Do(restore ? EditAction(edit::Restore{saved}) : EditAction(edit::Reset{}));
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
  ASSERT_EQ(now().robots.size(), 1u);
  EXPECT_EQ(Do(edit::Restore{saved}).error, Error::kOk);
  EXPECT_EQ(now().step, 12u);
  EXPECT_EQ(Steps(20), hashes);
}

TEST_F(StepperRestoreTest, AStepperStartsFromAState) {
  Begin(true);
  Steps(12);
  const SavedStatePtr saved = Save();
  const auto hashes = Steps(20);
  stepper_ = std::make_unique<Stepper>(Stepper::Boards{frames_, board_, edits_, control_, bell_}, clock_,
                                       NullLogger(), RunOptions{}, StepHelpers{nullptr, &driver_});
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

// --- the journal

TEST_F(StepperRestoreTest, TheJournalBeginsWithTheStateAndGetsEachStep) {
  Begin(true);
  Steps(2);
  Do(edit::SetJournal{&journal_});
  Steps(2);
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 2", "step 3 lockstep key 2", "step 4 lockstep"));
  EXPECT_THAT(journal_.asked, ElementsAre(3u, 4u));
  ASSERT_EQ(journal_.states.size(), 1u);
  EXPECT_EQ(journal_.states[0]->mode, Mode::kLockstep);
  EXPECT_FALSE(journal_.states[0]->controllers.empty());
  EXPECT_EQ(journal_.frames.back(), frames_.Latest());
}

TEST_F(StepperRestoreTest, AJournalTakenAwayGetsNothingMore) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Do(edit::SetJournal{nullptr});
  Steps(2);
  Do(edit::Reset{});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0"));
}

TEST_F(StepperRestoreTest, ResetLoadAndRestoreBeginTheJournalAnew) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Steps(2);
  const SavedStatePtr saved = Save();
  Do(edit::Reset{3});
  Step();
  Do(edit::Restore{saved});
  Step();
  Do(edit::Load{Read(kRobots)});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "step 1 lockstep", "step 2 lockstep", "begin 0",
                                           "step 1 lockstep", "begin 2", "step 3 lockstep key 0", "begin 0"));
  EXPECT_EQ(journal_.states[1]->frame->seed, 3u);
  EXPECT_EQ(journal_.states[2]->setpoints, saved->setpoints);
}

TEST_F(StepperRestoreTest, EditsAreInputsOfTheStepAfterWhichTheyCame) {
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  Do(edit::SetMode{Mode::kFree});
  Do(edit::SetStep{5'000'000});
  Do(edit::SetSpeed{2});
  Do(edit::SetMode{Mode::kLockstep});
  Do(edit::SetParticipants{{"robot1", "robot3"}});
  Do(edit::StopAll{});
  Do(edit::Pause{});
  Do(edit::Run{});
  Do(edit::UnloadController{"robot2"});
  Do(edit::Save{});
  EXPECT_THAT(journal_.Take(), ElementsAre("input 1 set_mode free", "input 1 set_step 5000 us",
                                           HasSubstr("input 1 set_speed 2"), "input 1 set_mode lockstep",
                                           "input 1 set_participants robot1 robot3", "input 1 stop_all",
                                           "input 1 pause", "input 1 run", "input 1 release_robot robot2"));
}

TEST_F(StepperRestoreTest, RefusedEditsAreNoInputs) {
  Begin();
  Do(edit::SetJournal{&journal_});
  journal_.Take();
  EXPECT_NE(Do(edit::UnloadController{"nobody"}).error, Error::kOk);
  EXPECT_NE(Do(edit::SetParticipants{{"nobody"}}).error, Error::kOk);
  EXPECT_NE(Do(edit::Step{1, nullptr}).error, Error::kOk);
  EXPECT_NE(Do(edit::Seek{}).error, Error::kOk);
  EXPECT_THAT(journal_.Take(), IsEmpty());
}

TEST_F(StepperRestoreTest, ADeadlineIsAnInputAndAnEvent) {
  Begin();
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  Keep("robot2");
  Keep("robot3");
  clock_.Advance(2 * kNanosecondsPerSecond);
  std::stop_source stop;
  board_.AddObserver([&stop](const FramePtr&) { stop.request_stop(); });
  stepper_->Run(stop.get_token());
  EXPECT_THAT(journal_.Take(),
              ElementsAre("input 1 deadline robot1 stop", "note 1 warning", "step 2 lockstep"));
}

TEST_F(StepperRestoreTest, AControllerThatStopsIsAnInputBeforeItsStep) {
  driver_.fails_after = 1;
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Steps(3);
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "step 1 lockstep", "note 2 error",
                                           "input 1 controller_stopped robot2 controller count crashed",
                                           "step 2 lockstep", "step 3 lockstep key 2"));
}

TEST_F(StepperRestoreTest, AControllerThatStandsFromTheStartIsNoInput) {
  Begin(true);
  Do(edit::SetJournal{&journal_});
  Step();
  journal_.Take();
  driver_.fails_at_start = true;
  Do(edit::Reset{});
  EXPECT_THAT(journal_.Take(), ElementsAre("begin 0", "note 0 error"));
  EXPECT_EQ(journal_.states.back()->controllers.at(1), std::byte{1}) << "its state says so";
}

}  // namespace
}  // namespace coopdyn
