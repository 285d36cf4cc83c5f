// SPDX-License-Identifier: MIT
// The stepper with a supervisor, by a driver written by hand. No threads: the tests run the steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/server/physics/stepper_boards.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Returns the actions that the test has scripted for the step after each frame.
class Scripted final : public ControllerDriver {
 public:
  void Step(const FramePtr& frame, std::span<Setpoint> /*setpoints*/,
            std::vector<SentMessage>& /*messages*/) override {
    now = frame->step;
  }
  Supervision TakeSupervision() override { return script[now]; }
  std::vector<StoppedController> TakeStopped() override { return std::exchange(stopped, {}); }

  std::map<std::uint64_t, Supervision> script;  // by the step of the frame seen
  std::vector<StoppedController> stopped;
  std::uint64_t now = 0;
};

class StepperSupervisorTest : public StepperBoards {
 protected:
  static constexpr std::int32_t kRobot1 = WorldId::kRobots + 1, kRobot2 = WorldId::kRobots + 2;

  /// Two robots, a box that is fixed, a ball and a target.
  void Start() {
    auto scenario = std::make_shared<Scenario>(
        *Read("[FLOOR]\nsize 20 20\n[TARGET]\nred 3 0\n[BOX_1]\ntype box\nsize 0.4 0.4 0.4\nposition 0 5\n"
              "[BALL_1]\ntype sphere\nsize 0.2\nmass 1\nposition 2 5\n"
              "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n"
              "[ROBOT_2]\ntype coopbot\nname robot2\nposition 0 2\nsync no\n"));
    scenario->simulation.supervisor = {"boss", "boss.so", {}, {"test.scenario", 2}};
    RunOptions options;
    options.ends_daemon = true;
    options.mode = Mode::kLockstep;
    stepper_ = MakeStepper(clock_, options, {nullptr, &driver_});
    Diagnostics diagnostics;
    ASSERT_TRUE(stepper_->Start(scenario, diagnostics)) << diagnostics.ToString();
  }
  /// Makes robot1, the only participant, ready, which runs the step. Returns the reported frame.
  FramePtr Step() {
    FramePtr told;
    board_.Ready(board_.FindSlot("robot1"), {1, "ana", "a"}, 1,
                 [&told](const StepResult& result) { told = result.frame; });
    return told;
  }
  static Supervision::Move To(std::int32_t id, double x_m, double y_m) {
    return {id, {{x_m, y_m, id == 1 ? 0.2 : id == 2 ? 0.1 : 0}, Quaternion::Identity()}};
  }
  std::vector<std::string> Events() const {
    std::vector<std::string> texts;
    for (const Event& event : control_.events()) texts.push_back(event.text);
    return texts;
  }

  SteadyClock clock_;
  Scripted driver_;
  std::unique_ptr<Stepper> stepper_;
};

TEST_F(StepperSupervisorTest, AMoveIsInTheFrameOfItsStep) {
  Start();
  driver_.script[1].moves = {To(kRobot2, 5, 5), To(1, -3, 0), To(2, -5, 0), To(WorldId::kTargets + 1, 4, 4)};
  EXPECT_NEAR(RobotPose(*Step(), 1).p.y(), 2, 1e-3);
  const FramePtr told = Step();
  EXPECT_EQ(told->step, 2u);
  EXPECT_EQ(told, frames_.Latest());
  EXPECT_NEAR((RobotPose(*told, 1).p - Vector3(5, 5, 0)).norm(), 0, 1e-9);
  EXPECT_EQ(ObjectPose(*told, told->scene->objects[0]).p, Vector3(-3, 0, 0.2));
  EXPECT_EQ(ObjectPose(*told, told->scene->objects[1]).p, Vector3(-5, 0, 0.1));
  EXPECT_EQ(told->scene->targets[0].p_WT, Vector3(4, 4, 0));
  EXPECT_NEAR((RobotPose(*Step(), 1).p - Vector3(5, 5, 0)).norm(), 0, 1e-3) << "it stays there";
  EXPECT_THAT(Events(), ElementsAre("supervisor boss: move robot2 BOX_1 BALL_1 red_target_1"));
}

TEST_F(StepperSupervisorTest, TwoRobotsMayChangePlaces) {
  Start();
  driver_.script[0].moves = {To(kRobot1, 0, 2), To(kRobot2, 0, 0)};
  const FramePtr told = Step();
  EXPECT_NEAR(RobotPose(*told, 0).p.y(), 2, 1e-9);
  EXPECT_NEAR(RobotPose(*told, 1).p.y(), 0, 1e-9);
}

TEST_F(StepperSupervisorTest, IfOneMoveCannotBeNothingMovesAndOneEventSaysWhy) {
  Start();
  for (std::uint64_t k = 0; k < 3; ++k) driver_.script[k].moves = {To(1, -3, 0), To(kRobot2, 0, 0.05)};
  for (int k = 0; k < 3; ++k) Step();
  const FramePtr frame = frames_.Latest();
  EXPECT_EQ(ObjectPose(*frame, frame->scene->objects[0]).p.x(), 0);
  EXPECT_NEAR(RobotPose(*frame, 1).p.y(), 2, 1e-3);
  EXPECT_THAT(Events(), ElementsAre(HasSubstr("supervisor boss moves nothing: ")));
}

TEST_F(StepperSupervisorTest, WhatIsNotThereOrMovedTwiceIsRefused) {
  Start();
  driver_.script[0].moves = {To(77, 1, 1)};
  driver_.script[1].moves = {To(1, 4, 4), To(1, 5, 5)};
  Step();
  Step();
  EXPECT_THAT(Events(), ElementsAre("supervisor boss moves nothing: there is nothing with the id 77",
                                    "supervisor boss moves nothing: 1 is moved twice in one step"));
}

TEST_F(StepperSupervisorTest, ASeriesOfMovesIsOneEvent) {
  Start();
  for (std::uint64_t k = 0; k < 5; ++k) driver_.script[k].moves = {To(1, 4, 0.1 * static_cast<double>(k))};
  for (int k = 0; k < 8; ++k) Step();
  driver_.script[9].moves = {To(1, 4, 3)};
  for (int k = 0; k < 8; ++k) Step();
  EXPECT_EQ(Events().size(), 2u);
}

TEST_F(StepperSupervisorTest, MovesAreNoEditsThatAClientTakesBack) {
  Start();
  driver_.script[0].moves = {To(1, 4, 4)};
  Step();
  edits_.Push({edit::Undo{}, [](const EditResult& result) { EXPECT_NE(result.error, Error::kOk); }});
  std::stop_source stop;
  edits_.Push({edit::Pause{}, [&](const EditResult&) { stop.request_stop(); }});
  stepper_->Run(stop.get_token());
  EXPECT_EQ(control_.status().undo, 0u);
}

TEST_F(StepperSupervisorTest, ALogIsOfTheFrameThatWasSeen) {
  Start();
  driver_.script[1].logs = {{"robot1.energy", 3.5}, {"round", 1}};
  Step();
  EXPECT_TRUE(control_.logged().empty());
  Step();
  const auto logged = control_.logged();
  ASSERT_EQ(logged.size(), 2u);
  EXPECT_EQ(logged.at("robot1.energy").value, 3.5);
  EXPECT_EQ(logged.at("round").step, 1u);
  EXPECT_EQ(logged.at("round").time_s, 0.01);
}

TEST_F(StepperSupervisorTest, TooManyNamesAreOneEvent) {
  Start();
  for (int i = 0; i < 103; ++i) driver_.script[0].logs.push_back({"n" + std::to_string(i), 1});
  Step();
  EXPECT_EQ(control_.logged().size(), 100u);
  EXPECT_THAT(Events(), ElementsAre("n100 is not logged: 100 names are already logged: log one of those"));
}

TEST_F(StepperSupervisorTest, EndsTheRunAfterTheStep) {
  Start();
  driver_.script[2].end = "the ball is in the goal";
  bool ended = false;
  stepper_->set_on_ended([&ended] { ended = true; });
  for (int k = 0; k < 5; ++k) Step();
  EXPECT_TRUE(ended);
  EXPECT_EQ(frames_.Latest()->step, 3u);
  EXPECT_EQ(control_.end(), RunEnd::kSupervisor);
  EXPECT_THAT(Events(), ElementsAre("supervisor boss ends the run: the ball is in the goal"));
}

TEST_F(StepperSupervisorTest, OneThatFailedIsAnErrorThatNamesNoRobot) {
  Start();
  driver_.stopped = {{"supervisor boss", "controller boss crashed (abort)"}};
  Step();
  EXPECT_THAT(Events(), ElementsAre("the run no longer has a supervisor: controller boss crashed (abort)"));
  EXPECT_EQ(control_.stopped().at("supervisor boss").by, "controller");
}

}  // namespace
}  // namespace coopdyn
