// SPDX-License-Identifier: MIT
// Carries a connection's messages over datagrams: sends the output of the module's session, which holds the
// other end of a socket pair, and passes received messages to it. Used on one thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "server/net/unique_fd.h"

namespace coopdyn {

class YarpUdpRelay final : public std::enable_shared_from_this<YarpUdpRelay> {
 public:
  enum class Direction {
    kIn,  // discards the session's output: such a connection has no replies
    kOut,
  };

  /// Null if no socket pair is available. `session` receives the session's end.
  static std::shared_ptr<YarpUdpRelay> Make(boost::asio::io_context& context,
                                            boost::asio::ip::udp::socket datagrams, Direction direction,
                                            UniqueFd& session);
  /// Runs until the session closes its end or the receiver is gone; then calls `on_end`.
  void Start(std::function<void()> on_end);
  void Close();
  /// Time since the last datagram, or since the start.
  std::chrono::steady_clock::duration silent_for() const {
    return std::chrono::steady_clock::now() - heard_at_;
  }

 private:
  YarpUdpRelay(boost::asio::io_context& context, boost::asio::ip::udp::socket datagrams, Direction direction);
  boost::asio::awaitable<void> CarryIn();
  boost::asio::awaitable<void> CarryOut();
  void Run(boost::asio::awaitable<void> carrying);

  boost::asio::io_context& context_;
  boost::asio::ip::udp::socket datagrams_;
  boost::asio::local::stream_protocol::socket stream_;
  const Direction direction_;
  std::function<void()> on_end_;
  std::chrono::steady_clock::time_point heard_at_ = std::chrono::steady_clock::now();
};

}  // namespace coopdyn
