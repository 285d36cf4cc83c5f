// SPDX-License-Identifier: MIT
// Registers our modules with a YARP name server elsewhere, on a thread of its own: one connection at a time
// (its backlog is 1), with retries. Any thread.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "server/base/log.h"

namespace coopdyn {

class NameClient {
 public:
  /// `host`, `port`: of the name server. Connects only when there is something to tell; then asks it each
  /// `check_every` whether it was started anew, and registers everything again if so.
  NameClient(std::string host, int port, Logger logger,
             std::chrono::milliseconds check_every = std::chrono::seconds(5));
  /// Unregisters what is registered, waiting at most half a second for it.
  ~NameClient();
  NameClient(const NameClient&) = delete;
  NameClient& operator=(const NameClient&) = delete;

  /// Splits "host:port", "host" (port 10000) or "[::1]:10000". Returns an error text.
  static std::string ParseServer(const std::string& text, std::string& host, int& port);

  /// An empty `ip`: the address that the name server sees. Returns at once; it is tried until it succeeds or
  /// the name is unregistered. Failures are logged, each once.
  void Register(const std::string& name, const std::string& ip, int port);
  void Unregister(const std::string& name);
  /// Requests that have not been answered yet.
  std::size_t pending() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
