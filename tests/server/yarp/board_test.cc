// SPDX-License-Identifier: MIT
// Control boards of YARP 3 and 4: from a program's Bottles to the module's commands, and back. The replies of
// a real board are in YARP's words: controlBoard_nws_yarp 3.12 and 4.0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/yarp/board_stream.h"
#include "server/yarp/translator.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::StartsWith;

constexpr double kRadian = 180 / std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A board of a revolute elbow in position mode at 30 degrees, and a sliding lift in velocity mode.
Message State(std::int64_t step = 100) {
  Message reply = ReplyTo(command::kGetBoard, "elbow lift");
  reply.params = {0, 1, 1, 1, 3, 1};
  reply.data = {45 / kRadian, 0, 1.5, 45 / kRadian, 45 / kRadian, -90 / kRadian, 90 / kRadian, 2, 20,
                kInfinity, 0, 0, 10 / kRadian, 20 / kRadian, 100, 0, 0, 360 / kRadian / 4096,
                //
                0.25, 0.1, -2, 0.25, 0.1, 0, 0.5, kInfinity, kInfinity, 500, 5, 0, 0.2, 0.4, 50, 1, 2, 1e-5,
                //
                step * 0.01, static_cast<double>(step)};
  return reply;
}

/// The module's reply in a mode in which commands are answered immediately.
Message Taken(const Message& command, std::int64_t step = 100) {
  Message reply = ReplyTo(command.command);
  reply.params = {0};
  reply.data = {step * 0.01, static_cast<double>(step)};
  return reply;
}

class BoardTest : public ::testing::Test {
 protected:
  explicit BoardTest(const char* port = "/robot1/arm/rpc:i") : board_(TranslatorOf(port, JointsTable())) {}

  /// The reply to `request`; the commands to the module are in told_.
  YarpAnswer Ask(const std::string& request, const Message& state = State()) {
    told_.clear();
    Message reply = state;
    EXPECT_EQ(board_->Decode(*ParseBottle(request)).message.command, command::kGetBoard) << request;
    while (const std::optional<Message> next = board_->Next(reply)) {
      told_.push_back(*next);
      reply = answer_.error == 0 ? Taken(*next) : answer_;
    }
    return board_->Reply(reply);
  }
  std::string Text(const std::string& request, const Message& state = State()) {
    return BottleText(Ask(request, state).bottle);
  }
  void ExpectTold(const std::string& request, command::Id command, const std::vector<std::int32_t>& joints,
                  const std::vector<double>& data) {
    Text(request);
    ASSERT_EQ(told_.size(), 1u) << request;
    EXPECT_EQ(told_[0].command, command) << request;
    EXPECT_EQ(told_[0].params, joints) << request;
    EXPECT_THAT(told_[0].data, Pointwise(::testing::DoubleNear(1e-9), data)) << request;
  }

  const std::unique_ptr<YarpTranslator> board_;
  std::vector<Message> told_;
  Message answer_ = {};  // reply to commands; may be an error of the module
};

TEST_F(BoardTest, TellsWhatItIs) {
  EXPECT_EQ(Text("get axes"), "[is] axes 2 [tsta] 0 1.0 [ok]");
  EXPECT_EQ(Text("[get] [name] 1"), "[is] [name] lift [tsta] 1 1.0 [ok]");
  EXPECT_EQ(Text("get type 0"), "[is] type 1987212385 [tsta] 2 1.0 [ok]");
  EXPECT_EQ(Text("get type 1"), "[is] type 1919972449 [tsta] 3 1.0 [ok]");
  EXPECT_EQ(Text("[get] [prot]"), "[prot] 1 9 0 [ok]");
  EXPECT_EQ(Text("get mtnm"), "[is] mtnm 2 [tsta] 4 1.0 [ok]");
}

TEST_F(BoardTest, IsInDegreesWhereJointsTurnAndInMetresWhereTheySlide) {
  EXPECT_THAT(Text("get enc 0"), StartsWith("[is] enc 45.0"));
  EXPECT_THAT(Text("get enc 1"), StartsWith("[is] enc 0.25"));
  EXPECT_THAT(Text("get esp 1"), HasSubstr("0.1"));
  EXPECT_THAT(Text("get llim 0"), StartsWith("[is] llim -90.0 90.0 [tsta]"));
  EXPECT_THAT(Text("get llim 1"), StartsWith("[is] llim 0.0 0.5 [tsta]"));
  EXPECT_THAT(Text("get iimp ipr 1"), StartsWith("[is] iimp (500.0 5.0) [tsta]"));
}

TEST_F(BoardTest, GivesListsForAllJoints) {
  EXPECT_THAT(Text("get torq trqs"), StartsWith("[is] torq (1.5 -2.0) [tsta] 0 1.0 [ok]"));
  EXPECT_EQ(Text("get icmd cmds"), "[is] cmds ([pos] [vel]) [tsta] 1 1.0 [ok]");
  EXPECT_EQ(Text("get icmd cmog 1 (1)"), "[is] cmog ([vel]) [tsta] 2 1.0 [ok]");
  EXPECT_EQ(Text("get intm mods"), "([stif] [comp]) [tsta] 3 1.0 [ok]");
  EXPECT_EQ(Text("get torq rngs"), "[is] torq (-20.0 -1000000000.0) (20.0 1000000000.0) [tsta] 4 1.0 [ok]");
  EXPECT_EQ(Text("get asta"), "[is] asta (1 1) [tsta] 5 1.0 [ok]");
  EXPECT_EQ(Text("get pid pids pos"),
            "[is] pid ((100.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0) (50.0 2.0 1.0 0.0 0.0 "
            "0.0 0.0 0.0 0.0 0.0)) [ok]");
}

TEST_F(BoardTest, GivesOneJoint) {
  EXPECT_EQ(Text("get icmd cmod 1"), "[is] 1 [vel] [tsta] 0 1.0 [ok]");
  EXPECT_EQ(Text("get intm mode 1"), "[comp] [tsta] 1 1.0 [ok]");
  EXPECT_EQ(Text("get pid pid pos 1"), "[is] pid (50.0 2.0 1.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0) [ok]");
  EXPECT_EQ(Text("get pid ena pos 1"), "[is] pid 1 [ok]");
  EXPECT_EQ(Text("get vmo 1"), "[is] vmo 0.1 [tsta] 2 1.0 [ok]");
  EXPECT_EQ(Text("get torq ref 0"), "[is] torq 0.0 [tsta] 3 1.0 [ok]");
}

TEST_F(BoardTest, MovesJoints) {
  ExpectTold("set pos 0 90", command::kSetPositions, {1}, {90 / kRadian});
  ExpectTold("[set] [poss] (45.0 0.5)", command::kSetPositions, {1, 2}, {45 / kRadian, 0.5});
  ExpectTold("set posg 1 (1) (0.5)", command::kSetPositions, {2}, {0.5});
  ExpectTold("set rel 0 15", command::kSetPositions, {1}, {60 / kRadian});
  ExpectTold("set vmos (10 0.1)", command::kSetVelocities, {1, 2}, {10 / kRadian, 0.1});
  ExpectTold("set dpo 0 1.5", command::kSetPositionsDirect, {1}, {1.5 / kRadian});
  ExpectTold("set torq ref 0 0.5", command::kSetEfforts, {1}, {0.5});
  EXPECT_EQ(Text("set pos 0 90"), "[ok]");
}

TEST_F(BoardTest, ChangesHowJointsMove) {
  ExpectTold("set vel 0 30", command::kSetProfile, {1}, {30 / kRadian, 20 / kRadian});
  ExpectTold("set accs (40 0.5)", command::kSetProfile, {1, 2}, {10 / kRadian, 40 / kRadian, 0.2, 0.5});
  ExpectTold("set icmd cmod 0 torq", command::kSetModes, {1}, {4});
  ExpectTold("set icmd cmog 2 (0 1) ([pos] [posd])", command::kSetModes, {1, 2}, {1, 2});
  ExpectTold("set pid pid pos 0 (1 2 3 4 5 6 7 8 9 10)", command::kSetGains, {1}, {1, 3, 2});
  ExpectTold("set adi 0", command::kSetModes, {1}, {0});
  ExpectTold("set iimp iof 1 (2.5)", command::kSetCompliance, {2}, {500, 5, 2.5});
  ExpectTold("set iimp ipr 1 (100 3)", command::kSetCompliance, {2}, {100, 3, 0});
  ExpectTold("set intm mode 1 stif", command::kSetCompliance, {2}, {kInfinity, 5, 0});
}

TEST_F(BoardTest, KeepsTheImpedanceOfAStiffJointForWhenItIsCompliant) {
  EXPECT_EQ(Text("set iimp ipr 0 (2.0 0.5)"), "[ok]");
  ASSERT_EQ(told_.size(), 1u);  // the module decides whether the client may
  EXPECT_EQ(told_[0].data[0], kInfinity);
  EXPECT_THAT(Text("get iimp ipr 0"), StartsWith("[is] iimp (2.0 0.5)"));
  ExpectTold("set intm mode 0 comp", command::kSetCompliance, {1}, {2 * kRadian, 0.5 * kRadian, 0});
}

TEST_F(BoardTest, GivesWayALittleWhenNobodyHasSaidHowCompliantItIs) {
  ExpectTold("set intm mode 0 comp", command::kSetCompliance, {1}, {100, 10, 0});
}

TEST_F(BoardTest, StopsEachJointInItsMode) {
  EXPECT_EQ(Text("set stos"), "[ok]");
  ASSERT_EQ(told_.size(), 2u);
  EXPECT_EQ(told_[0].command, command::kHold);
  EXPECT_THAT(told_[0].params, ElementsAre(1));
  EXPECT_EQ(told_[1].command, command::kSetVelocities);
  EXPECT_THAT(told_[1].params, ElementsAre(2));
  EXPECT_THAT(told_[1].data, ElementsAre(0));
}

TEST_F(BoardTest, HasNotArrivedWhileItsCommandIsNotInForce) {
  EXPECT_THAT(Text("get dons"), StartsWith("[is] dons 1"));
  Text("set pos 0 90");  // accepted after step 100, so in force in step 102 at the latest
  EXPECT_THAT(Text("get don 0", State(101)), StartsWith("[is] don 0"));
  EXPECT_THAT(Text("get don 1", State(101)), StartsWith("[is] don 1"));
  EXPECT_THAT(Text("get dons", State(101)), StartsWith("[is] dons 0"));
  EXPECT_THAT(Text("get don 0", State(102)), StartsWith("[is] don 1"));
}

TEST_F(BoardTest, ShowsAReferenceAtOnceToWhoHasSetIt) {
  Text("set pos 0 30.5");
  EXPECT_THAT(Text("get pos 0"), StartsWith("[is] pos 30.5"));
  EXPECT_THAT(Text("get don 0"), StartsWith("[is] don 0"));
  Text("set pos 0 500");
  EXPECT_THAT(Text("get pos 0"), StartsWith("[is] pos 90.0"));
  Text("set dpo 0 12");
  EXPECT_THAT(Text("get dpo 0"), StartsWith("[is] dpo 12.0"));
  Text("set vmo 1 0.05");
  EXPECT_THAT(Text("get vmo 1"), StartsWith("[is] vmo 0.05"));
  Text("set torq ref 0 0.5");
  EXPECT_THAT(Text("get torq ref 0"), StartsWith("[is] torq 0.5"));
}

TEST_F(BoardTest, ShowsAModeAtOnceToWhoHasSetIt) {
  Text("set icmd cmod 0 torq");
  EXPECT_EQ(Text("get icmd cmod 0"), "[is] 0 [torq] [tsta] 0 1.0 [ok]");
  EXPECT_EQ(Text("get icmd cmod 0", State(102)), "[is] 0 [pos] [tsta] 1 1.02 [ok]");
}

TEST_F(BoardTest, FailsAsARealOneAndSaysWhy) {
  EXPECT_EQ(Text("bogus"), "[nak]");
  EXPECT_EQ(Text("get"), "[nak]");
  EXPECT_THAT(Text("foo bar"), StartsWith("[fail] \"begin with get or set"));
  EXPECT_THAT(Text("get bogus"), StartsWith("[fail] \"there is no bogus"));
  EXPECT_THAT(Text("set pos 9 1"), StartsWith("[fail] \"there is no joint 9: they are counted from 0 to 1"));
  EXPECT_THAT(Text("set pos 0.5 1"), StartsWith("[fail] \"joints are whole numbers"));
  EXPECT_THAT(Text("set poss (1)"), StartsWith("[fail] \"2 values are needed for 2 joints, not 1"));
  EXPECT_THAT(Text("set pos 0 far"), StartsWith("[fail] \"values are numbers"));
  EXPECT_THAT(Text("set icmd cmod 0 ipwm"),
              StartsWith("[fail] \"the modes are idl, pos, posd, vel and torq"));
  EXPECT_THAT(Text("set ipwm ref 0 1"), StartsWith("[fail] \"motors have no PWM here"));
  EXPECT_THAT(Text("get icur ref 0"), StartsWith("[fail] \"motors have no currents here"));
  EXPECT_THAT(Text("set llim 0 1 2"), StartsWith("[fail] \"the limits are those of the robot's model"));
  EXPECT_THAT(Text("get pid pid trq 0"), StartsWith("[fail] \"the servo for positions is the only PID"));
  EXPECT_THAT(Text("set posg 2 (1 1) (0 0)"), StartsWith("[fail] \"a joint is named twice"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(BoardTest, ResetsAPidByItsOwnGains) {
  ExpectTold("set pid res pos 1", command::kSetGains, {2}, {50, 1, 2});
  EXPECT_EQ(Text("set pid res pos 0"), "[ok]");
  EXPECT_THAT(Text("get pid res pos 0"), StartsWith("[fail] \"of a PID"));
  EXPECT_THAT(Text("set pid res trq 0"), StartsWith("[fail] \"the servo for positions is the only PID"));
  EXPECT_THAT(Text("set pid res pos 9"), StartsWith("[fail] \"there is no joint 9"));
}

TEST_F(BoardTest, TellsTheCountsOfAnEncoderThatHasSome) {
  EXPECT_EQ(Text("[get] [mcpr] 0"), "[is] [mcpr] 4096.0 [tsta] 0 1.0 [ok]");
  EXPECT_EQ(Text("get mnum"), "[is] mnum 2 [tsta] 1 1.0 [ok]");
  EXPECT_THAT(Text("get mcpr 1"), StartsWith("[fail] \"joint 1 slides: it has no revolutions"));
  EXPECT_THAT(Text("get mcpr 2"), StartsWith("[fail] \"there is no joint 2"));
  Message exact = State();
  exact.data[17] = 0;
  EXPECT_THAT(Text("get mcpr 0", exact), StartsWith("[fail] \"the encoder of joint 0 is exact"));
}

TEST_F(BoardTest, SetsNoEncoder) {
  for (const char* const what : {"enc 0 10", "encs (0 0)", "ere 0", "eres", "mnc 0 10", "mncs (0 0)", "mre 0",
                                 "mres", "mcpr 0 4096"}) {
    EXPECT_THAT(Text(std::string("set ") + what),
                StartsWith("[fail] \"encoders are those of the robot's model"))
        << what;
  }
  EXPECT_TRUE(told_.empty());
}

TEST_F(BoardTest, SaysWhereAccelerationsAre) {
  for (const char* const what : {"eac 0", "eacs", "mac 0", "macs"})
    EXPECT_THAT(Text(std::string("get ") + what), HasSubstr("stateExt:o has the accelerations")) << what;
}

TEST_F(BoardTest, SaysWhyTheModuleRefuses) {
  answer_ = ErrorReply(command::kSetPositions, Error::kOwned, "robot1 is driven by ana");
  EXPECT_EQ(Text("set pos 0 1"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_EQ(Text("get axes", ErrorReply(command::kGetBoard, Error::kNotPossible, "gone")), "[fail] gone");
}

TEST_F(BoardTest, HelpsByWords) {
  EXPECT_THAT(Text("help"), StartsWith("[many] \"A control board of YARP: degrees"));
}

class BoardStreamTest : public BoardTest {
 protected:
  BoardStreamTest() : BoardTest("/robot1/arm/command:i") {}
};

TEST_F(BoardStreamTest, TakesCommandsOfBothVersions) {
  ExpectTold("([vmo] 1) (0.2)", command::kSetVelocities, {2}, {0.2});
  ExpectTold("([vmos]) (10.0 0.2)", command::kSetVelocities, {1, 2}, {10 / kRadian, 0.2});
  ExpectTold("([dpog] 1 (0)) (10.0)", command::kSetPositionsDirect, {1}, {10 / kRadian});
  ExpectTold("([dtqs]) (1.0 2.0)", command::kSetEfforts, {1, 2}, {1, 2});
  ExpectTold("([ipod] [dpo] 0) (10.0)", command::kSetPositionsDirect, {1}, {10 / kRadian});
  ExpectTold("([ivel] [vmog] 1 (1)) (0.3)", command::kSetVelocities, {2}, {0.3});
  ExpectTold("([ived] [vdsa]) (10.0 0.2)", command::kSetVelocities, {1, 2}, {10 / kRadian, 0.2});
  ExpectTold("([ipos] [poss]) (10.0 0.2)", command::kSetPositions, {1, 2}, {10 / kRadian, 0.2});
}

TEST_F(BoardStreamTest, LeavesOutWhatItCannotDo) {
  for (const char* const message : {"", "10.0 20.0", "([vmos])", "() (1.0)", "([vmos]) (1.0)",
                                    "([vmo] 7) (1.0)", "([vmog] 2 (0 x)) (1.0 2.0)", "([icur] [ref] 0) (1.0)",
                                    "([ipwm] [refs]) (1.0 2.0)", "([vmos]) (a b)"}) {
    EXPECT_THAT(Text(message), StartsWith("[fail]")) << message;
    EXPECT_TRUE(told_.empty()) << message;
  }
}

class BoardRpcTest : public BoardTest {
 protected:
  BoardRpcTest() : BoardTest("/robot1/arm/nws/rpc:i") {}
  std::string Bytes(const std::string& request) { return Ask(request).bytes; }
};

TEST_F(BoardRpcTest, OpensAsARealOne) {
  EXPECT_EQ(Bytes("getRemoteProtocolVersion"), Hex("00010000 01000000 00000400 00000000"));
  EXPECT_EQ(Bytes("getAxesRPC"),
            Hex("00010000 02000000 00010000 01000000 09000000 6f6b0000 01000000 02000000"));
  const std::string interfaces = Bytes("getDeviceInterfacesRPC");
  EXPECT_THAT(interfaces,
              StartsWith(Hex("00010000 02000000 00010000 01000000 09000000 6f6b0000 00010000 17000000 "
                             "00010000 02000000 04000000 11000000 'iAmplifierControl'")));
}

TEST_F(BoardRpcTest, AnswersWithACodeAlone) {
  const std::string kOk = Hex("00010000 01000000 09000000 6f6b0000");
  EXPECT_EQ(Bytes("setControlModeOneRPC 0 7565168"), kOk);  // [pos] as a number
  EXPECT_EQ(Bytes("positionMoveAllRPC (10.0 0.2)"), kOk);
  ExpectTold("setControlModeOneRPC 0 1685286768", command::kSetModes, {1}, {2});  // [posd]
  ExpectTold("setControlModeAllRPC ([vel] [vel])", command::kSetModes, {1, 2}, {3, 3});
  ExpectTold("positionMoveGroupRPC (1) (0.2)", command::kSetPositions, {2}, {0.2});
  ExpectTold("velocityMoveOneRPC 0 10.0", command::kSetVelocities, {1}, {10 / kRadian});
  ExpectTold("setTrajSpeedOneRPC 0 20.0", command::kSetProfile, {1}, {20 / kRadian, 20 / kRadian});
  ExpectTold("setPidRPC 829648752 0 (1.0 2.0 3.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0)", command::kSetGains, {1},
             {1, 3, 2});
  ExpectTold("resetPidRPC 829648752 1", command::kSetGains, {2}, {50, 1, 2});
}

TEST_F(BoardRpcTest, AnswersWithCodeAndValues) {
  EXPECT_EQ(Text("getAxisNameRPC 1"), "([ok]) lift");
  EXPECT_EQ(Text("getJointTypeRPC 0"), "([ok]) 1987212385");
  EXPECT_EQ(Text("getPosLimitsRPC 1"), "([ok]) 0.0 0.5");
  EXPECT_EQ(Text("getTorqueRangeAllRPC"), "([ok]) (-20.0 -1000000000.0) (20.0 1000000000.0)");
  EXPECT_EQ(Text("checkMotionDoneAllRPC"), "([ok]) [ok]");
  EXPECT_EQ(Text("getEncoderTimedOneRPC 1"), "([ok]) 0.25 1.0");
  EXPECT_EQ(Text("getInteractionModesAllRPC"), "([ok]) (1718187123 1886220131)");
  EXPECT_EQ(Text("getPidRPC 829648752 1"), "([ok]) (50.0 2.0 1.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0)");
  EXPECT_EQ(Text("getRemoteVariablesListRPC"), "([ok]) ()");
  EXPECT_EQ(Text("isCalibratorDevicePresentRPC"), "([ok]) [fail]");
  EXPECT_EQ(Text("getLastJointFaultRPC 0"), "([ok]) 0 \"\"");
  EXPECT_EQ(Text("getMotorEncoderCountsPerRevolutionRPC 0"), "([ok]) 4096.0");
}

TEST_F(BoardRpcTest, KeepsTheShapeOfTheAnswerWhenItRefuses) {
  EXPECT_THAT(Text("getRefCurrentOneRPC 0"), StartsWith("([err2]) 0.0"));
  EXPECT_THAT(Text("getTemperatureAllRPC"), StartsWith("([err2]) ()"));
  EXPECT_THAT(Text("getMotorEncoderCountsPerRevolutionRPC 1"), StartsWith("([err2]) 0.0"));
  EXPECT_THAT(Text("setMotorEncoderCountsPerRevolutionRPC 0 4096.0"), StartsWith("[err2]"));
  EXPECT_THAT(Text("getAxisNameRPC 7"), StartsWith("([err7]) \"\" \"there is no joint 7"));
  EXPECT_THAT(Text("setRefDutyCycleOneRPC 0 1.0"), StartsWith("[err2]"));
  EXPECT_EQ(Bytes("setPosLimitsRPC 0 1.0 2.0"), Hex("00010000 01000000 09000000 65727232"));
  EXPECT_THAT(Text("bogus"), StartsWith("[fail] \"calls end with RPC"));
}

TEST(BoardSampler, SendsTheFieldsOfEachVersion) {
  const BoardState state = *ReadBoard(State());
  BoardSampler sampler;
  std::string bytes;
  sampler.AppendState(state, YarpDialect::k3, bytes);
  EXPECT_EQ(bytes.size(), 8u + 9 * (8 + 2 * 8 + 8) + 2 * (8 + 2 * 4 + 8));
  EXPECT_THAT(bytes, StartsWith(Hex("00010000 16000000 0a010000 02000000")));
  bytes.clear();
  sampler.AppendState(state, YarpDialect::k4, bytes);
  EXPECT_THAT(bytes, StartsWith(Hex("00010000 18000000 14010000 02000000")));
  EXPECT_EQ(bytes.size(), 8u + 8 * (8 + 2 * 8 + 8) + 4 * (8 + 2 * 4 + 8));
}

TEST(BoardSampler, TakesAccelerationsFromTheVelocities) {
  BoardState state = *ReadBoard(State());
  BoardSampler sampler;
  std::string bytes;
  sampler.AppendState(state, YarpDialect::k3, bytes);
  state.time_s += 0.5;
  state.joints[1].velocity += 2;
  bytes.clear();
  sampler.AppendState(state, YarpDialect::k3, bytes);
  YarpDialect dialect = YarpDialect::k3;
  const Bottle fields = *DecodeBottle(bytes, dialect);
  ASSERT_EQ(fields.size(), 22u);
  EXPECT_THAT(BottleText(*fields[4].As<Bottle>()), "0.0 4.0");
  EXPECT_THAT(BottleText(*fields[18].As<Bottle>()), "7565168 7103862");  // [pos] [vel]
  EXPECT_EQ(fields[15].word(), "fail");                                  // no duty cycles
}

TEST(ReadBoard, TakesNothingElse) {
  EXPECT_FALSE(ReadBoard(Taken({})));
  Message cut = State();
  cut.data.pop_back();
  EXPECT_FALSE(ReadBoard(cut));
}

}  // namespace
}  // namespace coopdyn
