// SPDX-License-Identifier: MIT
// Replies to YARP programs on a module's port, byte by byte.
#include "server/yarp/encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/yarp/bottle.h"
#include "tests/server/yarp/hex.h"
#include "tests/server/yarp/port.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A session without sockets: answers each request with mode 1, time 0.5 and step 50.
class Talk {
 public:
  explicit Talk(std::string path = "/robot1/motors", CommandTable table = MotorsTable())
      : port_(std::move(path), std::move(table)) {}
  /// The reply to `bytes`.
  std::string operator()(std::string_view bytes) {
    std::string out;
    in_ += bytes;
    if (encoding_ == nullptr) {
      const EncodingKind* const kind = Choose(encodings_, in_);
      if (kind == nullptr) return out;
      encoding_ = kind->make(port_);
    }
    while (!in_.empty() && !ended) {
      Incoming incoming = encoding_->Decode(in_);
      in_.erase(0, incoming.consumed);
      out += incoming.answer;
      if (incoming.ask) {
        ++asked;
        Message reply;
        reply.params = {4711};
        Answer(reply, out);
      }
      if (incoming.status == DecodeStatus::kMessage) {
        requests.push_back(incoming.message);
        Message reply = ReplyTo(incoming.message.command);
        reply.params = {1};
        reply.data = {0.5, 50};
        Answer(reply, out);
      } else if (incoming.status == DecodeStatus::kBad || incoming.status == DecodeStatus::kFatal) {
        Answer(incoming.message, out);
      }
      ended = incoming.status == DecodeStatus::kFatal || incoming.status == DecodeStatus::kLeave;
      if (incoming.status == DecodeStatus::kNeedMore || incoming.consumed == 0) break;
    }
    return out;
  }
  std::string Pushed(Message message) {
    std::string out;
    UnaskedMessage push(std::move(message));
    encoding_->Push(push, out);
    return out;
  }

  std::vector<Message> requests;
  bool ended = false;
  int asked = 0;

 private:
  void Answer(Message reply, std::string& out) {
    while (const std::optional<Message> next = encoding_->Next(reply, out)) {
      requests.push_back(*next);
      reply = ReplyTo(next->command);
    }
    encoding_->Reply(reply, out);
  }

  Port port_;
  NameTable names_;
  YarpNetwork network_{names_, spdlog::default_logger(), {}};
  const Encodings encodings_ = EncodingsWithYarp(network_);
  std::unique_ptr<Encoding> encoding_;
  std::string in_;
};

std::string Frame(char command, const Bottle& bottle, YarpDialect dialect = YarpDialect::k3) {
  std::string payload;
  EncodeBottle(bottle, dialect, payload);
  std::string frame = Hex("'YA' 0a000000 'RP' 0201 ffffffffffffffff 08000000");
  frame += static_cast<char>(payload.size());
  return frame + Hex("000000 00000000 00000000 7e") + command + Hex("0001") + payload;
}

const std::string kAck = Hex("'YA' 00000000 'RP'");
const std::string kTcp = Hex("'YA' e41e0000 'RP' 09000000 'anon_rpc' 00");

TEST(YarpEncoding, WordsReachTheModule) {
  Talk talk;
  EXPECT_EQ(talk("CONNECT foo\r\n"), "Welcome foo\r\n");
  EXPECT_EQ(talk("d\r\nset_velocity 0.2 0.5\r\n"), "[ok] 1 0.5 50.0\r\n");
  ASSERT_EQ(talk.requests.size(), 1u);
  EXPECT_EQ(talk.requests[0].command, command::kSetVelocity);
  EXPECT_EQ(talk.requests[0].data, (std::vector<double>{0.2, 0.5}));
}

TEST(YarpEncoding, MistakesAreToldInWords) {
  Talk talk;
  talk("CONNECT foo\r\n");
  EXPECT_THAT(talk("d\r\nset_velocty 0.2\r\n"),
              StartsWith("[fail] \"unknown command 'set_velocty': did you mean set_velocity?"));
  EXPECT_THAT(talk("d\r\nset_velocity fast\r\n"), StartsWith("[fail] "));
  EXPECT_THAT(talk("d\r\n(1 2)\r\n"), HasSubstr("a request begins with a command"));
  EXPECT_TRUE(talk.requests.empty());
  EXPECT_FALSE(talk.ended);
}

TEST(YarpEncoding, HelpListsTheCommands) {
  Talk talk;
  talk("CONNECT foo\r\n");
  const std::string help = talk("d\r\nhelp\r\n");
  EXPECT_THAT(help, StartsWith("[many] "));
  EXPECT_THAT(help, HasSubstr("set_velocity"));
}

TEST(YarpEncoding, AMessageIsAnsweredByAMessage) {
  Talk talk;
  talk("CONNECT foo\r\n");
  EXPECT_EQ(talk("d\r\n0 \"\" 11 () (0.2 0.5)\r\n"), "0 \"\" 11 (1) (0.5 50.0)\r\n");
  ASSERT_EQ(talk.requests.size(), 1u);
  EXPECT_EQ(talk.requests[0].data, (std::vector<double>{0.2, 0.5}));
  EXPECT_THAT(talk("d\r\n0 \"\" 11 (0.5) (0.2)\r\n"), HasSubstr("whole numbers: not 0.5"));
}

TEST(YarpEncoding, TcpGetsItsReplyAndThenTheAcknowledgement) {
  Talk talk;
  EXPECT_EQ(talk(kTcp).size(), 8u);
  EXPECT_EQ(talk(Frame('d', *ParseBottle("set_velocity 0.2 0.5"))),
            Hex("00010000 04000000 09000000 'ok__' 01000000 01000000 0a000000 000000000000e03f 0a000000 "
                "0000000000004940") +
                kAck);
  EXPECT_EQ(talk(Frame('D', *ParseBottle("set_velocity 0.2 0.5"))), kAck);
  EXPECT_EQ(talk(Frame('D', *ParseBottle("nonsense"))), kAck);
  EXPECT_EQ(talk.requests.size(), 2u);
}

TEST(YarpEncoding, RepliesHaveTheDialectOfTheRequest) {
  Talk talk;
  talk(kTcp);
  EXPECT_THAT(talk(Frame('d', *ParseBottle("set_velocity 0.2 0.5"), YarpDialect::k4)),
              HasSubstr(Hex("14000000 000000000000e03f")));
}

TEST(YarpEncoding, FastTcpGetsNoAcknowledgement) {
  Talk talk;
  talk(Hex("'YA' 641e0000 'RP' 09000000 'anon_rpc' 00"));
  EXPECT_EQ(talk(Frame('D', *ParseBottle("set_velocity 0.2 0.5"))), "");
  EXPECT_EQ(talk.requests.size(), 1u);
}

TEST(YarpEncoding, AdministrationIsAnswered) {
  Talk talk;
  talk("CONNACK admin\r\n");
  EXPECT_EQ(talk("a\r\n[ver]\r\n"), "[ver] 1 2 3\r\n<ACK>\r\n");
  EXPECT_EQ(talk("a\r\n[list] [out] \"/x\"\r\n"), "\r\n<ACK>\r\n");
  EXPECT_THAT(talk("a\r\n[del] \"/x\"\r\n"), StartsWith("-1 \"Could not find an outgoing connection to /x"));
  EXPECT_THAT(talk("a\r\n[prop] [get] /robot1/motors\r\n"), HasSubstr("(is_rpc 1)"));
  EXPECT_THAT(talk("a\r\n[prop] [set] /robot1/motors (qos ((priority HIGH)))\r\n"), StartsWith("[fail] "));
  EXPECT_THAT(talk("a\r\nwhat\r\n"), StartsWith("[fail] "));
  EXPECT_THAT(talk("*\r\n"), StartsWith("This is /robot1/motors"));
  EXPECT_THAT(talk("?\r\n"), HasSubstr("d    then a request"));
  EXPECT_THAT(talk("nonsense\r\n"), StartsWith("Port command not understood."));
  EXPECT_EQ(talk("q\r\n"), "<ACK>\r\n");
  EXPECT_TRUE(talk.ended);
}

TEST(YarpEncoding, AReversedConnectionGetsReadings) {
  Talk talk;
  talk("CONNECT me\r\n");
  EXPECT_EQ(talk("r\r\n"), "");
  ASSERT_EQ(talk.requests.size(), 1u);
  EXPECT_EQ(talk.requests[0].command, command::kSubscribe);
  Message reading;
  reading.command = -command::kGetWheels;
  reading.data = {1.5, 2.5, 0.25, 25};
  EXPECT_EQ(talk.Pushed(reading), "D 0 0.25\r\n1.5 2.5\r\n");
  EXPECT_EQ(talk.Pushed(reading), "D 1 0.25\r\n1.5 2.5\r\n");
}

TEST(YarpEncoding, OnlyAReversedConnectionSubscribes) {
  Talk talk;
  talk("CONNECT me\r\n");
  EXPECT_THAT(talk("d\r\nsubscribe\r\n"), StartsWith("[fail] "));
  EXPECT_TRUE(talk.requests.empty());
}

TEST(YarpEncoding, BytesThatComeOneByOneDoTheSame) {
  Talk talk;
  std::string out;
  for (const char byte :
       kTcp + Frame('d', *ParseBottle("set_velocity 0.2 0.5")) + Frame('a', *ParseBottle("[ver]")))
    out += talk(std::string(1, byte));
  EXPECT_EQ(talk.requests.size(), 1u);
  EXPECT_TRUE(out.ends_with(kAck));
}

TEST(YarpEncoding, OtherEncodingsAreStillThere) {
  Talk talk;
  EXPECT_EQ(talk("ping\n"), "0 \"\" 0 1 1 2 0.5 50.0\n");
}

TEST(YarpEncoding, WhoWantsToSendDatagramsGetsAPortAndNothingMore) {
  Talk talk;
  EXPECT_EQ(talk(Hex("'YA' 611e0000 'RP' 03000000 '/w' 00")), Hex("'YA' 67120000 'RP'"));
  EXPECT_EQ(talk.asked, 1);
  EXPECT_EQ(talk(Frame('d', BottleOf(std::string("get_limits")))), "");
  EXPECT_TRUE(talk.ended);
  EXPECT_TRUE(talk.requests.empty());
}

struct KindOfPort {
  const char* path;
  CommandTable (*table)();
};
class EveryPort : public testing::TestWithParam<KindOfPort> {};

TEST_P(EveryPort, AnswersOnlyWhatItHasDecoded) {
  const auto& [path, table] = GetParam();
  Talk program(path, table());
  EXPECT_THAT(program(Hex("'YA' e41e0000 'RP' 03000000 '/x' 00")), StartsWith("YA"));  // asks for its version
  EXPECT_EQ(program.asked, 1);
  EXPECT_TRUE(program(Frame('d', {}).substr(0, 50) + std::string(20, '\xff')).empty() || program.ended);

  Talk reader(path, table());
  reader("CONNECT /me\r\nr\r\n");
  Talk words(path, table());
  words("CONNECT /me\r\n");
  EXPECT_THAT(words("d\r\n)(\r\n"), HasSubstr("fail"));
  EXPECT_NE(words("a\r\n[add] \"tcp://x\"\r\n"), "");
  EXPECT_NE(words("d\r\nhelp\r\n"), "");
}

INSTANTIATE_TEST_SUITE_P(
    Ports, EveryPort,
    testing::Values(KindOfPort{"/robot1/motors", MotorsTable}, KindOfPort{"/world_input_port", WorldTable},
                    KindOfPort{"/clock/rpc", SimulationTable}, KindOfPort{"/robot1/arm/rpc:i", JointsTable},
                    KindOfPort{"/robot1/arm/nws/rpc:i", JointsTable},
                    KindOfPort{"/robot1/arm/command:i", JointsTable},
                    KindOfPort{"/robot1/lidar/rpc:i", LidarTable},
                    KindOfPort{"/robot1/camera/rpc", CameraTable}, KindOfPort{"/robot1/imu/rpc:o", ImuTable},
                    KindOfPort{"/robot1/battery/rpc:i", BatteryTable}));

TEST(YarpEncoding, ConnectionsAreAddedByBottlesAndByLines) {
  Talk talk;
  talk("CONNACK admin\r\n");
  EXPECT_EQ(talk("a\r\n[add] \"tcp://x\"\r\n"), "0 \"\"\r\n<ACK>\r\n");
  EXPECT_EQ(talk("/x\r\n"), "<ACK>\r\n");
  EXPECT_EQ(talk.asked, 2);
}

}  // namespace
}  // namespace coopdyn
