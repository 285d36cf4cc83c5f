// SPDX-License-Identifier: MIT
// A connection that the daemon makes to another program, with a limit of time. On the thread of its context.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

namespace coopdyn {

/// What it has not done within its time fails with operation_aborted: it is closed then. Each of its
/// coroutines throws boost::system::system_error.
class Dialled {
 public:
  static constexpr std::size_t kMaxLineBytes = std::size_t{64} << 10;

  static std::shared_ptr<Dialled> Begin(boost::asio::io_context& context, std::chrono::milliseconds within);

  boost::asio::awaitable<void> Connect(std::string host, int port);
  boost::asio::awaitable<void> Write(std::string bytes);
  /// The next line, with its end.
  boost::asio::awaitable<std::string> ReadLine();

  boost::asio::ip::tcp::socket& socket() { return socket_; }

 private:
  Dialled(boost::asio::io_context& context, std::chrono::milliseconds within);

  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  std::string read_;  // beyond the last line
};

}  // namespace coopdyn
