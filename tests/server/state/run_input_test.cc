// SPDX-License-Identifier: MIT
#include "server/state/run_input.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

struct Case {
  std::variant<RunEdit, RobotEvent, WorldInput> what;
  std::string action, detail;
};

std::vector<Case> AllInputs() {
  return {
      {edit::Run{}, "run", ""},
      {edit::Pause{}, "pause", ""},
      {edit::Step{3}, "step", "3"},
      {edit::SetMode{Mode::kLockstep}, "set_mode", "lockstep"},
      {edit::SetStep{12'345'000}, "set_step", "0.012345"},
      {edit::SetSpeed{0.1 + 0.2}, "set_speed", "0.30000000000000004"},
      {edit::SetSpeed{-1}, "set_speed", "-1.0"},
      {edit::SetParticipants{{"robot1", "ant_3"}}, "set_participants", "robot1 ant_3"},
      {edit::SetParticipants{}, "set_participants", ""},
      {edit::StopAll{}, "stop_all", ""},
      {edit::UnloadController{"robot2"}, "release_robot", "robot2"},
      {edit::TuneJoints{"robot1", "arm", command::kSetCompliance, {1, 3}, {50, 2, 0.1, 1e3, 0, -1}},
       "set_compliance", "/robot1/arm (1 3) 50.0 2.0 0.1 1000.0 0.0 -1.0"},
      {edit::TuneJoints{"robot1", "arm", command::kSetProfile, {}, {0.5, 2}}, "set_profile",
       "/robot1/arm 0.5 2.0"},
      {DeadlineFired{"robot3", LossPolicy::kStop}, "deadline", "robot3 stop"},
      {ClientLost{"robot3", LossPolicy::kDrop}, "disconnect", "robot3 drop"},
      {ControllerStopped{"supervisor referee", "controller referee crashed"}, "supervisor_stopped",
       "referee controller referee crashed"},
      {ControllerStopped{"robot2", "controller count crashed (signal 11)"}, "controller_stopped",
       "robot2 controller count crashed (signal 11)"},
  };
}

TEST(RunInputTest, EachHasATextThatReadsBackTheSame) {
  for (const Case& each : AllInputs()) {
    const InputText text = Encode({7, each.what});
    EXPECT_EQ(text, (InputText{each.action, each.detail}));
    const std::optional<RunInput> read = DecodeInput(7, text.action, text.detail);
    ASSERT_TRUE(read) << text.action;
    EXPECT_EQ(read->step, 7u);
    EXPECT_EQ(read->what.index(), each.what.index()) << text.action;
    EXPECT_EQ(Encode(*read), text);
  }
}

TEST(RunInputTest, StepsOfWholeMicrosecondsReadBackTheSame) {
  for (Nanoseconds step = kMinStep; step <= kMaxStep; step += 97'000) {
    const InputText text = Encode({0, edit::SetStep{step}});
    const std::optional<RunInput> read = DecodeInput(0, text.action, text.detail);
    ASSERT_TRUE(read) << text.detail;
    ASSERT_EQ(As<edit::SetStep>(read->what)->step, step);
  }
}

TEST(RunInputTest, WhatNoInputIsIsNotRead) {
  const std::string nul("run\0", 4);
  const std::vector<InputText> bad = {
      {"", ""},
      {"walk", ""},
      {"run", "fast"},
      {"step", ""},
      {"step", "0"},
      {"step", "-3"},
      {"step", "99999999999999999999"},
      {"step", "1 2"},
      {"step", "1\npause"},
      {"set_mode", "backwards"},
      {"set_mode", ""},
      {"set_mode", "7"},
      {"set_step", "0"},
      {"set_step", "nan"},
      {"set_step", "1e300"},
      {"set_step", "0.0123456"},
      {"set_step", "20000 us"},
      {"set_speed", "inf"},
      {"set_speed", ""},
      {"stop_all", "now"},
      {"release_robot", ""},
      {"deadline", ""},
      {"deadline", "robot1"},
      {"set_gains", ""},
      {"set_gains", "/robot1/arm"},
      {"set_gains", "robot1 1 2 3"},
      {"set_gains", "/robot1 1 2 3"},
      {"set_gains", "/robot1/arm (1 2 3"},
      {"set_positions", "/robot1/arm 1"},
      {"deadline", "robot1 wait"},
      {"deadline", " stop"},
      {"disconnect", "robot1 explode"},
      {"controller_stopped", "robot1"},
      {nul, ""},
      {"run", std::string(1, '\0')},
      {"\xff\xfe", "\xff"},
      {std::string(2'000'000, 'a'), ""},
      {"set_participants", std::string(2'000'000, 'a')},
      // Commands that are not inputs, lines that are not commands, other forms of a message.
      {"get_status", ""},
      {"quit", ""},
      {"reset", "7"},
      {"load_scenario", "corridor"},
      {"hello", "ana"},
      {"help", ""},
      {"verbose", ""},
      {"# run", ""},
      {"0 \"\" 101 0 0", ""},
      {"0", "\"\" 103 0 0"},
      {"run\n", "pause"},
      {"OPEN", "/robot1/motors"},
  };
  for (const InputText& text : bad) {
    EXPECT_FALSE(DecodeInput(0, text.action, text.detail))
        << text.action.substr(0, 40) << " " << text.detail.substr(0, 40);
  }
}

TEST(RunInputTest, AnyBytesAreReadOrNotButNeverHarm) {
  std::uint32_t random = 1;
  const auto next = [&random] { return random = random * 1664525 + 1013904223, random >> 16; };
  for (const Case& each : AllInputs()) {
    for (int i = 0; i < 200; ++i) {
      std::string detail = each.detail;
      for (std::uint32_t n = next() % 4; n > 0; --n) {
        const std::size_t at = detail.empty() ? 0 : next() % (detail.size() + 1);
        detail.insert(at, 1, static_cast<char>(next()));
      }
      if (const std::optional<RunInput> read = DecodeInput(0, each.action, detail)) {
        EXPECT_TRUE(DecodeInput(0, Encode(*read).action, Encode(*read).detail)) << detail;
      }
    }
  }
}

TEST(RunInputTest, AStepThatCannotBeIsSaid) {
  std::string error;
  Message request;
  request.command = command::kSetStep;
  request.data = {0.2};
  EXPECT_FALSE(RunEditOf(request, error));
  EXPECT_NE(error.find("0.0005 to 0.1 s"), std::string::npos) << error;
  error.clear();
  request.command = command::kGetStatus;
  EXPECT_FALSE(RunEditOf(request, error));
  EXPECT_EQ(error, "");
}

}  // namespace
}  // namespace coopdyn
