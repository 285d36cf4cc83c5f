// SPDX-License-Identifier: MIT
#include "server/yarp/network.h"

#include <chrono>
#include <cstdint>
#include <exception>
#include <sstream>
#include <string_view>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "protocol/command_ids.h"
#include "server/base/mutex.h"
#include "server/naming/name_client.h"
#include "server/net/dialled.h"
#include "server/net/io_thread.h"
#include "server/net/unique_fd.h"
#include "server/yarp/carrier.h"
#include "server/yarp/stream.h"
#include "server/yarp/target.h"
#include "server/yarp/udp_relay.h"
#include "server/yarp/world_interface.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using asio::use_awaitable;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::system_error;

constexpr std::chrono::seconds kConnectWithin{3}, kProbeWithin{1}, kLookAfterSender{3};
constexpr int kSendBuffer = 64 << 10;  // samples in the kernel's buffer become stale

struct Address {
  std::string host;
  int port = 0;
};

/// True for addresses that only programs on this machine or network link can have.
bool IsInside(const asio::ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return IsInside(asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()));
  constexpr unsigned kLinkLocal = 0xa9fe;  // 169.254
  const bool link =
      address.is_v4() ? address.to_v4().to_uint() >> 16 == kLinkLocal : address.to_v6().is_link_local();
  return link || address.is_loopback() || address.is_unspecified() || address.is_multicast();
}

Message Refusal(const std::string& why) {
  return ErrorReply(command::kUnreadable, Error::kNotPossible, why + "\r\n");
}

}  // namespace

struct YarpNetwork::Impl : std::enable_shared_from_this<YarpNetwork::Impl> {
  Impl(NameTable& n, Logger l, YarpNetworkOptions o)
      : names(n), logger(std::move(l)), options(std::move(o)) {}

  /// Null after Stop().
  asio::io_context* Context() {
    const MutexLock lock(mutex);
    if (!stopped && thread == nullptr) thread = std::make_unique<IoThread>("yarp", logger);
    return stopped ? nullptr : &thread->context();
  }

  asio::awaitable<void> Add(asio::io_context& context, std::string from, std::string address,
                            YarpStream stream, YarpAsker asker, ReplyFunction done) {
    const YarpTarget target = ParseYarpTarget(address);
    const std::string problem = co_await Open(context, from, target, stream, asker);
    Message reply;
    reply.text = "Added connection from " + from + " to " + address + "\r\n";
    done(problem.empty() ? std::move(reply) : Refusal(problem));
  }

  /// Returns an error text.
  asio::awaitable<std::string> Open(asio::io_context& context, const std::string& from,
                                    const YarpTarget& target, YarpStream stream, YarpAsker asker) {
    if (!target.problem.empty())
      co_return "Cannot connect to " + target.name + " by " + target.carrier_words + ": " + target.problem;
    std::string why;
    try {
      const Address address = co_await Find(context, target.name, asker);
      if (address.port == 0) co_return "Do not know how to connect to " + target.name;
      const YarpDialect dialect =
          IsText(target.carrier) ? YarpDialect::k3 : co_await DialectOf(context, address);
      const auto dialled = Dialled::Begin(context, kConnectWithin);
      tcp::socket& socket = dialled->socket();
      co_await dialled->Connect(address.host, address.port);
      socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer));
      co_await dialled->Write(YarpHello(target.carrier, from + target.qualifiers));
      std::string welcome;
      std::optional<std::size_t> size = 0;
      while (size == std::size_t{0}) {
        char block[256];
        const std::size_t count = co_await socket.async_read_some(asio::buffer(block), use_awaitable);
        welcome.append(block, count);
        size = WelcomeBytes(target.carrier, welcome);
      }
      if (!size) co_return "Cannot connect to " + target.name + ": it is no port of YARP";
      const Output output{from, target, dialect, stream};
      why = target.carrier == YarpCarrier::kUdp
                ? SendDatagrams(context, output, address, socket.remote_endpoint().address(), welcome)
                : HandOver(output, UniqueFd(socket.release()), welcome);
    } catch (const system_error& error) {
      why = error.code() == asio::error::operation_aborted ? "no answer" : error.code().message();
    }
    co_return why.empty() ? "" : "Cannot connect to " + target.name + ": " + why;
  }

  struct Output {
    const std::string& from;
    const YarpTarget& target;
    YarpDialect dialect;
    YarpStream stream;
  };

  /// Passes the connection to the module. Returns an error text.
  std::string HandOver(const Output& output, UniqueFd session, const std::string& welcome) {
    const YarpTarget& target = output.target;
    const std::optional<NameEntry> source = names.Find(output.from);
    if (!source || !source->adopt) return output.from + " has gone";
    links.End(output.from, target.name, YarpLink::Way::kOut);
    const YarpLinks::Id id =
        links.Add({output.from, target.name, target.carrier_words, YarpLink::Way::kOut}, session);
    YarpOutput::Events events;
    events.end = [weak = weak_from_this(), id] {
      const auto impl = weak.lock();
      if (impl == nullptr) return;
      impl->links.Forget(id);
      if (impl->options.gone) impl->options.gone(id);
    };
    if (options.taken) {
      events.taken = [weak = weak_from_this(), id, name = target.name,
                      every = output.stream.every](std::uint64_t step) {
        if (const auto impl = weak.lock()) impl->options.taken(id, name, step, every);
      };
    }
    events.fails = [logger = logger, from = output.from, to = target.name](const std::string& why) {
      logger->warn("{} sends nothing to {}: {}", from, to, why);
    };
    auto encoding =
        std::make_unique<YarpOutput>(target.carrier, output.dialect, output.stream, std::move(events));
    PeerInfo peer = DescribePeer(session.get());
    peer.trusted = peer.trusted && options.trusts_this_machine;
    source->adopt(session.Release(), welcome, std::move(peer), std::move(encoding));
    return {};
  }

  /// HandOver() for a reader whose UDP port is in `welcome`.
  std::string SendDatagrams(asio::io_context& context, const Output& output, const Address& reader,
                            const asio::ip::address& ip, const std::string& welcome) {
    udp::socket datagrams(context);
    datagrams.connect({ip, static_cast<std::uint16_t>(WelcomePort(welcome))});
    UniqueFd session;
    const auto relay =
        YarpUdpRelay::Make(context, std::move(datagrams), YarpUdpRelay::Direction::kOut, session);
    if (relay == nullptr) return "there are too many connections";
    std::string problem = HandOver(output, std::move(session), welcome);
    if (!problem.empty()) return problem;
    relay->Start([self = shared_from_this(), &context, reader, from = output.from] {
      asio::co_spawn(context, self->TellEnd(context, reader, from), asio::detached);
    });
    return {};
  }

  /// Tells a reader of datagrams, by a separate connection, that no more will come.
  static asio::awaitable<void> TellEnd(asio::io_context& context, Address reader, std::string from) {
    try {
      const auto dialled = Dialled::Begin(context, kProbeWithin);
      co_await dialled->Connect(reader.host, reader.port);
      co_await dialled->Write(YarpHello(YarpCarrier::kText, "admin") + "~" + from + "\r\nq\r\n");
      co_await dialled->ReadLine();
      co_await dialled->ReadLine();
    } catch (const system_error&) {
      // The reader has gone.
    }
  }

  /// Opens a UDP port for `sender`. Returns an error text.
  std::string TakeDatagrams(asio::io_context& context, const std::string& sender, const std::string& to,
                            YarpAsker asker, std::int32_t& port) {
    const std::optional<NameEntry> module = names.Find(to);
    if (!module || !module->adopt) return to + " has gone";
    UniqueFd session;
    std::shared_ptr<YarpUdpRelay> relay;
    asio::ip::address address;
    try {
      // `--host` may be a host name.
      address = udp::resolver(context).resolve(options.address, "0")->endpoint().address();
      udp::socket datagrams(context, udp::endpoint(address, 0));
      port = datagrams.local_endpoint().port();
      relay = YarpUdpRelay::Make(context, std::move(datagrams), YarpUdpRelay::Direction::kIn, session);
    } catch (const system_error& error) {
      return error.code().message();
    }
    if (relay == nullptr) return "there are too many connections";
    if (sender.starts_with('/')) links.End(to, sender, YarpLink::Way::kIn);
    const YarpLinks::Id id = links.Add({to, sender, "udp", YarpLink::Way::kIn}, session);
    relay->Start([weak = weak_from_this(), id] {
      if (const auto impl = weak.lock()) impl->links.Forget(id);
    });
    // A datagram's sender is not verified.
    PeerInfo peer{sender + " by udp", options.trusts_this_machine && address.is_loopback()};
    module->adopt(session.Release(), YarpHello(YarpCarrier::kFastTcp, sender), std::move(peer), nullptr);
    asio::co_spawn(context, WatchSender(context, sender, asker, id, relay),
                   [self = shared_from_this()](const std::exception_ptr& /*ended*/) {});
    return {};
  }

  /// Datagrams do not show that their sender has died, but its port does: it refuses connections. A sender
  /// that has no port, or may not be asked, must keep sending.
  asio::awaitable<void> WatchSender(asio::io_context& context, std::string sender, YarpAsker asker,
                                    YarpLinks::Id id, std::weak_ptr<YarpUdpRelay> datagrams) {
    asio::steady_timer timer(context);
    for (bool known = false;;) {
      timer.expires_after(kLookAfterSender);
      co_await timer.async_wait(use_awaitable);
      if (!links.Has(id)) co_return;
      try {
        const Address address = co_await Find(context, sender, asker);
        if (address.port == 0 && !known) {
          const auto relay = datagrams.lock();
          if (relay == nullptr || relay->silent_for() >= ConnectionEnd::kDatagramSilence) break;
          continue;
        }
        if (address.port == 0) break;
        known = true;
        const auto dialled = Dialled::Begin(context, kProbeWithin);
        co_await dialled->Connect(address.host, address.port);
      } catch (const system_error& error) {
        if (error.code() == asio::error::connection_refused) break;
      }
    }
    links.End(id);
  }

  asio::awaitable<void> TellVersion(asio::io_context& context, std::string name, YarpAsker asker,
                                    ReplyFunction done) {
    Message reply;
    reply.params = {3};
    try {
      const Address address = co_await Find(context, name, asker);
      if (address.port != 0 && co_await DialectOf(context, address) == YarpDialect::k4) reply.params = {4};
    } catch (const system_error&) {
      // assume the older version
    }
    done(std::move(reply));
  }

  asio::awaitable<void> Tell(asio::io_context& context, std::string from, std::string to, bool connects) {
    try {
      // The subscriber is not known here.
      const std::optional<NameEntry> own = Own(from);
      Address source;
      if (own) source = {options.own_ip, own->port};  // co_await within ?: frees twice, with GCC 12
      if (!own) source = co_await Find(context, from, YarpAsker::kStranger);
      const Address reader = co_await Find(context, to, YarpAsker::kStranger);
      if (source.port == 0 || (connects && reader.port == 0)) co_return;
      const std::string request = connects ? "[add] \"tcp:/" + to + "\"" : "[del] \"" + to + "\"";
      const auto dialled = Dialled::Begin(context, kConnectWithin);
      co_await dialled->Connect(source.host, source.port);
      co_await dialled->Write(YarpHello(YarpCarrier::kText, "admin") + "a\r\n" + request + "\r\nq\r\n");
      co_await dialled->ReadLine();  // Welcome admin
      co_await dialled->ReadLine();
    } catch (const system_error& error) {
      logger->debug("{} could not be told about {}: {}", from, to, error.code().message());
    }
  }

  /// The entry of one of our names.
  std::optional<NameEntry> Own(const std::string& name) const {
    const std::optional<NameEntry> entry = names.Find(name);
    return entry && !entry->external ? entry : std::nullopt;
  }

  /// The address of another program. Port 0: unknown name, or connecting to it is not allowed. That includes
  /// the daemon itself, which would appear to be a local program. In our own table every name has an address
  /// that it may have (NameTable::Register()). At another name server anybody may have registered any
  /// address.
  asio::awaitable<Address> Find(asio::io_context& context, const std::string& name, YarpAsker asker) {
    if (Own(name) || !NameProblem(name).empty()) co_return Address{};
    if (options.server.empty()) {
      const std::optional<NameEntry> entry = names.Find(name);
      co_return entry ? Address{entry->ip, entry->port} : Address{};
    }
    Address server;
    if (!NameClient::ParseServer(options.server, server.host, server.port).empty()) co_return Address{};
    const auto dialled = Dialled::Begin(context, kConnectWithin);
    co_await dialled->Connect(server.host, server.port);
    co_await dialled->Write("NAME_SERVER query " + name + "\n");
    // registration name /reader ip 127.0.0.1 port 10005 type tcp
    std::istringstream words(co_await dialled->ReadLine());
    std::string word;
    Address found;
    words >> word;
    if (word == "registration") words >> word >> word >> word >> found.host >> word >> found.port;
    if (!words) co_return Address{};
    boost::system::error_code no_number;
    const auto address = asio::ip::make_address(found.host, no_number);
    const bool may = asker == YarpAsker::kTrusted || (!no_number && !IsInside(address));
    co_return may ? found : Address{};
  }

  /// YARP 3 and 4 answer `[pid]` differently. A program that does not answer counts as version 3.
  asio::awaitable<YarpDialect> DialectOf(asio::io_context& context, const Address& address) {
    if (options.dialect) co_return *options.dialect;
    std::string answer;
    try {
      const auto dialled = Dialled::Begin(context, kProbeWithin);
      co_await dialled->Connect(address.host, address.port);
      co_await dialled->Write(YarpHello(YarpCarrier::kTextAck, "admin") + "a\r\n[pid]\r\n");
      co_await dialled->ReadLine();  // Welcome admin
      answer = co_await dialled->ReadLine();
    } catch (const system_error&) {
      // assume version 3
    }
    co_return answer.starts_with("[fail]") ? YarpDialect::k4 : YarpDialect::k3;
  }

  NameTable& names;
  const Logger logger;
  const YarpNetworkOptions options;
  YarpLinks links;
  mutable Mutex mutex;
  bool stopped GUARDED_BY(mutex) = false;
  std::unique_ptr<IoThread> thread GUARDED_BY(mutex);
};

YarpNetwork::YarpNetwork(NameTable& names, Logger logger, YarpNetworkOptions options)
    : impl_(std::make_shared<Impl>(names, std::move(logger), std::move(options))),
      made_(std::make_shared<YarpMadeThings>()) {}

YarpNetwork::~YarpNetwork() {
  Stop();
}

void YarpNetwork::Connect(const std::string& from, const std::string& target, YarpStream stream,
                          YarpAsker asker, ReplyFunction done) {
  asio::io_context* const context = impl_->Context();
  if (context == nullptr) return done(Refusal("the daemon is stopping"));
  asio::co_spawn(*context, impl_->Add(*context, from, target, stream, asker, std::move(done)),
                 [impl = impl_](const std::exception_ptr& thrown) {
                   if (thrown) std::rethrow_exception(thrown);  // the thread logs it
                 });
}

std::optional<YarpDialect> YarpNetwork::dialect() const {
  return impl_->options.dialect;
}

void YarpNetwork::NoteRefused(const std::string& port, const std::string& sender, const std::string& why) {
  impl_->logger->warn("{} sends what {} does not do: {}", sender.empty() ? "a program of YARP" : sender, port,
                      why);
}

void YarpNetwork::AskVersion(const std::string& name, YarpAsker asker, ReplyFunction done) {
  asio::io_context* const context = impl_->Context();
  if (context == nullptr) return done(Refusal("the daemon is stopping"));
  asio::co_spawn(*context, impl_->TellVersion(*context, name, asker, std::move(done)), asio::detached);
}

void YarpNetwork::Accept(const std::string& sender, const std::string& to, YarpAsker asker,
                         ReplyFunction done) {
  asio::io_context* const context = impl_->Context();
  if (context == nullptr) return done(Refusal("the daemon is stopping"));
  asio::post(*context, [impl = impl_, context, sender, to, asker, done = std::move(done)] {
    Message reply;
    reply.params = {0};
    const std::string problem = impl->TakeDatagrams(*context, sender, to, asker, reply.params[0]);
    done(problem.empty() ? reply : Refusal("Cannot take datagrams: " + problem));
  });
}

void YarpNetwork::Tell(const std::string& from, const std::string& to, bool connects) {
  asio::io_context* const context = impl_->Context();
  if (context == nullptr) return;
  asio::co_spawn(*context, impl_->Tell(*context, from, to, connects),
                 [impl = impl_](const std::exception_ptr& thrown) {
                   if (thrown) std::rethrow_exception(thrown);  // the thread logs it
                 });
}

YarpLinks& YarpNetwork::links() {
  return impl_->links;
}

void YarpNetwork::Stop() {
  std::unique_ptr<IoThread> thread;
  {
    const MutexLock lock(impl_->mutex);
    impl_->stopped = true;
    thread = std::move(impl_->thread);
  }
}

}  // namespace coopdyn
