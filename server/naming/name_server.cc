// SPDX-License-Identifier: MIT
#include "server/naming/name_server.h"

#include <sys/socket.h>

#include <atomic>
#include <map>
#include <utility>

#include <boost/asio/io_context.hpp>

#include "server/naming/name_session.h"
#include "server/net/listener.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;

}  // namespace

struct NameServer::Impl {
  Impl(asio::io_context& c, NameTable& t, NetServices& s, std::string a)
      : context(c),
        table(t),
        services(s),
        advertise(std::move(a)),
        listener(c, s, [this](UniqueFd fd, PeerInfo peer) { Open(std::move(fd), std::move(peer)); }) {}

  void Open(UniqueFd fd, PeerInfo peer) {
    NameContext where{LocalAddress(fd.get()).ip, PeerAddress(fd.get()).ip, advertise};
    const bool v6 = where.asked_at.find(':') != std::string::npos;
    NameSession::Socket socket(context);
    boost::system::error_code error;
    socket.assign(NameSession::Socket::protocol_type(v6 ? AF_INET6 : AF_INET, IPPROTO_TCP), fd.get(), error);
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
  return impl_->listener.Listen(addresses, port);
}

int NameServer::port() const {
  return impl_->listener.port();
}

std::size_t NameServer::session_count() const {
  return impl_->count;
}

}  // namespace coopdyn
