// SPDX-License-Identifier: MIT
// Carries the messages of a connection over datagrams: what the module's session says on its end of a pair of
// sockets goes out, and what comes in goes to it. Its thread only.
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
    kIn,  // what the session says is thrown away, as such a connection has no replies
    kOut,
  };

  /// Null: no pair of sockets is to be had. `session` gets the session's end.
  static std::shared_ptr<YarpUdpRelay> Make(boost::asio::io_context& context,
                                            boost::asio::ip::udp::socket datagrams, Direction direction,
                                            UniqueFd& session);
  /// Runs until the session closes its end, or nobody listens any more; then calls `on_end`.
  void Start(std::function<void()> on_end);
  void Close();
  /// Since the last datagram, or since the beginning.
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
