// SPDX-License-Identifier: MIT
#include "server/net/peer.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace coopdyn {
namespace {

constexpr int kKeepIdle_s = 10;
constexpr int kKeepInterval_s = 5;
constexpr int kKeepCount = 3;
constexpr std::uint32_t kSilent_ms = 20'000;
constexpr int kUnansweredProbes = 3;
// Bytes that the kernel buffers beyond the peer's window. Without this limit it would accept several MB for a
// peer that does not read, one push at a time, each as costly as a step.
constexpr int kUnsentBytes = 64 << 10;
constexpr int kLocalSendBytes = 1 << 20;  // the kernel caps it at net.core.wmem_max

/// `get`: getpeername or getsockname.
template <typename Get>
SocketAddress AddressBy(Get get, int fd) {
  SocketAddress address;
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (get(fd, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return address;
  char text[INET6_ADDRSTRLEN] = "";
  if (storage.ss_family == AF_INET) {
    sockaddr_in v4;
    std::memcpy(&v4, &storage, sizeof v4);
    inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
    address = {text, ntohs(v4.sin_port), (ntohl(v4.sin_addr.s_addr) >> 24) == 127};
  } else if (storage.ss_family == AF_INET6) {
    sockaddr_in6 v6;
    std::memcpy(&v6, &storage, sizeof v6);
    address.port = ntohs(v6.sin6_port);
    if (IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr)) {
      inet_ntop(AF_INET, &v6.sin6_addr.s6_addr[12], text, sizeof text);
      address.loopback = v6.sin6_addr.s6_addr[12] == 127;
    } else {
      inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
      address.loopback = IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr);
    }
    address.ip = text;
  }
  return address;
}

/// The value of a numeric option; -1 if the socket does not have it.
int Option(int fd, int level, int option) {
  int value = 0;
  socklen_t size = sizeof value;
  return getsockopt(fd, level, option, &value, &size) == 0 ? value : -1;
}

bool IsTcp(int fd) {
  return Option(fd, SOL_SOCKET, SO_PROTOCOL) == IPPROTO_TCP;
}

bool IsLocal(int fd) {
  return Option(fd, SOL_SOCKET, SO_DOMAIN) == AF_UNIX;
}

void SetOption(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof value);
}

}  // namespace

SocketAddress PeerAddress(int fd) {
  return AddressBy(getpeername, fd);
}

SocketAddress LocalAddress(int fd) {
  return AddressBy(getsockname, fd);
}

std::string ToString(const SocketAddress& address) {
  const bool v6 = address.ip.find(':') != std::string::npos;
  return (v6 ? "[" + address.ip + "]" : address.ip) + ":" + std::to_string(address.port);
}

PeerInfo DescribePeer(int fd) {
  if (IsLocal(fd)) {
    ucred who{};
    socklen_t size = sizeof who;
    const bool known = getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 && who.pid > 0;
    return {known ? "unix:" + std::to_string(who.pid) : "unix", true};
  }
  const SocketAddress address = PeerAddress(fd);
  return {address.port == 0 ? "a client that has gone" : ToString(address), address.loopback};
}

std::optional<ConnectionEnd> EndOf(int fd) {
  const int type = Option(fd, SOL_SOCKET, SO_TYPE);
  if (type == SOCK_STREAM) return ConnectionEnd{};
  if (type == SOCK_DGRAM) return ConnectionEnd{ConnectionEnd::kDatagramSilence};
  return std::nullopt;
}

void SetClientSocketOptions(int fd) {
  if (IsLocal(fd)) SetOption(fd, SOL_SOCKET, SO_SNDBUF, kLocalSendBytes);
  if (!IsTcp(fd)) return;
  SetOption(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  SetOption(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, kUnsentBytes);
  SetOption(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepIdle_s);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepInterval_s);
  SetOption(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepCount);
  // No TCP_USER_TIMEOUT: it also ends connections whose peer lives but does not read (a program at a
  // breakpoint). PeerLooksDead() detects what keepalive misses.
}

bool PeerHasEnded(int fd) {
  // poll() sees the end behind unread bytes, but not an end that arrived while another thread was in recv():
  // the kernel queues it only afterwards. Peeking into a stream waits for that. On a datagram socket a peek
  // would consume the error.
  if (Option(fd, SOL_SOCKET, SO_TYPE) == SOCK_STREAM) {
    char byte = 0;
    const ssize_t count = ::recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    const bool is_empty = count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    if (count <= 0 && !is_empty) return true;
  }
  pollfd state{fd, POLLRDHUP, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

bool PeerLooksDead(const tcp_info& info) {
  return info.tcpi_last_ack_recv > kSilent_ms &&
         (info.tcpi_unacked > 0 || info.tcpi_probes >= kUnansweredProbes);
}

bool PeerLooksDead(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return IsTcp(fd) && getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 && PeerLooksDead(info);
}

}  // namespace coopdyn
