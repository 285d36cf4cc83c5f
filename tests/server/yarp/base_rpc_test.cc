// SPDX-License-Identifier: MIT
// Requests to a drive as sent by the network clients of YARP 3.12 and 4.0, the resulting requests to the
// module, and the reply bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/server/yarp/device_rpc_fixture.h"

namespace coopdyn::device_rpc {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// At most 0.5 m/s and 5 rad/s.
class BaseCommandTest : public DeviceRpcTest {
 protected:
  BaseCommandTest()
      : DeviceRpcTest(YarpTalk::kBase, "/robot1/base/command:i", MotorsTable(),
                      ReplyWith(command::kGetLimits, {10, 0.05, 0.2})) {}

  void ExpectVelocity(const std::string& request, double forward_m_s, double turn_rad_s) {
    EXPECT_EQ(Text(request), "[ok]") << request;
    ASSERT_EQ(told_.size(), 1u) << request;
    EXPECT_EQ(told_[0].command, command::kSetVelocity) << request;
    EXPECT_TRUE(told_[0].params.empty()) << request;
    ASSERT_EQ(told_[0].data.size(), 2u) << request;
    EXPECT_NEAR(told_[0].data[0], forward_m_s, 1e-12) << request;
    EXPECT_NEAR(told_[0].data[1], turn_rad_s, 1e-12) << request;
  }
};

TEST_F(BaseCommandTest, AsksTheModuleForItsLimits) {
  Ask("3 0.2 0.0 0.0 100.0");
  EXPECT_EQ(asked_.command, command::kGetLimits);
}

TEST_F(BaseCommandTest, CartesianCommandsGoAheadAndTurn) {
  ExpectVelocity("3 0.2 0.0 90.0 100.0", 0.2, kHalfTurn / 2);
  ExpectVelocity("3 -0.2 0.0 -45.0 100.0", -0.2, -kHalfTurn / 4);
  ExpectVelocity("3 1 0 0", 1, 0);
}

TEST_F(BaseCommandTest, CartesianCommandsDoNotGoSideways) {
  ExpectVelocity("3 0.2 0.7 0.0 100.0", 0.2, 0);
}

TEST_F(BaseCommandTest, PolarCommandsGoByTheirPartAhead) {
  ExpectVelocity("2 0.0 0.4 90.0 100.0", 0.4, kHalfTurn / 2);
  ExpectVelocity("2 60.0 0.4 0.0 100.0", 0.2, 0);
  ExpectVelocity("2 90.0 0.4 0.0 100.0", 0, 0);
  ExpectVelocity("2 180.0 0.4 0.0 100.0", -0.4, 0);
}

TEST_F(BaseCommandTest, PercentAreOfTheFastestThatWheelsGo) {
  ExpectVelocity("1 0.0 100.0 0.0 100.0", 0.5, 0);
  ExpectVelocity("1 0.0 0.0 100.0 100.0", 0, 5);
  ExpectVelocity("1 60.0 50.0 -10.0 100.0", 0.125, -0.5);
}

TEST_F(BaseCommandTest, OtherCommandsDoNothing) {
  for (const char* const request :
       {"", "3", "3 0.2", "3 0.2 0.0", "3 fast 0.0 0.0 100.0", "3 0.2 0.0 (1.0)", "4 0.2 0.0 0.0 100.0",
        "0 0.2 0.0 0.0 100.0", "1.5 0.2 0.0 0.0 100.0", "ahead 0.2 0.0 0.0 100.0", "(3) 0.2 0.0 0.0"}) {
    ExpectNoSuchRequest(request);
    EXPECT_THAT(Text(request), HasSubstr("3 FORWARD SIDEWAYS TURN GAIN")) << request;
  }
}

TEST_F(BaseCommandTest, WithoutLimitsNothingIsTold) {
  reading_ = Refused(command::kGetLimits);
  EXPECT_EQ(Text("3 0.2 0.0 0.0 100.0"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_TRUE(told_.empty());
  reading_ = ReplyTo(command::kGetLimits);
  EXPECT_THAT(Text("1 0.0 100.0 0.0 100.0"), StartsWith("[fail]"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(BaseCommandTest, SaysWhyTheDriveRefuses) {
  answer_ = Refused(command::kSetVelocity);
  EXPECT_EQ(Text("3 0.2 0.0 0.0 100.0"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_EQ(told_.size(), 1u);
}

class BaseRpcTest : public DeviceRpcTest {
 protected:
  BaseRpcTest()
      : DeviceRpcTest(YarpTalk::kBaseRpc, "/robot1/base/rpc:i", MotorsTable(), ReplyTo(command::kPing)) {}
};

TEST_F(BaseRpcTest, AppliesAVelocity) {
  EXPECT_EQ(Bytes("applyVelocityCommandRPC 0.3 0.1 90.0 1.0"), Hex("01000000 00000000"));
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0].command, command::kSetVelocity);
  ASSERT_EQ(told_[0].data.size(), 2u);
  EXPECT_DOUBLE_EQ(told_[0].data[0], 0.3);
  EXPECT_DOUBLE_EQ(told_[0].data[1], kHalfTurn / 2);
}

TEST_F(BaseRpcTest, AppliesAVelocityInTheWordsOfYarp4) {
  device_->set_dialect(YarpDialect::k4);
  EXPECT_EQ(Bytes("applyVelocityCommandRPC 0.3 0.0 90.0 1.0"), Hex("00010000 01000000 09000000 6f6b0000"));
  EXPECT_EQ(told_.size(), 1u);
}

TEST_F(BaseRpcTest, KnowsTheLastVelocity) {
  EXPECT_EQ(Text("getLastVelocityCommandRPC"), "0 0.0 0.0 0.0");
  EXPECT_TRUE(told_.empty());
  Ask("applyVelocityCommandRPC 0.5 0.25 90.0 1.0");
  EXPECT_EQ(Bytes("getLastVelocityCommandRPC"),
            Hex("00010000 04000000 01000000 00000000 0a000000 000000000000e03f"
                "0a000000 0000000000000000 0a000000 0000000000805640"));
  EXPECT_TRUE(told_.empty());
}

TEST_F(BaseRpcTest, KnowsTheLastVelocityInTheWordsOfYarp4) {
  Ask(kAskVersion);
  Ask("applyVelocityCommandRPC 0.5 0.0 90.0 1.0");
  EXPECT_EQ(Bytes("getLastVelocityCommandRPC"),
            Hex("00010000 04000000 00010000 01000000 09000000 6f6b0000 14000000 000000000000e03f"
                "14000000 0000000000000000 14000000 0000000000805640"));
}

TEST_F(BaseRpcTest, OtherRequestsDoNothing) {
  for (const char* const request :
       {"", "bogus", "applyVelocityCommandRPC", "applyVelocityCommandRPC 0.3 0.0",
        "applyVelocityCommandRPC fast 0.0 0.0 1.0", "applyVelocityCommand 0.3 0.0 0.0 1.0",
        "getLastVelocityCommand", "3 0.3 0.0 0.0 100.0"}) {
    ExpectNoSuchRequest(request);
    EXPECT_THAT(Text(request), HasSubstr("applyVelocityCommandRPC FORWARD")) << request;
  }
}

TEST_F(BaseRpcTest, TellsNothingToAModuleThatDoesNotAnswer) {
  reading_ = Refused(command::kPing);
  EXPECT_EQ(Text("applyVelocityCommandRPC 0.3 0.0 0.0 1.0"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_TRUE(told_.empty());
}

TEST_F(BaseRpcTest, SaysWhyTheDriveRefuses) {
  answer_ = Refused(command::kSetVelocity);
  EXPECT_EQ(Text("applyVelocityCommandRPC 0.3 0.0 0.0 1.0"), "[fail] \"robot1 is driven by ana\"");
  EXPECT_EQ(told_.size(), 1u);
}

}  // namespace
}  // namespace coopdyn::device_rpc
