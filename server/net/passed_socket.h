// SPDX-License-Identifier: MIT
// A connection that one process has accepted and another serves: `coopdyn host` reads who is calling, then
// passes the socket to the daemon of that seat (SCM_RIGHTS, unix(7)). One message of a SOCK_SEQPACKET socket
// for each connection. The codec is pure; any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/net/peer.h"
#include "server/net/unique_fd.h"

namespace boost::asio {
class io_context;
}

namespace coopdyn {

/// What the host tells a daemon about a connection, or about all of them.
enum class PassedKind : char {
  kNames = 'N',  // a connection to the name server
  kPage = 'P',   // a connection to the page
  kTaken = 'T',  // the teacher drives: students may only watch
  kGiven = 'G',  // they may drive again
  kAdmit = 'A',  // the machine of `peer` may connect to the daemon's own ports
};

struct PassedSocket {
  /// Longest message: the head of an HTTP request and what was read with it.
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 10;

  PassedKind kind = PassedKind::kNames;
  PeerInfo peer = {};
  std::string already_read = {};  // by the sender, of the client's bytes
  UniqueFd fd = {};               // of kNames and kPage only
};

/// The bytes of the message, without the socket.
std::string EncodePassed(const PassedSocket& passed);
/// Nothing: these are no such bytes. Without the socket.
std::optional<PassedSocket> DecodePassed(std::string_view bytes);

/// Sends a connection without blocking. Returns 0 or an errno code; EAGAIN: later.
int SendPassed(int to, const PassedSocket& passed);

/// Receives connections at a path in the file system. Processes of other users cannot send any.
class PassedDoor {
 public:
  using TakeFunction = std::function<void(PassedSocket)>;

  /// `take` is called on the thread of `context`, which outlives the door.
  PassedDoor(boost::asio::io_context& context, TakeFunction take);
  /// On the thread of `context`, or when that has stopped. Removes the path.
  ~PassedDoor();
  PassedDoor(const PassedDoor&) = delete;
  PassedDoor& operator=(const PassedDoor&) = delete;

  /// Listens at `path`; replaces what a process that has died left there. An error text, empty if it listens.
  /// Any thread, once.
  std::string Listen(const std::string& path);

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

/// A connected socket to the door at `path`; none, and errno says why.
UniqueFd ConnectToDoor(const std::string& path);

}  // namespace coopdyn
