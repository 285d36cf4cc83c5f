// SPDX-License-Identifier: MIT
// One HTTP connection: reads requests one after the other, checks their rights and answers them, or hands the
// connection over to a WebSocket or a stream. UI thread.
#pragma once

#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/web/http_routes.h"
#include "server/web/web_context.h"

namespace coopdyn {

class PageBridge;

class HttpSession : public WebConnection, public std::enable_shared_from_this<HttpSession> {
 public:
  static constexpr std::uint32_t kMaxHeaderBytes = 16 << 10;
  static constexpr std::uint64_t kMaxBodyBytes = 16 << 20;
  static constexpr std::uint64_t kMaxStrangersBodyBytes = 1 << 20;  // without the token in the header
  static constexpr std::chrono::seconds kBodyTime{60};
  static constexpr std::chrono::seconds kAnswerTime{60};   // for a module or picture, and again for writing
  static constexpr std::chrono::seconds kExportTime{600};  // for converting a recording

  HttpSession(boost::asio::ip::tcp::socket socket, WebContext& context, PeerInfo peer);
  ~HttpSession() override;

  /// `already_read`: the first bytes, if somebody else has read them.
  void Start(const std::string& already_read = {});
  /// Answers 503 and closes: too many connections.
  void Refuse();
  void Close() override;

 private:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  void ReadHeader();
  void OnHeader();
  /// True if the header announces a body of permitted length; limits a chunked body.
  bool TakesBody();
  void ReadBody();
  void OnRequest();
  /// Hands the connection to a PageSocket.
  void BecomeSocket();
  /// Hands the connection to a PictureStream.
  void BecomeStream(const ImageRequest& image);
  void AnswerStatus();
  void AnswerSnapshot(const ImageRequest& image, bool body_wanted);
  void AnswerCall(const std::string& body);
  /// The token in the header, else `token_of_body`.
  std::string_view TokenOr(std::string_view token_of_body) const;
  bool HasToken(std::string_view token_of_body) const;
  std::string WhyNoToken(std::string_view token_of_body) const;
  /// Checks or uploads the file in `body`.
  void AnswerFile(const std::string& body);
  void AnswerRuns();
  void AnswerRun(const std::string& name);
  /// Hands the connection to a FileStream, unless `ticket` has timed out.
  void OpenRun(std::uint64_t ticket, const std::string& name, const WebRunFile& run);
  /// Starts the deadline for an answer from `whom`. Returns the ticket for AnswerLater().
  std::uint64_t Await(const std::string& whom, std::chrono::seconds time = kAnswerTime);
  /// A callback that calls AnswerLater().
  std::function<void(const HttpAnswer&)> LaterAnswer(std::uint64_t ticket);
  /// Calls Answer(), unless `ticket` has timed out.
  void AnswerLater(std::uint64_t ticket, HttpAnswer answer);
  void Answer(HttpAnswer answer);
  /// Briefly discards further input so that the client can read the answer, then closes.
  void Drain();

  boost::beast::tcp_stream stream_;
  WebContext& context_;
  const PeerInfo peer_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  std::optional<boost::beast::http::response<boost::beast::http::string_body>> response_;
  HttpRoute route_;
  boost::asio::steady_timer deadline_timer_;
  std::uint64_t ticket_ = 0;  // of the pending answer
  std::unique_ptr<PageBridge> bridge_;
  std::size_t drained_ = 0;
};

}  // namespace coopdyn
