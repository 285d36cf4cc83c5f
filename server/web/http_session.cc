// SPDX-License-Identifier: MIT
#include "server/web/http_session.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "server/web/access.h"
#include "server/web/direct_answers.h"
#include "server/web/page_bridge.h"
#include "server/web/page_socket.h"
#include "server/web/streams.h"

namespace coopdyn {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

namespace {

constexpr std::size_t kMaxDrainBytes = std::size_t{1} << 20;
constexpr std::chrono::seconds kDrainTime{2};
constexpr std::chrono::seconds kRetryAfter{15};  // by then, connections without a request have timed out

constexpr std::size_t kMaxCheckedBytes = std::size_t{2} << 20;

HttpRequestHead HeadOf(const http::request<http::string_body>& request) {
  HttpRequestHead head;
  head.method = request.method_string();
  head.target = request.target();
  head.http_1_1 = request.version() >= 11;
  const auto hosts = request.equal_range(http::field::host);
  for (auto host = hosts.first; host != hosts.second; ++host) head.hosts.push_back(host->value());
  head.origin = request[http::field::origin];
  head.content_type = request[http::field::content_type];
  head.if_none_match = request[http::field::if_none_match];
  head.upgrade = beast::websocket::is_upgrade(request);
  return head;
}

/// The answer to a malformed HTTP request.
HttpAnswer UnreadableAnswer(const error_code& failed) {
  HttpAnswer answer = failed == http::error::header_limit ? ErrorAnswer(431, "the header is too long")
                      : failed == http::error::body_limit
                          ? ErrorAnswer(413, "the body is too long: at most 16 MiB")
                          : ErrorAnswer(400, "not an HTTP request: " + failed.message());
  answer.close = true;
  return answer;
}

bool IsUnreadable(const error_code& failed) {
  return failed.category() == http::make_error_code(http::error::bad_method).category() &&
         failed != http::error::end_of_stream && failed != http::error::partial_message;
}

}  // namespace

HttpSession::HttpSession(asio::ip::tcp::socket socket, WebContext& context, PeerInfo peer)
    : stream_(std::move(socket)), context_(context), peer_(std::move(peer)), deadline_timer_(context.io) {}

HttpSession::~HttpSession() = default;

void HttpSession::Start(const std::string& already_read) {
  asio::buffer_copy(buffer_.prepare(already_read.size()), asio::buffer(already_read));
  buffer_.commit(already_read.size());
  ReadHeader();
}

void HttpSession::Refuse() {
  HttpAnswer answer = ErrorAnswer(503, "too many connections: close some pages and try again");
  answer.headers.emplace_back("Retry-After", std::to_string(kRetryAfter.count()));
  answer.close = true;
  parser_.emplace();
  Answer(std::move(answer));
}

void HttpSession::Close() {
  stream_.close();
}

void HttpSession::ReadHeader() {
  parser_.emplace();
  parser_->header_limit(kMaxHeaderBytes);
  parser_->body_limit(kMaxBodyBytes);
  stream_.expires_after(context_.options.header_time);
  http::async_read_header(stream_, buffer_, *parser_,
                          [self = shared_from_this()](error_code failed, std::size_t) {
                            if (IsUnreadable(failed)) return self->Answer(UnreadableAnswer(failed));
                            if (failed) return self->Close();
                            self->OnHeader();
                          });
}

void HttpSession::OnHeader() {
  const Request& request = parser_->get();
  route_ = FindRoute(HeadOf(request), context_.options.host_names);
  const bool has_body = parser_->chunked() || parser_->content_length().value_or(0) > 0;
  if (route_.kind == HttpRouteKind::kRefused) {
    route_.refusal.close |= has_body;  // the body is not read
    return Answer(route_.refusal);
  }
  if (!TakesBody()) {
    HttpAnswer answer = ErrorAnswer(413,
                                    "a body of more than 1 MiB from another machine needs the header "
                                    "\"Authorization: Bearer TOKEN\"");
    answer.close = true;
    return Answer(std::move(answer));
  }
  if (beast::iequals(request[http::field::expect], "100-continue") && has_body) {
    response_.emplace(http::status::continue_, 11);
    stream_.expires_after(kBodyTime);
    http::async_write(stream_, *response_, [self = shared_from_this()](error_code failed, std::size_t) {
      if (failed) return self->Close();
      self->ReadBody();
    });
    return;
  }
  ReadBody();
}

bool HttpSession::TakesBody() {
  if (peer_.trusted) return true;
  const bool large = parser_->content_length().value_or(0) > kMaxStrangersBodyBytes;
  if (!large && !parser_->chunked()) return true;
  if (context_.TakesToken(TokenOr({}), peer_.text)) return true;
  parser_->body_limit(kMaxStrangersBodyBytes);
  return !large;
}

void HttpSession::ReadBody() {
  stream_.expires_after(kBodyTime);
  http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code failed, std::size_t) {
    if (IsUnreadable(failed)) return self->Answer(UnreadableAnswer(failed));
    if (failed) return self->Close();
    self->stream_.expires_never();
    self->OnRequest();
  });
}

void HttpSession::OnRequest() {
  const Request& request = parser_->get();
  const bool head_only = request.method() == http::verb::head;
  switch (route_.kind) {
    case HttpRouteKind::kRefused:
      return Answer(route_.refusal);
    case HttpRouteKind::kAsset:
      return Answer(AnswerAsset(*route_.asset, std::string_view(request[http::field::if_none_match]),
                                std::string_view(request[http::field::accept_encoding])));
    case HttpRouteKind::kSnapshot:
      return AnswerSnapshot(route_.image, !head_only);
    case HttpRouteKind::kStream:
      return BecomeStream(route_.image);
    case HttpRouteKind::kStatus:
      return AnswerStatus();
    case HttpRouteKind::kNames:
      return Answer(AnswerNames(context_, route_.name));
    case HttpRouteKind::kModules:
      return Answer(AnswerModules(context_));
    case HttpRouteKind::kScene:
      return Answer(AnswerScene(context_));
    case HttpRouteKind::kText:
      return Answer(AnswerText(context_));
    case HttpRouteKind::kFileText: {
      const std::uint64_t ticket = Await("the file");
      return context_.files.Text(route_.thumb_kind, route_.thumb, LaterAnswer(ticket));
    }
    case HttpRouteKind::kMesh:
      return Answer(AnswerMesh(context_, route_.name));
    case HttpRouteKind::kTexture:
      return Answer(AnswerTexture(context_, route_.name));
    case HttpRouteKind::kRuns:
      return AnswerRuns();
    case HttpRouteKind::kRun:
      return AnswerRun(route_.run);
    case HttpRouteKind::kRunView: {
      // Comparing repeats two runs: too much work to do for strangers.
      if (route_.view.what == "parting" && !HasToken({})) return Answer(ErrorAnswer(403, WhyNoToken({})));
      const std::uint64_t ticket = Await("the recording");
      return context_.files.Run(route_.view, LaterAnswer(ticket));
    }
    case HttpRouteKind::kCosts:
      return Answer(AnswerCosts(context_));
    case HttpRouteKind::kGallery: {
      const std::uint64_t ticket = Await("the gallery");
      return context_.files.Gallery(LaterAnswer(ticket));
    }
    case HttpRouteKind::kThumb: {
      const std::uint64_t ticket = Await("the picture");
      return context_.files.Thumb(route_.thumb_kind, route_.thumb, LaterAnswer(ticket));
    }
    case HttpRouteKind::kCheck:
    case HttpRouteKind::kUpload:
      return AnswerFile(request.body());
    case HttpRouteKind::kCall:
      return AnswerCall(request.body());
    case HttpRouteKind::kSocket:
      return BecomeSocket();
  }
}

void HttpSession::BecomeSocket() {
  const auto socket = std::make_shared<PageSocket>(std::move(stream_), context_, peer_);
  context_.connections.Add(socket, peer_);
  socket->Start(parser_->release());
}

void HttpSession::BecomeStream(const ImageRequest& image) {
  if (!context_.pictures.available()) {
    return Answer(ErrorAnswer(503, "the daemon runs without pictures (--no-render)"));
  }
  const auto stream = std::make_shared<PictureStream>(stream_.release_socket(), context_, image);
  context_.connections.Add(stream, peer_);
  stream->Start(parser_->get().method() == http::verb::head);
}

void HttpSession::AnswerStatus() {
  const std::uint64_t ticket = Await("/simulation");
  context_.status.Ask([self = shared_from_this(), ticket](const Message& reply) {
    if (reply.error != 0) return self->AnswerLater(ticket, ErrorAnswer(503, reply.text));
    self->AnswerLater(ticket, JsonAnswer(reply.text));
  });
}

void HttpSession::AnswerSnapshot(const ImageRequest& image, bool body_wanted) {
  if (!body_wanted && context_.pictures.available()) {
    return Answer({.type = MediaType(image.format), .headers = {{"Cache-Control", "no-store"}}});
  }
  const std::uint64_t ticket = Await("the picture");
  context_.pictures.Request(
      image, [self = shared_from_this(), ticket, format = image.format](const ImageResult& result) {
        if (!result.error.empty())
          return self->AnswerLater(ticket, ErrorAnswer(result.is_unknown ? 404 : 503, result.error));
        HttpAnswer answer;
        answer.type = MediaType(format);
        answer.headers = {{"Cache-Control", "no-store"},
                          {"X-Simulated-Time", std::to_string(ToSeconds(result.time))}};
        answer.body.assign(result.bytes->begin(), result.bytes->end());
        self->AnswerLater(ticket, std::move(answer));
      });
}

std::function<void(const HttpAnswer&)> HttpSession::LaterAnswer(std::uint64_t ticket) {
  return [self = shared_from_this(), ticket](const HttpAnswer& answer) { self->AnswerLater(ticket, answer); };
}

std::string_view HttpSession::TokenOr(std::string_view token_of_body) const {
  const std::string_view bearer = BearerToken(std::string_view(parser_->get()[http::field::authorization]));
  return bearer.empty() ? token_of_body : bearer;
}

bool HttpSession::HasToken(std::string_view token_of_body) const {
  return peer_.trusted || context_.TakesToken(TokenOr(token_of_body), peer_.text);
}

std::string HttpSession::WhyNoToken(std::string_view token_of_body) const {
  const std::string wait =
      TokenOr(token_of_body).empty() ? std::string() : context_.TokenWaitText(peer_.text);
  return wait.empty() ? kTokenText : wait;
}

void HttpSession::AnswerFile(const std::string& body) {
  const bool upload = route_.kind == HttpRouteKind::kUpload;
  if (const char* const why = context_.services.WhyReadOnly(peer_); upload && why != nullptr)
    return Answer(ErrorAnswer(403, why));
  PageFileRead read = ReadPageFile(body);
  if (!read.error.empty()) return Answer(ErrorAnswer(400, read.error));
  if (!HasToken(read.token)) return Answer(ErrorAnswer(403, WhyNoToken(read.token)));
  if (!upload && read.file.text.size() > kMaxCheckedBytes) {
    return Answer(
        ErrorAnswer(413, "the page does not check texts of more than 2 MiB: run coopdyn check FILE"));
  }
  const std::uint64_t ticket = Await(upload ? "the upload" : "the check");
  upload ? context_.files.Upload(std::move(read.file), LaterAnswer(ticket))
         : context_.files.Check(std::move(read.file), LaterAnswer(ticket));
}

void HttpSession::AnswerCall(const std::string& body) {
  const PageRead read = ReadPageMessage(body);
  const PageCall* call = read.message ? std::get_if<PageCall>(&*read.message) : nullptr;
  if (call == nullptr) {
    return Answer(
        ErrorAnswer(400, read.error.empty() ? "send a call: an object without \"type\"" : read.error));
  }
  PeerInfo peer = peer_;
  const std::string_view token = TokenOr(call->token);
  peer.trusted = HasToken(call->token);
  const std::string wait = peer.trusted || token.empty() ? std::string() : context_.TokenWaitText(peer.text);
  peer.text = "page " + peer.text;
  const std::uint64_t ticket = Await(call->module);
  bridge_ = std::make_unique<PageBridge>(
      context_.io, context_.names, context_.frames, std::move(peer),
      [self = weak_from_this(), ticket, wait](const PageReply& reply) {
        const auto session = self.lock();
        if (!session || !reply.id) return;  // a push
        HttpAnswer answer = JsonAnswer(WritePageReply(reply));
        if (reply.message.error == static_cast<std::int32_t>(Error::kNotAllowed)) {
          answer = ErrorAnswer(403, wait.empty() ? reply.message.text : wait);
        }
        session->AnswerLater(ticket, std::move(answer));
      });
  bridge_->Handle(*call);
}

void HttpSession::AnswerRuns() {
  const std::uint64_t ticket = Await("the list of recordings");
  context_.runs.List([self = shared_from_this(), ticket](const WebRunFile& list) {
    self->AnswerLater(ticket, JsonAnswer(list.text));
  });
}

void HttpSession::AnswerRun(const std::string& name) {
  const std::uint64_t ticket = Await(name, kExportTime);
  context_.runs.Open(name, [self = shared_from_this(), ticket, name](const WebRunFile& run) {
    if (run.status != 200) return self->AnswerLater(ticket, ErrorAnswer(run.status, run.text));
    self->OpenRun(ticket, name, run);
  });
}

void HttpSession::OpenRun(std::uint64_t ticket, const std::string& name, const WebRunFile& run) {
  UniqueFd file(::open(run.file.c_str(), O_RDONLY | O_CLOEXEC));
  if (run.temporary) ::unlink(run.file.c_str());  // removed from the disk when `file` is closed
  struct stat about {};
  if (file.get() < 0 || ::fstat(file.get(), &about) != 0 || !S_ISREG(about.st_mode)) {
    return AnswerLater(ticket, ErrorAnswer(404, name + " cannot be read"));
  }
  if (ticket != ticket_) return;  // timed out
  ++ticket_;
  deadline_timer_.cancel();
  const bool head_only = parser_->get().method() == http::verb::head;
  const auto stream = std::make_shared<FileStream>(std::move(stream_), context_.runs, std::move(file),
                                                   static_cast<std::uint64_t>(about.st_size));
  context_.connections.Add(stream, peer_);
  stream->Start(name, head_only);
}

std::uint64_t HttpSession::Await(const std::string& whom, std::chrono::seconds time) {
  const std::uint64_t ticket = ++ticket_;
  deadline_timer_.expires_after(time);
  deadline_timer_.async_wait([self = shared_from_this(), ticket, whom, time](error_code cancelled) {
    if (cancelled) return;
    const std::string text = "no answer from " + whom + " within " + std::to_string(time.count()) + " s";
    self->AnswerLater(ticket, ErrorAnswer(504, text));
  });
  return ticket;
}

void HttpSession::AnswerLater(std::uint64_t ticket, HttpAnswer answer) {
  if (ticket != ticket_) return;
  ++ticket_;
  deadline_timer_.cancel();
  Answer(std::move(answer));
}

void HttpSession::Answer(HttpAnswer answer) {
  const Request& request = parser_->get();
  const unsigned version = request.version() == 10 ? 10 : 11;
  response_.emplace(static_cast<http::status>(answer.status), version);
  for (const auto& [name, value] : CommonHeaders()) response_->set(name, value);
  for (const auto& [name, value] : answer.headers) response_->set(name, value);
  const bool with_body = answer.status != 304;
  if (with_body) response_->set(http::field::content_type, answer.type);
  response_->keep_alive(!answer.close && request.keep_alive());
  if (request.method() == http::verb::head && with_body) {
    if (!answer.body.empty()) response_->content_length(answer.body.size());
  } else {
    response_->body() = std::move(answer.body);
    response_->prepare_payload();
  }
  stream_.expires_after(kAnswerTime);
  http::async_write(stream_, *response_, [self = shared_from_this()](error_code failed, std::size_t) {
    // Posted, because the bridge may be calling this session.
    asio::post(self->stream_.get_executor(), [self, failed] {
      self->bridge_ = nullptr;
      if (failed) return self->Close();
      if (self->response_->need_eof() || !self->response_->keep_alive()) return self->Drain();
      self->ReadHeader();
    });
  });
}

void HttpSession::Drain() {
  error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  if (drained_ == 0) stream_.expires_after(kDrainTime);
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(16384),
                          [self = shared_from_this()](error_code failed, std::size_t count) {
                            self->drained_ += count;
                            if (failed || self->drained_ > kMaxDrainBytes) return self->Close();
                            self->Drain();
                          });
}

}  // namespace coopdyn
