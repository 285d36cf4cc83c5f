// SPDX-License-Identifier: MIT
#include "server/web/web_connections.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace coopdyn {
namespace {

using Answered = WebConnections::Verdict;  // coopdyn::Verdict is another

struct FakeConnection : WebConnection {
  void Close() override { closed = true; }
  bool closed = false;
};

PeerInfo Peer(const std::string& text) {
  return {.text = text, .trusted = text.starts_with("127.")};
}

/// Connections that live until closed, like the server's.
class Visitors {
 public:
  explicit Visitors(WebLimits limits) : connections_(limits) {}

  Answered Come(const std::string& peer) {
    const Answered verdict = connections_.Admit(Peer(peer));
    std::erase_if(alive_, [](const auto& connection) { return connection->closed; });
    if (verdict == Answered::kDrop) return verdict;
    alive_.push_back(std::make_shared<FakeConnection>());
    connections_.Add(alive_.back(), Peer(peer));
    return verdict;
  }
  /// How many of `count` connections are served.
  int Come(const std::string& peer, int count) {
    int served = 0;
    for (int i = 0; i < count; ++i) served += Come(peer) == Answered::kServe ? 1 : 0;
    return served;
  }
  void AllLeave() { alive_.clear(); }
  std::size_t count() const { return alive_.size(); }

 private:
  WebConnections connections_;
  std::vector<std::shared_ptr<FakeConnection>> alive_;
};

constexpr WebLimits kLimits{.loopback = 50, .per_address = 10, .others = 30};

TEST(WebConnections, AnAddressHasItsShare) {
  Visitors visitors(kLimits);
  EXPECT_EQ(visitors.Come("10.0.0.9:4711", 12), 10);
  EXPECT_EQ(visitors.Come("10.0.0.8:4711", 12), 10);
}

TEST(WebConnections, OthersDoNotUseUpTheRoomOfThisMachine) {
  Visitors visitors(kLimits);
  for (const char* peer : {"10.0.0.1:1", "10.0.0.2:1", "10.0.0.3:1", "10.0.0.4:1"}) visitors.Come(peer, 10);
  EXPECT_EQ(visitors.Come("127.0.0.1:4711", 60), 50);
}

TEST(WebConnections, WhoHasMostMakesRoomForWhoHasLess) {
  Visitors visitors(kLimits);
  for (const char* peer : {"10.0.0.1:1", "10.0.0.2:1", "10.0.0.3:1"}) EXPECT_EQ(visitors.Come(peer, 10), 10);
  EXPECT_EQ(visitors.Come("10.0.0.4:1", 5), 5);
  EXPECT_EQ(visitors.count(), 30U);
}

TEST(WebConnections, NobodyMakesRoomForWhoHasAsMuch) {
  Visitors visitors({.loopback = 50, .per_address = 10, .others = 10});
  EXPECT_EQ(visitors.Come("10.0.0.1:1", 5), 5);
  EXPECT_EQ(visitors.Come("10.0.0.2:1", 5), 5);
  EXPECT_EQ(visitors.Come("10.0.0.1:1"), Answered::kRefuse);
}

TEST(WebConnections, RefusalsAreBoundedToo) {
  Visitors visitors(kLimits);
  visitors.Come("10.0.0.9:1", 10);
  for (std::size_t i = 0; i < WebConnections::kRefusedAtOnce; ++i) {
    EXPECT_EQ(visitors.Come("10.0.0.9:1"), Answered::kRefuse);
  }
  EXPECT_EQ(visitors.Come("10.0.0.9:1"), Answered::kDrop);
}

TEST(WebConnections, WhoHasGoneDoesNotCount) {
  Visitors visitors(kLimits);
  visitors.Come("10.0.0.9:1", 10);
  visitors.AllLeave();
  EXPECT_EQ(visitors.Come("10.0.0.9:1", 10), 10);
}

TEST(WebConnections, AnAddressIsANetworkOf64BitsInIpv6) {
  EXPECT_EQ(NetworkOf(Peer("[2001:db8:0:1::7]:80")), NetworkOf(Peer("[2001:db8:0:1:ff::1]:81")));
  EXPECT_NE(NetworkOf(Peer("[2001:db8:0:1::7]:80")), NetworkOf(Peer("[2001:db8:0:2::7]:80")));
  EXPECT_NE(NetworkOf(Peer("10.0.0.8:80")), NetworkOf(Peer("10.0.0.9:80")));
}

}  // namespace
}  // namespace coopdyn
