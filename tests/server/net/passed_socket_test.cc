// SPDX-License-Identifier: MIT
#include "server/net/passed_socket.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <future>
#include <random>

#include <boost/asio/io_context.hpp>

#include "server/base/log.h"
#include "server/net/io_thread.h"

namespace coopdyn {
namespace {

std::string DoorPath() {
  return testing::TempDir() + "door" + std::to_string(::getpid());
}

std::pair<UniqueFd, UniqueFd> Pair() {
  std::array<int, 2> ends{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  return {UniqueFd(ends[0]), UniqueFd(ends[1])};
}

TEST(PassedSocket, SaysWhoCallsAndWhatWasRead) {
  PassedSocket passed{.kind = PassedKind::kPage, .already_read = "GET / HTTP/1.1\r\n\n\0x"};
  passed.peer = {.text = "10.0.0.7:1234", .trusted = true, .yields = true};
  const auto read = DecodePassed(EncodePassed(passed));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->kind, PassedKind::kPage);
  EXPECT_EQ(read->peer.text, "10.0.0.7:1234");
  EXPECT_TRUE(read->peer.trusted);
  EXPECT_TRUE(read->peer.yields);
  EXPECT_EQ(read->already_read, passed.already_read);
}

TEST(PassedSocket, AStrangerStaysOne) {
  PassedSocket passed{.kind = PassedKind::kNames};
  passed.peer = {.text = "x", .trusted = false};
  EXPECT_FALSE(DecodePassed(EncodePassed(passed))->peer.trusted);
}

TEST(PassedSocket, OtherBytesAreNone) {
  for (const std::string bad : {"", "N", "Nt", "Xt\n", "Nz\n", "N\n", "Ntpeer"})
    EXPECT_FALSE(DecodePassed(bad)) << bad;
  std::mt19937 random(7);
  for (int i = 0; i < 10000; ++i) {
    std::string bytes(random() % 12, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    if (const auto passed = DecodePassed(bytes)) {
      EXPECT_EQ(EncodePassed(*passed).size(), bytes.size());
    }
  }
}

class PassedDoorTest : public testing::Test {
 protected:
  PassedDoorTest() : io_("door", NullLogger()) {}

  IoThread io_;
};

TEST_F(PassedDoorTest, TheReceiverTalksToTheClient) {
  std::promise<PassedSocket> came;
  PassedDoor door(io_.context(), [&came](PassedSocket passed) { came.set_value(std::move(passed)); });
  ASSERT_EQ(door.Listen(DoorPath()), "");
  UniqueFd sender = ConnectToDoor(DoorPath());
  ASSERT_TRUE(sender);
  auto [client, accepted] = Pair();
  PassedSocket passed{.kind = PassedKind::kNames, .already_read = "OPEN /x\n"};
  passed.peer.text = "me";
  passed.fd = std::move(accepted);
  ASSERT_EQ(SendPassed(sender.get(), passed), 0);
  passed.fd.Reset();
  PassedSocket received = came.get_future().get();
  EXPECT_EQ(received.already_read, "OPEN /x\n");
  ASSERT_EQ(::send(received.fd.get(), "ok\n", 3, 0), 3);
  std::array<char, 8> said{};
  EXPECT_EQ(::read(client.get(), said.data(), said.size()), 3);
  io_.Stop();
}

TEST_F(PassedDoorTest, ASocketThatIsMissingOrTooManyIsDropped) {
  std::promise<PassedSocket> came;
  PassedDoor door(io_.context(), [&came](PassedSocket passed) { came.set_value(std::move(passed)); });
  ASSERT_EQ(door.Listen(DoorPath()), "");
  UniqueFd sender = ConnectToDoor(DoorPath());
  PassedSocket without{.kind = PassedKind::kNames};
  without.peer.text = "me";
  ASSERT_EQ(SendPassed(sender.get(), without), 0);
  auto [client, extra] = Pair();
  PassedSocket with{.kind = PassedKind::kTaken};
  with.peer.text = "me";
  with.fd = std::move(extra);
  ASSERT_EQ(SendPassed(sender.get(), with), 0);
  with.fd.Reset();
  std::array<char, 1> byte{};
  EXPECT_EQ(::read(client.get(), byte.data(), byte.size()), 0);  // closed
  ASSERT_EQ(SendPassed(sender.get(), {.kind = PassedKind::kGiven, .peer = {.text = "-"}}), 0);
  EXPECT_EQ(came.get_future().get().kind, PassedKind::kGiven);
  io_.Stop();
}

TEST_F(PassedDoorTest, APathThatADeadProcessLeftIsUsedAgainAndALiveOneIsNot) {
  PassedDoor door(io_.context(), [](const PassedSocket&) {});
  ASSERT_EQ(door.Listen(DoorPath()), "");
  PassedDoor other(io_.context(), [](const PassedSocket&) {});
  EXPECT_NE(other.Listen(DoorPath()).find("belongs to another daemon"), std::string::npos);
  io_.Stop();
}

TEST_F(PassedDoorTest, TooLongAPathIsSaid) {
  PassedDoor door(io_.context(), [](const PassedSocket&) {});
  EXPECT_NE(door.Listen("/tmp/" + std::string(200, 'x')).find("is too long for a socket"), std::string::npos);
  io_.Stop();
}

}  // namespace
}  // namespace coopdyn
