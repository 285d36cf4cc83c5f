// SPDX-License-Identifier: MIT
// A third encoding that only this test knows: sessions must support encodings other than their own.
#include "server/net/encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/net/session.h"
#include "server_fixture.h"
#include "tests/cpu.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

/// The reply to `HI NAME` has two parts; then `add N` collects numbers until `ask` sends them as one request,
/// with the reply `= N`; `tell` is the same without a reply.
class ChattyEncoding final : public Encoding {
 public:
  std::string Greeting() override { return "hello\n"; }

  Incoming Decode(std::string_view bytes) override {
    const std::size_t end = bytes.find('\n');
    if (end == bytes.npos) return {};
    const std::string line(bytes.substr(0, end));
    Incoming incoming{DecodeStatus::kNothing, end + 1};
    if (line.starts_with("HI ")) {
      incoming.answer = "welcome " + line.substr(3) + "\n";
    } else if (line.starts_with("add ")) {
      request_.data.push_back(std::stod(line.substr(4)));
    } else if (line.starts_with("count to ")) {  // a request for each, one reply
      left_ = std::stoi(line.substr(9)) - 1;
      wants_reply_ = true;
      incoming.status = DecodeStatus::kMessage;
      incoming.message = Echo(1);
    } else if (line == "ask" || line == "tell") {
      wants_reply_ = line == "ask";
      incoming.status = DecodeStatus::kMessage;
      incoming.message = std::exchange(request_, {});
      incoming.message.command = ScriptedEndpoint::kPushes;
    } else {
      incoming.status = DecodeStatus::kFatal;
      incoming.message = ErrorReply(0, Error::kMalformed, "what?");
      wants_reply_ = true;
    }
    return incoming;
  }
  std::optional<Message> Next(const Message& reply, std::string& out) override {
    if (left_ == 0) return std::nullopt;
    --left_;
    out += "got " + std::to_string(reply.data.at(0)) + "\n";
    return Echo(reply.data.at(0) + 1);
  }
  void Reply(const Message& reply, std::string& out) override {
    if (!wants_reply_) return;
    out += reply.error != 0 ? "! " + reply.text + "\n" : "= " + std::to_string(reply.data.at(0)) + "\n";
  }
  void Push(UnaskedMessage& push, std::string& out) override {
    out += "* " + push.message()->text + std::to_string(push.message()->data.size()) + "\n";
  }

 private:
  static Message Echo(double number) {
    Message request;
    request.command = ScriptedEndpoint::kEcho;
    request.data = {number};
    return request;
  }

  Message request_;
  int left_ = 0;
  bool wants_reply_ = false;
};

std::unique_ptr<Encoding> MakeChatty(const Endpoint& /*endpoint*/) {
  return std::make_unique<ChattyEncoding>();
}

Match MatchesHi(std::string_view bytes) {
  constexpr std::string_view kFirst = "HI ";
  return bytes.starts_with(kFirst) ? Match::kYes : kFirst.starts_with(bytes) ? Match::kMaybe : Match::kNo;
}

Encodings WithChatty() {
  Encodings encodings = StandardEncodings();
  encodings.insert(encodings.begin(), EncodingKind{MatchesHi, MakeChatty});
  return encodings;
}

class EncodingTest : public ServerFixture {
 protected:
  EncodingTest() : ServerFixture(WithChatty()) {}
};

TEST_F(EncodingTest, AThirdOneIsChosenByItsFirstBytesGreetsAndShakesHands) {
  TestClient client = Connect();
  for (const char byte : std::string("HI ana\n")) ASSERT_TRUE(client.Send({&byte, 1}));
  EXPECT_EQ(client.Line(), "hello");
  EXPECT_EQ(client.Line(), "welcome ana");
  EXPECT_EQ(endpoint_.Count("request"), 0);
}

TEST_F(EncodingTest, ARequestMaySpanSeveralMessagesAndHaveNoReply) {
  TestClient client = Connect();
  client.Send("HI ana\nadd 2\nadd 7\ntell\nadd 1\nask\n");
  for (const char* line : {"hello", "welcome ana", "* 3", "* 3", "* 3", "= 1.000000"}) {
    EXPECT_EQ(client.Line(), line);
  }
  EXPECT_EQ(endpoint_.Count("request"), 2);
}

TEST_F(EncodingTest, ARequestMayBecomeSeveralAndTellMeanwhile) {
  TestClient client = Connect();
  client.Send("HI ana\ncount to 3\ncount to 1\n");
  for (const char* line :
       {"hello", "welcome ana", "got 1.000000", "got 2.000000", "= 3.000000", "= 1.000000"}) {
    EXPECT_EQ(client.Line(), line);
  }
  EXPECT_EQ(endpoint_.Count("request"), 4);
}

TEST_F(EncodingTest, WhatARequestBecomesIsDoneThoughTheClientSendsNoMore) {
  TestClient client = Connect();
  client.Send("HI ana\ncount to 3\n");
  client.EndInput();
  EXPECT_EQ(client.Rest(), "hello\nwelcome ana\ngot 1.000000\ngot 2.000000\n= 3.000000\n");
}

TEST_F(EncodingTest, AFatalMistakeGetsItsReplyAndANoticeInTheEncodingThenTheEnd) {
  TestClient client = Connect();
  client.Send("HI ana\nnonsense\n");
  EXPECT_EQ(client.Rest(), "hello\nwelcome ana\n! what?\n* what?0\n");
  EXPECT_TRUE(NoSessions());
}

TEST_F(EncodingTest, TheOthersAreChosenAsBefore) {
  TestClient text = Connect();
  text.Send("H\necho 1\n");
  EXPECT_THAT(text.Line(), HasSubstr(" -2 0 0"));
  EXPECT_THAT(text.Line(), HasSubstr(" 500 "));
  TestClient binary = Connect();
  binary.Send("CDS1" + Frame(ScriptedEndpoint::kEcho, {3}));
  EXPECT_EQ(binary.Frame().command, ScriptedEndpoint::kEcho);
}

TEST_F(EncodingTest, OneThatWasAgreedUponGreetsBeforeAnythingComes) {
  auto [ours, theirs] = SocketPair();
  server_->Adopt(theirs.Release(), "", {"dialled", true}, std::make_unique<ChattyEncoding>());
  TestClient client(std::move(ours));
  EXPECT_EQ(client.Line(), "hello");
}

TEST_F(EncodingTest, AConnectionOfDatagramsEndsWhenNothingHasComeForItsTime) {
  auto [ours, theirs] = SocketPair(SOCK_DGRAM);
  ASSERT_EQ(EndOf(theirs.get())->silence, ConnectionEnd::kDatagramSilence);
  bool ended = false;
  const IoThread::Poster poster = thread_.poster();
  std::shared_ptr<Session> session;
  TestClient client(std::move(ours));
  client.Send("hold 1\n");  // arrives before the silence begins
  thread_.Call([&, fd = theirs.Release()] {
    session = std::make_shared<Session>(
        thread_.context(), Session::Socket(thread_.context(), Session::AnyProtocol(), fd),
        ConnectionEnd{std::chrono::milliseconds(500)}, endpoint_, services_, poster,
        PeerInfo{"datagrams", true}, [&ended](ClientId) { ended = true; });
    session->Start({});
  });
  ASSERT_TRUE(Sees("request 501 1"));
  EXPECT_TRUE(Sees("input ended"));
  EXPECT_EQ(endpoint_.Count("closed"), 0);  // its pending requests are still answered
  Release();
  EXPECT_THAT(client.Line(), HasSubstr(" 501 "));
  EXPECT_TRUE(Sees("closed"));
  thread_.Call([&] { EXPECT_TRUE(ended); });
}

TEST(StandardEncodingsTest, ReadWhatComesByteByByteOnce) {
  ScriptedEndpoint endpoint;
  for (const std::string head : {"CDS1", "log "}) {
    const auto read = [&](std::size_t n) {
      std::string bytes = head;
      if (head == "CDS1") {
        Message message;
        message.text.assign(n, 'x');
        EncodeBinary(message, bytes);
      } else {
        bytes += std::string(n, 'x') + "\n";
      }
      const auto kinds = StandardEncodings();
      const auto encoding = Choose(kinds, bytes)->make(endpoint);
      std::size_t done = 0;
      for (std::size_t end = 1; end <= bytes.size(); ++end)
        done += encoding->Decode(std::string_view(bytes).substr(done, end - done)).consumed;
    };
    ExpectLinear(read, 100'000);
  }
}

}  // namespace
}  // namespace coopdyn
