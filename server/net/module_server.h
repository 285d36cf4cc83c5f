// SPDX-License-Identifier: MIT
// The connections of one module: those accepted on its port and those passed to it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/net/encoding.h"
#include "server/net/endpoint.h"
#include "server/net/handover.h"
#include "server/net/io_thread.h"
#include "server/net/net_services.h"
#include "server/net/peer.h"

namespace coopdyn {

/// Constructed on any thread, destroyed on thread `io` or after it has stopped; each member names its thread.
/// The endpoint is called only on the io thread, never from within Push(), Close() or a ReplyFunction.
class ModuleServer {
 public:
  /// `io`, `endpoint` and `services` outlive it. `name`, e.g. "/robot1/motors", is for log lines.
  ModuleServer(IoThread& io, Endpoint& endpoint, NetServices& services, std::string name);
  /// Closes every connection with the notice "the module is closed", as far as it can be written at once.
  /// Calls OnClosed() for each open connection.
  ~ModuleServer();
  ModuleServer(const ModuleServer&) = delete;
  ModuleServer& operator=(const ModuleServer&) = delete;

  /// Listener::Listen(). Any thread, at most once; without it only adopted connections arrive.
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Continues with another server's port and connections. Any thread, instead of the other Listen().
  void Listen(LoosePort port);
  /// Gives away the port and the connections whose Session::may_leave() is true, after their current reads.
  /// Any thread but `io`, which must be running.
  LoosePort Release();
  /// The port; 0 if it does not listen. Constant after Listen().
  int port() const;
  const std::string& name() const;

  /// Adopts a connection as if newly accepted, with `already_read` as its first bytes. Takes ownership of
  /// `fd`. `encoding`: already agreed with the client; null: the first bytes choose. Any thread.
  void Adopt(int fd, std::string already_read, PeerInfo peer, std::unique_ptr<Encoding> encoding = nullptr);
  /// Adopt() as a function that may outlive this server (it then closes the descriptor).
  AdoptFunction adopter() const;

  /// Closes every connection with a notice. Io thread. OnClosed() follows later for each.
  void CloseAll(const std::string& reason);
  /// Number of connections not yet fully closed. Any thread.
  std::size_t session_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
