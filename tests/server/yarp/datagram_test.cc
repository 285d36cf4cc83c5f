// SPDX-License-Identifier: MIT
#include "server/yarp/datagram.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/yarp/carrier.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn {
namespace {

/// A message with a payload of N bytes.
std::string MessageOf(std::size_t bytes) {
  std::string message;
  AppendYarpMessage(YarpCarrier::kUdp, "D 1 2.5", std::string(bytes, 'x'), message);
  return message;
}

TEST(Datagrams, HaveTheChecksumAndTheirNumber) {
  const std::vector<std::string> datagrams = CutIntoDatagrams("123456789");
  ASSERT_EQ(datagrams.size(), 1u);
  EXPECT_EQ(datagrams[0], Hex("2639f4cb 00000000 '123456789'"));  // the check value of CRC-32
}

TEST(Datagrams, AreJoinedToTheMessage) {
  const std::string message = MessageOf(150'000);
  const std::vector<std::string> datagrams = CutIntoDatagrams(message);
  ASSERT_EQ(datagrams.size(), 3u);
  DatagramJoiner joiner;
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(joiner.Add(datagrams[0]), "");
    EXPECT_EQ(joiner.Add(datagrams[1]), "");
    EXPECT_EQ(joiner.Add(datagrams[2]), message);
  }
}

TEST(Datagrams, AMessageWithAGapIsDroppedAndTheNextOneComes) {
  const std::vector<std::string> datagrams = CutIntoDatagrams(MessageOf(150'000));
  const std::string small = MessageOf(3);
  DatagramJoiner joiner;
  joiner.Add(datagrams[0]);
  EXPECT_EQ(joiner.Add(datagrams[2]), "");
  EXPECT_EQ(joiner.Add(datagrams[1]), "");
  EXPECT_EQ(joiner.Add(CutIntoDatagrams(small)[0]), small);
  joiner.Add(datagrams[0]);
  EXPECT_EQ(joiner.Add(CutIntoDatagrams(small)[0]), small);
}

TEST(Datagrams, WhatIsSpoiledOrSaysNothingIsDropped) {
  std::string spoiled = CutIntoDatagrams(MessageOf(3))[0];
  spoiled.back() ^= 1;
  std::string wake_up = CutIntoDatagrams(MessageOf(3))[0];
  wake_up.replace(4, 4, "\xff\xff\xff\xff");
  DatagramJoiner joiner;
  for (const std::string& datagram : {std::string(), std::string("1234567"), spoiled, wake_up,
                                      CutIntoDatagrams("no message at all, but whole")[0]}) {
    EXPECT_EQ(joiner.Add(datagram), "");
  }
  EXPECT_EQ(joiner.Add(CutIntoDatagrams(MessageOf(3))[0]), MessageOf(3));
}

}  // namespace
}  // namespace coopdyn
