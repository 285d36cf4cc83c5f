// SPDX-License-Identifier: MIT
// The stepper with loaded controllers, by a driver written by hand. No threads: the tests run the steps.
#include <gtest/gtest.h>

#include "tests/server/model/sensor_of.h"
#include "tests/server/physics/stepper_boards.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

/// Drives robot 0 at 2 rad/s and lets it broadcast the number of each step.
class Driver final : public ControllerDriver {
 public:
  void Check(const Scenario& scenario, Diagnostics& diagnostics) override {
    for (const RobotEntry& robot : scenario.robots) {
      if (robot.controller.name == "bad") diagnostics.Error(robot.controller.where, "no such option");
    }
  }
  void Configure(const FramePtr& frame) override {
    ++configured;
    EXPECT_EQ(frame->step, 0u);
    if (stops_at_once) stopped.push_back({"robot1", "it crashed"});
  }
  void Step(const FramePtr& frame, std::span<Setpoint> setpoints,
            std::vector<SentMessage>& messages) override {
    seen.push_back(frame->step);
    setpoints[0] = setpoints[1] = {2};
    RobotMessage message;
    message.count = 1;
    message.values[0] = static_cast<double>(frame->step + 1);
    messages.push_back({1, frame->step + 1, {}});
    messages.push_back({0, frame->step + 1, message});
    if (frame->step == 1) stopped.push_back({"robot1", "it divided by zero", with_daemon});
  }
  void Rest() override { ++rests; }
  void Unload(int robot) override { unloaded.push_back(robot); }
  std::vector<std::byte> Save() const override { return {}; }
  bool Restore(const FramePtr& frame, std::span<const std::byte> /*saved*/) override {
    Configure(frame);
    return true;
  }
  std::vector<int> Unloaded() const override { return {}; }
  void Stop(int /*robot*/, const std::string& /*why*/) override {}
  std::vector<StoppedController> TakeStopped() override { return std::exchange(stopped, {}); }
  PhaseTimes times() const override { return {10, 20, 0, 0}; }
  double child_cpu_s() const override { return 0; }

  bool stops_at_once = false, with_daemon = false;
  int configured = 0, rests = 0;
  std::vector<std::uint64_t> seen;
  std::vector<int> unloaded;
  std::vector<StoppedController> stopped;
};

class StepperControllersTest : public StepperBoards {
 protected:
  /// robot1, driven by `controller`, and robot2; they hear each other after `delay_steps`.
  static std::shared_ptr<const Scenario> TwoRobots(const std::string& controller, int delay_steps = 0) {
    const auto read = Read(
        "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
        "[ROBOT_2]\ntype coopbot\nname robot2\nposition 0 2\n");
    auto scenario = std::make_shared<Scenario>(*read);
    auto model = std::make_shared<RobotModel>(*read->robots[0].model);
    SensorOf<NeighboursModel>(*model) = {.range_m = 5, .message_range_m = 5, .delay_steps = delay_steps};
    for (RobotEntry& robot : scenario->robots) robot.model = model;
    scenario->robots[0].controller = {controller, controller + ".so", {}, {"test.scenario", 4}};
    return scenario;
  }

  std::string Start(std::shared_ptr<const Scenario> scenario, ControllerDriver* driver) {
    RunOptions options;
    options.mode = Mode::kLockstep;
    return Start(std::move(scenario), driver, options);
  }
  std::string Start(std::shared_ptr<const Scenario> scenario, ControllerDriver* driver,
                    const RunOptions& options) {
    stepper_ = MakeStepper(clock_, options, {nullptr, driver});
    Diagnostics diagnostics;
    stepper_->Start(std::move(scenario), diagnostics);
    return diagnostics.ToString();
  }
  /// Five steps as fast as `options` allow, by the loop of the physics thread.
  void RunFive(RunOptions options) {
    options.mode = Mode::kFree;
    options.duration_s = 0.05;
    options.ends_daemon = true;
    Start(TwoRobots("good"), &driver_, options);
    std::stop_source stop;
    stepper_->set_on_ended([&stop] { stop.request_stop(); });
    stepper_->Run(stop.get_token());
    EXPECT_EQ(frames_.Latest()->step, 5u);
  }
  /// Makes robot2, the only participant, ready, which runs the step.
  void Step() {
    board_.Ready(board_.FindSlot("robot2"), {1, "ana", "a"}, 1, [](const StepResult&) {});
  }

  SteadyClock clock_;
  Driver driver_;
  std::unique_ptr<Stepper> stepper_;
};

TEST_F(StepperControllersTest, ADrivenRobotMovesAsItsControllerSays) {
  EXPECT_EQ(Start(TwoRobots("good"), &driver_), "");
  EXPECT_EQ(driver_.configured, 1);
  for (int k = 0; k < 3; ++k) Step();
  EXPECT_EQ(driver_.seen, (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(SetpointOf(*frames_.Latest(), 0), (WheelSpeeds{2, 2}));
  EXPECT_EQ(SetpointOf(*frames_.Latest(), 1), (WheelSpeeds{0, 0}));
}

TEST_F(StepperControllersTest, LockstepDoesNotWaitForADrivenRobot) {
  Start(TwoRobots("good"), &driver_);
  Step();
  EXPECT_EQ(frames_.Latest()->step, 1u);
}

TEST_F(StepperControllersTest, AStoppedControllerIsAnEvent) {
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 3; ++k) Step();
  const std::vector<Event> events = control_.events();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].step, 2u);
  EXPECT_EQ(events[0].level, "error");
  EXPECT_EQ(events[0].text, "robot1 stands: it divided by zero");
}

TEST_F(StepperControllersTest, ItsRobotIsListedWithStepTimeAndReason) {
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 3; ++k) Step();
  const StoppedRobots stopped = control_.stopped();
  ASSERT_EQ(stopped.size(), 1u);
  EXPECT_EQ(stopped.at("robot1").by, "controller");
  EXPECT_EQ(stopped.at("robot1").step, 2u);
  EXPECT_EQ(stopped.at("robot1").time_s, 0.02);
  EXPECT_EQ(stopped.at("robot1").why, "it divided by zero");
  EXPECT_FALSE(control_.end());
}

TEST_F(StepperControllersTest, AResetForgetsWhoWasStoppedButForTheReport) {
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 3; ++k) Step();
  ASSERT_FALSE(control_.stopped().empty());
  std::stop_source stop;
  edits_.Push({edit::Reset{}, [&](const EditResult&) {
                 stop.request_stop();
                 bell_.Ring();
               }});
  stepper_->Run(stop.get_token());
  EXPECT_TRUE(control_.stopped().empty());
  const StoppedRobots told = control_.stopped_or_failed();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told.at("robot1").step, 2u);
  control_.AddStopped("robot1", {"client", 9, 0.09, "lost its client ana"});
  EXPECT_EQ(control_.stopped_or_failed().at("robot1").by, "controller") << "the failure counts more";
}

TEST_F(StepperControllersTest, AControllerThatEndsWithTheDaemonHasNotFailed) {
  driver_.with_daemon = true;
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 3; ++k) Step();
  ASSERT_EQ(control_.events().size(), 1u);
  EXPECT_EQ(control_.events()[0].level, "info");
  EXPECT_TRUE(control_.stopped().empty());
}

TEST_F(StepperControllersTest, IfAskedToTheRunEndsWithTheStepInWhichOneFailed) {
  RunOptions options;
  options.mode = Mode::kFree;
  options.duration_s = 0.05;
  options.ends_daemon = true;
  options.stop_on_controller_failure = true;
  Start(TwoRobots("good"), &driver_, options);
  std::stop_source stop;
  stepper_->set_on_ended([&stop] { stop.request_stop(); });
  stepper_->Run(stop.get_token());
  EXPECT_EQ(frames_.Latest()->step, 2u);
  EXPECT_EQ(control_.end(), RunEnd::kController);
  EXPECT_EQ(control_.status().state, RunState::kEnded);
}

TEST_F(StepperControllersTest, IfAskedToARunWhoseControllerCannotStartNeverSteps) {
  driver_.stops_at_once = true;
  RunOptions options;
  options.mode = Mode::kFree;
  options.stop_on_controller_failure = true;
  stepper_ = MakeStepper(clock_, options, {nullptr, &driver_});
  std::stop_source stop;
  stepper_->set_on_ended([&stop] { stop.request_stop(); });
  Diagnostics diagnostics;
  stepper_->Start(TwoRobots("good"), diagnostics);
  EXPECT_TRUE(stop.stop_requested());
  EXPECT_EQ(control_.end(), RunEnd::kController);
  EXPECT_EQ(frames_.Latest()->step, 0u);
}

TEST_F(StepperControllersTest, TheOwnerSaysThatAControllerIsStopped) {
  Start(TwoRobots("good"), &driver_);
  EXPECT_EQ(board_.Owners()[0].name, "controller good");
  for (int k = 0; k < 3; ++k) Step();
  EXPECT_EQ(board_.Owners()[0].name, "controller good (stopped)");
}

TEST_F(StepperControllersTest, AControllerThatCannotStartIsAnEventAtStepZero) {
  driver_.stops_at_once = true;
  EXPECT_EQ(Start(TwoRobots("good"), &driver_), "");
  ASSERT_EQ(control_.events().size(), 1u);
  EXPECT_EQ(control_.events()[0].step, 0u);
}

TEST_F(StepperControllersTest, WrongOptionsAreErrorsOfTheScenario) {
  EXPECT_EQ(Start(TwoRobots("bad"), &driver_), "test.scenario:4: error: no such option\n");
}

TEST_F(StepperControllersTest, WithoutADriverAControllerIsAnError) {
  EXPECT_NE(Start(TwoRobots("good"), nullptr).find("test.scenario:4: error: "), std::string::npos);
}

TEST_F(StepperControllersTest, BroadcastsOfAStepLieInItsFrameBySender) {
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 2; ++k) Step();
  const FramePtr frame = frames_.Latest();
  ASSERT_EQ(frame->messages.size(), 2u);
  EXPECT_EQ(frame->messages[0].robot, 0u);
  EXPECT_EQ(frame->messages[0].step, 2u);
  EXPECT_EQ(frame->messages[0].message.values[0], 2);
  EXPECT_EQ(frame->messages[1].robot, 1u);
}

TEST_F(StepperControllersTest, BroadcastsStayAsLongAsTheyMayBeHeard) {
  Start(TwoRobots("good", 3), &driver_);
  for (int k = 0; k < 10; ++k) Step();
  const FramePtr frame = frames_.Latest();
  ASSERT_EQ(frame->messages.size(), 8u);  // of steps 7, 8, 9 and 10
  EXPECT_EQ(frame->messages.front().step, 7u);
  EXPECT_EQ(frame->messages.back().step, 10u);
}

TEST_F(StepperControllersTest, TheyRestWhenNoStepFollowsAtOnce) {
  RunFive({});
  EXPECT_EQ(driver_.rests, 1);
}

TEST_F(StepperControllersTest, TheyRestWhileTheNextStepIsAwaited) {
  RunOptions options;
  options.speed = 10;
  RunFive(options);
  EXPECT_GT(driver_.rests, 4);
}

TEST_F(StepperControllersTest, TheyRestBeforeAnythingIsEdited) {
  int rests_before = -1;
  edits_.Push({edit::StopAll{}, [&](const EditResult&) { rests_before = driver_.rests; }});
  RunFive({});
  EXPECT_EQ(rests_before, 1);
}

TEST_F(StepperControllersTest, TheyRestAfterAStepOnTheThreadOfWhoeverMadeItPossible) {
  Start(TwoRobots("good"), &driver_);
  for (int k = 0; k < 3; ++k) Step();
  EXPECT_EQ(driver_.rests, 3);
}

TEST_F(StepperControllersTest, TimesAddThoseOfTheControllers) {
  Start(TwoRobots("good"), &driver_);
  Step();
  const PhaseTimes times = stepper_->phase_times();
  EXPECT_EQ(times.sense, 10);
  EXPECT_EQ(times.control, 20);
  EXPECT_GT(times.physics, 0);
}

}  // namespace
}  // namespace coopdyn
