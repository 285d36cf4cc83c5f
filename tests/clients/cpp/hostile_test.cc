// SPDX-License-Identifier: MIT
// Answers that no daemon gives: each is an Error that says what is wrong.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/page.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "tests/clients/cpp/error_of.h"

namespace coopdyn::client {
namespace {

namespace fs = std::filesystem;

/// Listens on a port of this machine and serves each connection in a separate thread.
class Peer {
 public:
  explicit Peer(std::function<void(int)> serve) {
    listening_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listening_, 64), 0);
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    accepting_ = std::thread([this, serve = std::move(serve)] {
      for (int fd = -1; (fd = accept(listening_, nullptr, nullptr)) >= 0;) {
        const int on = 1;
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
        serving_.emplace_back([serve, fd] {
          serve(fd);
          close(fd);
        });
      }
    });
  }
  ~Peer() {
    shutdown(listening_, SHUT_RDWR);
    accepting_.join();
    for (std::thread& thread : serving_) thread.join();
    close(listening_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  std::string server() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  int listening_ = -1, port_ = 0;
  std::vector<std::thread> serving_;
  std::thread accepting_;
};

void WriteTo(int fd, const std::string& bytes) {
  EXPECT_TRUE(send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0 || errno == EPIPE ||
              errno == ECONNRESET);
}

/// Answers a request with some bytes, then closes, or waits for the peer to close.
class Answerer : public Peer {
 public:
  explicit Answerer(const std::string& answer, bool waits = false)
      : Peer([answer, waits](int fd) {
          char bytes[4096];
          (void)!read(fd, bytes, sizeof(bytes));
          WriteTo(fd, answer);
          while (waits && read(fd, bytes, sizeof(bytes)) > 0) {
          }
        }) {}
};

/// A daemon until a client has connected; then every reply except that to `hello` is `bytes`, with the
/// command of the request if they are a message.
class HostileDaemon : public Peer {
 public:
  explicit HostileDaemon(const std::string& bytes) : Peer([this, bytes](int fd) { Serve(fd, bytes); }) {}
  void Turn() { hostile_ = true; }

 private:
  void Serve(int fd, const std::string& bytes) {
    std::string in;
    char some[4096];
    for (ssize_t n = 0; (n = read(fd, some, sizeof(some))) > 0;) {
      in.append(some, static_cast<std::size_t>(n));
      if (in.starts_with("NAME_SERVER list\n")) {
        for (const char* module : {"motors", "distance", "target", "pose", "neighbours"})
          WriteTo(fd, "registration name /robot1/" + std::string(module) + " ip 127.0.0.1 port 1 type tcp\n");
        return WriteTo(fd, "*** end of message\n");
      }
      if (in.starts_with("OPEN ") && in.ends_with('\n')) {
        WriteTo(fd, "ok\n");
        in.clear();
      }
      if (in.starts_with(kBinaryMagic)) in.erase(0, kBinaryMagic.size());
      while (!in.empty() && !in.starts_with("OPEN")) {
        const Decoded decoded = DecodeBinary(in);
        if (decoded.status != DecodeStatus::kMessage) break;
        in.erase(0, decoded.consumed);
        WriteTo(fd, ReplyTo(decoded.message, bytes));
      }
    }
  }

  std::string ReplyTo(const Message& request, const std::string& bytes) const {
    Message reply{0, "", request.command, {1}, {0.01, 1}};
    if (request.command == command::kGetStatus)
      reply.text = R"({"protocol": 1, "scenario": "s", "http": "x://y"})";
    if (hostile_ && request.command != command::kHello) {
      Decoded decoded = DecodeBinary(bytes);
      if (decoded.status != DecodeStatus::kMessage) return bytes;
      reply = std::move(decoded.message);
      reply.command = request.command;
    }
    std::string out;
    EncodeBinary(reply, out);
    return out;
  }

  std::atomic<bool> hostile_ = false;
};

/// Calls every function of the client; each may throw only an Error.
std::vector<std::function<void(Simulation&)>> AllCalls() {
  std::vector<std::function<void(Simulation&)>> calls = {
      [](auto& sim) { sim.robots(); },
      [](auto& sim) { sim.mode(); },
      [](auto& sim) { sim.dt(); },
      [](auto& sim) { sim.status(); },
      [](auto& sim) { sim.hash(); },
      [](auto& sim) { sim.waiting(); },
      [](auto& sim) { sim.describe("/x"); },
      [](auto& sim) { sim.call("/x", "y"); },
      [](auto& sim) { sim.call("/simulation", "4"); },
      [](auto& sim) { sim.snapshot(testing::TempDir() + "hostile.png"); },
      [](auto& sim) { sim.recording(); },
      [](auto& sim) { sim.recordings(); },
      [](auto& sim) { sim.stop_recording(); },
      [](auto& sim) { sim.saved_states(); },
      [](auto& sim) { sim.playback(); },
      [](auto& sim) { sim.reset(); },
      [](auto& sim) { sim.reload(); },
      [](auto& sim) { sim.branch(); },
      [](auto& sim) { sim.step(1, 0.05); },
      [](auto& sim) { sim.team(); },
      [](auto& sim) { sim.team("swarm1"); },
      [](auto& sim) { sim.robot(1); }};
  for (const auto& call : std::vector<std::function<void(Robot&)>>{
           [](auto& r) { r.get_pose(); }, [](auto& r) { r.get_pose_3d(); },
           [](auto& r) { r.get_distances(); }, [](auto& r) { r.get_geometry(); },
           [](auto& r) { r.get_targets(); }, [](auto& r) { r.get_target(1); },
           [](auto& r) { r.get_robots(); }, [](auto& r) { r.get_neighbours(); },
           [](auto& r) { r.get_messages(); }, [](auto& r) { r.get_wheels(); },
           [](auto& r) { r.get_limits(); }, [](auto& r) { r.sense("red"); },
           [](auto& r) { r.set_velocity(0.1, 0); }, [](auto& r) { r.send_message({1}); },
           [](auto& r) { r.subscribe("pose"), r.next("pose", 0.05); }}) {
    calls.push_back([call](Simulation& sim) {
      Robot robot = sim.robot("robot1");
      call(robot);
    });
  }
  return calls;
}

TEST(Hostile, RepliesAreErrorsAndNothingElse) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::int32_t least = std::numeric_limits<std::int32_t>::min(), most = -(least + 1);
  std::vector<std::string> replies = {std::string(24, '\xFF'),
                                      std::string("\x14\0\0\0", 4) + std::string(20, '\xFF')};
  for (
      const Message& message : std::vector<Message>{
          {0, "", 0, {}, {}},
          {0, "", 0, {}, {0.02}},
          {0, "a b c d", 0, {1, 2, 3, 4}, {0.02, 2}},
          {0, "", 0, {1, most, most, most, most, most}, {1, 2, 3, 0.02, 2}},
          {0, "pose distances", 0, {1, least, -1, least, -1}, {1, 2, 3, inf, -inf}},
          {0, "robot1 robot2", 0, {-1, -1}, {NAN, NAN}},
          {0, "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", 0, {1}, {0.02, 1e300}},
          {0,
           R"({"robots": 1, "commands": [{"name": "y", "id": 1e99}], "awaiting": {"a": 1}, "step": 1e99})",
           0,
           {0, 0},
           {1, 2}},
          {0,
           R"({"robots": [{}, null], "robot_count": 1e99, "protocol": "1", "playback": [], "http": "://:1"})",
           0,
           {1},
           {1, 2}},
          {-7, "", 0, {}, {}},
          {5, "load", 0, {}, {}},
          {6, "", 0, {}, {}},
          {10, "robot1", 0, {}, {}}}) {
    EncodeBinary(message, replies.emplace_back());
  }
  for (const std::string& bytes : replies) {
    for (const auto& call : AllCalls()) {
      HostileDaemon daemon(bytes);
      Simulation sim = connect(daemon.server(), {.name = "ana", .timeout = 1});
      Robot robot = sim.robot("robot1");
      daemon.Turn();
      try {
        call(sim);
      } catch (const Error&) {
      }
    }
  }
}

class Page : public testing::Test {
 protected:
  Page() : folder_(fs::temp_directory_path() / ("coopdyn-page-" + std::to_string(getpid()))) {
    fs::create_directory(folder_);
  }
  ~Page() override { fs::remove_all(folder_); }

  /// The error of a download from a page with this answer. It leaves no partial file.
  Error DownloadFrom(const Answerer& page, double timeout_s = 60) {
    return ErrorOf([&] {
      Download(Address("127.0.0.1", "", "", 3), "http://" + page.server() + "/", "/x", file(), "recording",
               timeout_s);
    });
  }
  std::string file() const { return (folder_ / "x.run").string(); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(Page, GivesAWholeFile) {
  const Answerer page("HTTP/1.1 200 OK\r\ncontent-length: 5\r\n\r\nwhole and more");
  EXPECT_EQ(DownloadFrom(page).code(), 0);
  std::ifstream in(file());
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "whole");
  EXPECT_EQ(files(), 1);
}

TEST_F(Page, ThatIsNoneIsAnError) {
  for (const std::string said :
       {"", "SSH-2.0-x\r\n\r\n", "HTTP/1.1 200 OK\r\n\r\nno length", "HTTP/1.1 2x0 OK\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: 99999999999999999999\r\n\r\n", "HTTP/1.1 200 OK\r\nConte"}) {
    const Answerer page(said);
    EXPECT_EQ(DownloadFrom(page).code(), Error::kNoConnection) << said;
  }
  const Answerer page("HTTP/1.1 200 OK\r\n" + std::string(100000, 'x'));
  EXPECT_EQ(DownloadFrom(page).code(), Error::kNoConnection);
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatBreaksOffLeavesNoFile) {
  const Answerer page("HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n1234");
  const Error error = DownloadFrom(page);
  EXPECT_TRUE(Says(error, "-1 the connection broke")) << error.text();
  EXPECT_TRUE(Says(error, "4 of 10 bytes")) << error.text();
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatGivesNothingMoreIsNotWaitedForLong) {
  for (const std::string said : {"", "HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n1234",
                                 "HTTP/1.1 500 no\r\nContent-Length: 10\r\n\r\n1234"}) {
    const Answerer page(said, true);
    EXPECT_EQ(DownloadFrom(page, 0.05).code(), 11) << said;
  }
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatRefusesSaysWhy) {
  const Answerer none("HTTP/1.1 404 no\r\nContent-Length: 5\r\n\r\ngone\n");
  EXPECT_TRUE(Says(DownloadFrom(none), "10 no recording: gone"));
  const Answerer refused("HTTP/1.1 403 no\r\nContent-Length: 6\r\n\r\nsecret");
  EXPECT_TRUE(Says(DownloadFrom(refused), "5 no recording: secret"));
}

}  // namespace
}  // namespace coopdyn::client
