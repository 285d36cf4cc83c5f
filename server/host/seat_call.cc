// SPDX-License-Identifier: MIT
#include "server/host/seat_call.h"

#include <sys/socket.h>

#include <array>
#include <memory>
#include <utility>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

namespace coopdyn {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;

/// A request under way; lives as long as a handler waits.
struct Call : std::enable_shared_from_this<Call> {
  Call(asio::io_context& context, std::function<void(SeatAnswer)> d)
      : socket(context), patience(context), done(std::move(d)) {
    parser.body_limit(kMaxSeatAnswer);
  }

  void Begin(std::chrono::seconds time) {
    patience.expires_after(time);
    patience.async_wait([weak = weak_from_this()](const error_code& aborted) {
      const std::shared_ptr<Call> self = weak.lock();
      error_code ignored;
      if (!aborted && self) self->socket.close(ignored);
    });
    http::async_write(socket, request, [self = shared_from_this()](const error_code& failed, std::size_t) {
      if (failed) return self->End({});
      http::async_read(self->socket, self->buffer, self->parser, [self](const error_code& lost, std::size_t) {
        if (lost) return self->End({});
        self->End({self->parser.get().result_int(), std::move(self->parser.get().body())});
      });
    });
  }

  void End(SeatAnswer answer) {
    patience.cancel();
    if (done) std::exchange(done, nullptr)(std::move(answer));
  }

  asio::local::stream_protocol::socket socket;
  asio::steady_timer patience;
  std::function<void(SeatAnswer)> done;
  http::request<http::string_body> request;
  http::response_parser<http::string_body> parser;
  boost::beast::flat_buffer buffer;
};

}  // namespace

void CallSeat(asio::io_context& context, Seat& seat, const std::string& target, const std::string& body,
              std::function<void(SeatAnswer)> done, std::chrono::seconds time) {
  const auto call = std::make_shared<Call>(context, std::move(done));
  std::array<int, 2> ends{-1, -1};
  error_code failed;
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0) {
    return asio::post(context, [call] { call->End({}); });
  }
  UniqueFd far(ends[1]);
  call->socket.assign(asio::local::stream_protocol(), ends[0], failed);
  call->request = {body.empty() ? http::verb::get : http::verb::post, target, 11, body};
  call->request.set(http::field::host, "localhost");
  call->request.set(http::field::connection, "close");
  if (!body.empty()) call->request.set(http::field::content_type, "application/json");
  call->request.prepare_payload();
  call->Begin(time);
  PassedSocket passed{.kind = PassedKind::kPage};
  passed.peer = {.text = "the class's host", .trusted = true};
  passed.fd = std::move(far);
  if (!seat.PassNow(passed)) passed.fd.Reset();  // which ends the call
}

}  // namespace coopdyn
