// SPDX-License-Identifier: MIT
#include "server/net/module_server.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/net/listener.h"
#include "server/net/session.h"
#include "server/net/turn.h"
#include "server/net/unique_fd.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;

constexpr auto kSweepPeriod = std::chrono::seconds(4);  // keepalive's 20 s + this < 25 s

}  // namespace

struct ModuleServer::Impl : std::enable_shared_from_this<ModuleServer::Impl> {
  /// Passes a connection to the server's thread; closes it if the server is gone. Any thread.
  using Sender = std::function<void(DetachedConnection)>;

  Impl(IoThread& thread, Endpoint& e, NetServices& s, std::string n)
      : io(thread),
        context(io.context()),
        turn(Turn::Of(context)),
        poster(io.poster()),
        endpoint(e),
        services(s),
        name(std::move(n)),
        listener(context, s,
                 [this](UniqueFd fd, PeerInfo peer) {
                   turn.Run([&] { Open({.fd = std::move(fd), .peer = std::move(peer)}); });
                 }),
        sweep_timer(context) {}

  Sender sender() {
    return [post = poster, weak = weak_from_this()](DetachedConnection arrival) {
      post([weak, held = std::make_shared<DetachedConnection>(std::move(arrival))] {
        const std::shared_ptr<Impl> impl = weak.lock();
        if (impl && !impl->closed) impl->Open(std::move(*held));
      });
    };
  }

  void Open(DetachedConnection arrival) {
    const std::optional<ConnectionEnd> end = EndOf(arrival.fd.get());
    if (!end) {
      return services.logger()->error("{}: cannot take a connection: neither a stream nor datagrams", name);
    }
    SetClientSocketOptions(arrival.fd.get());
    Session::Socket socket(context);
    boost::system::error_code error;
    socket.assign(Session::AnyProtocol(), arrival.fd.get(), error);
    if (error) return services.logger()->error("{}: cannot take a connection: {}", name, error.message());
    arrival.fd.Release();
    if (!arrival.peer.trusted) Sweep();
    auto session = std::make_shared<Session>(context, std::move(socket), *end, endpoint, services, poster,
                                             arrival.peer, [this](ClientId id) { Forget(id); });
    sessions.emplace(session->id(), session);
    count = sessions.size();
    session->Start(std::move(arrival));
  }

  void Forget(ClientId id) {
    sessions.erase(id);
    count = sessions.size();
  }

  void Sweep() {
    if (std::exchange(sweeping, true)) return;
    sweep_timer.expires_after(kSweepPeriod);
    sweep_timer.async_wait([weak = weak_from_this()](const boost::system::error_code& aborted) {
      const std::shared_ptr<Impl> impl = weak.lock();
      if (!aborted && impl) impl->turn.Run([&] { impl->CheckPeers(); });
    });
  }

  void CheckPeers() {
    if (closed) return;
    sweeping = false;
    bool untrusted = false;
    for (const auto& [id, session] : sessions) {
      untrusted = untrusted || !session->trusted();
      session->CheckPeerLives();
    }
    if (untrusted) Sweep();
  }

  /// Makes the sessions that may leave call `done`. Returns their number. Io thread.
  std::size_t SendAway(const std::function<void(DetachedConnection)>& done) {
    std::vector<std::shared_ptr<Session>> leaving;
    for (const auto& [id, session] : sessions) {
      if (session->may_leave()) leaving.push_back(session);
    }
    for (const auto& session : leaving) session->Leave(done);
    return leaving.size();
  }

  void Close() {
    closed = true;
    sweep_timer.cancel();
    for (const auto& [id, session] : std::exchange(sessions, {})) session->Abort("the module is closed");
    count = 0;
  }

  IoThread& io;
  asio::io_context& context;
  Turn& turn;
  const IoThread::Poster poster;
  Endpoint& endpoint;
  NetServices& services;
  const std::string name;
  Listener listener;
  asio::steady_timer sweep_timer;
  std::map<ClientId, std::shared_ptr<Session>> sessions;
  std::atomic<std::size_t> count{0};
  bool sweeping = false;
  bool closed = false;
};

ModuleServer::ModuleServer(IoThread& io, Endpoint& endpoint, NetServices& services, std::string name)
    : impl_(std::make_shared<Impl>(io, endpoint, services, std::move(name))) {}

ModuleServer::~ModuleServer() {
  impl_->Close();
}

std::string ModuleServer::Listen(const std::vector<std::string>& addresses, int port) {
  return impl_->listener.Listen(addresses, port);
}

void ModuleServer::Listen(LoosePort port) {
  impl_->listener.Listen(std::move(port.listening), port.port);
  for (DetachedConnection& connection : port.connections) impl_->sender()(std::move(connection));
}

LoosePort ModuleServer::Release() {
  LoosePort released{.port = port()};
  Mutex mutex;
  ConditionVariable one_more;
  std::vector<DetachedConnection>& connections = released.connections;
  std::size_t all = 0;
  const auto add = [&](DetachedConnection connection) {
    const MutexLock lock(mutex);
    connections.push_back(std::move(connection));
    one_more.NotifyAll();
  };
  impl_->io.Call([&] {
    released.listening = impl_->listener.Release();
    all = impl_->SendAway(add);
  });
  {
    const MutexLock lock(mutex);
    while (connections.size() < all) one_more.Wait(mutex);
  }
  std::erase_if(connections, [](const DetachedConnection& each) { return !each.fd; });
  return released;
}

int ModuleServer::port() const {
  return impl_->listener.port();
}

const std::string& ModuleServer::name() const {
  return impl_->name;
}

void ModuleServer::Adopt(int fd, std::string already_read, PeerInfo peer,
                         std::unique_ptr<Encoding> encoding) {
  adopter()(fd, std::move(already_read), std::move(peer), std::move(encoding));
}

AdoptFunction ModuleServer::adopter() const {
  return [send = impl_->sender()](int fd, std::string already_read, PeerInfo peer,
                                  std::unique_ptr<Encoding> encoding) {
    send({UniqueFd(fd), std::move(already_read), std::move(peer), std::move(encoding)});
  };
}

void ModuleServer::CloseAll(const std::string& reason) {
  for (const auto& [id, session] : impl_->sessions) session->Close(reason);
}

std::size_t ModuleServer::session_count() const {
  return impl_->count;
}

}  // namespace coopdyn
