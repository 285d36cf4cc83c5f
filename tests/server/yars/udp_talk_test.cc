// SPDX-License-Identifier: MIT
// The UDP protocol of YARS, datagram by datagram.
#include "server/yars/udp_talk.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

std::string Ints(std::initializer_list<std::int32_t> numbers) {
  std::string out;
  for (const std::int32_t number : numbers) PutInt(number, out);
  return out;
}

std::string Floats(std::initializer_list<float> numbers) {
  std::string out;
  for (const float number : numbers) PutFloat(number, out);
  return out;
}

/// A step of robot 0 with these motors.
std::string StepOf(std::initializer_list<float> motors) {
  return Ints({40, 0, static_cast<std::int32_t>(motors.size())}) + Floats(motors) + Ints({-1});
}

/// The reply to get_channel: motors m1, m2, …, values v1, …, all from −1 to 1, on link 1; `auxiliary` last.
Message ChannelReply(int motors, int values, int auxiliary = 0) {
  Message reply = ReplyTo(command::kGetChannel);
  reply.params = {motors, values + auxiliary, 1, 1};
  const auto add = [&reply](const std::string& name, bool is_auxiliary) {
    reply.text += (reply.text.empty() ? "" : " ") + name;
    reply.data.insert(reply.data.end(), {-2, 2, -1, 1, is_auxiliary ? 1.0 : 0.0, 1});
  };
  for (int i = 0; i < motors; ++i) add("m" + std::to_string(i + 1), false);
  for (int i = 0; i < values; ++i) add("v" + std::to_string(i + 1), false);
  for (int i = 0; i < auxiliary; ++i) add("a" + std::to_string(i + 1), true);
  return reply;
}

Message ValuesReply(std::vector<double> values, const std::string& text = "") {
  Message reply = ReplyTo(command::kSetMotors, text);
  reply.params = {1};
  reply.data = std::move(values);
  reply.data.insert(reply.data.end(), {0.1, 10});  // time and step
  return reply;
}

class YarsUdpTalkTest : public testing::Test {
 protected:
  /// Sends a datagram; the module first reports its channel if asked.
  YarsUdpTalk::Action Send(const std::string& datagram) {
    YarsUdpTalk::Action action = talk_.Take(datagram);
    if (action.request && action.request->command == command::kGetChannel) action = talk_.Answer(channel_);
    return action;
  }
  std::string Answer(const std::string& datagram) {
    const YarsUdpTalk::Action action = Send(datagram);
    return action.datagrams.size() == 1 ? action.datagrams.front() : "";
  }
  static std::int32_t IdOf(const YarsUdpTalk::Action& action) {
    return action.datagrams.empty() ? -9 : YarsReader(action.datagrams.front()).Int().value_or(-9);
  }

  YarsUdpTalk talk_;
  Message channel_ = ChannelReply(2, 3, 1);
};

TEST_F(YarsUdpTalkTest, APingIsAnswered) {
  EXPECT_EQ(Answer(Ints({0, -1})), Ints({1, -1}));
}

TEST_F(YarsUdpTalkTest, AByteSaysOnlyWhoItIs) {
  EXPECT_TRUE(Send(std::string(1, '\0')).datagrams.empty());
  EXPECT_FALSE(talk_.waits());
}

TEST_F(YarsUdpTalkTest, TheBasicHandshakeTellsTheTreeWithoutAuxiliaryValues) {
  EXPECT_EQ(Answer(Ints({10, -1})), Ints({11, 0, 100, 200, 300, 300, 400, 400, 400, -1}));
}

TEST_F(YarsUdpTalkTest, AuxiliaryValuesAreForWhoKnowsThem) {
  // Clients that know only the basic handshake refuse values that it did not announce.
  const auto values = [this] {
    Send(StepOf({0, 0}));
    const YarsUdpTalk::Action done = talk_.Answer(ValuesReply({1, 2, 3, 4}));
    YarsReader reader(done.datagrams.at(0));
    for (int i = 0; i < 3; ++i) reader.Int();
    return reader.Int();
  };
  EXPECT_EQ(values(), 4) << "no handshake";
  Send(Ints({10, -1}));
  EXPECT_EQ(values(), 3);
  Send(Ints({60, 0, 7, -1}));
  talk_.Done(ReplyTo(command::kReset));
  EXPECT_EQ(values(), 3) << "after an init";
  Send(Ints({12, 82, -1}));
  EXPECT_EQ(values(), 4);
}

TEST_F(YarsUdpTalkTest, TheExtendedHandshakeTellsRangesAndNames) {
  channel_ = ChannelReply(1, 1);
  EXPECT_EQ(Answer(Ints({12, 82, -1})), Ints({13, 83, 0, 100, 200, 300}) + Floats({-1, 1}) + Ints({-1}));
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, 2}) + "m1" + Ints({-1}));
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, 400}) + Floats({-1, 1}) + Ints({-1}));
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, 2}) + "v1" + Ints({-1}));
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, -1}));
}

TEST_F(YarsUdpTalkTest, WhatHasNoBoundsHasThoseThatYarsTells) {
  channel_ = ChannelReply(1, 1);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 6; i < 10; ++i) channel_.data[i] = i % 2 == 0 ? -kInfinity : kInfinity;
  channel_.data[2] = -kInfinity;  // not mapped
  channel_.data[3] = kInfinity;
  EXPECT_EQ(Answer(Ints({12, 82, -1})), Ints({13, 83, 0, 100, 200, 300}) + Floats({-2, 2}) + Ints({-1}));
  Answer(Ints({12, -1}));
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, 400}) + Floats({-100'000, 100'000}) + Ints({-1}));
}

TEST_F(YarsUdpTalkTest, AfterAResetTheBasicHandshakeBeginsAnew) {
  Send(Ints({10, -1}));
  Send(Ints({50, 0, -1}));
  channel_ = ChannelReply(3, 5);  // more than before
  talk_.Done(ReplyTo(command::kReset));
  EXPECT_EQ(Answer(Ints({10, -1})), Ints({11, 0, 100, 200, 300, 300, 300, 400, 400, 400, 400, 400, -1}));
}

TEST_F(YarsUdpTalkTest, AHandshakeMayBeginAgain) {
  Send(Ints({12, 82, -1}));
  Send(Ints({12, -1}));
  EXPECT_EQ(YarsReader(Answer(Ints({12, 80, -1}))).Int(), 13);
  EXPECT_EQ(Answer(Ints({12, -1})), Ints({13, 2}) + "m1" + Ints({-1}));
}

TEST_F(YarsUdpTalkTest, AStepSetsTheMotorsAndIsAnsweredWithTheValues) {
  const YarsUdpTalk::Action asked = Send(StepOf({0.5, -0.25}));
  ASSERT_TRUE(asked.request);
  EXPECT_EQ(asked.request->command, command::kSetMotors);
  EXPECT_EQ(asked.request->data, (std::vector<double>{0.5, -0.25}));
  const YarsUdpTalk::Action done = talk_.Answer(ValuesReply({0.125, 0.25, 0.5, 0.75}));
  ASSERT_EQ(done.datagrams.size(), 1u);
  EXPECT_EQ(done.datagrams[0], Ints({41, 0, 0, 4}) + Floats({0.125, 0.25, 0.5, 0.75}) + Ints({-1}));
}

TEST_F(YarsUdpTalkTest, MotorsAndValuesGoInTheOrderOfTheHandshake) {
  channel_ = ChannelReply(2, 2);
  channel_.data[5] = 2;          // m1 is on link 2
  channel_.data[2 * 6 + 5] = 2;  // v1, too
  channel_.params[3] = 2;
  EXPECT_EQ(Answer(Ints({10, -1})), Ints({11, 0, 100, 200, 300, 400, 200, 300, 400, -1}));
  EXPECT_EQ(Send(StepOf({1, 0})).request->data, (std::vector<double>{0, 1}));
  EXPECT_EQ(talk_.Answer(ValuesReply({0.25, 0.5})).datagrams[0],
            Ints({41, 0, 0, 2}) + Floats({0.5, 0.25}) + Ints({-1}));
}

TEST_F(YarsUdpTalkTest, AnAbortedTryIsToldInTheAnswer) {
  Send(StepOf({0, 0}));
  const YarsUdpTalk::Action done = talk_.Answer(ValuesReply({0, 0, 0, 0}, "aborted"));
  YarsReader reader(done.datagrams.at(0));
  reader.Int();
  reader.Int();
  EXPECT_EQ(reader.Int(), 1);
}

TEST_F(YarsUdpTalkTest, ACopyOfAStepUnderWayIsIgnored) {
  Send(StepOf({0, 0}));
  const YarsUdpTalk::Action copy = talk_.Take(StepOf({0, 0}));
  EXPECT_FALSE(copy.request);
  EXPECT_TRUE(copy.datagrams.empty());
  EXPECT_EQ(talk_.Answer(ValuesReply({0, 0, 0, 0})).datagrams.size(), 1u);
}

TEST_F(YarsUdpTalkTest, AnotherRequestDuringAStepIsTakenUpAfterIt) {
  Send(StepOf({0, 0}));
  EXPECT_TRUE(talk_.Take(Ints({0, -1})).datagrams.empty());
  const YarsUdpTalk::Action done = talk_.Answer(ValuesReply({0, 0, 0, 0}));
  ASSERT_EQ(done.datagrams.size(), 2u);
  EXPECT_EQ(done.datagrams[1], Ints({1, -1}));
}

TEST_F(YarsUdpTalkTest, AnAnswerStaysWhenTheOrderBehindItIsDenied) {
  for (const std::string& order : {Ints({50, 0, -1}), Ints({100, -1})}) {
    Send(StepOf({0, 0}));
    talk_.Take(order);
    YarsUdpTalk::Action done = talk_.Answer(ValuesReply({0, 0, 0, 0}));
    ASSERT_TRUE(done.order);
    const YarsUdpTalk::Action denied = talk_.Denied(std::move(done), "eva drives it");
    EXPECT_FALSE(denied.order);
    EXPECT_FALSE(denied.leaves);
    ASSERT_EQ(denied.datagrams.size(), 2u);
    EXPECT_EQ(YarsReader(denied.datagrams[0]).Int(), 41);
    EXPECT_EQ(denied.datagrams[1], YarsUdpTalk::Refusal("eva drives it"));
    EXPECT_EQ(denied.trouble, "eva drives it");
    EXPECT_FALSE(talk_.waits());
  }
}

TEST_F(YarsUdpTalkTest, ARepeatedNumberGetsTheSameAnswerWithoutAnotherStep) {
  const std::string numbered = StepOf({0.5, 0.5}) + Ints({7});
  ASSERT_TRUE(Send(numbered).request);
  const std::string answer = talk_.Answer(ValuesReply({1, 1, 1, 1})).datagrams.at(0);
  EXPECT_TRUE(answer.ends_with(Ints({-1, 7})));
  const YarsUdpTalk::Action again = Send(numbered);
  EXPECT_FALSE(again.request);
  EXPECT_EQ(again.datagrams, std::vector<std::string>{answer});
  EXPECT_TRUE(Send(StepOf({0.5, 0.5}) + Ints({8})).request);
}

TEST_F(YarsUdpTalkTest, MoreThan250ValuesGoInSeveralDatagrams) {
  channel_ = ChannelReply(2, 600);
  Send(StepOf({0, 0}));
  std::vector<double> values(600);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  const YarsUdpTalk::Action done = talk_.Answer(ValuesReply(values));
  ASSERT_EQ(done.datagrams.size(), 3u);
  const std::int32_t left[] = {600, 350, 100};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(done.datagrams[i].size(), YarsUdpTalk::kUsable);
    YarsReader reader(done.datagrams[i]);
    for (int skipped = 0; skipped < 3; ++skipped) reader.Int();
    EXPECT_EQ(reader.Int(), left[i]);
    EXPECT_EQ(reader.Float(), static_cast<float>(600 - left[i]));
  }
}

TEST_F(YarsUdpTalkTest, MoreThan80DatagramsOfValuesWaitForTheClient) {
  channel_ = ChannelReply(2, 250 * 81);
  Send(StepOf({0, 0}));
  EXPECT_EQ(talk_.Answer(ValuesReply(std::vector<double>(250 * 81))).datagrams.size(), 80u);
  EXPECT_EQ(Send(Ints({40, -1})).datagrams.size(), 1u);
  EXPECT_EQ(IdOf(Send(Ints({40, -1}))), YarsUdpTalk::kRefused);
}

TEST_F(YarsUdpTalkTest, MoreThan250MotorsComeInSeveralDatagrams) {
  channel_ = ChannelReply(300, 1);
  std::string first = Ints({40, 0, 300}), second = Ints({40, 0, 49});
  for (int i = 0; i < 251; ++i) PutFloat(0.25F, first);
  for (int i = 0; i < 49; ++i) PutFloat(0.5F, second);
  EXPECT_FALSE(Send(first + Ints({-1})).request);
  const YarsUdpTalk::Action whole = Send(second + Ints({-1}));
  ASSERT_TRUE(whole.request);
  EXPECT_EQ(whole.request->data.size(), 300u);
  EXPECT_EQ(whole.request->data.front(), 0.25);
  EXPECT_EQ(whole.request->data.back(), 0.5);
}

TEST_F(YarsUdpTalkTest, AWrongRobotIsRefusedInWords) {
  for (const std::string& wrong :
       {Ints({40, 1, 2}) + Floats({0, 0}) + Ints({-1, 7}), Ints({20, 3, -1, 7}), Ints({50, 1, -1, 7}),
        Ints({60, -2, 17, -1, 7}), Ints({70, 9, 17, -1, 7})}) {
    const YarsUdpTalk::Action refused = Send(wrong);
    EXPECT_FALSE(refused.request || refused.order);
    EXPECT_EQ(IdOf(refused), YarsUdpTalk::kRefused);
    EXPECT_NE(refused.trouble.find("number 0"), std::string::npos);
    EXPECT_TRUE(refused.datagrams[0].ends_with(Ints({-1, 7})));
    talk_ = {};
  }
}

TEST_F(YarsUdpTalkTest, AWrongNumberOfMotorsIsRefusedInWords) {
  const YarsUdpTalk::Action refused = Send(StepOf({1, 2, 3}));
  EXPECT_FALSE(refused.request);
  EXPECT_EQ(IdOf(refused), YarsUdpTalk::kRefused);
  EXPECT_NE(refused.trouble.find("2 motors, not 3"), std::string::npos);
}

TEST_F(YarsUdpTalkTest, MotorsMustBeFinite) {
  EXPECT_EQ(IdOf(Send(StepOf({1, std::numeric_limits<float>::quiet_NaN()}))), YarsUdpTalk::kRefused);
}

TEST_F(YarsUdpTalkTest, InitResetAndNextTryAreOrdersForTheWorld) {
  Send(Ints({0, -1}));
  const YarsUdpTalk::Action init = Send(Ints({60, 0, 17, -1}));
  ASSERT_TRUE(init.order);
  EXPECT_EQ(init.order->seed, 17u);
  EXPECT_EQ(talk_.Done(ReplyTo(command::kReset)).datagrams.at(0), Ints({61, 0, -1}));
  const YarsUdpTalk::Action reset = Send(Ints({50, 0, -1}));
  ASSERT_TRUE(reset.order);
  EXPECT_FALSE(reset.order->seed);
  EXPECT_EQ(talk_.Done(ReplyTo(command::kReset)).datagrams.at(0), Ints({51, 0, -1}));
  EXPECT_EQ(Send(Ints({70, 0, 18, -1})).order->seed, 18u);
  EXPECT_EQ(talk_.Done(ReplyTo(command::kReset)).datagrams.at(0), Ints({71, 0, -1}));
}

TEST_F(YarsUdpTalkTest, AStepThatAResetEndsIsAnsweredWithWhatIsNow) {
  Send(StepOf({0, 0}));
  const YarsUdpTalk::Action again =
      talk_.Answer(ErrorReply(command::kSetMotors, Error::kNotPossible, "reset"));
  ASSERT_TRUE(again.request);
  EXPECT_EQ(again.request->command, command::kGetValues);
  EXPECT_EQ(IdOf(talk_.Answer(ValuesReply({0, 0, 0, 0}))), 41);
}

TEST_F(YarsUdpTalkTest, ALateCopyOfANumberIsNoStep) {
  for (const std::int32_t number : {7, 8}) {
    ASSERT_TRUE(Send(StepOf({0, 0}) + Ints({number})).request);
    talk_.Answer(ValuesReply({1, 1, 1, 1}));
  }
  const YarsUdpTalk::Action late = Send(StepOf({0, 0}) + Ints({7}));
  EXPECT_FALSE(late.request);
  ASSERT_EQ(late.datagrams.size(), 1U);
  EXPECT_EQ(IdOf(late), 99);
  EXPECT_TRUE(late.datagrams[0].ends_with(Ints({-1, 7})));
  EXPECT_TRUE(Send(StepOf({0, 0}) + Ints({9})).request);
}

TEST_F(YarsUdpTalkTest, AStepIsAnsweredByTheModuleThatTakesThePlace) {
  Send(StepOf({0, 0}));
  talk_.Answer(ErrorReply(command::kSetMotors, Error::kNotPossible, "load"));
  const Message gone =
      ErrorReply(command::kGetValues, Error::kNotPossible, "seeker" + std::string(kGoneText));
  EXPECT_TRUE(talk_.Answer(gone).datagrams.empty());
  const YarsUdpTalk::Action moved = talk_.MoveOn();
  ASSERT_TRUE(moved.request);
  EXPECT_EQ(moved.request->command, command::kGetChannel);
  const YarsUdpTalk::Action values = talk_.Answer(channel_);
  ASSERT_TRUE(values.request);
  EXPECT_EQ(values.request->command, command::kGetValues);
  EXPECT_EQ(IdOf(talk_.Answer(ValuesReply({0, 0, 0, 0}))), 41);
}

TEST_F(YarsUdpTalkTest, AStepStaysOverWhenTheModuleMovesTwice) {
  Send(StepOf({0, 0}));
  talk_.MoveOn();
  talk_.Answer(ErrorReply(command::kGetChannel, Error::kNotPossible, "seeker" + std::string(kGoneText)));
  ASSERT_TRUE(talk_.MoveOn().request);
  const YarsUdpTalk::Action values = talk_.Answer(channel_);
  ASSERT_TRUE(values.request);
  EXPECT_EQ(values.request->command, command::kGetValues);
}

TEST_F(YarsUdpTalkTest, AModuleWithOtherMotorsWantsAHandshake) {
  Send(StepOf({0, 0}));
  talk_.MoveOn();
  EXPECT_EQ(IdOf(talk_.Answer(ChannelReply(3, 4))), 99);
  EXPECT_EQ(IdOf(Send(Ints({10, -1}))), 11);
}

TEST_F(YarsUdpTalkTest, ARequestBehindAResetIsTakenUpAfterIt) {
  Send(Ints({50, 0, -1}));
  Send(Ints({0, -1}));
  EXPECT_FALSE(talk_.MoveOn().request);
  YarsUdpTalk::Action done = talk_.Done(ReplyTo(0));
  ASSERT_EQ(done.datagrams, std::vector<std::string>{Ints({51, 0, -1})});
  ASSERT_TRUE(done.request);
  EXPECT_EQ(talk_.Answer(channel_).datagrams, std::vector<std::string>{Ints({1, -1})});
}

/// The datagrams of a new simulation.
std::vector<std::string> Upload(const std::string& text, std::int32_t each, std::int32_t source) {
  std::vector<std::string> all = {
      Ints({90, 5, static_cast<std::int32_t>(text.size()), each, source, 7, -1, 0, -1})};
  for (std::size_t at = 0, i = 0; at < text.size(); at += static_cast<std::size_t>(each), ++i) {
    all.push_back(Ints({90, 5, static_cast<std::int32_t>(i)}) +
                  text.substr(at, static_cast<std::size_t>(each)) + Ints({-1}));
  }
  return all;
}

TEST_F(YarsUdpTalkTest, ANewSimulationComesInPieces) {
  std::string xml = "<rosiml version=\"1.0\"><movables/></rosiml>";
  xml.resize(2500, ' ');
  EXPECT_EQ(Answer(Ints({93, -1})), Ints({94, -1}));
  const std::vector<std::string> all = Upload(xml, 1004, 1);
  EXPECT_EQ(Answer(all[0]), Ints({91, -1}));
  EXPECT_TRUE(Send(all[2]).datagrams.empty());  // in any order
  EXPECT_TRUE(Send(all[1]).datagrams.empty());
  EXPECT_TRUE(Send(all[1]).datagrams.empty());  // and twice
  const YarsUdpTalk::Action last = Send(all[3]);
  ASSERT_TRUE(last.order);
  EXPECT_EQ(last.order->kind, YarsOrder::Kind::kLoadText);
  EXPECT_EQ(last.order->text, xml);
  EXPECT_EQ(talk_.Done(ReplyTo(command::kLoadScenario)).datagrams.at(0), Ints({91, -1}));
}

TEST_F(YarsUdpTalkTest, ANewSimulationMayNameAFile) {
  for (const std::string& datagram : Upload("lightseeker", 1004, 0)) {
    const YarsUdpTalk::Action action = Send(datagram);
    if (!action.order) continue;
    EXPECT_EQ(action.order->kind, YarsOrder::Kind::kLoadFile);
    EXPECT_EQ(action.order->text, "lightseeker");
    return;
  }
  FAIL() << "nothing was loaded";
}

TEST_F(YarsUdpTalkTest, ANewSimulationWithMistakesFails) {
  for (const std::string& datagram : Upload("<rosiml/>", 1004, 1)) Send(datagram);
  const YarsUdpTalk::Action failed =
      talk_.Done(ErrorReply(command::kLoadScenario, Error::kNotPossible, "line 1: …"));
  EXPECT_EQ(failed.datagrams.at(0), Ints({92, -1}));
  EXPECT_EQ(failed.trouble, "line 1: …");
}

TEST_F(YarsUdpTalkTest, AfterAnotherSimulationTheChannelIsAskedAnew) {
  Send(StepOf({0, 0}));
  talk_.Answer(ValuesReply({0, 0, 0, 0}));
  Send(Ints({50, 0, -1}));
  talk_.Done(ReplyTo(command::kReset));
  EXPECT_EQ(talk_.Take(StepOf({0, 0})).request->command, command::kGetChannel);
}

TEST_F(YarsUdpTalkTest, QuitLeaves) {
  const YarsUdpTalk::Action quit = Send(Ints({100, -1}));
  EXPECT_TRUE(quit.leaves);
  EXPECT_EQ(quit.datagrams.at(0), Ints({101, -1}));
}

TEST_F(YarsUdpTalkTest, AnUnknownRequestIsRefusedInWords) {
  const YarsUdpTalk::Action refused = Send(Ints({33, -1}));
  EXPECT_EQ(IdOf(refused), YarsUdpTalk::kRefused);
  EXPECT_NE(refused.trouble.find("no request 33"), std::string::npos);
}

TEST_F(YarsUdpTalkTest, NonsenseNeitherCrashesNorHoldsAnythingUp) {
  std::mt19937 random(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string datagram;
    constexpr std::int32_t kIds[] = {0, 10, 12, 20, 30, 40, 50, 60, 70, 90, 93, 100, -1, 7};
    PutInt(kIds[random() % std::size(kIds)], datagram);
    const std::size_t size = random() % 40;
    for (std::size_t k = 0; k < size; ++k)
      datagram += static_cast<char>(random() % 3 == 0 ? 0xff : random() % 6);
    YarsUdpTalk::Action action = talk_.Take(datagram);
    for (int rounds = 0; talk_.waits(); ++rounds) {
      ASSERT_LT(rounds, 10);
      if (action.order) {
        action = talk_.Done(ReplyTo(0));
      } else {
        ASSERT_TRUE(action.request);
        action = talk_.Answer(action.request->command == command::kGetChannel ? channel_
                                                                              : ValuesReply({0, 0, 0, 0}));
      }
    }
  }
}

}  // namespace
}  // namespace coopdyn
