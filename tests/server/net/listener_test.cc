// SPDX-License-Identifier: MIT
#include "server/net/listener.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "server/base/clock.h"
#include "server/net/io_thread.h"
#include "test_client.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

class LocalListenerTest : public ::testing::Test {
 protected:
  ~LocalListenerTest() override {
    thread_.Call([this] { listener_.reset(); });
  }

  SteadyClock clock_;
  NetServices services_{NullLogger(), clock_};
  IoThread thread_{"listener", NullLogger()};
  std::string peer_;
  const std::string name_ = "coopdyn-listener-test-" + std::to_string(getpid());
  std::unique_ptr<Listener> listener_ =
      std::make_unique<Listener>(thread_.context(), services_, [this](UniqueFd fd, const PeerInfo& peer) {
        peer_ = peer.text + (peer.trusted ? " trusted" : "");
        EXPECT_EQ(::write(fd.get(), "hi\n", 3), 3);
      });
};

TEST_F(LocalListenerTest, AcceptsWithTheProcessOfThePeer) {
  ASSERT_EQ(listener_->ListenLocal(name_), "");
  TestClient client = TestClient::ConnectLocal(name_);
  EXPECT_EQ(client.Line(), "hi");
  EXPECT_EQ(client.Line(), "<end>");
  thread_.Call([this] { EXPECT_EQ(peer_, "unix:" + std::to_string(getpid()) + " trusted"); });
}

TEST_F(LocalListenerTest, WithATokenForAllNoPeerOfThisMachineIsTrusted) {
  NetServices wary(NullLogger(), clock_, StandardEncodings(), false, false);
  std::string peers;
  auto listener = std::make_unique<Listener>(
      thread_.context(), wary,
      [&peers](UniqueFd, const PeerInfo& peer) { peers += peer.trusted ? "+" : "-"; });
  ASSERT_EQ(listener->Listen({"127.0.0.1"}, 0), "");
  ASSERT_EQ(listener->ListenLocal(name_), "");
  EXPECT_EQ(TestClient::ConnectLocal(name_).Line(), "<end>");
  EXPECT_EQ(TestClient::Connect(listener->port()).Line(), "<end>");
  thread_.Call([&] {
    EXPECT_EQ(peers, "--");
    listener.reset();
  });
}

TEST_F(LocalListenerTest, ANameThatIsTakenIsSaidAndTcpListensOn) {
  Listener other(thread_.context(), services_, nullptr);
  ASSERT_EQ(other.ListenLocal(name_), "");
  ASSERT_EQ(listener_->Listen({"127.0.0.1"}, 0), "");
  EXPECT_THAT(listener_->ListenLocal(name_), HasSubstr("in use"));
  EXPECT_EQ(TestClient::Connect(listener_->port()).Line(), "hi");
  thread_.Stop();
}

TEST_F(LocalListenerTest, APortThatSomebodyListensOnIsNotFree) {
  ASSERT_EQ(listener_->Listen({"127.0.0.1"}, 0), "");
  EXPECT_FALSE(IsPortFree(listener_->port()));
}

TEST_F(LocalListenerTest, ANameThatIsTooLongIsRefused) {
  EXPECT_THAT(listener_->ListenLocal(std::string(200, 'x')), HasSubstr("too long"));
}

}  // namespace
}  // namespace coopdyn
