// SPDX-License-Identifier: MIT
// Listens for TCP connections on one port of one or several addresses, and for those of this machine's
// programs on a unix socket, and hands out accepted descriptors.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/net/net_services.h"
#include "server/net/peer.h"
#include "server/net/unique_fd.h"

namespace boost::asio {
class io_context;
}

namespace coopdyn {

/// The addresses that `--host` stands for: "", "localhost" and "127.0.0.1" both loopback addresses,
/// "0.0.0.0", "::" and "any" every address of the machine, anything else itself.
std::vector<std::string> ListenAddresses(const std::string& host);

/// What Listen() says when no more files can be open: another port is no better.
inline constexpr const char* kTooManyFiles = "Too many open files";

/// "nc (pid 77)"; empty if nobody listens there or it cannot be seen (another user's process).
std::string PortHolder(int port);

/// Whether a program on this machine could listen on `port` of all its addresses now.
bool IsPortFree(int port);

/// Running out of descriptors is logged (NetServices::LogExhausted()) and survived: accepting goes on when
/// some are free.
class Listener {
 public:
  /// Called on the io thread for each connection; options of client sockets are set.
  using AcceptFunction = std::function<void(UniqueFd fd, PeerInfo peer)>;

  /// Any thread. `context` and `services` outlive it.
  Listener(boost::asio::io_context& context, NetServices& services, AcceptFunction on_accept);
  /// On the io thread, or when that has stopped.
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Listens on `port` (0 = any free one) of all `addresses`, the same on each. A v6 address that the machine
  /// does not have is left out if another one works. Any thread, once. Returns an error text, empty if it
  /// listens: "port 10002 of 127.0.0.1 is in use by nc (pid 77)".
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Listens besides on the unix socket of this name in Linux's abstract namespace. Any thread, once. Returns
  /// an error text.
  std::string ListenLocal(const std::string& name);
  /// Goes on with sockets of another listener's Release(). Any thread, once.
  void Listen(std::vector<UniqueFd> listening, int port);
  /// Accepts nothing any more and gives its sockets away; who connects waits. Io thread.
  std::vector<UniqueFd> Release();
  /// The port it listens on; 0 = none.
  int port() const { return port_; }

 private:
  struct Impl;
  void Add(std::vector<UniqueFd> listening);

  std::shared_ptr<Impl> impl_;
  int port_ = 0;
};

}  // namespace coopdyn
