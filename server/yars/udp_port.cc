// SPDX-License-Identifier: MIT
#include "server/yars/udp_port.h"

#include <array>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <boost/asio/ip/udp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>

#include "protocol/module_tables.h"
#include "server/net/peer.h"
#include "server/net/turn.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using std::chrono::steady_clock;

constexpr std::chrono::seconds kWatch{2};

constexpr const char* kGone =
    "this port's robot has been removed: the experiment has changed; a reset reads its file again";

/// Replaces a robot that has been removed.
class NoRobot final : public Endpoint {
 public:
  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return table_; }
  void OnRequest(Connection& /*connection*/, Message request, ReplyFunction reply) override {
    reply(ErrorReply(request.command, Error::kNoSuchName, kGone));
  }

 private:
  const std::string path_;
  const CommandTable table_ = ChannelTable();
};

std::string ToText(const udp::endpoint& peer) {
  return ToString(SocketAddress{peer.address().to_string(), peer.port(), peer.address().is_loopback()});
}

}  // namespace

/// The client of a port.
struct YarsPorts::Client {
  udp::endpoint peer;
  std::string peer_text;
  steady_clock::time_point heard;
  YarsUdpTalk talk;
  bool trouble_logged = false;
};

/// State that a removed robot leaves to the next one on its port. Waiting datagrams stay in the sockets.
struct YarsPorts::Left {
  std::vector<std::pair<udp, UniqueFd>> sockets;
  std::optional<Client> client;
};

struct YarsPorts::Shared {
  Mutex mutex;
  std::map<int, std::weak_ptr<YarsUdpPort::Impl>> ports GUARDED_BY(mutex);

  std::shared_ptr<YarsUdpPort::Impl> Find(int port) {
    const MutexLock lock(mutex);
    const auto found = ports.find(port);
    return found == ports.end() ? nullptr : found->second.lock();
  }
};

YarsPorts::YarsPorts(YarsWorld& world, IoThread& control, NetServices& net)
    : world_(world),
      control_(control),
      net_(net),
      shared_(std::make_shared<Shared>()),
      nobody_(std::make_unique<NoRobot>()) {}

YarsPorts::~YarsPorts() = default;

YarsPorts::Left YarsPorts::TakeLeft(int port) {
  vacant_.erase(port);  // this also fills left_
  auto found = left_.extract(port);
  return found.empty() ? Left() : std::move(found.mapped());
}

void YarsPorts::Vacate(const std::vector<std::string>& addresses, int port) {
  std::string error;
  auto vacant = YarsUdpPort::Open({}, *nobody_, control_, net_, *this, addresses, port, error);
  if (vacant != nullptr) vacant_[port] = std::move(vacant);
}

/// Used only on the robot's thread, in its turn.
class YarsUdpPort::Impl final : public std::enable_shared_from_this<Impl>, private Connection {
 public:
  Impl(std::string robot, Endpoint& channel, IoThread& io, NetServices& net, YarsPorts& ports)
      : robot_(std::move(robot)),
        channel_(channel),
        net_(net),
        owner_(ports),
        ports_(ports.shared_),
        world_(ports.world()),
        poster_(io.poster()),
        turn_(Turn::Of(io.context())),
        context_(io.context()),
        watch_(io.context()) {}

  std::string Listen(const std::vector<std::string>& addresses, int port) {
    port_ = port;
    YarsPorts::Left left = owner_.TakeLeft(port);
    client_ = std::move(left.client);
    for (auto& [protocol, fd] : left.sockets) {
      auto socket = std::make_unique<udp::socket>(context_);
      error_code failed;
      socket->assign(protocol, fd.Release(), failed);
      if (!failed) socket->non_blocking(true, failed);
      sockets_.push_back(std::move(socket));
    }
    if (!sockets_.empty()) return {};
    for (const std::string& text : addresses) {
      error_code failed;
      const asio::ip::address address = asio::ip::make_address(text, failed);
      if (failed) continue;
      auto socket = std::make_unique<udp::socket>(context_);
      socket->open(address.is_v6() ? udp::v6() : udp::v4(), failed);
      if (!failed && address.is_v6()) socket->set_option(asio::ip::v6_only(true), failed);
      if (!failed) socket->bind({address, static_cast<std::uint16_t>(port)}, failed);
      if (!failed) socket->non_blocking(true, failed);
      namespace errc = boost::system::errc;
      const bool is_missing =
          failed == errc::address_not_available || failed == errc::address_family_not_supported;
      if (failed && is_missing) continue;
      if (failed) return "UDP port " + std::to_string(port) + " of " + text + ": " + failed.message();
      sockets_.push_back(std::move(socket));
    }
    return sockets_.empty() ? "no address for UDP port " + std::to_string(port) : "";
  }

  void Start() {
    {
      const MutexLock lock(ports_->mutex);
      ports_->ports[port_] = weak_from_this();
    }
    if (client_) {
      Begin();
      Perform(client_->talk.MoveOn());
    }
    for (const auto& socket : sockets_) Wait(*socket);
  }

  void Close() {
    {
      const MutexLock lock(ports_->mutex);
      ports_->ports.erase(port_);
    }
    YarsPorts::Left left{.sockets = {}, .client = client_};
    Leave();
    for (const auto& socket : sockets_) {
      error_code ignored;
      const udp protocol = socket->local_endpoint(ignored).protocol();
      left.sockets.emplace_back(protocol, UniqueFd(socket->release(ignored)));
    }
    closed_ = true;
    owner_.left_.insert_or_assign(port_, std::move(left));
  }

 private:
  // Connection
  ClientId id() const override { return id_; }
  const std::string& peer() const override { return client_ ? client_->peer_text : nobody_; }
  bool trusted() const override {
    return net_.trusts_this_machine() && client_ && client_->peer.address().is_loopback();
  }
  bool input_ended() const override { return false; }
  bool output_ended() const override { return false; }
  bool Push(const UnaskedPtr& /*message*/, std::int64_t /*dropped*/) override { return true; }
  void Close(const std::string& reason) override {
    Say(spdlog::level::info, reason);
    Post([](Impl& self) { self.Leave(); });
  }

  bool is_vacant() const { return robot_.empty(); }

  template <typename Work>
  void Post(Work work) {
    poster_([weak = weak_from_this(), work = std::move(work)]() mutable {
      if (const auto self = weak.lock(); self != nullptr && !self->closed_) work(*self);
    });
  }

  void Say(spdlog::level::level_enum level, const std::string& text) {
    const std::string where = is_vacant() ? "" : "/" + robot_ + "/channel by ";
    net_.LogPeer(level, peer(), where + "UDP: " + text);
  }

  void Wait(udp::socket& socket) {
    socket.async_wait(udp::socket::wait_read, [self = shared_from_this(), &socket](const error_code& failed) {
      if (failed || self->closed_) return;
      self->turn_.Run([&] { self->Receive(socket); });
      if (!self->closed_) self->Wait(socket);
    });
  }

  void Receive(udp::socket& socket) {
    constexpr int kAtOnce = 64;
    for (int i = 0; i < kAtOnce && !closed_; ++i) {
      std::array<char, 2 * YarsUdpTalk::kMaxDatagram> bytes;
      udp::endpoint from;
      error_code failed;
      const std::size_t count = socket.receive_from(asio::buffer(bytes), from, 0, failed);
      if (failed == asio::error::would_block) return;
      if (failed) continue;  // an error of an earlier datagram
      if (PeerInfo peer{.text = ToText(from)}; net_.Admits(peer)) Take({bytes.data(), count}, from, socket);
    }
  }

  void Take(std::string_view datagram, const udp::endpoint& from, udp::socket& socket) {
    const auto now = steady_clock::now();
    const bool says_who = datagram.size() == 1;
    if (client_ && from != client_->peer) {
      if (says_who) return;
      // A silent client may have gone; there is no other sign of that.
      constexpr std::chrono::seconds kMayGo{2};
      if (now - client_->heard < kMayGo || client_->talk.waits())
        return Send(YarsUdpTalk::Refusal(YarsDrivenText(robot_, client_->peer_text)), from, socket);
      Say(spdlog::level::info, "silent, " + ToText(from) + " takes its place");
      Leave();
    }
    if (!client_) {
      client_ = YarsPorts::Client{.peer = from, .peer_text = ToText(from), .heard = now, .talk = {}};
      Begin();
    }
    client_->heard = now;
    if (!says_who && net_.read_only()) return Send(YarsUdpTalk::Refusal(kReadOnlyText), from, socket);
    Perform(client_->talk.Take(datagram));
  }

  void Begin() {
    id_ = net_.NextClient();
    channel_.OnOpen(*this);
    Watch();
  }

  /// Removes the client.
  void Leave() {
    if (!client_) return;
    channel_.OnInputEnded(*this);
    channel_.OnClosed(*this);
    client_.reset();
    ++serial_;
    watch_.cancel();
  }

  void Watch() {
    watch_.expires_after(kWatch);
    watch_.async_wait([self = shared_from_this()](const error_code& failed) {
      if (failed || self->closed_) return;
      self->turn_.Run([&] {
        if (!self->client_) return;
        const bool is_silent = steady_clock::now() - self->client_->heard > ConnectionEnd::kDatagramSilence;
        if (is_silent && !self->client_->talk.waits()) {
          self->Say(spdlog::level::info, "silent for 10 s: the client counts as gone");
          return self->Leave();
        }
        self->Watch();
      });
    });
  }

  /// Replaces the action's order while another client drives the robot.
  void KeepFromOthers(YarsUdpTalk::Action& action) {
    while (action.order) {
      const bool quits = action.order->kind == YarsOrder::Kind::kQuit;
      if (quits && !world_.quits()) return;
      const std::string driver = channel_.DriverBeside(*this);
      if (driver.empty()) return;
      action = client_->talk.Denied(std::move(action), YarsDrivenText(robot_, driver));
    }
  }

  void Perform(YarsUdpTalk::Action action) {
    while (true) {
      KeepFromOthers(action);
      if (!action.trouble.empty() && !std::exchange(client_->trouble_logged, true))
        Say(spdlog::level::warn, action.trouble);
      for (const std::string& datagram : action.datagrams)
        Send(datagram, client_->peer, SocketFor(client_->peer));
      if (action.order) Ask(*std::move(action.order));
      if (action.leaves) return Leave();
      if (!action.request) return;
      // Handles immediate replies in this loop, so a chain of replies does not grow the stack.
      answer_.reset();
      asking_ = true;
      channel_.OnRequest(*this, *std::move(action.request),
                         [weak = weak_from_this(), serial = ++serial_](const Message& reply) {
                           const auto self = weak.lock();
                           if (self == nullptr || self->closed_ || serial != self->serial_) return;
                           if (self->asking_) {
                             self->answer_ = reply;
                           } else {
                             self->client_->heard = steady_clock::now();
                             self->Perform(self->client_->talk.Answer(reply));
                           }
                         });
      asking_ = false;
      if (!answer_ || !client_) return;
      action = client_->talk.Answer(*std::exchange(answer_, std::nullopt));
    }
  }

  void Ask(YarsOrder order) {
    world_.Ask(std::move(order), *this,
               [ports = ports_, number = port_, peer = client_->peer](const Message& reply) {
                 if (const auto port = ports->Find(number); port != nullptr)
                   port->Post([peer, reply](Impl& self) { self.Resume(peer, reply); });
               });
  }

  /// The world has answered. The robot and this port may be new since the order.
  void Resume(const udp::endpoint& peer, const Message& reply) {
    if (!client_ || client_->peer != peer || !client_->talk.waits()) return;
    client_->heard = steady_clock::now();
    const bool is_gone = is_vacant() && reply.error == 0;
    Perform(client_->talk.Done(is_gone ? ErrorReply(0, Error::kNoSuchName, kGone) : reply));
  }

  udp::socket& SocketFor(const udp::endpoint& peer) {
    for (const auto& socket : sockets_) {
      error_code ignored;
      if (socket->local_endpoint(ignored).address().is_v6() == peer.address().is_v6()) return *socket;
    }
    return *sockets_.front();
  }

  static void Send(const std::string& datagram, const udp::endpoint& to, udp::socket& socket) {
    error_code lost;  // may be lost: the client asks again
    socket.send_to(asio::buffer(datagram), to, 0, lost);
  }

  const std::string robot_;  // empty: the robot has been removed
  int port_ = 0;
  Endpoint& channel_;
  NetServices& net_;
  YarsPorts& owner_;
  const std::shared_ptr<YarsPorts::Shared> ports_;
  YarsWorld& world_;
  const IoThread::Poster poster_;
  Turn& turn_;
  asio::io_context& context_;
  std::vector<std::unique_ptr<udp::socket>> sockets_;
  asio::steady_timer watch_;
  bool closed_ = false;
  const std::string nobody_;
  std::optional<YarsPorts::Client> client_;
  ClientId id_ = 0;           // of client_
  std::uint64_t serial_ = 0;  // of the pending request
  bool asking_ = false;
  std::optional<Message> answer_;  // a reply that arrived during OnRequest()
};

YarsUdpPort::YarsUdpPort(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::unique_ptr<YarsUdpPort> YarsUdpPort::Open(std::string robot, Endpoint& channel, IoThread& io,
                                               NetServices& net, YarsPorts& ports,
                                               const std::vector<std::string>& addresses, int port,
                                               std::string& error) {
  auto impl = std::make_shared<Impl>(std::move(robot), channel, io, net, ports);
  error = impl->Listen(addresses, port);
  if (!error.empty()) return nullptr;
  io.Call([&impl] { impl->Start(); });
  return std::unique_ptr<YarsUdpPort>(new YarsUdpPort(std::move(impl)));
}

YarsUdpPort::~YarsUdpPort() {
  impl_->Close();
}

}  // namespace coopdyn
