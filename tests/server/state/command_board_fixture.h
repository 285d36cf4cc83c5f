// SPDX-License-Identifier: MIT
// A board with robots and two clients, without sockets and threads; the tests control the clock.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/state/command_board.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
inline constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

class CommandBoardTest : public testing::Test {
 protected:
  CommandBoardTest() { UseRobots({"robot1", "robot2"}); }

  RobotEntry MakeRobot(const std::string& name) {
    RobotEntry entry;
    entry.name = name;
    entry.model = model_;
    return entry;
  }
  RobotEntry MakeDriven(const std::string& name) {
    RobotEntry entry = MakeRobot(name);
    entry.controller.name = "diffuse";
    return entry;
  }

  void UseRobots(const std::vector<std::string>& names, StepEnd end = StepEnd::kLoad) {
    std::vector<RobotEntry> entries;
    for (const std::string& name : names) entries.push_back(MakeRobot(name));
    UseEntries(std::move(entries), end);
  }

  void UseEntries(std::vector<RobotEntry> entries, StepEnd end = StepEnd::kLoad) {
    auto scenario = std::make_shared<Scenario>();
    scenario->robots = std::move(entries);
    scene_ = MakeScene(std::move(scenario));
    board_.SetMode(Mode::kLockstep, now_);
    board_.Configure(*scene_, end, MakeFrame(0), now_);
  }

  FramePtr MakeFrame(std::uint64_t step) {
    auto frame = std::make_shared<Frame>();
    frame->step = step;
    frame->scene = scene_;
    return frame;
  }

  /// Runs a complete step; returns its set-points.
  std::vector<WheelSpeeds> RunStep() {
    std::vector<WheelSpeeds> result = ByRobot(board_.Latch(step_ + 1));
    board_.FinishStep(MakeFrame(++step_), now_);
    return result;
  }

  /// A StepDone that stores its result in `answers_[key]`.
  StepDone Note(const std::string& key) {
    return [this, key](const StepResult& result) { answers_[key].push_back(result); };
  }

  SlotId slot(const std::string& robot) { return board_.FindSlot(robot); }

  std::shared_ptr<RobotModel> model_ = [] {
    auto model = std::make_shared<RobotModel>();
    model->type = "test";
    model->links.resize(1);
    model->actuators = {{"motors", {0, 1}, DriveModel{}}};
    return model;
  }();
  CommandBoard board_;
  std::shared_ptr<const Scene> scene_;
  Nanoseconds now_ = 0;
  std::uint64_t step_ = 0;
  std::map<std::string, std::vector<StepResult>> answers_;
  const Client ana_{1, "ana", "127.0.0.1:1"};
  const Client bob_{2, "bob", "127.0.0.1:2"};
};

}  // namespace coopdyn
