// SPDX-License-Identifier: MIT
// The connections of one module: those it accepts on its port and those handed to it.
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

/// Constructed on any thread, destroyed on the thread `io` or when that has stopped; the rest
/// says. The endpoint is called on the io thread only, never from within Push(), Close() or a ReplyFunction.
class ModuleServer {
 public:
  /// `io`, `endpoint` and `services` outlive it. `name`, e.g. "/robot1/motors", is for log lines.
  ModuleServer(IoThread& io, Endpoint& endpoint, NetServices& services, std::string name);
  /// Closes every connection with the notice "the module is closed" as far as it can be written at once; each
  /// still open one gets its OnClosed().
  ~ModuleServer();
  ModuleServer(const ModuleServer&) = delete;
  ModuleServer& operator=(const ModuleServer&) = delete;

  /// Listener::Listen(). Any thread, at most once; without it only adopted connections come.
  std::string Listen(const std::vector<std::string>& addresses, int port);
  /// Goes on with the port and the connections of another server. Any thread, instead of the other Listen().
  void Listen(LoosePort port);
  /// Gives away its port, and the connections of Session::may_leave(); waits for what is being
  /// read. Any thread but `io`, which runs.
  LoosePort Release();
  /// The port it listens on; 0 = none. Constant after Listen().
  int port() const;
  const std::string& name() const;

  /// Takes over a connection: it behaves as newly accepted, its first bytes being `already_read`. Owns `fd`
  /// from the call on. `encoding`: what both sides have agreed upon; null: the first bytes choose. Any
  /// thread.
  void Adopt(int fd, std::string already_read, PeerInfo peer, std::unique_ptr<Encoding> encoding = nullptr);
  /// Adopt() as a function that may be called even after this server is gone (it closes the descriptor then).
  AdoptFunction adopter() const;

  /// Closes every connection with a notice. Io thread. OnClosed() follows for each, later.
  void CloseAll(const std::string& reason);
  /// Connections not yet fully closed. Any thread.
  std::size_t session_count() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn
