// SPDX-License-Identifier: MIT
#include "server/yarp/translator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

class ClockTranslatorTest : public ::testing::Test {
 protected:
  Message Request(const std::string& text) {
    const Decoded decoded = clock_->Decode(*ParseBottle(text));
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << text;
    return decoded.message;
  }
  std::string Answer(const Message& reply) { return BottleText(clock_->Reply(reply).bottle); }
  static Message Clock() {
    Message reply = ReplyTo(command::kGetClock);
    reply.params = {12, 500'000'000};
    reply.data = {0.01, 12.5, 1250};
    return reply;
  }
  const std::unique_ptr<YarpTranslator> clock_ = TranslatorOf("/clock/rpc", SimulationTable());
};

TEST_F(ClockTranslatorTest, CallsBecomeCommandsOfTheSimulation) {
  EXPECT_EQ(Request("pauseSimulation").command, command::kPause);
  EXPECT_EQ(Request("continueSimulation").command, command::kRun);
  EXPECT_EQ(Request("resetSimulationState").command, command::kReset);
  const Message step = Request("stepSimulationAndWait 10");
  EXPECT_EQ(step.command, command::kStep);
  EXPECT_EQ(step.params, (std::vector<std::int32_t>{10}));
  EXPECT_EQ(Request("stepSimulation").params, (std::vector<std::int32_t>{1}));
}

TEST_F(ClockTranslatorTest, RepliesAreThoseOfTheCalls) {
  Request("pauseSimulation");
  EXPECT_EQ(Answer(ReplyTo(command::kPause)), "[done]");
  Request("stepSimulationAndWait 1");
  EXPECT_EQ(Answer(ReplyTo(command::kStep)), "");
  Request("getSimulationTime");
  EXPECT_EQ(Answer(Clock()), "12.5");
  Request("getStepSize");
  EXPECT_EQ(Answer(Clock()), "0.01");
}

TEST_F(ClockTranslatorTest, WhatGoesWrongIsTold) {
  const Message refusal = ErrorReply(command::kStep, Error::kNotPossible, "time runs: pause first");
  Request("stepSimulationAndWait 1");
  EXPECT_EQ(Answer(refusal), "[fail] \"time runs: pause first\" 5");
  for (const char* const call : {"stepSimulation 1", "pauseSimulation", "continueSimulation"}) {
    Request(call);
    EXPECT_EQ(Answer(refusal), "[fail] \"time runs: pause first\" 5") << call;
  }
}

TEST_F(ClockTranslatorTest, OtherCallsAreRefused) {
  for (const char* text : {"", "explode", "(1 2)", "stepSimulation many", "stepSimulation 1.5"}) {
    const Decoded decoded = clock_->Decode(*ParseBottle(text));
    EXPECT_EQ(decoded.status, DecodeStatus::kBad) << text;
    EXPECT_THAT(Answer(decoded.message), HasSubstr("stepSimulation")) << text;
  }
}

TEST(TranslatorOf, OtherPortsSpeakTheWordsOfTheirModules) {
  EXPECT_EQ(TranslatorOf("/clock", SimulationTable()), nullptr);
  EXPECT_EQ(TranslatorOf("/robot1/motors", MotorsTable()), nullptr);
}

}  // namespace
}  // namespace coopdyn
