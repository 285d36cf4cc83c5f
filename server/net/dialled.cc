// SPDX-License-Identifier: MIT
#include "server/net/dialled.h"

#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

namespace coopdyn {

namespace asio = boost::asio;
using asio::use_awaitable;

Dialled::Dialled(asio::io_context& context, std::chrono::milliseconds within)
    : resolver_(context), socket_(context), limit_(context, within) {}

std::shared_ptr<Dialled> Dialled::Begin(asio::io_context& context, std::chrono::milliseconds within) {
  const std::shared_ptr<Dialled> dialled(new Dialled(context, within));
  dialled->limit_.async_wait([weak = std::weak_ptr(dialled)](const boost::system::error_code& aborted) {
    const auto slow = weak.lock();
    if (aborted || slow == nullptr) return;
    slow->resolver_.cancel();
    boost::system::error_code ignored;
    slow->socket_.close(ignored);
  });
  return dialled;
}

asio::awaitable<void> Dialled::Connect(std::string host, int port) {
  const auto found = co_await resolver_.async_resolve(host, std::to_string(port), use_awaitable);
  co_await asio::async_connect(socket_, found, use_awaitable);
}

asio::awaitable<void> Dialled::Write(std::string bytes) {
  co_await asio::async_write(socket_, asio::buffer(bytes), use_awaitable);
}

asio::awaitable<std::string> Dialled::ReadLine() {
  const std::size_t count = co_await asio::async_read_until(
      socket_, asio::dynamic_buffer(read_, kMaxLineBytes), '\n', use_awaitable);
  std::string line = read_.substr(0, count);
  read_.erase(0, count);
  co_return line;
}

}  // namespace coopdyn
