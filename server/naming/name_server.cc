// SPDX-License-Identifier: MIT
#include "server/naming/name_server.h"

#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>

#include <boost/asio/io_context.hpp>

#include "server/naming/name_session.h"
#include "server/net/listener.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;

constexpr const char* kLoopback = "127.0.0.1";

/// The usual loopback address, and at most that of IPv6 besides.
bool IsLoopbackOnly(const std::vector<std::string>& addresses) {
  return std::find(addresses.begin(), addresses.end(), kLoopback) != addresses.end() &&
         std::all_of(addresses.begin(), addresses.end(),
                     [](const std::string& address) { return address == kLoopback || address == "::1"; });
}

/// What is said to a client of the unix socket is as if it had come by loopback.
std::string IpOf(const SocketAddress& address) {
  return address.ip.empty() ? kLoopback : address.ip;
}

}  // namespace

struct NameServer::Impl {
  Impl(asio::io_context& c, NameTable& t, NetServices& s, std::string a)
      : context(c),
        table(t),
        services(s),
        advertise(std::move(a)),
        listener(c, s, [this](UniqueFd fd, PeerInfo peer) { Open(std::move(fd), std::move(peer)); }) {}

  void Open(UniqueFd fd, PeerInfo peer) {
    const SocketAddress here = LocalAddress(fd.get());
    NameContext where{IpOf(here), IpOf(PeerAddress(fd.get())), advertise};
    const bool local = here.ip.empty(), v6 = here.ip.find(':') != std::string::npos;
    NameSession::Socket socket(context);
    boost::system::error_code error;
    socket.assign(NameSession::Socket::protocol_type(local ? AF_UNIX
                                                     : v6  ? AF_INET6
                                                           : AF_INET,
                                                     local ? 0 : IPPROTO_TCP),
                  fd.get(), error);
    if (error) return services.logger()->error("names: cannot take a connection: {}", error.message());
    fd.Release();
    const std::uint64_t id = ++last_id;
    auto session = std::make_shared<NameSession>(std::move(socket), table, services, std::move(peer),
                                                 std::move(where), [this, id] {
                                                   sessions.erase(id);
                                                   count = sessions.size();
                                                 });
    sessions.emplace(id, session);
    count = sessions.size();
    session->Start();
  }

  void Close() {
    for (const auto& [id, session] : std::exchange(sessions, {})) session->Abort();
    count = 0;
  }

  asio::io_context& context;
  NameTable& table;
  NetServices& services;
  const std::string advertise;
  Listener listener;
  std::map<std::uint64_t, std::shared_ptr<NameSession>> sessions;
  std::uint64_t last_id = 0;
  std::atomic<std::size_t> count{0};
};

NameServer::NameServer(asio::io_context& context, NameTable& table, NetServices& services,
                       std::string advertise)
    : impl_(std::make_shared<Impl>(context, table, services, std::move(advertise))) {}

NameServer::~NameServer() {
  impl_->Close();
}

std::string NameServer::Listen(const std::vector<std::string>& addresses, int port) {
  std::string error = impl_->listener.Listen(addresses, port);
  if (!error.empty() || !IsLoopbackOnly(addresses)) return error;
  const std::string missing = impl_->listener.ListenLocal(LocalName(impl_->listener.port()));
  if (!missing.empty()) impl_->services.logger()->info("{}; programs of this machine use TCP", missing);
  return {};
}

int NameServer::port() const {
  return impl_->listener.port();
}

std::size_t NameServer::session_count() const {
  return impl_->count;
}

}  // namespace coopdyn
