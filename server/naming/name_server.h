// SPDX-License-Identifier: MIT
// The embedded name server: YARP's plain-text name protocol on one port, and `OPEN /name`, which turns the
// connection into one of that module's.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/naming/name_table.h"
#include "server/net/net_services.h"

namespace boost::asio {
class io_context;
}

namespace coopdyn {

/// Constructed on any thread, destroyed on the thread that runs `context` or when that has stopped.
class NameServer {
 public:
  /// `advertise`: the address in every answer about our own names; empty = the one at which it was asked.
  /// `table`, `context` and `services` outlive it.
  NameServer(boost::asio::io_context& context, NameTable& table, NetServices& services,
             std::string advertise = "");
  ~NameServer();
  NameServer(const NameServer&) = delete;
  NameServer& operator=(const NameServer&) = delete;

  /// Listener::Listen(). Any thread, once.
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// 0 = none. Constant after Listen().
  int port() const;
  /// Connections that are still ours. Any thread.
  std::size_t session_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
