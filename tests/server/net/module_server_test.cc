// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <sstream>

#include "server/net/listener.h"
#include "server_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

using ModuleServerTest = ServerFixture;

TEST_F(ModuleServerTest, ABusyPortIsNamedWithItsHolder) {
  thread_.Stop();  // servers may then be destroyed here
  ModuleServer second(thread_, endpoint_, services_, "/second");
  const std::string error = second.Listen({"127.0.0.1"}, server_->port());
  EXPECT_THAT(error,
              HasSubstr("port " + std::to_string(server_->port()) + " of 127.0.0.1 is in use by net_test"));
  EXPECT_THAT(error, HasSubstr("pid " + std::to_string(::getpid())));
  EXPECT_EQ(second.port(), 0);
}

TEST_F(ModuleServerTest, LoopbackListensOnBothAddressesWithOnePort) {
  ModuleServer both(thread_, endpoint_, services_, "/both");
  ASSERT_EQ(both.Listen(ListenAddresses("localhost"), 0), "");
  TestClient v4 = TestClient::Connect(both.port(), "127.0.0.1");
  v4.Send("echo 1\n");
  EXPECT_THAT(v4.Line(), HasSubstr(" 500 "));
  TestClient v6 = TestClient::Connect(both.port(), "::1");
  if (v6.ok()) {  // a machine without IPv6 is fine
    v6.Send("echo 1\n");
    EXPECT_THAT(v6.Line(), HasSubstr(" 500 "));
    EXPECT_EQ(endpoint_.Count("open [::1]:"), 1);
  }
  v4.Close();
  v6.Close();
  thread_.Stop();  // it may then be destroyed here
}

TEST_F(ModuleServerTest, ItsPortIsFreeAgainAtItsEnd) {
  const int port = server_->port();
  thread_.Call([this] { server_.reset(); });
  EXPECT_FALSE(TestClient::Connect(port).ok());
  server_ = std::make_unique<ModuleServer>(thread_, endpoint_, services_, "/again");
  EXPECT_EQ(server_->Listen({"127.0.0.1"}, port), "");
}

TEST_F(ModuleServerTest, AnAddressThatIsNotOursIsAnErrorThatNamesIt) {
  thread_.Stop();
  ModuleServer wrong(thread_, endpoint_, services_, "/wrong");
  EXPECT_THAT(wrong.Listen({"192.0.2.7"}, 0), HasSubstr("192.0.2.7"));
  EXPECT_THAT(wrong.Listen({"127.0.0.1"}, 70'000), HasSubstr("65535"));
}

TEST_F(ModuleServerTest, FiveHundredConnectionsLeaveNoDescriptor) {
  {
    TestClient first = Connect();
    first.Send("echo 1\n");
    first.Line();
  }
  ASSERT_TRUE(NoSessions());
  const int before = OpenDescriptors();
  for (int i = 0; i < 500; ++i) {
    TestClient client = Connect();
    if (i % 5 == 0) client.Send("hold\n");
    if (i % 5 == 1) client.Send("echo 1\n");
    if (i % 5 == 2) client.Send("GET / HTTP/1.1\r\n\r\n");
    if (i % 5 == 3) client.Send("CDS1\1\0");
    if (i % 7 == 0) client.Reset();
  }
  EXPECT_TRUE(Eventually([this] {
    thread_.Call([this] {
      while (endpoint_.held() > 0) endpoint_.ReleaseOne();
    });
    return server_->session_count() == 0;
  }));
  EXPECT_EQ(OpenDescriptors(), before);
}

TEST_F(ModuleServerTest, TwoHundredIdleConnectionsHoldNobodyUp) {
  std::vector<TestClient> idle;
  for (int i = 0; i < 200; ++i) idle.push_back(Connect());
  TestClient client = Connect();
  client.Send("echo 1\n");
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
  EXPECT_TRUE(Eventually([this] { return server_->session_count() == 201; }));
}

TEST_F(ModuleServerTest, RunningOutOfDescriptorsIsSurvived) {
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &old), 0);
  TestClient served = Connect();
  served.Send("echo 1\n");
  ASSERT_THAT(served.Line(), HasSubstr(" 500 "));
  // Clients up to the limit: each needs two descriptors, so the last ones cannot be accepted.
  rlimit low = old;
  low.rlim_cur = static_cast<rlim_t>(OpenDescriptors() + 20);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
  std::vector<TestClient> clients;
  for (int i = 0; i < 40; ++i) {
    TestClient client = Connect();
    if (!client.ok()) break;
    clients.push_back(std::move(client));
  }
  ASSERT_GT(clients.size(), 5U);
  served.Send("echo 2\n");
  EXPECT_THAT(served.Line(), HasSubstr(" 500 "));
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &old), 0);
  for (TestClient& client : clients) {
    client.Send("echo 3\n");
    EXPECT_THAT(client.Line(), HasSubstr("500 0 3 3.0"));
  }
}

TEST(NetServicesTest, ExhaustionIsLoggedOnceUntilItHasBeenOverForAMinute) {
  ManualClock clock;
  std::ostringstream log;
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(log);
  NetServices services(std::make_shared<spdlog::logger>("test", sink), clock);
  const auto lines = [&log] {
    const std::string text = log.str();
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int i = 0; i < 200; ++i) {  // for more than a minute
    services.LogExhausted("cannot accept connections for now");
    clock.Advance(kNanosecondsPerSecond);
  }
  EXPECT_EQ(lines(), 1);
  clock.Advance(59 * kNanosecondsPerSecond);
  services.LogExhausted("cannot accept connections for now");
  EXPECT_EQ(lines(), 2);
  EXPECT_THAT(log.str(), HasSubstr("raise `ulimit -n`"));
}

TEST_F(ModuleServerTest, AnAdopterThatOutlivesTheServerClosesTheConnection) {
  const AdoptFunction adopter = server_->adopter();
  thread_.Call([this] { server_.reset(); });
  auto [ours, theirs] = SocketPair();
  adopter(theirs.Release(), "echo 1\n", {"pair", true}, nullptr);
  TestClient client(std::move(ours));
  EXPECT_EQ(client.Rest(), "");
}

TEST_F(ModuleServerTest, ADescriptorThatIsNoSocketIsClosedAndHarmsNobody) {
  const int before = OpenDescriptors();
  const int fd = ::dup(STDERR_FILENO);
  server_->Adopt(fd, "echo 1\n", {"wrong", true});
  TestClient client = Connect();
  client.Send("echo 1\n");
  EXPECT_THAT(client.Line(), HasSubstr(" 500 "));
  client.Close();
  EXPECT_TRUE(NoSessions());
  EXPECT_TRUE(Eventually([&] { return OpenDescriptors() == before; }));
}

TEST(PortHolder, IsEmptyForAPortNobodyHas) {
  EXPECT_EQ(PortHolder(1), "");
}

TEST(ListenAddresses, KnowsTheWordsForLoopbackAndForAll) {
  EXPECT_EQ(ListenAddresses(""), ListenAddresses("localhost"));
  EXPECT_EQ(ListenAddresses("127.0.0.1").size(), 2U);
  EXPECT_EQ(ListenAddresses("any"), ListenAddresses("0.0.0.0"));
  EXPECT_EQ(ListenAddresses("10.1.2.3"), std::vector<std::string>{"10.1.2.3"});
}

}  // namespace
}  // namespace coopdyn
