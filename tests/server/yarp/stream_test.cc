// SPDX-License-Identifier: MIT
// The bytes on a connection opened by one of our ports.
#include "server/yarp/stream.h"

#include <gtest/gtest.h>

#include <string>

#include "protocol/command_ids.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

Message Reading(std::initializer_list<double> data, std::string text = "") {
  Message reading;
  reading.command = -command::kGetPose;
  reading.text = std::move(text);
  reading.data = data;
  return reading;
}

std::string Written(YarpSampleWriter& writer, const Message& reading,
                    YarpCarrier carrier = YarpCarrier::kText) {
  std::string out;
  writer.Append(reading, carrier, YarpDialect::k3, out);
  return out;
}

TEST(YarpSampleWriter, AReadingIsAVectorWithItsStamp) {
  YarpSampleWriter writer;
  // As YARP 3.12 writes a Vector with an envelope, except for the split into blocks.
  EXPECT_EQ(Written(writer, Reading({1.5, 5, 12.5, 1250}), YarpCarrier::kTcp),
            Hex("'YA' 0a000000 'RP' 0201 ffffffffffffffff 11000000 18000000 00000000"
                "09000000 7e000001 'D 0 12.5' 00"
                "0a010000 02000000 000000000000f83f 0000000000001440"));
}

TEST(YarpSampleWriter, SamplesAreCountedWithThoseThatWereDropped) {
  YarpSampleWriter writer;
  EXPECT_EQ(Written(writer, Reading({7, 0.5, 50})), "D 0 0.5\r\n7.0\r\n");
  EXPECT_EQ(Written(writer, Reading({7, 0.75, 75}, "dropped 3")), "D 4 0.75\r\n7.0\r\n");
  EXPECT_EQ(Written(writer, Reading({7, 1, 100})), "D 5 1.0\r\n7.0\r\n");
}

TEST(YarpSampleWriter, TextAndParamsComeFirst) {
  YarpSampleWriter writer;
  Message reading = Reading({7, 0.5, 50}, "two words");
  reading.params = {1};
  EXPECT_EQ(Written(writer, reading), "D 0 0.5\r\n\"two words\" 1 7.0\r\n");
}

TEST(YarpSampleWriter, WhatIsNoReadingIsLeftOut) {
  YarpSampleWriter writer;
  EXPECT_EQ(Written(writer, Reading({})), "");
}

class YarpOutputTest : public ::testing::Test {
 protected:
  /// Advances `output` until samples are due.
  static void Begin(YarpOutput& output, std::string_view welcome) {
    const Incoming first = output.Decode(welcome);
    EXPECT_EQ(first.status, DecodeStatus::kMessage);
    EXPECT_EQ(first.message.command, command::kGetPose);
    EXPECT_EQ(first.consumed, 0u);
    const Incoming then = output.Decode(welcome);
    EXPECT_EQ(then.message.command, command::kSubscribe);
    EXPECT_EQ(then.message.params, (std::vector<std::int32_t>{3, command::kGetPose}));
    EXPECT_EQ(then.consumed, welcome.size());
  }
  static std::string Pushed(YarpOutput& output, Message message) {
    std::string out;
    UnaskedMessage push(std::move(message));
    output.Push(push, out);
    return out;
  }
  const YarpStream stream_{command::kGetPose, 3};
  const std::string ack_ = Hex("'YA' 00000000 'RP'");
};

TEST_F(YarpOutputTest, TcpWaitsForEachAcknowledgement) {
  YarpOutput output(YarpCarrier::kTcp, YarpDialect::k3, stream_, {});
  Begin(output, Hex("'YA' 382b0000 'RP'"));
  EXPECT_TRUE(output.takes_push());
  Pushed(output, Reading({7, 0.5, 50}));
  EXPECT_FALSE(output.takes_push());
  EXPECT_EQ(output.Decode(ack_.substr(0, 5)).consumed, 0u);
  EXPECT_FALSE(output.takes_push());
  EXPECT_EQ(output.Decode(ack_ + ack_).consumed, 8u);
  EXPECT_TRUE(output.takes_push());
}

TEST_F(YarpOutputTest, LinesAreAcknowledgedByLines) {
  YarpOutput output(YarpCarrier::kTextAck, YarpDialect::k3, stream_, {});
  Begin(output, "Welcome /robot1/pose/state:o\r\n");
  EXPECT_EQ(Pushed(output, Reading({7, 0.5, 50})), "D 0 0.5\r\n7.0\r\n");
  EXPECT_FALSE(output.takes_push());
  EXPECT_EQ(output.Decode("<AC").consumed, 0u);
  EXPECT_EQ(output.Decode("<ACK>\r\n").consumed, 7u);
  EXPECT_TRUE(output.takes_push());
}

TEST_F(YarpOutputTest, OtherCarriersIgnoreWhateverTheReaderSays) {
  YarpOutput output(YarpCarrier::kFastTcp, YarpDialect::k3, stream_, {});
  Begin(output, Hex("'YA' 382b0000 'RP'"));
  Pushed(output, Reading({7, 0.5, 50}));
  EXPECT_TRUE(output.takes_push());
  EXPECT_EQ(output.Decode("nonsense").consumed, 8u);
}

TEST_F(YarpOutputTest, TheFirstReadingIsASampleAndARefusalIsNone) {
  YarpOutput output(YarpCarrier::kText, YarpDialect::k3, stream_, {});
  std::string out;
  output.Reply(ErrorReply(command::kGetPose, Error::kNotPossible, "not yet"), out);
  EXPECT_EQ(out, "");
  Message reply = Reading({7, 0.5, 50});
  reply.command = command::kGetPose;
  output.Reply(reply, out);
  EXPECT_EQ(out, "D 0 0.5\r\n7.0\r\n");
  output.Reply(ReplyTo(command::kSubscribe), out);
  EXPECT_EQ(out, "D 0 0.5\r\n7.0\r\n");
}

TEST_F(YarpOutputTest, TheEndIsToldToTheReaderAndToWhoAsked) {
  int ended = 0;
  {
    YarpOutput output(YarpCarrier::kText, YarpDialect::k3, stream_, {.end = [&ended] { ++ended; }});
    Message notice;
    notice.command = command::kClosing;
    EXPECT_EQ(Pushed(output, notice), "q\r\n");
  }
  EXPECT_EQ(ended, 1);
}

TEST_F(YarpOutputTest, EachAcknowledgementTellsWhichStepTheReaderHas) {
  std::vector<std::uint64_t> taken;
  YarpOutput output(YarpCarrier::kTcp, YarpDialect::k3, stream_,
                    {.end = {}, .taken = [&taken](std::uint64_t step) { taken.push_back(step); }});
  Begin(output, Hex("'YA' 382b0000 'RP'"));
  Pushed(output, Reading({7, 0.5, 50}));
  output.Decode(ack_);
  Pushed(output, Reading({7, 0.51, 51}));
  EXPECT_EQ(taken, (std::vector<std::uint64_t>{50}));
}

class PictureOutputTest : public ::testing::Test {
 protected:
  static Message Shot(double time_s) {
    Message picture = ReplyTo(command::kGetImage);
    picture.params = {1, 1, 3, 0x030201};
    picture.data = {time_s, time_s * 100};
    return picture;
  }
  /// The request after `reply`, as text; appends bytes sent meanwhile to sent_.
  std::string After(YarpOutput& output, const Message& reply) {
    const std::optional<Message> next = output.Next(reply, sent_);
    if (!next) return "";
    return next->command == command::kReady ? "step " + std::to_string(next->params.at(0))
                                            : "picture " + std::to_string(next->params.at(0));
  }
  static Message StepReply() {
    Message reply = ReplyTo(command::kReady);
    reply.params = {0};
    return reply;
  }

  const YarpStream stream_{command::kGetImage, 5, YarpSample::kImage};
  std::string sent_;
};

TEST_F(PictureOutputTest, APictureIsAskedForAfterEachStepThatWasWaitedFor) {
  YarpOutput output(YarpCarrier::kFastTcp, YarpDialect::k3, stream_, {});
  const std::string welcome = Hex("'YA' 382b0000 'RP'");
  EXPECT_EQ(output.Decode(welcome).message.command, command::kGetImage);
  EXPECT_EQ(After(output, Shot(0)), "");
  EXPECT_EQ(output.Decode(welcome).message.command, command::kReady);
  EXPECT_EQ(After(output, StepReply()), "picture 0");
  EXPECT_EQ(After(output, Shot(0.05)), "step 5");
}

TEST_F(PictureOutputTest, TheSamePictureIsNotSentTwice) {
  YarpOutput output(YarpCarrier::kFastTcp, YarpDialect::k3, stream_, {});
  output.Decode("");
  After(output, Shot(0));
  output.Decode(Hex("'YA' 382b0000 'RP'"));
  const std::size_t once = sent_.size();
  EXPECT_GT(once, 60u);
  EXPECT_EQ(After(output, Shot(0)), "step 5");
  EXPECT_EQ(sent_.size(), once);
}

TEST_F(PictureOutputTest, TcpWaitsForTheAcknowledgementBeforeTheNextStep) {
  YarpOutput output(YarpCarrier::kTcp, YarpDialect::k3, stream_, {});
  const std::string welcome = Hex("'YA' 382b0000 'RP'");
  output.Decode(welcome);
  EXPECT_EQ(After(output, Shot(0)), "");
  EXPECT_EQ(output.Decode(welcome).status, DecodeStatus::kNothing);
  const Incoming acknowledged = output.Decode(Hex("'YA' 00000000 'RP'"));
  EXPECT_EQ(acknowledged.message.command, command::kReady);
  EXPECT_EQ(acknowledged.consumed, 8u);
}

TEST_F(PictureOutputTest, NothingIsAskedForWhenNothingCanComeAndThatIsTold) {
  std::vector<std::string> told;
  YarpOutput output(YarpCarrier::kFastTcp, YarpDialect::k3, stream_,
                    {.fails = [&told](const std::string& why) { told.push_back(why); }});
  output.Decode("");
  const Message stopping = ErrorReply(command::kReady, Error::kNotPossible, "the daemon is stopping");
  std::string asked = "picture 0";
  for (int i = 0; i < 10 && !asked.empty(); ++i) asked = After(output, stopping);
  EXPECT_EQ(asked, "");
  EXPECT_EQ(told, (std::vector<std::string>{"the daemon is stopping"}));
}

}  // namespace
}  // namespace coopdyn
