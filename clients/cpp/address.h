// SPDX-License-Identifier: MIT
// Where the daemon is and who we are: what every connection needs. Constant after construction.
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
/// `seconds` from `now`; never if they are more than a year.
Deadline After(double seconds, Deadline now = Clock::now());
/// Seconds from `now` to `deadline`.
double Until(Deadline deadline, Deadline now = Clock::now());

/// A descriptor that is closed with the object; -1: none.
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

/// A name of the daemon and its own address; port 0: reached through the daemon's port only.
struct Module {
  std::string name, host;
  int port = 0;
};

class Address {
 public:
  /// `server`: "HOST", "HOST:PORT", "[::1]:PORT", "unix:/PATH"; empty: COOPDYN_SERVER, else this machine.
  /// `name` empty: user@host:pid. `seat` and `pin`: of a class; neither: COOPDYN_SEAT; an empty seat: none.
  /// Throws Error 3 or 4 for what cannot be meant.
  Address(const std::string& server, const std::string& name, const std::string& token, double timeout_s,
          const std::optional<std::string>& seat = {}, const std::string& pin = {});

  const std::string& host() const { return host_; }
  int port() const { return port_; }  // 0: a unix socket, whose address is the host
  const std::string& seat() const { return seat_; }
  double timeout_s() const { return timeout_s_; }
  std::string text() const;
  /// What `hello` says. Only what may drive says the plain name: the same name on an actuator module takes it
  /// over, which a reader must not do. A second team of one program is another name: `number`.
  std::string HelloText(bool drives, int number = 1) const;
  /// The value of the header Authorization of requests to the page; empty: none.
  std::string Authorization() const;
  /// What is said of a daemon that closed a connection without a word.
  std::string WhyLost() const;

  /// A connected, non-blocking socket to the daemon: by its unix socket if it is on this machine and has one
  /// (and COOPDYN_TCP is not set), else by its port. A class has a port only: on a socket of that name
  /// another daemon would answer. Throws Error -1 or 11 with cause and cure.
  Socket Dial(Deadline deadline) const;
  /// Dial() as the server's address says: by the port, or the unix socket at a path.
  Socket DialPort(Deadline deadline) const;
  /// Every name of the daemon.
  std::vector<Module> Modules() const;
  /// A socket that talks to `module`, before its first byte. Throws Error 10 if the daemon has no such name.
  Socket OpenModule(const std::string& module, Deadline deadline) const;

 private:
  void TakeServer(const std::string& server);
  void TakeSeat(const std::optional<std::string>& seat, const std::string& pin);
  /// None if there is no such socket.
  Socket DialLocal() const;
  Socket DialTcp(Deadline deadline) const;
  Socket DialUnix() const;
  /// The error in the line that was said instead of what was asked for.
  Error Refusal(const std::string& said) const;
  Error NotADaemon(const std::string& said) const;
  std::string ReadLine(const Socket& socket, Deadline deadline) const;
  /// Sends the first line of a connection; in a class one before it says whose seat this is. Returns the
  /// deadline of the answer: the daemon of a seat may have to start first.
  Deadline Begin(const Socket& socket, const std::string& line, Deadline deadline) const;

  std::string host_, name_, token_, seat_, pin_;
  int port_ = 10000;
  double timeout_s_ = 3;
};

/// Waits until one of the descriptors has something, or the time is over: false then.
bool WaitReadable(const std::vector<int>& fds, double timeout_s);
/// Writes all of `bytes` to a non-blocking socket. False if the connection broke.
bool WriteAll(int fd, const std::string& bytes);

}  // namespace coopdyn::client
