// SPDX-License-Identifier: MIT
// The far end of a socket, how its connection ends, and the options of client sockets. Pure functions of a
// descriptor; thread-safe.
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

/// The event that ends a connection, and with it its client's ownership.
struct ConnectionEnd {
  static constexpr std::chrono::seconds kDatagramSilence{10};
  /// Ends when the client has been silent this long; zero: ends with its stream.
  std::chrono::milliseconds silence{0};

  bool with_stream() const { return silence.count() == 0; }
};
/// By the socket's type; nullopt if modules cannot use that type.
std::optional<ConnectionEnd> EndOf(int fd);

class Encoding;

/// Adopts a connection and takes ownership of `fd`. `already_read`: bytes that the client sent after the part
/// meant for another reader. `encoding`: already agreed with the client; null: these bytes choose. Any
/// thread.
using AdoptFunction =
    std::function<void(int fd, std::string already_read, PeerInfo peer, std::unique_ptr<Encoding> encoding)>;

/// An address and port as text; a v4-mapped v6 address is shown as v4.
struct SocketAddress {
  std::string ip;  // "127.0.0.1", "::1"; empty for a local (unix) socket
  int port = 0;
  bool loopback = false;
};

/// The far and the near end of a connected socket; empty if unknown.
SocketAddress PeerAddress(int fd);
SocketAddress LocalAddress(int fd);
/// "127.0.0.1:53120", "[::1]:53120".
std::string ToString(const SocketAddress& address);
/// Text and trust of the far end of a connected TCP or unix socket. A unix socket is trusted like loopback.
PeerInfo DescribePeer(int fd);

/// TCP: no delay, and keepalive that detects a dead peer within 25 s. Unix: room for large replies.
void SetClientSocketOptions(int fd);

/// True if the peer has shut down its sending side, closed, or died. Unread bytes stay unread.
bool PeerHasEnded(int fd);

/// True if a TCP peer has acknowledged nothing for 20 s although data is outstanding, when keepalive is
/// silent. A live peer that does not read answers window probes and does not count.
bool PeerLooksDead(int fd);
bool PeerLooksDead(const tcp_info& info);

}  // namespace coopdyn
