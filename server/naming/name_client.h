// SPDX-License-Identifier: MIT
// Registers our modules with an external YARP name server, on its own thread: one connection at a time (the
// server's backlog is 1), with retries. Thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/base/log.h"

namespace coopdyn {

class NameClient {
 public:
  /// `host`, `port`: the name server's address. Connects only when there is something to send; after that,
  /// checks each `check_every` whether the server was restarted, and if so registers everything again.
  NameClient(std::string host, int port, Logger logger,
             std::chrono::milliseconds check_every = std::chrono::seconds(5));
  /// Unregisters all names, waiting at most half a second for that.
  ~NameClient();
  NameClient(const NameClient&) = delete;
  NameClient& operator=(const NameClient&) = delete;

  /// Splits "host:port", "host" (port 10000) or "[::1]:10000". Returns an error text.
  static std::string ParseServer(const std::string& text, std::string& host, int& port);

  /// An empty `ip` means the address that the name server sees. Returns at once; retries until registration
  /// succeeds or the name is unregistered. Each failure is logged once.
  void Register(const std::string& name, const std::string& ip, int port);
  void Unregister(const std::string& name);
  /// Number of unanswered requests.
  std::size_t pending() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
