// SPDX-License-Identifier: MIT
// Listens for TCP connections on one port of one or more addresses, and for local programs on a unix socket.
// Passes on accepted descriptors.
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

/// The addresses that `--host` stands for: "", "localhost" and "127.0.0.1" are both loopback addresses;
/// "0.0.0.0", "::" and "any" are all addresses of the machine; any other text is itself.
std::vector<std::string> ListenAddresses(const std::string& host);

/// Listen()'s error when the process is out of file descriptors: another port would not help.
inline constexpr const char* kTooManyFiles = "Too many open files";

/// The program that listens on `port`: "nc (pid 77)"; empty if none, or if it is another user's process.
std::string PortHolder(int port);

/// Whether a program on this machine could now listen on `port` on all addresses.
bool IsPortFree(int port);

/// When descriptors run out, logs that (NetServices::LogExhausted()) and resumes accepting when some are
/// free.
class Listener {
 public:
  /// Called on the io thread for each connection, with the client socket options already set.
  using AcceptFunction = std::function<void(UniqueFd fd, PeerInfo peer)>;

  /// Any thread. `context` and `services` outlive it.
  Listener(boost::asio::io_context& context, NetServices& services, AcceptFunction on_accept);
  /// On the io thread, or when that has stopped.
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Listens on `port` of all `addresses`; 0 picks one free port for all. Skips a v6 address that the machine
  /// does not have if another address works. Any thread, once. Returns an error text, or empty on success:
  /// "port 10002 of 127.0.0.1 is in use by nc (pid 77)".
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Also listens on the unix socket of this name in Linux's abstract namespace. Any thread, once. Returns an
  /// error text.
  std::string ListenLocal(const std::string& name);
  /// Continues with the sockets of another listener's Release(). Any thread, once.
  void Listen(std::vector<UniqueFd> listening, int port);
  /// Stops accepting and gives its sockets away; new connections wait. Io thread.
  std::vector<UniqueFd> Release();
  /// The port; 0 before Listen().
  int port() const { return port_; }

 private:
  struct Impl;
  void Add(std::vector<UniqueFd> listening);

  std::shared_ptr<Impl> impl_;
  int port_ = 0;
};

}  // namespace coopdyn
