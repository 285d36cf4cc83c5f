// SPDX-License-Identifier: MIT
// A stepper whose states are saved, restored and written into a journal. No threads: edits are applied and
// steps run by the test.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/physics/stepper_boards.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {

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
  void Step(const FramePtr& frame, Mode mode, SavedStatePtr keyframe, Nanoseconds) override {
    frames.push_back(frame);
    std::string line = "step " + std::to_string(frame->step) + " " + ToString(mode);
    if (keyframe != nullptr) line += " key " + std::to_string(keyframe->controllers.size());
    EXPECT_TRUE(keyframe == nullptr || keyframe->frame == frame);
    log.push_back(line);
  }
  void Input(RunInput input) override {
    const InputText text = Encode(input);
    log.push_back("input " + std::to_string(input.step) + " " + text.action +
                  (text.detail.empty() ? "" : " " + text.detail));
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
    for (std::size_t i = 0; 2 * i < setpoints.size(); ++i) {
      if (frame->scene->robots[i].entry.controller.empty() || unloaded_.contains(static_cast<int>(i)))
        continue;
      const double speed = stopped_ ? 0 : 0.5 * (count_ % 8);
      setpoints[2 * i] = {speed};
      setpoints[2 * i + 1] = {2 - speed};
    }
  }
  void Unload(int robot) override { unloaded_.insert(robot); }
  std::vector<std::byte> Save() const override {
    std::vector<std::byte> bytes = {static_cast<std::byte>(count_), static_cast<std::byte>(stopped_)};
    for (const int robot : unloaded_) bytes.push_back(static_cast<std::byte>(robot));
    return bytes;
  }
  bool Restore(const FramePtr& /*frame*/, std::span<const std::byte> saved) override {
    if (refuses_all || std::ranges::equal(saved, refused)) return false;
    count_ = static_cast<int>(saved[0]);
    stopped_ = static_cast<int>(saved[1]) != 0;
    told_ = !stopped_;
    unloaded_.clear();
    for (const std::byte robot : saved.subspan(2)) unloaded_.insert(static_cast<int>(robot));
    return true;
  }
  std::vector<int> Unloaded() const override { return {unloaded_.begin(), unloaded_.end()}; }
  void Stop(int, const std::string&) override {
    if (!std::exchange(stopped_, true)) told_ = false;
  }
  std::vector<StoppedController> TakeStopped() override {
    if (std::exchange(told_, true)) return {};
    return {{"robot2", "controller count crashed"}};
  }
  PhaseTimes times() const override { return {}; }
  double child_cpu_s() const override { return 0; }

  bool fails_at_start = false, refuses_all = false;
  std::uint64_t fails_after = 1'000'000;
  std::vector<Nanoseconds> lengths;
  std::vector<std::byte> refused;  // that state does not fit

 private:
  int count_ = 0;
  bool stopped_ = false, told_ = true;
  std::set<int> unloaded_;
};

inline constexpr const char* kRobots =
    "[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\ndeadline 1s\non_deadline stop\n"
    "[ROBOT_2]\ntype coopbot\nname robot2\nposition 0 2\n"
    "[ROBOT_3]\ntype coopbot\nname robot3\nposition 0 4\n";

class StepperRestoreTest : public StepperBoards {
 protected:
  /// robot1 and robot3 are driven by clients, robot2 by a controller if `driven`.
  void Begin(bool driven = false, const std::string& more = "") {
    auto scenario = std::make_shared<Scenario>(*Read(kRobots + more));
    if (driven) scenario->robots[1].controller = {"count", "count.so", {}, {"test.scenario", 9}};
    options_.mode = Mode::kLockstep;
    stepper_ = MakeStepper(clock_, options_, {nullptr, &driver_});
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
    board_.Command(board_.FindSlot("robot1"), ana_, Wheels(wave, 2), {}, [](const StepResult&) {});
    if (now().step % 3 == 0) {
      board_.Command(board_.FindSlot("robot3"), bob_, Wheels(1, wave), {}, [](const StepResult&) {});
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
  Counting driver_;
  Journal journal_;
  RunOptions options_;
  std::unique_ptr<Stepper> stepper_;
  const Client ana_{1, "ana", "a"}, bob_{2, "bob", "b"};
};

}  // namespace coopdyn
