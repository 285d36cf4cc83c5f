// SPDX-License-Identifier: MIT
// The TCP protocol of YARS, byte by byte.
#include "server/yars/tcp_encoding.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/yars/wire.h"
#include "tests/server/devices/fake_client.h"

namespace coopdyn {
namespace {

std::string Text(const std::string& text) {
  std::string out = "s";
  PutInt(static_cast<std::int32_t>(text.size()), out);
  return out + text;
}

std::string Doubles(const std::vector<double>& numbers) {
  std::string out = "D";
  PutInt(static_cast<std::int32_t>(numbers.size()), out);
  for (const double number : numbers) PutDouble(number, out);
  return out;
}

struct FakeEndpoint final : Endpoint {
  explicit FakeEndpoint(CommandTable commands) : commands(std::move(commands)) {}
  const std::string& path() const override { return name; }
  const CommandTable& table() const override { return commands; }
  void OnRequest(Connection& /*connection*/, Message /*request*/, ReplyFunction /*reply*/) override {}

  std::string DriverBeside(const Connection& /*connection*/) const override { return driver; }

  std::string driver;
  std::string name = "/seeker/channel";
  CommandTable commands;
};

struct FakeWorld final : YarsWorld {
  void Ask(YarsOrder order, const Connection& /*asker*/, std::function<void(const Message&)> done) override {
    orders.push_back(std::move(order));
    done(ReplyTo(0));
  }
  std::vector<YarsOrder> orders;
};

class YarsTcpEncodingTest : public testing::Test {
 protected:
  /// Decodes all of `bytes`; returns the last result.
  Incoming Decode(std::string bytes) {
    Incoming incoming;
    while (!bytes.empty()) {
      incoming = encoding_->Decode(bytes);
      if (incoming.ask) incoming.ask(client_, [](const Message&) {});
      if (incoming.consumed == 0) break;
      bytes.erase(0, incoming.consumed);
    }
    return incoming;
  }

  FakeWorld world_;
  FakeEndpoint endpoint_{ChannelTable()};
  FakeClient client_{endpoint_, 1};
  std::unique_ptr<Encoding> encoding_ = YarsTcpEncodingKind(world_).make(endpoint_);
};

TEST_F(YarsTcpEncodingTest, WhileAnotherClientDrivesNobodyElseResetsOrQuits) {
  encoding_->Attach(client_, endpoint_);
  Decode(Text("RESET"));
  EXPECT_EQ(world_.orders.size(), 1U);
  endpoint_.driver = "ana";
  for (const std::string& word : {Text("RESET"), Text("QUIT")}) {
    const Incoming refused = Decode(word);
    EXPECT_EQ(refused.status, DecodeStatus::kFatal);
    EXPECT_EQ(refused.answer, Text("ERROR seeker is driven by ana: one client at a time"));
  }
  EXPECT_EQ(world_.orders.size(), 1U);
  Decode(Text("MESSAGE") + Text("hello"));
  EXPECT_EQ(world_.orders.size(), 2U);
}

TEST_F(YarsTcpEncodingTest, SensorsAreDoubles) {
  const Incoming asked = Decode(Text("SENSORS"));
  ASSERT_EQ(asked.status, DecodeStatus::kMessage);
  EXPECT_EQ(asked.message.command, command::kGetValues);
  Message reply = ReplyTo(command::kGetValues);
  reply.data = {0.5, -0.25, 1.5, 150};  // the last two: time and step
  std::string out;
  encoding_->Reply(reply, out);
  EXPECT_EQ(out, Doubles({0.5, -0.25}));
}

TEST_F(YarsTcpEncodingTest, ActuatorsSetTheMotorsAndGetNoAnswer) {
  EXPECT_EQ(Decode(Text("ACTUATORS")).status, DecodeStatus::kNothing);
  const Incoming step = Decode(Doubles({0.5, 1}));
  ASSERT_EQ(step.status, DecodeStatus::kMessage);
  EXPECT_EQ(step.message.command, command::kSetMotors);
  EXPECT_EQ(step.message.data, (std::vector<double>{0.5, 1}));
  std::string out;
  encoding_->Reply(ReplyTo(command::kSetMotors), out);
  EXPECT_EQ(out, "");
}

TEST_F(YarsTcpEncodingTest, TheConfigurationIsLinesOfText) {
  Decode(Text("CONFIGURATION"));
  Message reply = ReplyTo(command::kGetChannel, "motor eye eye");
  reply.params = {1, 2, 1, 1};
  reply.data = {-10, 10, -1, 1, 0, 1, 0, 0.5, 1, 0, 0, 1, 0, 0.5, 1, 0, 0, 1};
  std::string out, expected;
  encoding_->Reply(reply, out);
  for (const char* line : {"BEGIN CONFIGURATION",
                           "BEGIN DATA TYPES",
                           "INTEGER 4 bytes, little endian",
                           "DOUBLE 8 bytes, little endian",
                           "END DATA TYPES",
                           "BEGIN ROBOT DATA",
                           "NAME seeker",
                           "BEGIN SENSOR",
                           "NAME eye",
                           "DIMENSION 2",
                           "INTERNAL DOMAIN 0 0.5",
                           "EXTERNAL DOMAIN 1 0",
                           "INTERNAL DOMAIN 0 0.5",
                           "EXTERNAL DOMAIN 1 0",
                           "END SENSOR",
                           "BEGIN ACTUATOR",
                           "NAME motor",
                           "DIMENSION 1",
                           "INTERNAL DOMAIN -10 10",
                           "EXTERNAL DOMAIN -1 1",
                           "END ACTUATOR",
                           "END ROBOT DATA",
                           "END CONFIGURATION"}) {
    expected += Text(line);
  }
  EXPECT_EQ(out, expected);
}

TEST_F(YarsTcpEncodingTest, ARandomSeedIsThatOfTheNextReset) {
  std::string seed = "i";
  PutInt(17, seed);
  Decode(Text("RANDOM SEED") + seed + Text("RESET"));
  ASSERT_EQ(world_.orders.size(), 1u);
  EXPECT_EQ(world_.orders[0].kind, YarsOrder::Kind::kReset);
  EXPECT_EQ(world_.orders[0].seed, 17u);
  Decode(Text("RESET"));
  EXPECT_FALSE(world_.orders[1].seed);
}

TEST_F(YarsTcpEncodingTest, AMessageIsPassedOn) {
  Decode(Text("MESSAGE") + Text("generation 3"));
  ASSERT_EQ(world_.orders.size(), 1u);
  EXPECT_EQ(world_.orders[0].kind, YarsOrder::Kind::kLog);
  EXPECT_EQ(world_.orders[0].text, "generation 3");
}

TEST_F(YarsTcpEncodingTest, QuitLeavesAndTellsTheWorld) {
  EXPECT_EQ(Decode(Text("QUIT")).status, DecodeStatus::kLeave);
  EXPECT_EQ(world_.orders.at(0).kind, YarsOrder::Kind::kQuit);
}

TEST_F(YarsTcpEncodingTest, PartsOfAValueWaitForTheRest) {
  const std::string whole = Text("SENSORS");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Incoming part = encoding_->Decode(std::string_view(whole).substr(0, size));
    EXPECT_EQ(part.status, DecodeStatus::kNeedMore);
    EXPECT_EQ(part.consumed, 0u);
  }
}

TEST_F(YarsTcpEncodingTest, WhatIsNoCommandEndsTheConnectionWithWords) {
  const Incoming refused = Decode(Text("SENSOR"));
  EXPECT_EQ(refused.status, DecodeStatus::kFatal);
  EXPECT_NE(refused.message.text.find("no command 'SENSOR'"), std::string::npos);
  EXPECT_EQ(refused.answer, Text("ERROR " + refused.message.text));
}

TEST_F(YarsTcpEncodingTest, ActuatorsThatAreNotTakenAreToldOnce) {
  const auto warning = [this](std::string bytes, const Message& reply) {
    Decode(Text("ACTUATORS") + bytes);
    const std::string text = encoding_->Warning(reply);
    std::string out;
    encoding_->Reply(reply, out);
    EXPECT_EQ(out, "");
    return text;
  };
  EXPECT_EQ(warning(Doubles({1, 2}), ReplyTo(command::kSetMotors)), "");
  EXPECT_EQ(warning(Doubles({1, 2}), ErrorReply(command::kSetMotors, Error::kNotPossible, "reset")), "");
  const Message wrong = ErrorReply(command::kSetMotors, Error::kWrongData, "takes 2 values, not 1");
  EXPECT_NE(warning(Doubles({1}), wrong).find("takes 2 values, not 1"), std::string::npos);
  EXPECT_EQ(warning(Doubles({1}), wrong), "");
}

TEST_F(YarsTcpEncodingTest, AHugeCountIsRefused) {
  std::string huge = "D";
  PutInt(0x7fffffff, huge);
  Decode(Text("ACTUATORS"));
  EXPECT_EQ(Decode(huge).status, DecodeStatus::kFatal);
}

TEST_F(YarsTcpEncodingTest, AnotherModuleRefuses) {
  FakeEndpoint motors(MotorsTable());
  motors.name = "/seeker/motors";
  const Incoming refused = YarsTcpEncodingKind(world_).make(motors)->Decode(Text("SENSORS"));
  EXPECT_EQ(refused.status, DecodeStatus::kFatal);
  EXPECT_NE(refused.message.text.find("module channel"), std::string::npos);
}

TEST_F(YarsTcpEncodingTest, ItsFirstBytesAreNoOtherEncodings) {
  const auto match = YarsTcpEncodingKind(world_).match;
  for (const std::string& first :
       {Text("SENSORS"), Text("x"), Text("TEN LETTER"), Text(std::string(300, 'x')), Doubles({1, 2})})
    EXPECT_EQ(match(first), Match::kYes);
  EXPECT_EQ(match("s"), Match::kMaybe);
  EXPECT_EQ(match("st"), Match::kMaybe);
  for (const char* other :
       {"set_motors 1 1\n", "stop\r\n", "s\n", "st\n", "D\n", "subscribe\n", "GET / HTTP/1.1\r\n", "COOP"})
    EXPECT_EQ(match(other), Match::kNo) << other;
}

TEST_F(YarsTcpEncodingTest, NonsenseNeitherCrashesNorLoops) {
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    encoding_ = YarsTcpEncodingKind(world_).make(endpoint_);
    std::string bytes = random() % 2 == 0 ? Text("ACTUATORS") : "";
    bytes += "sdiDIx"[random() % 6];
    const std::size_t size = random() % 24;
    for (std::size_t k = 0; k < size; ++k)
      bytes += static_cast<char>(random() % 4 == 0 ? random() : random() % 3);
    Decode(bytes);
  }
}

}  // namespace
}  // namespace coopdyn
