// SPDX-License-Identifier: MIT
#include "server/naming/name_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "protocol/codec.h"
#include "scripted_endpoint.h"
#include "server/net/io_thread.h"
#include "server/net/module_server.h"
#include "test_client.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class NameServerTest : public ::testing::Test {
 protected:
  NameServerTest() {
    EXPECT_EQ(names_->Listen({"127.0.0.1"}, 0), "");
    names_->Serve();
    table_.AddOwn("/robot1/motors", 0, module_->adopter());
  }
  ~NameServerTest() override {
    names_thread_.Call([this] { names_.reset(); });
    module_thread_.Call([this] { module_.reset(); });
  }
  TestClient Connect() { return TestClient::Connect(names_->port()); }
  TestClient ConnectLocal() { return TestClient::ConnectLocal(NameServer::LocalName(names_->port())); }
  /// `open` and a binary request directly after it; the module answers the request.
  static void ExpectEcho(TestClient client, const std::string& open) {
    Message request;
    request.command = ScriptedEndpoint::kEcho;
    request.data = {5};
    std::string bytes = open + "CDS1";
    EncodeBinary(request, bytes);
    client.Send(bytes);
    client.EndInput();
    EXPECT_EQ(client.Line(), "ok");
    EXPECT_EQ(client.Frame().data.at(0), 5);
    EXPECT_EQ(client.Rest(), "");
  }

  SteadyClock clock_;
  NetServices services_{NullLogger(), clock_};
  ScriptedEndpoint endpoint_;
  NameTable table_;
  IoThread module_thread_{"module", NullLogger()};
  IoThread names_thread_{"names", NullLogger()};
  std::unique_ptr<ModuleServer> module_ =
      std::make_unique<ModuleServer>(module_thread_, endpoint_, services_, "/robot1/motors");
  std::unique_ptr<NameServer> names_ =
      std::make_unique<NameServer>(names_thread_.context(), table_, services_);
};

TEST_F(NameServerTest, AnswersSeveralRequestsOnOneConnection) {
  TestClient client = Connect();
  for (int i = 0; i < 3; ++i) {
    client.Send("NAME_SERVER query /robot1/motors\n");
    EXPECT_EQ(client.Line(), "registration name /robot1/motors ip 127.0.0.1 port 0 type tcp\r");
    EXPECT_EQ(client.Line(), "*** end of message\r");
  }
}

TEST_F(NameServerTest, WhoAsksBeforeItServesIsAnsweredWhenItDoes) {
  auto starting = std::make_unique<NameServer>(names_thread_.context(), table_, services_);
  ASSERT_EQ(starting->Listen({"127.0.0.1"}, 0), "");
  TestClient client = TestClient::Connect(starting->port());
  client.Send("NAME_SERVER query /late\n");
  EXPECT_TRUE(Eventually([&] { return starting->session_count() == 1; }));
  table_.AddOwn("/late", 0, module_->adopter());
  starting->Serve();
  EXPECT_EQ(client.Line(), "registration name /late ip 127.0.0.1 port 0 type tcp\r");
  names_thread_.Call([&] { starting.reset(); });
}

TEST_F(NameServerTest, OpenTurnsTheConnectionIntoTheModules) {
  TestClient client = Connect();
  client.Send("list\nOPEN /robot1/motors\n");
  EXPECT_THAT(client.Line(), StartsWith("registration"));
  EXPECT_THAT(client.Line(), StartsWith("***"));
  EXPECT_EQ(client.Line(), "ok");
  client.Send("echo 1\n");
  EXPECT_THAT(client.Line(), HasSubstr(" 500 0 3 1.0"));
  EXPECT_TRUE(Eventually([this] { return names_->session_count() == 0; }));
  EXPECT_EQ(module_->session_count(), 1U);
  EXPECT_EQ(endpoint_.events().front(), "open " + client.address() + " trusted");
}

TEST_F(NameServerTest, WhatFollowsOpenAtOnceReachesTheModule) {
  ExpectEcho(Connect(), "OPEN /robot1/motors\r\n");
}

TEST_F(NameServerTest, TheUnixSocketAnswersAsLoopbackDoes) {
  TestClient client = ConnectLocal();
  client.Send("NAME_SERVER query /robot1/motors\nNAME_SERVER register /mine tcp ... 4711\n");
  EXPECT_EQ(client.Line(), "registration name /robot1/motors ip 127.0.0.1 port 0 type tcp\r");
  EXPECT_EQ(client.Line(), "*** end of message\r");
  EXPECT_EQ(client.Line(), "registration name /mine ip 127.0.0.1 port 4711 type tcp\r");
}

TEST_F(NameServerTest, OpenTurnsAUnixConnectionIntoATrustedOneOfTheModule) {
  ExpectEcho(ConnectLocal(), "OPEN /robot1/motors\n");
  EXPECT_EQ(endpoint_.events().front(), "open unix:" + std::to_string(getpid()) + " trusted");
  EXPECT_TRUE(Eventually([this] { return names_->session_count() == 0 && module_->session_count() == 0; }));
}

TEST_F(NameServerTest, OnlyAServerOfLoopbackAloneHasAUnixSocket) {
  EXPECT_TRUE(ConnectLocal().ok());
  NameServer wide(names_thread_.context(), table_, services_);
  ASSERT_EQ(wide.Listen({"127.0.0.1", "127.0.0.2"}, 0), "");
  wide.Serve();
  EXPECT_TRUE(TestClient::Connect(wide.port(), "127.0.0.2").ok());
  EXPECT_FALSE(TestClient::ConnectLocal(NameServer::LocalName(wide.port())).ok());
  names_thread_.Stop();
}

TEST_F(NameServerTest, TheUnixSocketGoesWithTheServer) {
  const std::string name = NameServer::LocalName(names_->port());
  names_thread_.Call([this] { names_.reset(); });
  EXPECT_TRUE(Eventually([&name] { return !TestClient::ConnectLocal(name).ok(); }));
}

TEST_F(NameServerTest, AnUnknownModuleIsSaidAndTheConnectionGoesOn) {
  TestClient client = Connect();
  client.Send("OPEN /robot1/motor\n");
  EXPECT_EQ(client.Line(), "error 10 no such name /robot1/motor; did you mean /robot1/motors?");
  client.Send("OPEN /robot1/motors\n");
  EXPECT_EQ(client.Line(), "ok");
}

TEST_F(NameServerTest, OpenOfAModuleThatIsJustGoneClosesTheConnection) {
  module_thread_.Call([this] { module_.reset(); });
  TestClient client = Connect();
  client.Send("OPEN /robot1/motors\n");
  EXPECT_EQ(client.Line(), "ok");
  EXPECT_EQ(client.Line(), "<end>");
}

TEST_F(NameServerTest, MagicHttpAndEndlessLinesGetOneAnswerAndAreClosed) {
  TestClient magic = Connect();
  magic.Send("CDS1\x14");
  EXPECT_THAT(magic.Rest(), StartsWith("error 7 this is the port of names: send OPEN /robot1/motors"));
  TestClient http = Connect();
  http.Send("POST /x HTTP/1.1\r\nHost: a\r\n\r\nNAME_SERVER register /evil\n");
  EXPECT_THAT(http.Rest(), StartsWith("HTTP/1.1 400 "));
  TestClient endless = Connect();
  endless.Send(std::string(10'000, 'x'));
  EXPECT_THAT(endless.Rest(), StartsWith("error 8 "));
  TestClient long_line = Connect();
  long_line.Send("register /" + std::string(5'000, 'x') + "\n");
  EXPECT_THAT(long_line.Rest(), StartsWith("error 8 "));
  EXPECT_EQ(table_.List().size(), 1U);
}

TEST_F(NameServerTest, ATrickledRequestIsAnswered) {
  TestClient client = Connect();
  for (const char byte : std::string("query robot1/motors\n")) ASSERT_TRUE(client.Send({&byte, 1}));
  EXPECT_THAT(client.Line(), StartsWith("registration name /robot1/motors"));
}

TEST_F(NameServerTest, ConnectAndCloseIsHarmlessAndTwoHundredIdleOnesToo) {
  const int before = OpenDescriptors();
  {
    std::vector<TestClient> idle;
    for (int i = 0; i < 200; ++i) idle.push_back(Connect());
    TestClient client = Connect();
    client.Send("list\n");
    EXPECT_THAT(client.Line(), StartsWith("registration"));
  }
  EXPECT_TRUE(Eventually([this] { return names_->session_count() == 0; }));
  EXPECT_EQ(OpenDescriptors(), before);
}

TEST_F(NameServerTest, AReaderThatNeverReadsCostsBoundedMemoryAndHoldsNobodyUp) {
  TestClient deaf = Connect();
  std::string lists;
  for (int i = 0; i < 1'000; ++i) lists += "list\n";
  for (int i = 0; i < 200 && deaf.SendSome(lists) > 0; ++i) {
  }
  TestClient client = Connect();
  client.Send("list\n");
  EXPECT_THAT(client.Line(), StartsWith("registration"));
}

}  // namespace
}  // namespace coopdyn
