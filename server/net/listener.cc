// SPDX-License-Identifier: MIT
#include "server/net/listener.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

namespace coopdyn {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;

constexpr int kAcceptsAtOnce = 64;  // then other handlers run
constexpr auto kRetryAfter = std::chrono::milliseconds(100);
constexpr int kFreePortTries = 32;

struct Place {
  sockaddr_storage address{};
  socklen_t size = 0;
  std::string text;  // as the user named it
};

struct Bound {
  UniqueFd fd;
  int error = 0;  // errno
};

/// Appends the places that `name` stands for. Returns an error text.
std::string Resolve(const std::string& name, std::vector<Place>& places) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(name.c_str(), "0", &hints, &found);
  if (error != 0) return "cannot listen at \"" + name + "\": " + gai_strerror(error);
  for (const addrinfo* it = found; it != nullptr; it = it->ai_next) {
    Place place;
    std::memcpy(&place.address, it->ai_addr, it->ai_addrlen);
    place.size = it->ai_addrlen;
    place.text = name;
    places.push_back(std::move(place));
  }
  freeaddrinfo(found);
  return {};
}

void SetPort(sockaddr_storage& address, int port) {
  // sin_port and sin6_port have the same offset.
  reinterpret_cast<sockaddr_in*>(&address)->sin_port = htons(static_cast<std::uint16_t>(port));
}

Bound Bind(Place place, int port) {
  SetPort(place.address, port);
  const int family = place.address.ss_family;
  UniqueFd fd(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, IPPROTO_TCP));
  if (!fd) return {{}, errno};
  const int on = 1;
  setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (family == AF_INET6) setsockopt(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&place.address), place.size) != 0 ||
      ::listen(fd.get(), SOMAXCONN) != 0) {
    return {{}, errno};
  }
  return {std::move(fd), 0};
}

bool IsMissingV6(const Place& place, int error) {
  return place.address.ss_family == AF_INET6 && (error == EAFNOSUPPORT || error == EADDRNOTAVAIL);
}

bool IsOutOfResources(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

std::string BindError(const Place& place, int port, int error) {
  if (error == EMFILE || error == ENFILE) return kTooManyFiles;
  std::string text = "port " + std::to_string(port) + " of " + place.text;
  if (error != EADDRINUSE) return text + ": " + std::strerror(error);
  const std::string holder = PortHolder(port);
  return text + " is in use" + (holder.empty() ? "" : " by " + holder);
}

// --- the owner of a port

constexpr const char* kListening = "0A";  // TCP_LISTEN in /proc/net/tcp

/// Adds the links that /proc/PID/fd shows for sockets that listen on `port`: "socket:[12345]".
void AddListeners(const char* table, int port, std::set<std::string>& sockets) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);  // the heading
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string slot, local, remote, state, queues, timer, retransmits, uid, timeout, inode;
    words >> slot >> local >> remote >> state >> queues >> timer >> retransmits >> uid >> timeout >> inode;
    const std::size_t colon = local.rfind(':');
    if (!words || state != kListening || colon == std::string::npos) continue;
    if (std::strtol(local.c_str() + colon + 1, nullptr, 16) == port) sockets.insert("socket:[" + inode + "]");
  }
}

bool HoldsOneOf(const fs::path& process, const std::set<std::string>& sockets) {
  std::error_code error;
  for (fs::directory_iterator it(process / "fd", error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;
    if (sockets.contains(fs::read_symlink(it->path(), gone).string())) return true;
  }
  return false;
}

}  // namespace

std::string PortHolder(int port) {
  std::set<std::string> sockets;
  AddListeners("/proc/net/tcp", port, sockets);
  AddListeners("/proc/net/tcp6", port, sockets);
  if (sockets.empty()) return {};
  std::error_code error;
  for (fs::directory_iterator it("/proc", error), end; !error && it != end; it.increment(error)) {
    const std::string pid = it->path().filename().string();
    if (std::isdigit(static_cast<unsigned char>(pid[0])) == 0 || !HoldsOneOf(it->path(), sockets)) continue;
    std::string name;
    std::ifstream comm(it->path() / "comm");
    std::getline(comm, name);
    return (name.empty() ? "a process" : name) + " (pid " + pid + ")";
  }
  return {};
}

bool IsPortFree(int port) {
  Place any;  // 0.0.0.0 is zeros
  any.address.ss_family = AF_INET;
  any.size = sizeof(sockaddr_in);
  return Bind(any, port).error != EADDRINUSE;
}

std::vector<std::string> ListenAddresses(const std::string& host) {
  if (host.empty() || host == "localhost" || host == "loopback" || host == "127.0.0.1") {
    return {"127.0.0.1", "::1"};
  }
  if (host == "0.0.0.0" || host == "::" || host == "any" || host == "*") return {"0.0.0.0", "::"};
  return {host};
}

struct Listener::Impl : std::enable_shared_from_this<Listener::Impl> {
  struct Port {
    Port(asio::io_context& context, int fd) : descriptor(context, fd), retry(context) {}
    asio::posix::stream_descriptor descriptor;
    asio::steady_timer retry;
  };

  Impl(asio::io_context& c, NetServices& s, AcceptFunction a)
      : context(c), services(s), on_accept(std::move(a)) {}

  void Close() {
    on_accept = nullptr;
    for (const std::shared_ptr<Port>& port : ports) {  // pending waits hold their port
      boost::system::error_code ignored;
      port->descriptor.close(ignored);
      port->retry.cancel();
    }
    ports.clear();
  }

  void Wait(const std::shared_ptr<Port>& port) {
    port->descriptor.async_wait(asio::posix::stream_descriptor::wait_read,
                                [self = shared_from_this(), port](const boost::system::error_code& error) {
                                  if (!error && self->on_accept) self->Accept(port);
                                });
  }

  void Accept(const std::shared_ptr<Port>& port) {
    for (int i = 0; i < kAcceptsAtOnce && on_accept; ++i) {
      UniqueFd fd(
          ::accept4(port->descriptor.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!fd) {
        if (errno == EAGAIN || errno == EWOULDBLOCK) break;
        if (IsOutOfResources(errno)) return RetryLater(port, errno);
        continue;  // the connection ended before it was accepted
      }
      SetClientSocketOptions(fd.get());
      PeerInfo peer = DescribePeer(fd.get());
      peer.trusted = peer.trusted && services.trusts_this_machine();
      if (!services.Admits(peer)) continue;
      on_accept(std::move(fd), std::move(peer));
    }
    if (on_accept) Wait(port);
  }

  void RetryLater(const std::shared_ptr<Port>& port, int error) {
    services.LogExhausted(std::string("cannot accept connections for now: ") + std::strerror(error));
    port->retry.expires_after(kRetryAfter);
    port->retry.async_wait([self = shared_from_this(), port](const boost::system::error_code& aborted) {
      if (!aborted && self->on_accept) self->Accept(port);
    });
  }

  asio::io_context& context;
  NetServices& services;
  AcceptFunction on_accept;  // empty: closed
  std::vector<std::shared_ptr<Port>> ports;
};

Listener::Listener(asio::io_context& context, NetServices& services, AcceptFunction on_accept)
    : impl_(std::make_shared<Impl>(context, services, std::move(on_accept))) {}

Listener::~Listener() {
  impl_->Close();
}

std::string Listener::Listen(const std::vector<std::string>& addresses, int port) {
  if (port < 0 || port > 65535) return "port " + std::to_string(port) + ": write 0 (any free one) to 65535";
  std::vector<Place> places;
  for (const std::string& address : addresses) {
    if (std::string error = Resolve(address, places); !error.empty()) return error;
  }
  std::string error = "no address to listen at";
  std::vector<UniqueFd> bound;
  for (int attempt = 0; attempt < kFreePortTries; ++attempt) {
    bound.clear();
    int common_port = port;
    bool taken = false;  // the port is free at the first address but not at another
    for (const Place& place : places) {
      Bound one = Bind(place, common_port);
      if (!one.fd) {
        error = BindError(place, common_port, one.error);
        if (IsMissingV6(place, one.error)) continue;
        taken = port == 0 && common_port != 0 && one.error == EADDRINUSE;
        if (!taken) return error;
        break;
      }
      common_port = LocalAddress(one.fd.get()).port;
      bound.push_back(std::move(one.fd));
    }
    if (taken) continue;
    if (bound.empty()) return error;
    port_ = common_port;
    Add(std::move(bound));
    return {};
  }
  return error;
}

std::string Listener::ListenLocal(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.size() + 1 > sizeof address.sun_path) return "the name of the unix socket is too long: " + name;
  std::memcpy(address.sun_path + 1, name.data(), name.size());  // the leading zero means the abstract
                                                                // namespace
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd || ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(fd.get(), SOMAXCONN) != 0)
    return "unix socket @" + name + ": " + std::strerror(errno);
  std::vector<UniqueFd> one;
  one.push_back(std::move(fd));
  Add(std::move(one));
  return {};
}

void Listener::Listen(std::vector<UniqueFd> listening, int port) {
  port_ = port;
  Add(std::move(listening));
}

std::vector<UniqueFd> Listener::Release() {
  std::vector<UniqueFd> listening;
  for (const std::shared_ptr<Impl::Port>& port : impl_->ports)
    listening.emplace_back(port->descriptor.release());
  impl_->Close();
  return listening;
}

void Listener::Add(std::vector<UniqueFd> listening) {
  std::vector<std::shared_ptr<Impl::Port>> added;
  for (UniqueFd& fd : listening) {
    added.push_back(std::make_shared<Impl::Port>(impl_->context, fd.get()));
    fd.Release();
  }
  impl_->ports.insert(impl_->ports.end(), added.begin(), added.end());
  asio::post(impl_->context, [impl = impl_, added = std::move(added)] {
    for (const std::shared_ptr<Impl::Port>& one : added) impl->Wait(one);
  });
}

}  // namespace coopdyn
