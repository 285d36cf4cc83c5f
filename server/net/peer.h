// SPDX-License-Identifier: MIT
// Who is at the other end of a socket, how its connection ends, and the options every client's socket gets.
// Pure functions of a descriptor; any thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

struct tcp_info;

namespace coopdyn {

/// The far end of a connection.
struct PeerInfo {
  std::string text;      // "127.0.0.1:53120", "[::1]:53120", "unix:4711" (a process of this machine), "page"
  bool trusted = false;  // from loopback or from inside the daemon: needs no token
  bool yields = false;   // a student of a seat: may only watch while the teacher drives
};

/// What ends a connection, and with it what its client owns.
struct ConnectionEnd {
  static constexpr std::chrono::seconds kDatagramSilence{10};
  /// Its client has sent nothing for so long; zero: it ends with its stream.
  std::chrono::milliseconds silence{0};

  bool with_stream() const { return silence.count() == 0; }
};
/// By the type of the socket; nothing if it is of no type that a module can take.
std::optional<ConnectionEnd> EndOf(int fd);

class Encoding;

/// Takes over a connection: owns `fd` from the call on; `already_read` are the bytes that its client has sent
/// after the part that was for somebody else. `encoding`: what both sides have agreed upon; null: these bytes
/// choose. Any thread.
using AdoptFunction =
    std::function<void(int fd, std::string already_read, PeerInfo peer, std::unique_ptr<Encoding> encoding)>;

/// An address and port as text; the address of a v4-mapped v6 address is the v4 one.
struct SocketAddress {
  std::string ip;  // "127.0.0.1", "::1"; empty for a local (unix) socket
  int port = 0;
  bool loopback = false;
};

/// The far and the near end of a connected socket; empty if it has none.
SocketAddress PeerAddress(int fd);
SocketAddress LocalAddress(int fd);
/// "127.0.0.1:53120", "[::1]:53120".
std::string ToString(const SocketAddress& address);
/// Text and trust of the far end of a connected TCP or unix socket. A unix socket's is of this machine, as
/// loopback is.
PeerInfo DescribePeer(int fd);

/// TCP: no delay, and keepalive that finds a dead peer within 25 s. Unix: room for large replies.
void SetClientSocketOptions(int fd);

/// True if nothing follows what the peer has sent already: it has shut down its sending side, closed, or
/// died. What is unread stays so.
bool PeerHasEnded(int fd);

/// True if the peer of a TCP socket has acknowledged nothing for 20 s although something is outstanding:
/// keepalive is silent then. A peer that lives but does not read answers window probes and is left alone.
bool PeerLooksDead(int fd);
bool PeerLooksDead(const tcp_info& info);

}  // namespace coopdyn
