// SPDX-License-Identifier: MIT
// An outgoing connection to another program, with a time limit. Use on the thread of its io_context.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

namespace coopdyn {

/// When the time limit passes, closes the socket: pending operations fail with operation_aborted. Every
/// coroutine throws boost::system::system_error on failure.
class Dialled {
 public:
  static constexpr std::size_t kMaxLineBytes = std::size_t{64} << 10;

  static std::shared_ptr<Dialled> Begin(boost::asio::io_context& context, std::chrono::milliseconds within);

  boost::asio::awaitable<void> Connect(std::string host, int port);
  boost::asio::awaitable<void> Write(std::string bytes);
  /// Reads the next line, including its '\n'.
  boost::asio::awaitable<std::string> ReadLine();

  boost::asio::ip::tcp::socket& socket() { return socket_; }

 private:
  Dialled(boost::asio::io_context& context, std::chrono::milliseconds within);

  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  std::string read_;  // received bytes beyond the last line
};

}  // namespace coopdyn
