// SPDX-License-Identifier: MIT
// A client for tests: a blocking socket whose waits end after kPatience. One thread.
#pragma once

#include <sys/socket.h>

#include <string>
#include <string_view>
#include <utility>

#include "protocol/message.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

class TestClient {
 public:
  static constexpr int kPatience_ms = 60'000;

  /// Takes over a connected socket.
  explicit TestClient(UniqueFd fd) : fd_(std::move(fd)) {}
  /// Connects; `ok()` says whether it succeeded.
  static TestClient Connect(int port, const std::string& ip = "127.0.0.1");
  /// Connects to a unix socket of the abstract namespace.
  static TestClient ConnectLocal(const std::string& name);

  bool ok() const { return static_cast<bool>(fd_); }
  int fd() const { return fd_.get(); }
  /// "127.0.0.1:PORT" of this side.
  std::string address() const;

  /// Writes all bytes; false after kPatience.
  bool Send(std::string_view bytes);
  /// Writes the bytes that fit without waiting; returns their number.
  std::size_t SendSome(std::string_view bytes);
  /// A line without its '\n'; "<end>" if the connection ended before it, "<nothing>" if nothing arrived.
  std::string Line();
  std::string Exactly(std::size_t count);
  /// Reads until the server closes.
  std::string Rest();
  /// Decodes one binary frame.
  Message Frame();
  /// Sends FIN.
  void EndInput();
  void Close() { fd_.Reset(); }
  /// Closes with a reset, as a killed program with unread input does.
  void Reset();

 private:
  /// Appends to buffer_; false at the end or after kPatience.
  bool More();

  UniqueFd fd_;
  std::string buffer_;
  bool ended_ = false;
};

/// A loopback port that no other program is given during its lifetime; a socket with SO_REUSEADDR may listen
/// on it.
class HeldPort {
 public:
  HeldPort();
  int port() const { return port_; }

 private:
  UniqueFd fd_;
  int port_ = 0;
};

/// A connected pair of unix sockets.
std::pair<UniqueFd, UniqueFd> SocketPair(int type = SOCK_STREAM);
/// The number of open descriptors of this process.
int OpenDescriptors();
/// Waits until `condition()`; false after kPatience.
template <typename Condition>
bool Eventually(Condition condition);

}  // namespace coopdyn

#include <poll.h>

#include <chrono>

namespace coopdyn {

template <typename Condition>
bool Eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(TestClient::kPatience_ms);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    ::poll(nullptr, 0, 1);
  }
  return true;
}

}  // namespace coopdyn
