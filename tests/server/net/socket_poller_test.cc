// SPDX-License-Identifier: MIT
#include "server/net/socket_poller.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <functional>
#include <utility>

#include "test_client.h"

namespace coopdyn {
namespace {

/// One end of a socket pair, whose other end the test writes to.
class Told final : public SocketHandler {
 public:
  explicit Told(SocketPoller& poller) : poller_(poller) {
    auto [ours, theirs] = SocketPair();
    socket_ = std::move(ours);
    far_ = std::move(theirs);
  }

  bool Want(std::uint32_t events) {
    return poller_.Change(socket_.get(), *this, std::exchange(interest_, events), events);
  }
  void MakeReadable() { EXPECT_EQ(::send(far_.get(), "x", 1, 0), 1); }
  void EndFarSide() { far_.Reset(); }
  void OnReady(std::uint32_t events) override {
    ++times;
    last = events;
    if (then) then();
  }

  int times = 0;
  std::uint32_t last = 0;
  std::function<void()> then;

 private:
  SocketPoller& poller_;
  UniqueFd socket_, far_;
  std::uint32_t interest_ = 0;
};

class SocketPollerTest : public ::testing::Test {
 protected:
  boost::asio::io_context context_{1};
  SocketPoller& poller_ = SocketPoller::Of(context_);
  Told a_{poller_}, b_{poller_};
};

TEST_F(SocketPollerTest, TellsAgainUntilTheBytesAreRead) {
  ASSERT_TRUE(a_.Want(EPOLLIN));
  EXPECT_EQ(poller_.Poll(), 0u);
  a_.MakeReadable();
  EXPECT_EQ(poller_.Poll(), 1u);
  EXPECT_EQ(poller_.Poll(), 1u);
  EXPECT_EQ(a_.times, 2);
  EXPECT_EQ(a_.last, static_cast<std::uint32_t>(EPOLLIN));
}

TEST_F(SocketPollerTest, WhoWantsNothingIsNotEvenToldOfTheEnd) {
  ASSERT_TRUE(a_.Want(EPOLLIN));
  ASSERT_TRUE(a_.Want(0));
  a_.EndFarSide();
  EXPECT_EQ(poller_.Poll(), 0u);
  ASSERT_TRUE(a_.Want(EPOLLIN));
  EXPECT_EQ(poller_.Poll(), 1u);
}

TEST_F(SocketPollerTest, WhoIsDroppedWithinABatchIsNotTold) {
  ASSERT_TRUE(a_.Want(EPOLLIN));
  ASSERT_TRUE(b_.Want(EPOLLIN));
  a_.then = [this] { b_.Want(0); };
  b_.then = [this] { a_.Want(0); };
  a_.MakeReadable();
  b_.MakeReadable();
  poller_.Poll();
  EXPECT_EQ(a_.times + b_.times, 1);
}

TEST_F(SocketPollerTest, WritingIsToldOnlyToWhoWantsIt) {
  ASSERT_TRUE(a_.Want(EPOLLIN));
  EXPECT_EQ(poller_.Poll(), 0u);
  ASSERT_TRUE(a_.Want(EPOLLIN | EPOLLOUT));
  EXPECT_EQ(poller_.Poll(), 1u);
  EXPECT_EQ(a_.last, static_cast<std::uint32_t>(EPOLLOUT));
}

TEST_F(SocketPollerTest, ArmedItEndsTheWaitOfTheContext) {
  ASSERT_TRUE(a_.Want(EPOLLIN));
  poller_.Arm();
  EXPECT_EQ(context_.poll_one(), 0u);
  a_.MakeReadable();
  EXPECT_EQ(context_.run_one(), 1u);
  EXPECT_EQ(a_.times, 1);
}

TEST_F(SocketPollerTest, ADescriptorThatCannotBeWaitedForIsRefused) {
  UniqueFd closed(::dup(0));
  const int fd = closed.get();
  closed.Reset();
  EXPECT_FALSE(poller_.Change(fd, a_, 0, EPOLLIN));
}

}  // namespace
}  // namespace coopdyn
