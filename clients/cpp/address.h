// SPDX-License-Identifier: MIT
// The daemon's address and the client's identity, shared by all connections. Constant after construction.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/cpp/error.h"

namespace coopdyn::client {

using Clock = std::chrono::steady_clock;
using Deadline = Clock::time_point;
/// `now` plus `seconds`, capped at one year.
Deadline After(double seconds, Deadline now = Clock::now());
/// Seconds from `now` to `deadline`.
double SecondsUntil(Deadline deadline, Deadline now = Clock::now());

/// An owned file descriptor; -1: none.
class Socket {
 public:
  explicit Socket(int fd = -1) : fd_(fd) {}
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Socket();
  int fd() const { return fd_; }

 private:
  int fd_;
};

/// A module's name and address. Port 0: reachable only through the daemon's port.
struct Module {
  std::string name, host;
  int port = 0;
};

class Address {
 public:
  /// `server`: "HOST", "HOST:PORT", "[::1]:PORT", "unix:/PATH"; empty: COOPDYN_SERVER, else this machine.
  /// `name` empty: user@host:pid. `seat` and `pin`: of a class; neither: COOPDYN_SEAT; an empty seat: none.
  /// Throws Error 3 or 4 for invalid arguments.
  Address(const std::string& server, const std::string& name, const std::string& token, double timeout_s,
          const std::optional<std::string>& seat = {}, const std::string& pin = {});

  const std::string& host() const { return host_; }
  int port() const { return port_; }  // 0: host() is the address of a unix socket
  const std::string& seat() const { return seat_; }
  double timeout_s() const { return timeout_s_; }
  std::string text() const;
  /// The text of `hello`. Only connections that may drive use the plain name: a client of the same name takes
  /// over an actuator module, which a reader must not do. `number` distinguishes the teams of one program.
  std::string HelloText(bool drives, int number = 1) const;
  /// Value of the Authorization header for requests to the page; empty: no header.
  std::string Authorization() const;
  /// The hint in the error if the daemon closed a connection without a notice.
  std::string LossHint() const;

  /// Returns a connected, non-blocking socket: the daemon's unix socket if it runs on this machine and has
  /// one (and COOPDYN_TCP is not set), else TCP. A class is reached only by TCP: a unix socket of that name
  /// would belong to another daemon. Throws Error -1 or 11 with cause and cure.
  Socket Dial(Deadline deadline) const;
  /// Dials the address as given: a TCP port, or a unix socket's path.
  Socket DialPort(Deadline deadline) const;
  /// All names registered at the daemon.
  std::vector<Module> Modules() const;
  /// Returns a socket to `module` on which no message has been sent yet. Throws Error 10 if the daemon has no
  /// such name.
  Socket OpenModule(const std::string& module, Deadline deadline) const;

 private:
  void TakeServer(const std::string& server);
  void TakeSeat(const std::optional<std::string>& seat, const std::string& pin);
  /// Returns an empty Socket if the daemon has no unix socket here.
  Socket DialLocal() const;
  Socket DialTcp(Deadline deadline) const;
  Socket DialUnix() const;
  /// The error that an unexpected answer line stands for.
  Error Refusal(const std::string& said) const;
  Error NotADaemon(const std::string& said) const;
  std::string ReadLine(const Socket& socket, Deadline deadline) const;
  /// Sends a connection's first line, in a class after a line with seat and PIN. Returns the deadline of the
  /// answer, which is later in a class: the seat's daemon may have to start first.
  Deadline Begin(const Socket& socket, const std::string& line, Deadline deadline) const;

  std::string host_, name_, token_, seat_, pin_;
  int port_ = 10000;
  double timeout_s_ = 3;
};

/// Waits until a descriptor is readable. False on timeout.
bool WaitReadable(const std::vector<int>& fds, double timeout_s);
/// Writes all `bytes` to a non-blocking socket. False if the connection broke.
bool WriteAll(int fd, const std::string& bytes);

}  // namespace coopdyn::client
