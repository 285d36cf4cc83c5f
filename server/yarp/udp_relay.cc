// SPDX-License-Identifier: MIT
#include "server/yarp/udp_relay.h"

#include <sys/socket.h>

#include <array>
#include <exception>
#include <string>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include "server/yarp/carrier.h"
#include "server/yarp/datagram.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using asio::use_awaitable;
using Stream = asio::local::stream_protocol;

constexpr std::size_t kBlockBytes = std::size_t{64} << 10;

}  // namespace

YarpUdpRelay::YarpUdpRelay(asio::io_context& context, asio::ip::udp::socket datagrams, Direction direction)
    : context_(context), datagrams_(std::move(datagrams)), stream_(context), direction_(direction) {}

std::shared_ptr<YarpUdpRelay> YarpUdpRelay::Make(asio::io_context& context, asio::ip::udp::socket datagrams,
                                                 Direction direction, UniqueFd& session) {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0) return nullptr;
  UniqueFd near(ends[0]);
  session = UniqueFd(ends[1]);
  const std::shared_ptr<YarpUdpRelay> relay(new YarpUdpRelay(context, std::move(datagrams), direction));
  boost::system::error_code failed;
  relay->stream_.assign(Stream(), near.get(), failed);
  if (failed) return nullptr;
  near.Release();
  return relay;
}

void YarpUdpRelay::Start(std::function<void()> on_end) {
  on_end_ = std::move(on_end);
  Run(CarryIn());
  Run(CarryOut());
}

void YarpUdpRelay::Run(asio::awaitable<void> carrying) {
  asio::co_spawn(context_, std::move(carrying),
                 [self = shared_from_this()](const std::exception_ptr& thrown) {
                   self->Close();
                   try {
                     if (thrown) std::rethrow_exception(thrown);
                   } catch (const boost::system::system_error&) {
                     // One of the sockets has ended: so does the connection.
                   }
                 });
}

void YarpUdpRelay::Close() {
  boost::system::error_code ignored;
  datagrams_.close(ignored);
  stream_.close(ignored);
  if (on_end_) std::exchange(on_end_, nullptr)();
}

asio::awaitable<void> YarpUdpRelay::CarryIn() {
  std::string block(kBlockBytes, '\0');
  DatagramJoiner joiner;
  while (true) {
    const std::size_t count = co_await datagrams_.async_receive(asio::buffer(block), use_awaitable);
    heard_at_ = std::chrono::steady_clock::now();
    if (direction_ == Direction::kOut) continue;  // listens only for errors: nobody receives
    const std::string messages = joiner.Add(std::string_view(block).substr(0, count));
    co_await asio::async_write(stream_, asio::buffer(messages), use_awaitable);
  }
}

asio::awaitable<void> YarpUdpRelay::CarryOut() {
  std::string block(kBlockBytes, '\0'), said;
  YarpReader reader;
  reader.Next(YarpHello(YarpCarrier::kFastTcp, ""));
  while (true) {
    const std::size_t count = co_await stream_.async_read_some(asio::buffer(block), use_awaitable);
    if (direction_ == Direction::kIn) continue;
    said.append(block, 0, count);
    std::size_t sent = 0;
    while (true) {
      const std::string_view rest = std::string_view(said).substr(sent);
      const YarpInput message = reader.Next(rest);
      if (message.kind != YarpInput::Kind::kCommand) break;
      sent += message.consumed;
      if (message.text == "q") co_return;
      for (const std::string& datagram : CutIntoDatagrams(rest.substr(0, message.consumed)))
        co_await datagrams_.async_send(asio::buffer(datagram), use_awaitable);
    }
    said.erase(0, sent);
  }
}

}  // namespace coopdyn
