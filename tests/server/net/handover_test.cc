// SPDX-License-Identifier: MIT
// A module replaces another: its port and connections are handed over.
#include "server/net/handover.h"

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kManyNumbers = 1 << 18;

/// The world's reply to "ask", sent when the test requests it.
struct Asked {
  std::vector<ReplyFunction> waiting;
};

/// Lines: "get" echoes, "hold" waits for the endpoint, "ask" for Asked, "much" has a long reply.
class StayingEncoding final : public Encoding {
 public:
  explicit StayingEncoding(Asked& asked) : asked_(asked) {}

  void Attach(const Connection& /*connection*/, const Endpoint& endpoint) override { at_ = endpoint.path(); }
  bool outlives_module() const override { return true; }
  std::optional<Message> AskedAgain(const Message& /*reply*/) override { return Request(); }

  Incoming Decode(std::string_view bytes) override {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return {};
    const std::string_view line = bytes.substr(0, end);
    Incoming incoming{.status = DecodeStatus::kMessage, .consumed = end + 1, .message = Request()};
    if (line == "ask") {
      incoming.status = DecodeStatus::kNothing;
      incoming.ask = [this](const Connection& /*asker*/, ReplyFunction reply) {
        asked_.waiting.push_back(std::move(reply));
      };
    } else if (line == "hold") {
      incoming.message.command = ScriptedEndpoint::kHold;
    } else if (line == "much") {
      incoming.status = DecodeStatus::kNothing;
      incoming.answer = std::string(kManyNumbers, 'x') + "\n";
    }
    return incoming;
  }
  void Reply(const Message& reply, std::string& out) override { out += at_ + " " + reply.text + "\n"; }
  void Push(UnaskedMessage& /*push*/, std::string& out) override { out += "notice\n"; }

 private:
  static Message Request() {
    Message request;
    request.command = ScriptedEndpoint::kEcho;
    request.text = "echo";
    return request;
  }

  Asked& asked_;
  std::string at_;
};

class NamedEndpoint final : public ScriptedEndpoint {
 public:
  explicit NamedEndpoint(std::string name) : name_(std::move(name)) {}
  const std::string& path() const override { return name_; }

 private:
  const std::string name_;
};

class HandoverTest : public ServerFixture {
 protected:
  ~HandoverTest() override {
    next_thread_.Call([this] { next_.reset(); });
  }

  TestClient ConnectStaying() {
    auto [ours, theirs] = SocketPair();
    server_->Adopt(theirs.Release(), "", {"stays", true}, std::make_unique<StayingEncoding>(asked_));
    return TestClient(std::move(ours));
  }
  LoosePort Leave() {
    LoosePort port = server_->Release();
    thread_.Call([this] { server_.reset(); });
    return port;
  }
  void Replace() { next_->Listen(Leave()); }
  bool IsAsked() {
    return Eventually([this] {
      bool asked = false;
      thread_.Call([&] { asked = !asked_.waiting.empty(); });
      return asked;
    });
  }

  Asked asked_;
  NamedEndpoint next_endpoint_{"/next"};
  IoThread next_thread_{"next-io", NullLogger()};
  std::unique_ptr<ModuleServer> next_ =
      std::make_unique<ModuleServer>(next_thread_, next_endpoint_, services_, "/next");
};

TEST_F(HandoverTest, AConnectionThatStaysTalksToTheNextModule) {
  TestClient client = ConnectStaying();
  client.Send("get\n");
  EXPECT_EQ(client.Line(), endpoint_.path() + " echo");
  Replace();
  EXPECT_EQ(endpoint_.Count("closed"), 1);
  client.Send("get\nget\n");
  EXPECT_EQ(client.Line(), "/next echo");
  EXPECT_EQ(client.Line(), "/next echo");
  EXPECT_EQ(next_endpoint_.Count("open stays trusted"), 1);
  EXPECT_EQ(next_->session_count(), 1U);
}

TEST_F(HandoverTest, NoByteIsLostHoweverTheyCome) {
  TestClient client = ConnectStaying();
  std::unique_ptr<ModuleServer> now = std::move(server_);
  std::vector<std::unique_ptr<IoThread>> threads;
  IoThread* on = &thread_;
  constexpr int kModules = 50, kEach = 20;
  for (int i = 0; i < kModules; ++i) {
    for (int k = 0; k < kEach; ++k) client.Send(k % 2 == 0 ? "get\nge" : "t\n");
    LoosePort port = now->Release();
    on->Call([&] { now.reset(); });
    on = threads.emplace_back(std::make_unique<IoThread>("next", NullLogger())).get();
    now = std::make_unique<ModuleServer>(*on, next_endpoint_, services_, "/next");
    now->Listen(std::move(port));
  }
  for (int i = 0; i < kModules * kEach; ++i) ASSERT_THAT(client.Line(), HasSubstr(" echo")) << i;
  on->Call([&] { now.reset(); });
}

TEST_F(HandoverTest, WhatWaitsForTheWorldGoesOnWaitingThere) {
  TestClient client = ConnectStaying();
  client.Send("ask\nget\n");
  ASSERT_TRUE(IsAsked());
  Replace();
  ASSERT_TRUE(Eventually([this] { return next_->session_count() == 1; }));
  EXPECT_EQ(next_endpoint_.Count("request"), 0);
  asked_.waiting.front()(ReplyTo(0, "done"));
  EXPECT_EQ(client.Line(), "/next done");
  EXPECT_EQ(client.Line(), "/next echo");
}

TEST_F(HandoverTest, TheWorldMayAnswerWhileAConnectionIsBetweenTwoModules) {
  TestClient client = ConnectStaying();
  client.Send("ask\nget\n");
  ASSERT_TRUE(IsAsked());
  LoosePort port = Leave();
  asked_.waiting.front()(ReplyTo(0, "done"));
  next_->Listen(std::move(port));
  EXPECT_EQ(client.Line(), "/next done");
  EXPECT_EQ(client.Line(), "/next echo");
}

TEST_F(HandoverTest, AStepThatTheModuleHasNotAnsweredIsForgotten) {
  TestClient client = ConnectStaying();
  client.Send("hold\nget\n");
  ASSERT_TRUE(Sees("request 501"));
  Replace();
  EXPECT_EQ(client.Line(), "/next echo");
}

TEST_F(HandoverTest, WhatTheClientHasNotReadYetComesWhole) {
  TestClient client = ConnectStaying();
  for (int i = 0; i < 8; ++i) client.Send("much\n");
  client.Send("get\n");
  ASSERT_TRUE(Sees("open"));
  Replace();
  for (int i = 0; i < 8; ++i) EXPECT_EQ(client.Line(), std::string(kManyNumbers, 'x'));
  EXPECT_THAT(client.Line(), HasSubstr(" echo"));
}

TEST_F(HandoverTest, ARequestToAModuleThatHasGoneIsAskedOfTheNext) {
  TestClient client = ConnectStaying();
  client.Send("hold\n");
  ASSERT_TRUE(Sees("request 501"));
  thread_.Call([this] { endpoint_.ReleaseOne("robot1" + std::string(kGoneText)); });
  Replace();
  EXPECT_EQ(client.Line(), "/next echo");
}

TEST_F(HandoverTest, OneThatHasSaidNothingYetStays) {
  TestClient client = Connect();
  ASSERT_TRUE(Sees("open"));
  Replace();
  client.Send("echo 1\n");
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
}

TEST_F(HandoverTest, OthersEndWithANotice) {
  TestClient client = Connect();
  client.Send("echo 1\n");
  client.Line();
  Replace();
  EXPECT_THAT(client.Rest(), HasSubstr("the module is closed"));
  EXPECT_EQ(next_->session_count(), 0U);
}

TEST_F(HandoverTest, WhoConnectsBetweenTwoModulesIsAccepted) {
  LoosePort port = Leave();
  TestClient client = TestClient::Connect(port.port);
  ASSERT_TRUE(client.ok());
  client.Send("echo 1\n");
  next_->Listen(std::move(port));
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
  EXPECT_GT(next_->port(), 0);
}

}  // namespace
}  // namespace coopdyn
