// SPDX-License-Identifier: MIT
// The embedded name server: YARP's plain-text name protocol on one port, and `OPEN /name`, which passes the
// connection on to that module.
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

/// Constructed on any thread, destroyed on the thread that runs `context` or after it has stopped.
class NameServer {
 public:
  /// `advertise`: the address in every answer about our own names; empty: the address at which the server was
  /// asked. `hooks` are called on the thread of `context`. `table`, `context` and `services` outlive it.
  NameServer(boost::asio::io_context& context, NameTable& table, NetServices& services,
             std::string advertise = "",
             NameHooks hooks = {[](const std::string&, const std::string&) {},
                                [](const Subscription&, bool) {}});
  ~NameServer();
  NameServer(const NameServer&) = delete;
  NameServer& operator=(const NameServer&) = delete;

  /// Listener::Listen(). If all addresses are loopback, also listens on the unix socket LocalName(port),
  /// which costs its clients half of TCP's time; if another program has that socket, clients use TCP. New
  /// connections wait until Serve(). Any thread, once.
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Starts answering; call it when all names are known. Any thread, once.
  void Serve();
  /// Serves a connection that another process accepted and whose first bytes it has read. The thread of
  /// `context`.
  void Adopt(UniqueFd fd, PeerInfo peer, std::string already_read);
  /// The unix socket's name, in Linux's abstract namespace, for the name server on this port.
  static std::string LocalName(int port) { return "coopdyn-" + std::to_string(port); }
  /// The port; 0 before Listen(). Constant after it.
  int port() const;
  /// Number of connections not passed on to a module. Any thread.
  std::size_t session_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
