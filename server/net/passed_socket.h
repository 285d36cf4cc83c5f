// SPDX-License-Identifier: MIT
// Passes connections between processes: `coopdyn host` accepts a connection, reads its seat, and passes the
// socket to that seat's daemon (SCM_RIGHTS, unix(7)). One message of a SOCK_SEQPACKET socket per connection.
// The codec is pure; any thread.
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

/// A message of the host to a daemon, about one connection or all.
enum class PassedKind : char {
  kNames = 'N',  // a connection to the name server
  kPage = 'P',   // a connection to the page
  kTaken = 'T',  // the teacher drives: students may only watch
  kGiven = 'G',  // they may drive again
  kAdmit = 'A',  // the machine of `peer` may connect to the daemon's own ports
};

struct PassedSocket {
  /// Longest message: the head of an HTTP request and the bytes read with it.
  static constexpr std::size_t kMaxBytes = std::size_t{96} << 10;

  PassedKind kind = PassedKind::kNames;
  PeerInfo peer = {};
  std::string already_read = {};  // the client's bytes that the sender has read
  UniqueFd fd = {};               // of kNames and kPage only
};

/// The bytes of the message, without the socket.
std::string EncodePassed(const PassedSocket& passed);
/// Decodes the message, without the socket. Nullopt if malformed.
std::optional<PassedSocket> DecodePassed(std::string_view bytes);

/// Sends a connection without blocking. Returns 0 or an errno code; EAGAIN: later.
int SendPassed(int to, const PassedSocket& passed);

/// Receives connections at a path in the file system. Processes of other users cannot send any.
class PassedDoor {
 public:
  using TakeFunction = std::function<void(PassedSocket)>;

  /// Calls `take` on the thread of `context`, which must outlive the door.
  PassedDoor(boost::asio::io_context& context, TakeFunction take);
  /// On the thread of `context`, or when that has stopped. Removes the path.
  ~PassedDoor();
  PassedDoor(const PassedDoor&) = delete;
  PassedDoor& operator=(const PassedDoor&) = delete;

  /// Listens at `path`; replaces a socket left there by a dead process. Returns an error text, empty on
  /// success. Any thread, once.
  std::string Listen(const std::string& path);

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

/// Returns a socket connected to the door at `path`; on failure an empty one, with errno set.
UniqueFd ConnectToDoor(const std::string& path);

}  // namespace coopdyn
