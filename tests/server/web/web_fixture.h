// SPDX-License-Identifier: MIT
// A web server with two modules and a painter behind it, and plain clients.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/base/clock.h"
#include "server/naming/name_table.h"
#include "server/net/io_thread.h"
#include "server/net/module_server.h"
#include "server/state/frame_board.h"
#include "server/state/image_board.h"
#include "server/web/web_server.h"

namespace coopdyn {

/// Owned by its first commander; only Release() answers `stop`; `subscribe` pushes once. Io thread of the
/// fixture's modules, except for the counters.
class FakeMotors : public Endpoint {
 public:
  FakeMotors();
  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return table_; }
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override;
  void OnClosed(Connection& connection) override;
  /// Answers all pending requests.
  void Release();

  std::atomic<int> open_owners{0};
  std::atomic<int> closed{0};
  std::atomic<int> waiting{0};
  std::string peer;      // of the newest request
  bool trusted = false;  // likewise

 private:
  const std::string path_ = "/robot1/motors";
  CommandTable table_;
  ClientId owner_ = 0;
  std::string owner_peer_;
  std::vector<ReplyFunction> waiting_replies_;
};

/// Answers get_status, and refuses `run` from untrusted clients.
class FakeSimulation : public Endpoint {
 public:
  FakeSimulation();
  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return table_; }
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override;

  std::atomic<int> asked{0};

 private:
  const std::string path_ = "/simulation";
  CommandTable table_;
};

/// Draws "picture N" for request number N.
class FakePainter {
 public:
  explicit FakePainter(ImageBoard& board);
  std::atomic<int> drawn{0};

 private:
  ImageBoard& board_;
  SteadyClock clock_;
  std::jthread thread_;
};

struct WebWorld {
  explicit WebWorld(WebOptions options = DefaultOptions());
  ~WebWorld();
  static WebOptions DefaultOptions();
  void PublishFrame(std::uint64_t step);

  SteadyClock clock;
  NetServices services{NullLogger(), clock};
  NameTable names;
  FrameBoard frames;
  ImageBoard images;
  FakeMotors motors;
  FakeSimulation simulation;
  IoThread modules{"modules", NullLogger()};
  std::unique_ptr<ModuleServer> motors_server;
  std::unique_ptr<ModuleServer> simulation_server;
  FakePainter painter{images};
  std::unique_ptr<WebServer> web;
  int port = 0;
};

/// A blocking TCP connection; reads time out after a minute.
class RawClient {
 public:
  explicit RawClient(int port);
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  void Send(std::string_view bytes);
  void EndInput();
  /// Whether the peer has closed; waits up to `patience`.
  bool HasEnded(std::chrono::milliseconds patience);
  /// Reads until the peer closes.
  std::string ReadAll();
  /// Reads until `end`; returns the bytes read, including `end`.
  std::string ReadUntil(std::string_view end);
  /// Reads exactly `count` bytes.
  std::string ReadBytes(std::size_t count);

 private:
  int fd_;
  std::string buffer_;
};

struct HttpReply {
  int status = 0;
  std::string header;
  std::string body;
};
/// Sends a request on a new connection. Each of `headers` ends with CR LF.
HttpReply Fetch(int port, std::string_view method, std::string_view target, std::string_view body = {},
                std::string_view headers = {});

/// Waits until `condition` holds; false after a minute.
template <typename Condition>
bool Eventually(Condition condition) {
  const SteadyClock clock;
  const Nanoseconds end = clock.Now() + 60 * kNanosecondsPerSecond;
  while (!condition()) {
    if (clock.Now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

}  // namespace coopdyn
