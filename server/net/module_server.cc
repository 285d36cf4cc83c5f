// SPDX-License-Identifier: MIT
#include "server/net/module_server.h"

#include <atomic>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/base/mutex.h"
#include "server/net/listener.h"
#include "server/net/session.h"
#include "server/net/unique_fd.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;

constexpr auto kSweepPeriod = std::chrono::seconds(4);  // keepalive's 20 s + this < 25 s

}  // namespace

struct ModuleServer::Impl : std::enable_shared_from_this<ModuleServer::Impl> {
  /// What adopters hold: leads to the server while it lives.
  struct Gate {
    Mutex mutex;
    Impl* impl GUARDED_BY(mutex) = nullptr;
  };

  Impl(asio::io_context& c, Endpoint& e, NetServices& s, std::string n)
      : context(c),
        endpoint(e),
        services(s),
        name(std::move(n)),
        gate(std::make_shared<Gate>()),
        listener(c, s, [this](UniqueFd fd, PeerInfo peer) { Open(std::move(fd), {}, std::move(peer)); }),
        sweep_timer(c) {
    MutexLock lock(gate->mutex);
    gate->impl = this;
  }

  static void Adopt(const std::shared_ptr<Gate>& gate, UniqueFd fd, std::string already_read, PeerInfo peer,
                    std::unique_ptr<Encoding> encoding = nullptr) {
    MutexLock lock(gate->mutex);
    if (gate->impl == nullptr) return;
    // `work` only waits in the queue here: the lock keeps the io_context from going away.
    asio::post(gate->impl->context, [weak = gate->impl->weak_from_this(), fd = std::move(fd),
                                     already_read = std::move(already_read), peer = std::move(peer),
                                     encoding = std::move(encoding)]() mutable {
      const std::shared_ptr<Impl> impl = weak.lock();
      if (impl && !impl->closed)
        impl->Open(std::move(fd), already_read, std::move(peer), std::move(encoding));
    });
  }

  void Open(UniqueFd fd, const std::string& already_read, PeerInfo peer,
            std::unique_ptr<Encoding> encoding = nullptr) {
    const std::optional<ConnectionEnd> end = EndOf(fd.get());
    if (!end) {
      return services.logger()->error("{}: cannot take a connection: neither a stream nor datagrams", name);
    }
    SetClientSocketOptions(fd.get());
    if (!peer.trusted) Sweep();
    auto session = std::make_shared<Session>(context, std::move(fd), *end, endpoint, services,
                                             std::move(peer), [this](ClientId id) { Forget(id); });
    sessions.emplace(session->id(), session);
    count = sessions.size();
    session->Start(already_read, std::move(encoding));
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
      if (aborted || !impl || impl->closed) return;
      impl->sweeping = false;
      bool untrusted = false;
      for (const auto& [id, session] : impl->sessions) {
        untrusted = untrusted || !session->trusted();
        session->CheckPeerLives();
      }
      if (untrusted) impl->Sweep();
    });
  }

  void Close() {
    {
      MutexLock lock(gate->mutex);
      gate->impl = nullptr;
    }
    closed = true;
    sweep_timer.cancel();
    for (const auto& [id, session] : std::exchange(sessions, {})) session->Abort("the module is closed");
    count = 0;
  }

  asio::io_context& context;
  Endpoint& endpoint;
  NetServices& services;
  const std::string name;
  const std::shared_ptr<Gate> gate;
  Listener listener;
  asio::steady_timer sweep_timer;
  std::map<ClientId, std::shared_ptr<Session>> sessions;
  std::atomic<std::size_t> count{0};
  bool sweeping = false;
  bool closed = false;
};

ModuleServer::ModuleServer(asio::io_context& context, Endpoint& endpoint, NetServices& services,
                           std::string name)
    : impl_(std::make_shared<Impl>(context, endpoint, services, std::move(name))) {}

ModuleServer::~ModuleServer() {
  impl_->Close();
}

std::string ModuleServer::Listen(const std::vector<std::string>& addresses, int port) {
  return impl_->listener.Listen(addresses, port);
}

int ModuleServer::port() const {
  return impl_->listener.port();
}

const std::string& ModuleServer::name() const {
  return impl_->name;
}

void ModuleServer::Adopt(int fd, std::string already_read, PeerInfo peer,
                         std::unique_ptr<Encoding> encoding) {
  Impl::Adopt(impl_->gate, UniqueFd(fd), std::move(already_read), std::move(peer), std::move(encoding));
}

AdoptFunction ModuleServer::adopter() const {
  return [gate = impl_->gate](int fd, std::string already_read, PeerInfo peer) {
    Impl::Adopt(gate, UniqueFd(fd), std::move(already_read), std::move(peer));
  };
}

void ModuleServer::CloseAll(const std::string& reason) {
  for (const auto& [id, session] : impl_->sessions) session->Close(reason);
}

std::size_t ModuleServer::session_count() const {
  return impl_->count;
}

}  // namespace coopdyn
