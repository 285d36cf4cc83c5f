// SPDX-License-Identifier: MIT
#include "server/base/wrong_tokens.h"

#include <gtest/gtest.h>

#include <string>

namespace coopdyn {
namespace {

constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

TEST(WrongTokensTest, AFewSlipsCostNothing) {
  WrongTokens tokens(NullLogger());
  EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", 0), TokenVerdict::kWrong);
  EXPECT_EQ(tokens.Judge(false, "10.0.0.7:2", 0), TokenVerdict::kWrong);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:3", 0), TokenVerdict::kRight);
}

TEST(WrongTokensTest, WhoTriesOnWaitsLongerAndLonger) {
  WrongTokens tokens(NullLogger());
  for (int i = 0; i < WrongTokens::kFree; ++i) tokens.Judge(false, "10.0.0.7:1", 0);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", kSecond - 1), TokenVerdict::kTooSoon) << "though it is right";
  EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", kSecond), TokenVerdict::kWrong);
  EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", 3 * kSecond - 1), TokenVerdict::kTooSoon);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", 3 * kSecond), TokenVerdict::kRight);
}

TEST(WrongTokensTest, ARightTokenForOneThingDoesNotForgiveWrongOnesForAnother) {
  WrongTokens tokens(NullLogger());
  for (int i = 0; i < WrongTokens::kFree; ++i) {
    EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", 0, "seat ana"), TokenVerdict::kWrong);
    EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", 0, "seat ben"), TokenVerdict::kRight);
  }
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", 0, "seat ana"), TokenVerdict::kTooSoon);
  EXPECT_EQ(tokens.WaitText("10.0.0.7:1", 0, "seat ana"),
            "too many wrong PINs came from your address: wait 1 s, then try again");
  EXPECT_EQ(tokens.WaitText("10.0.0.7:1", 0, "seat ben"), "");
}

TEST(WrongTokensTest, WhoTriesManyThingsWaitsForAll) {
  WrongTokens tokens(NullLogger());
  for (int i = 0; i < WrongTokens::kFreeForAll; ++i)
    EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", 0, "seat " + std::to_string(i)), TokenVerdict::kWrong);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", 0, "seat ana"), TokenVerdict::kTooSoon);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", kSecond, "seat ana"), TokenVerdict::kRight);
}

TEST(WrongTokensTest, ManyAtOneAddressWhoSlipAndThenGetItRightNeverWait) {
  WrongTokens tokens(NullLogger());
  for (int student = 0; student < 100; ++student) {
    const std::string seat = std::to_string(student);
    EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", 0, seat), TokenVerdict::kWrong);
    EXPECT_EQ(tokens.Judge(true, "10.0.0.7:1", 0, seat), TokenVerdict::kRight);
  }
}

TEST(WrongTokensTest, SaysHowLongToWait) {
  WrongTokens tokens(NullLogger());
  const std::string peer = "10.0.0.7:1";
  EXPECT_EQ(tokens.WaitText(peer, 0), "");
  for (int i = 0; i < WrongTokens::kFree; ++i) tokens.Judge(false, peer, 0);
  EXPECT_EQ(tokens.WaitText(peer, 0),
            "too many wrong tokens came from your address: wait 1 s, then try again");
  tokens.Judge(false, peer, kSecond);
  EXPECT_NE(tokens.WaitText(peer, kSecond).find("wait 2 s"), std::string::npos);
  EXPECT_NE(tokens.WaitText(peer, 2 * kSecond + 1).find("wait 1 s"), std::string::npos);
  EXPECT_EQ(tokens.WaitText(peer, 3 * kSecond), "");
  EXPECT_EQ(tokens.WaitText("10.0.0.8:1", kSecond), "");
}

TEST(WrongTokensTest, NobodyWaitsMoreThanAMinute) {
  WrongTokens tokens(NullLogger());
  Nanoseconds now = 0;
  for (int i = 0; i < 100; ++i, now += WrongTokens::kLongestWait) {
    EXPECT_EQ(tokens.Judge(false, "10.0.0.7:1", now), TokenVerdict::kWrong) << i;
  }
}

TEST(WrongTokensTest, OtherAddressesDoNotWait) {
  WrongTokens tokens(NullLogger());
  for (int i = 0; i < WrongTokens::kFree; ++i) tokens.Judge(false, "10.0.0.7:1", 0);
  EXPECT_EQ(tokens.Judge(true, "10.0.0.8:1", 0), TokenVerdict::kRight);
}

TEST(WrongTokensTest, OneNetworkOfIPv6IsOneAddress) {
  WrongTokens tokens(NullLogger());
  for (int i = 0; i < WrongTokens::kFree; ++i) {
    tokens.Judge(false, "[2001:db8:1:2::" + std::to_string(i + 1) + "]:1", 0);
  }
  EXPECT_EQ(tokens.Judge(true, "[2001:db8:1:2::ff]:1", 0), TokenVerdict::kTooSoon);
  EXPECT_EQ(tokens.Judge(true, "[2001:db8:1:3::1]:1", 0), TokenVerdict::kRight);
}

TEST(WrongTokensTest, ManyAddressesTakeBoundedMemory) {
  WrongTokens tokens(NullLogger());
  for (std::size_t i = 0; i < 3 * WrongTokens::kMaxCounts; ++i) {
    EXPECT_EQ(tokens.Judge(false, std::to_string(i) + ":1", static_cast<Nanoseconds>(i)),
              TokenVerdict::kWrong);
  }
}

}  // namespace
}  // namespace coopdyn
