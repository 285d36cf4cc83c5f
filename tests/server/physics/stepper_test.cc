// SPDX-License-Identifier: MIT
// The physics thread and the baton, with real threads and the shipped robot.
#include "server/physics/stepper.h"

#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "tests/server/physics/stepper_boards.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

constexpr const char* kTwoRobots = R"([ROBOT_1]
type coopbot
name robot1
position 0 0
[ROBOT_2]
type coopbot
name robot2
position 0 2 0
)";

class StepperTest : public StepperBoards {
 protected:
  void Begin(const std::string& text, Mode mode, RunOptions options = {}) {
    options.mode = mode;
    stepper_ = MakeStepper(clock_, options);
    Diagnostics diagnostics;
    ASSERT_TRUE(stepper_->Start(Read(text), diagnostics)) << diagnostics.ToString();
  }

  void StartThread() {
    thread_ = std::jthread([this](std::stop_token stop) { stepper_->Run(stop); });
  }

  void TearDown() override {
    thread_.request_stop();
    bell_.Ring();
    if (thread_.joinable()) thread_.join();
  }

  /// A StepDone whose result goes to the returned future.
  static std::future<StepResult> Expect(StepDone& done) {
    auto promise = std::make_shared<std::promise<StepResult>>();
    done = [promise](const StepResult& result) { promise->set_value(result); };
    return promise->get_future();
  }

  /// Pushes an edit and waits for its result.
  EditResult Do(EditAction action) {
    auto promise = std::make_shared<std::promise<EditResult>>();
    edits_.Push({std::move(action), [promise](const EditResult& result) { promise->set_value(result); }});
    return promise->get_future().get();
  }

  /// Waits until `steps` more steps have run.
  StepResult WaitSteps(int steps) {
    StepDone done;
    auto result = Expect(done);
    board_.WaitSteps(steps, done);
    return result.get();
  }

  StepResult Command(const char* robot, const Client& client, const WheelSpeeds& setpoint,
                     std::optional<int> steps = {}) {
    StepDone done;
    auto result = Expect(done);
    board_.Command(board_.FindSlot(robot), client, SetpointsFor(setpoint), steps, done);
    return result.get();
  }

  SteadyClock clock_;
  std::unique_ptr<Stepper> stepper_;
  std::jthread thread_;
  const Client ana_{1, "ana", "a"}, bob_{2, "bob", "b"};
};

TEST_F(StepperTest, AnEditFromBeforeTheStartTakesEffectEvenIfTheRunEndsAtOnce) {
  Begin(kTwoRobots, Mode::kLockstep);
  EditResult result{Error::kNotPossible, "nobody answered"};
  edits_.Push({edit::SetJournal{nullptr}, [&result](const EditResult& given) { result = given; }});
  std::stop_source stop;
  stop.request_stop();
  stepper_->Run(stop.get_token());
  EXPECT_EQ(result.error, Error::kOk) << result.text;
}

TEST_F(StepperTest, TheLastReadyRobotsThreadRunsTheStepItself) {
  Begin(kTwoRobots, Mode::kLockstep);  // no physics thread at all
  board_.Ready(board_.FindSlot("robot1"), ana_, 1, [](const StepResult&) {});
  EXPECT_EQ(frames_.Latest()->step, 0u);
  board_.Ready(board_.FindSlot("robot2"), bob_, 1, [](const StepResult&) {});
  EXPECT_EQ(frames_.Latest()->step, 1u);
}

TEST_F(StepperTest, ItRunsAllStepsOfAShortCommand) {
  const ManualClock clock;  // however busy the machine is
  RunOptions options;
  options.mode = Mode::kLockstep;
  stepper_ = MakeStepper(clock, options);  // no physics thread at all
  Diagnostics diagnostics;
  ASSERT_TRUE(stepper_->Start(Read(kTwoRobots), diagnostics)) << diagnostics.ToString();
  for (const char* robot : {"robot1", "robot2"})
    board_.Ready(board_.FindSlot(robot), Client{1, robot, "a"}, 5, [](const StepResult&) {});
  EXPECT_EQ(frames_.Latest()->step, 5u);
  stepper_.reset();  // before its clock
}

TEST_F(StepperTest, ACommandForManyStepsIsCarriedOnByThePhysicsThread) {
  Begin(kTwoRobots, Mode::kLockstep);
  StartThread();
  board_.Command(board_.FindSlot("robot1"), ana_, Wheels(3, 3), 50, [](const StepResult&) {});
  const StepResult result = Command("robot2", bob_, {3, 3}, 50);
  EXPECT_EQ(result.frame->step, 50u);
  EXPECT_EQ(result.frame->time, 50 * kDefaultStep);
  EXPECT_EQ(SetpointOf(*result.frame, 0), (WheelSpeeds{3, 3}));
}

TEST_F(StepperTest, TheSameCommandsGiveTheSameHashWhoeverRunsTheSteps) {
  std::vector<std::uint64_t> hashes;
  for (const bool thread : {false, true}) {
    Begin(kTwoRobots, Mode::kLockstep);
    if (thread) StartThread();
    for (int k = 0; k < 50; ++k) {
      board_.Command(board_.FindSlot("robot1"), ana_, Wheels(0.1 * k, 2), {}, [](const StepResult&) {});
      Command("robot2", bob_, {2, 0.1 * k});
    }
    hashes.push_back(StateHash(*frames_.Latest()));
    TearDown();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(StepperTest, ResetGivesTheHashesOfAFreshStart) {
  Begin(kTwoRobots, Mode::kFree);
  StartThread();
  Do(edit::Pause{});
  std::vector<std::uint64_t> hashes;
  for (int run = 0; run < 3; ++run) {
    EXPECT_EQ(Do(edit::Reset{}).frame->step, 0u);
    StepDone done;
    auto ran = Expect(done);
    edits_.Push({edit::Step{20}, nullptr, done});
    hashes.push_back(StateHash(*ran.get().frame));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[1], hashes[2]);
}

TEST_F(StepperTest, RealtimeStepsByItself) {
  Begin(kTwoRobots, Mode::kRealtime);
  StartThread();
  const std::uint64_t before = frames_.Latest()->step;
  EXPECT_GE(WaitSteps(3).frame->step, before + 3);
}

TEST_F(StepperTest, PausedNothingRunsButTheAllowedSteps) {
  RunOptions options;
  options.paused = true;
  Begin(kTwoRobots, Mode::kFree, options);
  StartThread();
  EXPECT_EQ(Do(edit::SetSpeed{0}).frame->step, 0u);
  StepDone done;
  auto ran = Expect(done);
  edits_.Push({edit::Step{7}, nullptr, done});
  EXPECT_EQ(ran.get().frame->step, 7u);
  EXPECT_EQ(Do(edit::StopAll{}).frame->step, 7u);
  EXPECT_EQ(control_.status().state, RunState::kPaused);
}

TEST_F(StepperTest, PauseEndsStepNWhichTellsHowManyHaveRun) {
  RunOptions options;
  options.paused = true;
  Begin(kTwoRobots, Mode::kLockstep, options);
  StartThread();
  StepDone done;
  auto ended = Expect(done);
  edits_.Push({edit::Step{1'000'000}, nullptr, done});
  for (int k = 0; k < 3; ++k) {
    board_.Command(board_.FindSlot("robot1"), ana_, Wheels(1, 1), {}, [](const StepResult&) {});
    Command("robot2", bob_, {1, 1});
  }
  Do(edit::Pause{});
  const StepResult result = ended.get();
  EXPECT_EQ(result.end, StepEnd::kPaused);
  EXPECT_EQ(result.ran, 3);
  EXPECT_EQ(result.asked, 1'000'000);
  board_.Command(board_.FindSlot("robot1"), ana_, Wheels(1, 1), {}, [](const StepResult&) {});
  board_.Command(board_.FindSlot("robot2"), bob_, Wheels(1, 1), {}, [](const StepResult&) {});
  EXPECT_EQ(Do(edit::StopAll{}).frame->step, 3u) << "nothing more runs";
}

TEST_F(StepperTest, StepIsRefusedUnlessPaused) {
  Begin(kTwoRobots, Mode::kLockstep);
  StartThread();
  EXPECT_EQ(Do(edit::Step{1}).error, Error::kNotPossible);
}

TEST_F(StepperTest, ALoadThatCannotBeBuiltChangesNothing) {
  Begin(kTwoRobots, Mode::kLockstep);
  StartThread();
  board_.Ready(board_.FindSlot("robot1"), ana_, 1, [](const StepResult&) {});
  const std::uint64_t before = StateHash(*frames_.Latest());
  const EditResult result =
      Do(edit::Load{Read(std::string(kTwoRobots) + "[ROBOT_3]\ntype coopbot\nname robot3\nposition 0 0\n")});
  EXPECT_NE(result.error, Error::kOk);
  EXPECT_NE(result.text.find("test.scenario:"), std::string::npos) << result.text;
  EXPECT_EQ(StateHash(*result.frame), before);
  StepDone done;
  auto ran = Expect(done);
  board_.Ready(board_.FindSlot("robot2"), bob_, 1, done);
  EXPECT_EQ(ran.get().frame->step, 1u);
}

TEST_F(StepperTest, TheRunEndsAtItsDuration) {
  RunOptions options;
  options.duration_s = 0.25;
  options.ends_daemon = true;
  Begin(kTwoRobots, Mode::kFree, options);
  std::promise<void> ended;
  stepper_->set_on_ended([&] { ended.set_value(); });
  StartThread();
  ended.get_future().wait();
  EXPECT_EQ(frames_.Latest()->step, 25u);
  EXPECT_EQ(control_.status().state, RunState::kEnded);
  EXPECT_EQ(Do(edit::Run{}).error, Error::kNotPossible);
}

TEST_F(StepperTest, NothingStepsBeforeThePhysicsThreadRunsIfItIsToWait) {
  Begin(kTwoRobots, Mode::kLockstep);
  stepper_->WaitForRun();
  board_.Ready(board_.FindSlot("robot1"), ana_, 1, [](const StepResult&) {});
  StepDone done;
  auto ran = Expect(done);
  board_.Ready(board_.FindSlot("robot2"), bob_, 1, done);
  EXPECT_EQ(frames_.Latest()->step, 0u) << "a recording may still have to begin";
  StartThread();
  EXPECT_EQ(ran.get().frame->step, 1u);
}

TEST_F(StepperTest, AWorldWhoseRunHasEndedRefusesCommandsUntilAReset) {
  RunOptions options;
  options.duration_s = 0.02;
  Begin(kTwoRobots, Mode::kLockstep, options);
  StartThread();
  board_.Ready(board_.FindSlot("robot1"), ana_, 5, [](const StepResult&) {});
  StepDone done;
  auto ran = Expect(done);
  board_.Ready(board_.FindSlot("robot2"), bob_, 5, done);
  EXPECT_EQ(ran.get().end, StepEnd::kStopping);
  EXPECT_EQ(frames_.Latest()->step, 2u);
  EXPECT_FALSE(control_.end());
  EXPECT_EQ(control_.status().ended, "the run has reached its duration");
  EXPECT_EQ(Do(edit::Run{}).text, "the run has ended: it has reached its duration: reset starts it again");
  Do(edit::Reset{});
  EXPECT_EQ(control_.status().state, RunState::kRunning);
  EXPECT_EQ(control_.status().ended, "");
}

TEST_F(StepperTest, TheRunEndsWithItsLastStep) {
  RunOptions options;
  options.steps = 25;
  options.ends_daemon = true;
  Begin(std::string(kTwoRobots) + "[SIMULATION]\nstep 4ms\nduration 0.01\n", Mode::kFree, options);
  std::promise<void> ended;
  stepper_->set_on_ended([&] { ended.set_value(); });
  StartThread();
  ended.get_future().wait();
  EXPECT_EQ(frames_.Latest()->step, 25u);
}

TEST_F(StepperTest, ADeadlineLetsTheWorldGoOnAndIsAnEvent) {
  Begin(std::string(kTwoRobots) + "deadline 0.02\non_deadline stop\n", Mode::kLockstep);
  StartThread();
  EXPECT_EQ(Command("robot1", ana_, {1, 1}, 30).frame->step, 30u);
  ASSERT_EQ(control_.events().size(), 1u);
  EXPECT_NE(control_.events()[0].text.find("robot2 missed its deadline"), std::string::npos);
}

TEST_F(StepperTest, AWatchdogStopsTheRobotOfASilentClientAndIsAnEvent) {
  Begin(std::string(kTwoRobots) + "watchdog 0.1s\n", Mode::kRealtime);
  StartThread();
  for (const Client& client : {ana_, bob_}) {
    board_.Command(board_.FindSlot(client.id == 1 ? "robot1" : "robot2"), client, SetpointsFor({1, 1}), {},
                   {});
  }
  while (control_.events().empty()) WaitSteps(1);
  const Event event = control_.events()[0];
  EXPECT_EQ(event.level, "warning");
  EXPECT_TRUE(event.text.starts_with("bob has been silent for ")) << event.text;
  EXPECT_NE(event.text.find("s: robot2 is stopped until its next command"), std::string::npos) << event.text;
  EXPECT_EQ(control_.stopped().at("robot2").by, "watchdog");
  EXPECT_EQ(board_.InForce()[0].reference, 1) << "ana's drives on";
  EXPECT_EQ(board_.InForce()[2].reference, 0);
}

TEST_F(StepperTest, ASpeedHoldsOnlyForTheModeItWasSetIn) {
  RunOptions options;
  options.paused = true;
  Begin(kTwoRobots, Mode::kRealtime, options);
  StartThread();
  Do(edit::SetSpeed{4});
  EXPECT_EQ(control_.status().speed, 4);
  Do(edit::SetMode{Mode::kFree});
  EXPECT_LE(control_.status().speed, 0);
  Do(edit::SetMode{Mode::kRealtime});
  EXPECT_EQ(control_.status().speed, 4);
}

TEST_F(StepperTest, StoppingEndsEveryWait) {
  Begin(kTwoRobots, Mode::kLockstep);
  StartThread();
  StepDone done;
  auto waiting = Expect(done);
  board_.Ready(board_.FindSlot("robot1"), ana_, 1, done);
  thread_.request_stop();
  bell_.Ring();
  EXPECT_EQ(waiting.get().end, StepEnd::kStopping);
}

}  // namespace
}  // namespace coopdyn
