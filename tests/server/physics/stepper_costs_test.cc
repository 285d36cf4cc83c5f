// SPDX-License-Identifier: MIT
// The costs of steps, by parts; the tests control the clock, which otherwise stands still.
#include <gtest/gtest.h>

#include "stepper_restore_fixture.h"

namespace coopdyn {
namespace {

constexpr Nanoseconds kMs = 1'000'000;

class StepperCostsTest : public StepperRestoreTest {
 protected:
  /// A journal that needs 3 ms per step.
  class SlowJournal final : public RunJournal {
   public:
    explicit SlowJournal(ManualClock& clock) : clock_(clock) {}
    void Begin(const SavedStatePtr&) override {}
    bool WantsKeyframe(std::uint64_t) override { return false; }
    void Step(const FramePtr&, Mode, SavedStatePtr, Nanoseconds) override { clock_.Advance(3 * kMs); }
    void Input(RunInput) override {}
    void Note(Event) override {}

   private:
    ManualClock& clock_;
  };

  StepperCostsTest() { clock_.Advance(kNanosecondsPerSecond); }
  /// As published, which happens at the latest when the run pauses.
  StepCosts Costs() {
    clock_.Advance(kNanosecondsPerSecond);
    Step();
    return control_.status().costs;
  }
};

TEST_F(StepperCostsTest, WhatTheJournalTakesIsItsOwn) {
  Begin();
  SlowJournal journal(clock_);
  Do(edit::SetJournal{&journal});
  Steps(2);
  const StepCosts costs = Costs();
  EXPECT_EQ(costs.steps, 3u);
  EXPECT_EQ(costs.journal, 9 * kMs);
  EXPECT_EQ(costs.busy, 9 * kMs);
  EXPECT_EQ(costs.answer, 0);
}

TEST_F(StepperCostsTest, TellingWhoWaitsIsItsOwn) {
  Begin();
  board_.AddObserver([this](const FramePtr&) { clock_.Advance(2 * kMs); });
  Step();
  EXPECT_EQ(Costs().answer, 4 * kMs);
}

TEST_F(StepperCostsTest, TimeBetweenStepsIsIdle) {
  Begin();
  Step();
  clock_.Advance(7 * kMs);
  Step();
  EXPECT_EQ(Costs().idle, 7 * kMs + kNanosecondsPerSecond);
}

TEST_F(StepperCostsTest, APauseIsNotIdle) {
  Begin();
  Step();
  Do(edit::Pause{});
  clock_.Advance(7 * kMs);
  Do(edit::Run{});
  Step();
  EXPECT_EQ(Costs().idle, kNanosecondsPerSecond);
}

TEST_F(StepperCostsTest, AResetBeginsAnew) {
  Begin();
  Steps(5);
  const std::uint64_t runs = Costs().runs;
  Do(edit::Reset{});
  const StepCosts costs = Costs();
  EXPECT_EQ(costs.runs, runs + 1);
  EXPECT_EQ(costs.steps, 1u);
  EXPECT_EQ(costs.idle, 0);
}

}  // namespace
}  // namespace coopdyn
