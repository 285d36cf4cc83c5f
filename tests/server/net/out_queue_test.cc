// SPDX-License-Identifier: MIT
#include "server/net/out_queue.h"

#include <gtest/gtest.h>
#include <netinet/tcp.h>

#include <memory>
#include <optional>
#include <vector>

#include "protocol/codec.h"
#include "scripted_endpoint.h"
#include "server/net/in_buffer.h"
#include "server/net/peer.h"
#include "server/net/waiting_note.h"

namespace coopdyn {
namespace {

UnaskedPtr PushOf(int i, std::string text = "") {
  Message push;
  push.command = -20;
  push.params = {i};
  push.text = std::move(text);
  return boost::make_local_shared<UnaskedMessage>(std::move(push));
}

class OutQueueTest : public ::testing::Test {
 protected:
  OutQueueTest() { queue_.set_encoding(*text_); }
  /// The encoding for clients that begin with these bytes.
  std::unique_ptr<Encoding> EncodingOf(std::string_view first_bytes) {
    return Choose(StandardEncodings(), first_bytes)->make(endpoint_);
  }
  std::string Drain() {
    std::string all;
    while (queue_.Fill()) {
      all += queue_.unsent();
      queue_.Sent(queue_.unsent().size());
    }
    return all;
  }
  ScriptedEndpoint endpoint_;
  const std::unique_ptr<Encoding> text_ = EncodingOf("echo\n"), binary_ = EncodingOf("CDS1");
  OutQueue queue_;
};

TEST_F(OutQueueTest, DropsTheOldestOfMoreThan64PushesAndTheNextOneSaysHowMany) {
  queue_.set_blocked(true);
  for (int i = 1; i <= 67; ++i) queue_.AddPush(PushOf(i));
  const std::string sent = Drain();
  EXPECT_EQ(sent.substr(0, sent.find('\n')), "0 \"dropped 3\" -20 1 4 0");
  EXPECT_EQ(std::count(sent.begin(), sent.end(), '\n'), 64);
}

/// Expects an acknowledgement of each push.
class Acknowledged final : public Encoding {
 public:
  Incoming Decode(std::string_view /*bytes*/) override { return {}; }
  void Reply(const Message& reply, std::string& out) override { out += "reply " + reply.text + "\n"; }
  void Push(UnaskedMessage& push, std::string& out) override {
    out += "push " + std::to_string(push.message()->params.at(0)) + "\n";
    waits = true;
  }
  bool takes_push() const override { return !waits; }
  bool waits = false;
};

TEST_F(OutQueueTest, APushWaitsForTheAcknowledgementOfTheOneBefore) {
  Acknowledged encoding;
  queue_.set_encoding(encoding);
  for (int i = 1; i <= 3; ++i) queue_.AddPush(PushOf(i));
  EXPECT_EQ(Drain(), "push 1\n");
  EXPECT_FALSE(queue_.empty());
  encoding.waits = false;
  EXPECT_EQ(Drain(), "push 2\n");
}

TEST_F(OutQueueTest, WhatWaitsForAnAcknowledgementIsGivenUpWhenNoneCanCome) {
  Acknowledged encoding;
  queue_.set_encoding(encoding);
  for (int i = 1; i <= 3; ++i) queue_.AddPush(PushOf(i));
  queue_.AddReply(ReplyTo(0, "behind"));
  EXPECT_EQ(Drain(), "push 1\n");
  queue_.GiveUpPushes();
  EXPECT_EQ(Drain(), "reply behind\n");
  EXPECT_TRUE(queue_.empty());
}

TEST_F(OutQueueTest, ThePushThatTellsOfDroppedOnesKeepsItsText) {
  queue_.set_blocked(true);
  for (int i = 1; i <= 65; ++i) queue_.AddPush(PushOf(i, "red"));
  EXPECT_EQ(Drain().substr(0, 25), "0 \"dropped 1 red\" -20 1 2");
}

TEST_F(OutQueueTest, RepliesAreNeverDroppedAndKeepTheirPlace) {
  queue_.set_blocked(true);
  queue_.AddPush(PushOf(1));
  queue_.AddReply(ErrorReply(11, Error::kOwned, "mine"));
  for (int i = 2; i <= 65; ++i) queue_.AddPush(PushOf(i));
  EXPECT_EQ(Drain().substr(0, 48), "6 \"mine\" 11 0 0\n0 \"dropped 1\" -20 1 2 0\n0 \"\" -20");
}

TEST_F(OutQueueTest, APushThatHasBegunIsNotDropped) {
  queue_.AddPush(PushOf(1));  // encoded: nothing is before it
  queue_.Sent(3);
  queue_.set_blocked(true);
  for (int i = 2; i <= 70; ++i) queue_.AddPush(PushOf(i));
  EXPECT_EQ(Drain().substr(0, 40), "\" -20 1 1 0\n0 \"dropped 5\" -20 1 7 0\n0 \"\"");
}

TEST_F(OutQueueTest, WhatWaitsIsMadeWhenItsTurnComesAndWhatIsDroppedNever) {
  std::vector<int> made;
  queue_.set_blocked(true);
  for (int i = 1; i <= 1000; ++i) {
    queue_.AddPush(boost::make_local_shared<UnaskedMessage>([&made, i]() -> std::optional<Message> {
      made.push_back(i);
      return ErrorReply(-20, Error::kOk, "");
    }));
  }
  EXPECT_TRUE(made.empty());
  EXPECT_EQ(Drain().substr(0, 21), "0 \"dropped 936\" -20 0");
  ASSERT_EQ(made.size(), 64U);
  EXPECT_EQ(made.front(), 937);
  EXPECT_EQ(made.back(), 1000);
}

TEST_F(OutQueueTest, APushForSeveralIsMadeOnceAndOnlyWhoLostSomethingIsToldSo) {
  int made = 0;
  const auto push = boost::make_local_shared<UnaskedMessage>([&made]() -> std::optional<Message> {
    ++made;
    return ErrorReply(-20, Error::kOk, "red");
  });
  OutQueue binary;
  binary.set_encoding(*binary_);
  binary.AddPush(push);
  queue_.AddPush(push);
  queue_.AddPush(push, 3);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(Drain(), "0 \"red\" -20 0 0\n0 \"dropped 3 red\" -20 0 0\n");
  EXPECT_EQ(DecodeBinary(binary.unsent()).message.text, "red");
}

TEST_F(OutQueueTest, APushThatComesToNothingLeavesItsDroppedOnesToTheNext) {
  queue_.AddPush(boost::make_local_shared<UnaskedMessage>([]() { return std::optional<Message>(); }), 2);
  queue_.AddPush(PushOf(1), 1);
  EXPECT_EQ(Drain(), "0 \"dropped 3\" -20 1 1 0\n");
}

TEST(InBuffer, KeepsBytesInOrderWhileItGrowsAndIsUsedUp) {
  InBuffer buffer;
  std::string expected;
  for (int i = 0; i < 2000; ++i) {
    const std::string piece(static_cast<std::size_t>(i % 97), static_cast<char>('a' + i % 26));
    buffer.Append(piece);
    expected += piece;
    const std::size_t used = std::min(expected.size(), static_cast<std::size_t>(i % 61));
    buffer.Consume(used);
    expected.erase(0, used);
    ASSERT_EQ(buffer.bytes(), expected);
  }
}

TEST(WaitingNote, RepeatsAfterTwoSecondsOrWhenWhomChanges) {
  WaitingNote note;
  const WaitingNote::TimePoint start{};
  const auto at = [start](int ms) { return start + std::chrono::milliseconds(ms); };
  EXPECT_EQ(note.Pause(1), WaitingNote::kFirst);
  EXPECT_EQ(note.Line(1, "robot2 (no client), 1.0 s", at(1000)), "# waiting for robot2 (no client), 1.0 s\n");
  EXPECT_EQ(note.Pause(1), WaitingNote::kEach);
  EXPECT_EQ(note.Line(1, "robot2 (no client), 2.0 s", at(2000)), "");
  EXPECT_EQ(note.Line(1, "robot3 (no client), 2.2 s", at(2200)), "# waiting for robot3 (no client), 2.2 s\n");
  EXPECT_EQ(note.Line(1, "robot3 (no client), 4.2 s", at(4200)), "# waiting for robot3 (no client), 4.2 s\n");
  EXPECT_EQ(note.Line(1, "", at(9000)), "");
}

TEST(PeerLooksDead, OnlyIfSomethingIsOutstandingAndNothingWasHeardForLong) {
  tcp_info info{};
  info.tcpi_last_ack_recv = 30'000;
  EXPECT_FALSE(PeerLooksDead(info));  // idle: covered by keepalive
  info.tcpi_unacked = 1;
  EXPECT_TRUE(PeerLooksDead(info));
  info.tcpi_last_ack_recv = 5'000;
  EXPECT_FALSE(PeerLooksDead(info));
  info.tcpi_unacked = 0;
  info.tcpi_last_ack_recv = 30'000;
  info.tcpi_probes = 1;  // a client that does not read still answers probes
  EXPECT_FALSE(PeerLooksDead(info));
  info.tcpi_probes = 4;
  EXPECT_TRUE(PeerLooksDead(info));
}

}  // namespace
}  // namespace coopdyn
