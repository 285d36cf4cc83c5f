// SPDX-License-Identifier: MIT
#include "server/naming/name_server.h"

#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "server/naming/name_talk.h"
#include "server/net/await.h"
#include "server/net/listener.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Socket = asio::generic::stream_protocol::socket;

constexpr std::string_view kMagicFamily = "CDS";
constexpr std::size_t kMaxLineBytes = 4096;
constexpr std::size_t kMaxUnwritten = std::size_t{64} << 10;
constexpr std::chrono::seconds kLinger{5};
constexpr const char* kLoopback = "127.0.0.1";

/// True for the IPv4 loopback address, with or without IPv6's.
bool IsLoopbackOnly(const std::vector<std::string>& addresses) {
  return std::find(addresses.begin(), addresses.end(), kLoopback) != addresses.end() &&
         std::all_of(addresses.begin(), addresses.end(),
                     [](const std::string& address) { return address == kLoopback || address == "::1"; });
}

/// Clients of the unix socket count as loopback.
std::string IpOf(const SocketAddress& address) {
  return address.ip.empty() ? kLoopback : address.ip;
}

/// A connection not yet passed on to a module.
struct Client {
  Socket socket;
  const PeerInfo peer;
  NameContext context;
  std::string in = {};
  bool first_bytes = true;
  std::optional<NameTalk> talk = {};  // set if it speaks to a YARP port
};

NameReply TooLong() {
  NameReply reply{"error 8 a line has at most " + std::to_string(kMaxLineBytes) + " bytes\n"};
  reply.close = true;
  return reply;
}

NameReply AnswerLine(std::string_view line, Client& client, NameTable& table) {
  if (client.talk) return client.talk->Answer(line, client.context, table);
  client.talk = NameTalk::Begin(line);
  return client.talk ? NameReply{client.talk->Welcome()} : AnswerNameLine(line, client.context, table);
}

/// Answers the complete lines received, as one reply: up to a line that closes the connection or opens a
/// module, and up to kMaxUnwritten bytes.
NameReply AnswerLines(Client& client, NameTable& table, const Clock& clock) {
  NameReply all;
  const auto add = [&all](NameReply reply) {
    reply.text.swap(all.text);
    reply.text += all.text;
    all = std::move(reply);
  };
  std::string& in = client.in;
  if (client.first_bytes && in.starts_with(kMagicFamily)) {
    add(AnswerMagic(table));
  } else if (!kMagicFamily.starts_with(in)) {
    client.first_bytes = false;
  }
  const auto may_continue = [&all] { return !all.close && !all.open && all.text.size() < kMaxUnwritten; };
  std::size_t begin = 0;
  for (std::size_t end = 0; may_continue() && (end = in.find('\n', begin)) != std::string::npos;
       begin = end + 1) {
    const std::string_view line = std::string_view(in).substr(begin, end - begin);
    client.context.now = clock.Now();
    add(line.size() > kMaxLineBytes ? TooLong() : AnswerLine(line, client, table));
  }
  in.erase(0, begin);
  if (may_continue() && in.size() > kMaxLineBytes && in.find('\n') == std::string::npos) add(TooLong());
  return all;
}

}  // namespace

struct NameServer::Impl : std::enable_shared_from_this<NameServer::Impl> {
  Impl(asio::io_context& c, NameTable& t, NetServices& s, std::string a, NameHooks h)
      : context(c),
        table(t),
        services(s),
        advertise(std::move(a)),
        hooks(std::move(h)),
        listener(c, s, [this](UniqueFd fd, PeerInfo peer) { Open(std::move(fd), std::move(peer)); }) {}

  void Open(UniqueFd fd, PeerInfo peer, std::string already_read = {}) {
    NameContext where{IpOf(LocalAddress(fd.get())),
                      IpOf(PeerAddress(fd.get())),
                      advertise,
                      0,
                      services.read_only(),
                      &hooks};
    auto client = std::make_shared<Client>(
        Client{Socket(context), std::move(peer), std::move(where), std::move(already_read)});
    error_code error;
    client->socket.assign({AF_UNSPEC, 0}, fd.get(), error);  // Asio wants a protocol; nothing here uses it
    if (error) return services.logger()->error("names: cannot take a connection: {}", error.message());
    fd.Release();
    clients.insert(client);
    count = clients.size();
    if (serves) Serve(client);
  }

  void Serve(const std::shared_ptr<Client>& client) {
    asio::co_spawn(context, Talk(client),
                   [weak = weak_from_this(), client](const std::exception_ptr& thrown) {
                     if (const auto impl = weak.lock()) impl->Forget(client);
                     if (thrown) std::rethrow_exception(thrown);  // the thread logs it
                   });
  }

  /// Reads lines and sends answers one after the other, until the client leaves, is disconnected, or OPEN
  /// passes it on. *this lives at least as long as the client's socket is open.
  asio::awaitable<void> Talk(std::shared_ptr<Client> client) {
    Socket& socket = client->socket;
    char block[1024];
    NameReply reply;
    for (bool read = client->in.empty(); !reply.close; read = true) {
      if (read) {
        const auto [ended, count] = co_await socket.async_read_some(asio::buffer(block), kAwait);
        if (ended || !socket.is_open()) co_return;
        client->in.append(block, count);
      }
      do {
        reply = AnswerLines(*client, table, services.clock());
        const auto [failed, written] = co_await asio::async_write(socket, asio::buffer(reply.text), kAwait);
        if (failed || !socket.is_open()) co_return;
        if (reply.open) co_return GiveAway(*client, reply);
      } while (!reply.close && client->in.find('\n') != std::string::npos);
    }
    // Closing with unread input would make the kernel throw the answer away.
    error_code error;
    socket.shutdown(Socket::shutdown_send, error);
    asio::steady_timer limit(context, kLinger);
    limit.async_wait([client](const error_code& aborted) {
      error_code ignored;
      if (!aborted) client->socket.cancel(ignored);
    });
    while (!error)
      std::tie(error, std::ignore) = co_await socket.async_read_some(asio::buffer(block), kAwait);
  }

  void GiveAway(Client& client, const NameReply& reply) const {
    error_code error;
    const int fd = client.socket.release(error);
    if (error) return;
    services.LogPeer(spdlog::level::debug, client.peer.text, "opens " + reply.opened);
    reply.open(fd, std::move(client.in), client.peer, nullptr);
  }

  void Forget(const std::shared_ptr<Client>& client) {
    error_code ignored;
    client->socket.close(ignored);
    clients.erase(client);
    count = clients.size();
  }

  asio::io_context& context;
  NameTable& table;
  NetServices& services;
  const std::string advertise;
  const NameHooks hooks;
  Listener listener;
  bool serves = false;  // io thread
  std::set<std::shared_ptr<Client>> clients;
  std::atomic<std::size_t> count{0};
};

NameServer::NameServer(asio::io_context& context, NameTable& table, NetServices& services,
                       std::string advertise, NameHooks hooks)
    : impl_(std::make_shared<Impl>(context, table, services, std::move(advertise), std::move(hooks))) {}

NameServer::~NameServer() {
  for (const auto& client : impl_->clients) {
    error_code ignored;
    client->socket.close(ignored);
  }
}

std::string NameServer::Listen(const std::vector<std::string>& addresses, int port) {
  std::string error = impl_->listener.Listen(addresses, port);
  if (!error.empty() || !IsLoopbackOnly(addresses) || impl_->services.admits_only_known()) return error;
  const std::string missing = impl_->listener.ListenLocal(LocalName(impl_->listener.port()));
  if (!missing.empty()) impl_->services.logger()->info("{}; programs of this machine use TCP", missing);
  return {};
}

void NameServer::Serve() {
  asio::post(impl_->context, [weak = std::weak_ptr(impl_)] {
    const auto impl = weak.lock();
    if (impl == nullptr) return;
    impl->serves = true;
    for (const auto& client : impl->clients) impl->Serve(client);
  });
}

void NameServer::Adopt(UniqueFd fd, PeerInfo peer, std::string already_read) {
  SetClientSocketOptions(fd.get());
  impl_->Open(std::move(fd), std::move(peer), std::move(already_read));
}

int NameServer::port() const {
  return impl_->listener.port();
}

std::size_t NameServer::session_count() const {
  return impl_->count;
}

}  // namespace coopdyn
