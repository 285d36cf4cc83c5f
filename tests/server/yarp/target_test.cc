// SPDX-License-Identifier: MIT
#include "server/yarp/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

TEST(YarpTarget, HasANameACarrierAndPlugInsOfTheReader) {
  for (const char* const text : {"/reader", "reader", "tcp://reader"}) {
    const YarpTarget target = ParseYarpTarget(text);
    EXPECT_EQ(target.name, "/reader") << text;
    EXPECT_EQ(target.carrier, YarpCarrier::kTcp) << text;
    EXPECT_EQ(target.problem, "") << text;
  }
  const YarpTarget filtered = ParseYarpTarget("fast_tcp+recv.portmonitor+type.lua://a/reader");
  EXPECT_EQ(filtered.name, "/a/reader");
  EXPECT_EQ(filtered.carrier, YarpCarrier::kFastTcp);
  EXPECT_EQ(filtered.qualifiers, " (recv portmonitor) (type lua)");
  EXPECT_EQ(filtered.problem, "");
}

TEST(YarpTarget, WhatTheDaemonCannotDoIsAProblem) {
  for (const char* const carrier :
       {"tcp+send.portmonitor", "tcp+log.in", "tcp+recv.x+send.y", "udp+type.lua"})
    EXPECT_THAT(ParseYarpTarget(std::string(carrier) + "://r").problem, HasSubstr("no plug-in runs"))
        << carrier;
  for (const char* const carrier : {"mcast", "mjpeg", "http"})
    EXPECT_THAT(ParseYarpTarget(std::string(carrier) + "://r").problem, HasSubstr("use tcp")) << carrier;
  EXPECT_THAT(ParseYarpTarget("tcp+recv.x\ny://r").problem, HasSubstr("plain text"));
}

TEST(YarpTarget, AnAddressIsANameLikeAnyOther) {
  EXPECT_EQ(ParseYarpTarget("tcp://127.0.0.1:17999/").name, "/127.0.0.1:17999/");
  EXPECT_EQ(ParseYarpTarget("tcp:/127.0.0.1:17999").name, "/127.0.0.1:17999");
}

}  // namespace
}  // namespace coopdyn
