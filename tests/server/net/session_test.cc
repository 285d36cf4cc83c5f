// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "protocol/command_ids.h"
#include "server_fixture.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using SessionTest = ServerFixture;

TEST_F(SessionTest, AnswersLinesOfText) {
  TestClient client = Connect();
  client.Send("echo 0.5 2\r\n");
  EXPECT_EQ(client.Line(), "0 \"\" 500 0 3 0.5 0.25 7.0");
}

TEST_F(SessionTest, AnswersBinaryFrames) {
  TestClient client = Connect();
  client.Send("CDS1" + Frame(ScriptedEndpoint::kEcho, {3}));
  const Message reply = client.Frame();
  EXPECT_EQ(reply.command, ScriptedEndpoint::kEcho);
  EXPECT_THAT(reply.data, ElementsAre(3, 0.25, 7));
}

TEST_F(SessionTest, SaysNothingFirst) {
  TestClient client = Connect();
  ASSERT_TRUE(Sees("open"));
  client.EndInput();
  EXPECT_EQ(client.Rest(), "");
}

TEST_F(SessionTest, NamesThePeerAndTrustsLoopback) {
  TestClient client = Connect();
  ASSERT_TRUE(Sees("open"));
  EXPECT_EQ(endpoint_.events().front(), "open " + client.address() + " trusted");
}

TEST_F(SessionTest, ReadsMessagesThatComeByteByByte) {
  const auto trickle = [](TestClient& client, const std::string& bytes) {
    for (const char byte : bytes) ASSERT_TRUE(client.Send({&byte, 1}));
  };
  TestClient text = Connect();
  trickle(text, "echo 4\n");
  EXPECT_EQ(text.Line(), "0 \"\" 500 0 3 4.0 0.25 7.0");
  TestClient binary = Connect();
  trickle(binary, "CDS1" + Frame(ScriptedEndpoint::kEcho, {4}));
  EXPECT_THAT(binary.Frame().data, ElementsAre(4, 0.25, 7));
}

TEST_F(SessionTest, HandsOverTheNextRequestOnlyAfterTheReply) {
  TestClient client = Connect();
  client.Send("hold 1\nhold 2\necho 3\n");
  ASSERT_TRUE(Sees("request 501 1"));
  EXPECT_EQ(endpoint_.Count("request"), 1);
  Release();
  EXPECT_THAT(client.Line(), HasSubstr("501 0 3 1.0"));
  ASSERT_TRUE(Sees("request 501 2"));
  EXPECT_EQ(endpoint_.Count("request 500"), 0);
  Release();
  EXPECT_THAT(client.Line(), HasSubstr("501 0 3 2.0"));
  EXPECT_THAT(client.Line(), HasSubstr("500 0 3 3.0"));
}

TEST_F(SessionTest, AnswersThousandsOfPipelinedRequestsInOrder) {
  constexpr int kCount = 20'000;
  TestClient client = Connect();
  std::string bytes = "CDS1";
  for (int i = 0; i < kCount; ++i) bytes += Frame(ScriptedEndpoint::kEcho, {static_cast<double>(i)});
  std::jthread writer([&] { client.Send(bytes); });
  for (int i = 0; i < kCount; ++i) ASSERT_EQ(client.Frame().data.at(0), i);
}

TEST_F(SessionTest, TellsAtOnceThatInputEndedThenExecutesWhatCameAndCloses) {
  TestClient client = Connect();
  client.Send("hold 1\necho 2\n");
  client.EndInput();
  ASSERT_TRUE(Sees("input ended"));
  EXPECT_EQ(endpoint_.Count("request 500"), 0);
  EXPECT_EQ(endpoint_.Count("closed"), 0);
  Release();
  EXPECT_EQ(client.Rest(), "0 \"\" 501 0 3 1.0 0.25 7.0\n0 \"\" 500 0 3 2.0 0.25 7.0\n");
  EXPECT_TRUE(Sees("closed"));
  EXPECT_TRUE(NoSessions());
}

TEST_F(SessionTest, DoesNotExecuteALineThatWasCutOffAndSaysSo) {
  TestClient client = Connect();
  client.Send("echo 1\necho 2");
  client.EndInput();
  const std::string said = client.Rest(), echoed = "0 \"\" 500 0 3 1.0 0.25 7.0\n";
  EXPECT_TRUE(said.starts_with(echoed + "7 \"the connection ended in the middle of a message")) << said;
  EXPECT_EQ(std::ranges::count(said, '\n'), 2);
  EXPECT_TRUE(NoSessions());
}

TEST_F(SessionTest, AnswersAllThatCameBeforeTheEndThoughThePeerReadsLate) {
  TestClient client = ConnectPair();
  client.Send("big 3000000\necho 2\necho 3\n");  // the first reply does not fit into the socket
  client.EndInput();
  ASSERT_TRUE(Sees("input ended"));
  const std::string said = client.Rest();
  EXPECT_TRUE(said.ends_with("0 \"\" 500 0 3 2.0 0.25 7.0\n0 \"\" 500 0 3 3.0 0.25 7.0\n")) << said.size();
}

TEST_F(SessionTest, NoticesAKilledPeerWhileItsRequestWaits) {
  TestClient client = Connect();
  client.Send("hold 1\n");
  ASSERT_TRUE(Sees("request 501 1"));
  client.Reset();
  ASSERT_TRUE(Sees("input ended"));
  EXPECT_EQ(endpoint_.Count("closed"), 0);
  Release();
  EXPECT_TRUE(Sees("closed"));
  EXPECT_TRUE(NoSessions());
}

TEST_F(SessionTest, NoticesAKilledPeerThoughItIsFarAhead) {
  TestClient client = ConnectPair();
  client.Send("hold 1\n");
  ASSERT_TRUE(Sees("request 501 1"));
  const std::string comments(std::size_t{1} << 16, '#');
  int stuck = 0;  // until the server stops reading
  while (stuck < 200) {
    stuck = client.SendSome(comments) == 0 ? stuck + 1 : 0;
    if (stuck > 0) ::poll(nullptr, 0, 1);
  }
  client.Close();
  EXPECT_TRUE(Sees("input ended"));
}

TEST_F(SessionTest, ExecutesCompleteRequestsOfADeadPeer) {
  TestClient client = Connect();
  client.Send("hold 1\necho 2\n");
  ASSERT_TRUE(Sees("request 501 1"));
  client.Reset();
  ASSERT_TRUE(Sees("input ended"));
  Release();
  EXPECT_TRUE(Sees("request 500 2"));
  EXPECT_TRUE(Sees("closed"));
}

TEST_F(SessionTest, RequestsOfAPeerThatIsGoneSaySo) {
  TestClient client = ConnectPair();
  client.Send("hold 1\necho 2\necho 3\n");
  ASSERT_TRUE(Sees("request 501 1"));
  client.Close();
  ASSERT_TRUE(Sees("input ended"));
  Release();
  EXPECT_TRUE(Sees("request 500 3 of the deaf"));
  EXPECT_EQ(endpoint_.Count("request 501 1 of the deaf"), 0);
}

/// Each request takes 1 ms of the test's clock.
class SlowEndpoint : public ScriptedEndpoint {
 public:
  explicit SlowEndpoint(ManualClock& clock) : clock_(clock) {}
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override {
    clock_.Advance(1'000'000);
    ScriptedEndpoint::OnRequest(connection, std::move(request), std::move(reply));
  }

 private:
  ManualClock& clock_;
};

TEST(SessionTurn, EndsWithTheFirstRequestThatTakesLongThoughThousandsAreQueued) {
  ManualClock clock;
  NetServices services(NullLogger(), clock);
  SlowEndpoint endpoint(clock);
  IoThread thread("test-io", NullLogger());
  auto server = std::make_unique<ModuleServer>(thread, endpoint, services, "/test");
  auto [greedy, greedy_end] = SocketPair();
  auto [modest, modest_end] = SocketPair();
  std::string many;
  for (int i = 0; i < 200; ++i) many += "echo 1\n";
  thread.Call([&, greedy_fd = greedy_end.Release(), modest_fd = modest_end.Release()] {
    server->Adopt(greedy_fd, many, {"greedy", true});
    server->Adopt(modest_fd, "echo 2\n", {"modest", true});
  });
  EXPECT_THAT(TestClient(std::move(modest)).Line(), HasSubstr("500 0 3 2.0"));
  ASSERT_TRUE(Eventually([&] { return endpoint.Count("request 500 1") == 200; }));
  const std::vector<std::string> events = endpoint.events();
  const auto modest_turn = std::find(events.begin(), events.end(), "request 500 2");
  EXPECT_EQ(std::count(events.begin(), modest_turn, "request 500 1"), 1);
  thread.Call([&] { server.reset(); });
}

TEST_F(SessionTest, AReaderThatNeverReadsGetsNoMoreRequestsExecutedAndHoldsNobodyElseUp) {
  TestClient deaf = ConnectPair();
  const std::string request = Frame(ScriptedEndpoint::kBig, {10'000});
  std::string bytes = "CDS1";
  for (int i = 0; i < 200; ++i) bytes += request;
  ASSERT_TRUE(deaf.Send(bytes));
  ASSERT_TRUE(Sees("request 503"));
  TestClient other = Connect();
  other.Send("echo 1\n");
  EXPECT_THAT(other.Line(), HasSubstr(" 500 "));
  EXPECT_LT(endpoint_.Count("request 503"), 200);
  for (int i = 0; i < 200; ++i) ASSERT_EQ(deaf.Frame().data.size(), 10'000U) << i;  // nothing is lost
}

TEST_F(SessionTest, PushesPrecedeTheReplyAndAreNotDroppedForAReaderThatReads) {
  TestClient client = Connect();
  client.Send("pushes 3\n");
  for (const char* value : {"1.0", "2.0", "3.0"}) {
    EXPECT_EQ(client.Line(), std::string("0 \"\" -500 0 3 ") + value + " 0.25 7.0");
  }
  EXPECT_THAT(client.Line(), HasSubstr(" 505 "));
}

TEST_F(SessionTest, DropsTheOldestPushesOfAReaderThatDoesNotReadAndSaysHowMany) {
  constexpr int kPushes = 100'000;
  TestClient client = ConnectPair();
  client.Send("CDS1" + Frame(ScriptedEndpoint::kEcho));
  client.Frame();
  thread_.Call([&] {
    Connection* connection = endpoint_.connections().begin()->second;
    for (int i = 1; i <= kPushes; ++i) connection->Push(ScriptedEndpoint::PushOf(i), 0);
  });
  int expected = 1;
  int noted = 0;
  int after_gap = 0;
  while (expected <= kPushes) {
    const Message push = client.Frame();
    ASSERT_EQ(push.command, -ScriptedEndpoint::kEcho);
    if (!push.text.empty()) {
      ASSERT_THAT(push.text, StartsWith("dropped "));
      noted += std::stoi(push.text.substr(8));
      expected += std::stoi(push.text.substr(8));
    }
    if (noted > 0) ++after_gap;
    ASSERT_EQ(push.data.at(0), expected++);
  }
  EXPECT_GT(noted, 0);
  EXPECT_EQ(after_gap, 64);
}

TEST_F(SessionTest, TheKernelKeepsLittleForAReaderThatDoesNotRead) {
  constexpr int kPushes = 20'000;
  TestClient client = Connect();
  client.Send("CDS1" + Frame(ScriptedEndpoint::kEcho));
  client.Frame();
  thread_.Call([&] {
    Connection* connection = endpoint_.connections().begin()->second;
    for (int i = 1; i <= kPushes; ++i) connection->Push(ScriptedEndpoint::PushOf(i), 0);
  });
  int sent = 0;
  while (sent < kPushes && client.Frame().text.empty()) ++sent;
  EXPECT_LT(sent, kPushes / 4);
}

TEST_F(SessionTest, HttpGets400AndIsClosed) {
  TestClient client = Connect();
  client.Send("POST /x HTTP/1.1\r\nHost: localhost:10002\r\nContent-Length: 7\r\n\r\necho 1\n");
  const std::string answer = client.Rest();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 400 "));
  EXPECT_EQ(endpoint_.Count("request"), 0);
  EXPECT_TRUE(Sees("closed"));
}

TEST_F(SessionTest, AnotherMagicGetsALineThatSaysWhatToSend) {
  TestClient client = Connect();
  client.Send("CDS2xxxx");
  const std::string answer = client.Rest();
  EXPECT_THAT(answer, HasSubstr("CDS1"));
  EXPECT_EQ(answer.find('\n'), answer.size() - 1);
}

TEST_F(SessionTest, TwentyMalformedMessagesInARowCloseIt) {
  TestClient client = Connect();
  std::string lines;
  for (int i = 0; i < 20; ++i) lines += "!?\n";
  client.Send(lines + "echo 1\n");
  for (int i = 0; i < 20; ++i) EXPECT_THAT(client.Line(), StartsWith("7 "));
  EXPECT_THAT(client.Line(), HasSubstr("20 malformed messages"));
  EXPECT_EQ(client.Line(), "<end>");
  EXPECT_TRUE(Sees("closed"));
  EXPECT_EQ(endpoint_.Count("request"), 0);
}

TEST_F(SessionTest, AGoodMessageForgivesTheMalformedOnesBefore) {
  TestClient client = Connect();
  std::string lines;
  for (int i = 0; i < 19; ++i) lines += "!?\n";
  client.Send(lines + "echo 1\n" + lines + "echo 2\n");
  client.EndInput();
  EXPECT_THAT(client.Rest(), HasSubstr("500 0 3 2.0"));
}

TEST_F(SessionTest, AFrameThatDoesNotAddUpGetsError7AndANoticeAndIsClosed) {
  TestClient client = Connect();
  client.Send(std::string("CDS1\x08\0\0\0", 8) + std::string(8, 'x'));
  const Message reply = client.Frame();
  EXPECT_EQ(reply.error, 7);
  EXPECT_EQ(reply.command, command::kUnreadable);
  EXPECT_EQ(client.Frame().command, command::kClosing);
  EXPECT_EQ(client.Rest(), "");
}

TEST_F(SessionTest, ATooLargeRequestGetsError8AndIsClosed) {
  TestClient binary = Connect();
  std::string head("CDS1", 4);
  const std::uint32_t size = 2U << 20;
  head.append(reinterpret_cast<const char*>(&size), 4);
  binary.Send(head + std::string(16, '\0'));
  EXPECT_EQ(binary.Frame().error, 8);
  TestClient text = Connect();
  text.Send("echo " + std::string(kMaxRequestBytes + 10, '1'));
  EXPECT_THAT(text.Line(), StartsWith("8 "));
  EXPECT_TRUE(Sees("closed", 2));
}

TEST_F(SessionTest, AScenarioTextOfSeveralMegabytesIsRead) {
  Message request;
  request.command = command::kLoadScenario;
  request.text.assign(std::size_t{3} << 20, 'x');
  std::string bytes = "CDS1";
  EncodeBinary(request, bytes);
  TestClient client = Connect();
  std::jthread writer([&] { client.Send(bytes); });
  EXPECT_EQ(client.Frame().text, request.text);
}

TEST_F(SessionTest, AReplyThatIsTooLargeBecomesError8AndTheConnectionGoesOn) {
  TestClient client = Connect();
  client.Send("CDS1" + Frame(ScriptedEndpoint::kBig, {9.0 * (1 << 20)}) +
              Frame(ScriptedEndpoint::kEcho, {1}));
  const Message reply = client.Frame();
  EXPECT_EQ(reply.error, 8);
  EXPECT_EQ(reply.command, ScriptedEndpoint::kBig);
  EXPECT_EQ(client.Frame().error, 0);
}

TEST_F(SessionTest, AnExceptionOfTheEndpointBecomesError9AndTheConnectionGoesOn) {
  TestClient client = Connect();
  client.Send("throw\necho 1\n");
  EXPECT_THAT(client.Line(), StartsWith("9 \"internal error"));
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
}

TEST_F(SessionTest, ASecondReplyIsIgnored) {
  TestClient client = Connect();
  client.Send("twice\necho 1\n");
  EXPECT_THAT(client.Line(), HasSubstr(" 504 "));
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
}

TEST_F(SessionTest, CloseSendsANoticeInTheClientsEncodingAndDropsWhatWaits) {
  TestClient binary = Connect();
  binary.Send("CDS1" + Frame(ScriptedEndpoint::kHold));
  TestClient text = Connect();
  text.Send("hold\n");
  TestClient silent = Connect();
  ASSERT_TRUE(Sees("request 501", 2));
  ASSERT_TRUE(Sees("open", 3));
  TestClient taker = Connect();
  taker.Send("drop\n");
  const Message notice = binary.Frame();
  EXPECT_EQ(notice.command, command::kClosing);
  EXPECT_EQ(notice.text, "taken over");
  EXPECT_EQ(binary.Rest(), "");
  EXPECT_EQ(text.Rest(), "0 \"taken over\" -1 0 0\n");
  EXPECT_EQ(silent.Rest(), "# taken over\n");
  EXPECT_TRUE(Sees("closed", 3));
  EXPECT_THAT(taker.Line(), HasSubstr(" 506 "));
  Release();  // a late reply is dropped
  taker.Send("echo 1\n");
  EXPECT_THAT(taker.Line(), HasSubstr(" 500 "));
}

TEST_F(SessionTest, TheNoticeArrivesThoughTheServerHasNotReadEverything) {
  TestClient client = Connect();
  client.Send("hold 1\n");
  ASSERT_TRUE(Sees("request 501"));
  client.Send(std::string(200'000, '#') + "\n");
  TestClient taker = Connect();
  taker.Send("drop\n");
  EXPECT_EQ(client.Rest(), "0 \"taken over\" -1 0 0\n");
}

TEST_F(SessionTest, AClosingConnectionIsGivenUpThoughItsPeerNeitherReadsNorCloses) {
  TestClient client = ConnectPair();
  client.Send("CDS1" + Frame(ScriptedEndpoint::kBig, {1'000'000}));
  ASSERT_TRUE(Sees("request 503"));
  thread_.Call([this] { server_->CloseAll("taken over"); });
  EXPECT_TRUE(Sees("closed"));  // immediately; the socket follows after Session::kLinger
  EXPECT_TRUE(NoSessions());
}

TEST_F(SessionTest, HelpAndAFirstEmptyLinePrintComments) {
  for (const char* line : {"help\n", "\r\n"}) {
    TestClient client = Connect();
    client.Send(line);
    client.EndInput();
    const std::string help = client.Rest();
    EXPECT_THAT(help, HasSubstr("echo"));
    EXPECT_EQ(help[0], '#');
  }
  EXPECT_EQ(endpoint_.Count("request"), 0);
}

TEST_F(SessionTest, VerboseExplainsEachReplyAndSaysWhomAWaitingRequestWaitsFor) {
  TestClient client = Connect();
  client.Send("verbose\necho 2\nhold 3\n");
  EXPECT_THAT(client.Line(), StartsWith("# "));
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
  EXPECT_THAT(client.Line(), StartsWith("# echo: first"));
  EXPECT_EQ(client.Line(), "# waiting for robot2 (no client), 1.2 s");
  Release();
  EXPECT_THAT(client.Line(), HasSubstr(" 501 "));
}

TEST_F(SessionTest, AdoptedConnectionsBeginWithWhatWasReadBefore) {
  TestClient client = ConnectPair("echo 1\nech");
  client.Send("o 2\n");
  EXPECT_THAT(client.Line(), HasSubstr("500 0 3 1.0"));
  EXPECT_THAT(client.Line(), HasSubstr("500 0 3 2.0"));
  EXPECT_EQ(endpoint_.events().front(), "open pair trusted");
}

TEST_F(SessionTest, TheServersEndIsANoticeAndAClosedCallForEveryConnection) {
  TestClient text = Connect();
  text.Send("hold 1\n");
  TestClient other = ConnectPair("CDS1" + Frame(ScriptedEndpoint::kHold, {2}));
  ASSERT_TRUE(Sees("request 501", 2));
  thread_.Call([this] { server_->CloseAll("the daemon stops"); });
  thread_.Call([this] { server_.reset(); });
  EXPECT_EQ(endpoint_.Count("closed"), 2);
  EXPECT_EQ(text.Rest(), "0 \"the daemon stops\" -1 0 0\n");
  EXPECT_EQ(other.Frame().text, "the daemon stops");
}

}  // namespace
}  // namespace coopdyn
