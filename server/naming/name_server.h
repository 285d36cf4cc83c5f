// SPDX-License-Identifier: MIT
// The embedded name server: YARP's plain-text name protocol on one port, and `OPEN /name`, which turns the
// connection into one of that module's.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/naming/name_protocol.h"
#include "server/naming/name_table.h"
#include "server/net/net_services.h"
#include "server/net/unique_fd.h"

namespace boost::asio {
class io_context;
}

namespace coopdyn {

/// Constructed on any thread, destroyed on the thread that runs `context` or when that has stopped.
class NameServer {
 public:
  /// `advertise`: the address in every answer about our own names; empty = the one at which it was asked.
  /// `hooks` are called on the thread of `context`.
  /// `table`, `context` and `services` outlive it.
  NameServer(boost::asio::io_context& context, NameTable& table, NetServices& services,
             std::string advertise = "",
             NameHooks hooks = {[](const std::string&, const std::string&) {},
                                [](const Subscription&, bool) {}});
  ~NameServer();
  NameServer(const NameServer&) = delete;
  NameServer& operator=(const NameServer&) = delete;

  /// Listener::Listen(); if that is loopback only, listens besides on the unix socket LocalName(port), which
  /// costs its clients half of what TCP does. Without that (another program has it) there is TCP. Who
  /// connects waits until Serve(). Any thread, once.
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Answers from now on, as all names are there. Any thread, once.
  void Serve();
  /// Serves a connection that another process has accepted, and of which it has read the first bytes. The
  /// thread of `context`.
  void Adopt(UniqueFd fd, PeerInfo peer, std::string already_read);
  /// The name, in Linux's abstract namespace, of the unix socket of the name server on this port.
  static std::string LocalName(int port) { return "coopdyn-" + std::to_string(port); }
  /// 0 = none. Constant after Listen().
  int port() const;
  /// Connections that are still ours. Any thread.
  std::size_t session_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
