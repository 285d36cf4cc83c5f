// SPDX-License-Identifier: MIT
#include "server/naming/name_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/naming/name_server.h"
#include "server/net/io_thread.h"
#include "test_client.h"

namespace coopdyn {
namespace {

/// Our own name server plays the external one: the protocol is the same.
class NameClientTest : public ::testing::Test {
 protected:
  ~NameClientTest() override {
    thread_.Call([this] { names_.reset(); });
  }

  SteadyClock clock_;
  NetServices services_{NullLogger(), clock_};
  NameTable table_;
  IoThread thread_{"names", NullLogger()};
  std::unique_ptr<NameServer> names_ = std::make_unique<NameServer>(thread_.context(), table_, services_);
};

TEST_F(NameClientTest, RegistersAndUnregistersAllAtItsEnd) {
  ASSERT_EQ(names_->Listen({"127.0.0.1"}, 0), "");
  names_->Serve();
  {
    NameClient client("127.0.0.1", names_->port(), NullLogger());
    for (int i = 1; i <= 10; ++i)
      client.Register("/r" + std::to_string(i) + "/motors", "192.0.2.7", 10'000 + i);
    EXPECT_TRUE(Eventually([&] { return client.pending() == 0; }));
    EXPECT_EQ(table_.List().size(), 10U);
    EXPECT_EQ(table_.Find("/r3/motors")->port, 10'003);
    EXPECT_EQ(table_.Find("/r3/motors")->ip, "192.0.2.7");
    client.Unregister("/r3/motors");
    EXPECT_TRUE(Eventually([&] { return client.pending() == 0; }));
    EXPECT_FALSE(table_.Find("/r3/motors"));
  }
  EXPECT_EQ(table_.List().size(), 0U);
}

TEST_F(NameClientTest, TriesAgainUntilTheServerIsThere) {
  const HeldPort held;
  const int port = held.port();
  NameClient client("127.0.0.1", port, NullLogger());
  client.Register("/robot1/motors", "", 10'002);
  EXPECT_EQ(client.pending(), 1U);
  ASSERT_EQ(names_->Listen({"127.0.0.1"}, port), "");
  names_->Serve();
  EXPECT_TRUE(Eventually([&] { return table_.Find("/robot1/motors").has_value(); }));
  EXPECT_EQ(table_.Find("/robot1/motors")->ip, "127.0.0.1");
}

TEST_F(NameClientTest, AServerThatWasStartedAgainGetsAllNamesAgain) {
  const HeldPort held;
  const int port = held.port();
  ASSERT_EQ(names_->Listen({"127.0.0.1"}, port), "");
  names_->Serve();
  NameClient client("127.0.0.1", port, NullLogger(), std::chrono::milliseconds(10));
  client.Register("/robot1/motors", "", 10'002);
  client.Register("/robot1/pose", "", 10'003);
  client.Register("/robot1/gone", "", 10'004);
  client.Unregister("/robot1/gone");
  EXPECT_TRUE(Eventually([&] { return table_.List().size() == 2 && client.pending() == 0; }));
  NameTable after;
  thread_.Call([&] { names_ = std::make_unique<NameServer>(thread_.context(), after, services_); });
  ASSERT_EQ(names_->Listen({"127.0.0.1"}, port), "");
  names_->Serve();
  EXPECT_TRUE(Eventually([&] { return after.List().size() == 2; }));
  EXPECT_EQ(after.Find("/robot1/pose")->port, 10'003);
  thread_.Call([this] { names_.reset(); });
}

TEST_F(NameClientTest, ItsEndDoesNotWaitForAServerThatIsAway) {
  NameClient client("127.0.0.1", 1, NullLogger());
  client.Register("/robot1/motors", "", 10'002);
  EXPECT_EQ(client.pending(), 1U);  // and the destructor returns: the time limit of the test checks it
}

TEST(ParseServer, ReadsHostAndPortAndSaysWhatToWrite) {
  std::string host;
  int port = 0;
  EXPECT_EQ(NameClient::ParseServer("lab:10100", host, port), "");
  EXPECT_EQ(host, "lab");
  EXPECT_EQ(port, 10'100);
  EXPECT_EQ(NameClient::ParseServer("lab", host, port), "");
  EXPECT_EQ(port, 10'000);
  EXPECT_EQ(NameClient::ParseServer("[::1]:7", host, port), "");
  EXPECT_EQ(host, "::1");
  EXPECT_EQ(port, 7);
  for (const char* wrong : {"", ":5", "lab:", "lab:x", "lab:99999", "::1", "[::1", "[::1]x"}) {
    EXPECT_NE(NameClient::ParseServer(wrong, host, port), "") << wrong;
  }
}

}  // namespace
}  // namespace coopdyn
