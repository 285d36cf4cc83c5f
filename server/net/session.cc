// SPDX-License-Identifier: MIT
#include "server/net/session.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Limits of one turn before other connections get theirs: the number of requests, and the time after which
// none begins.
constexpr int kRequestsAtOnce = 256;
constexpr Nanoseconds kTurn = 500'000;
constexpr milliseconds kWatchPeriod{20};

}  // namespace

Session::Session(asio::io_context& context, Socket socket, ConnectionEnd end, Endpoint& endpoint,
                 NetServices& services, const IoThread::Poster& poster, PeerInfo peer,
                 std::function<void(ClientId)> on_end)
    : context_(context),
      turn_(Turn::Of(context)),
      socket_(std::move(socket)),
      end_(end),
      input_end_(std::make_shared<SocketEnd>(socket_.native_handle())),
      endpoint_(&endpoint),
      services_(services),
      poster_(poster),
      id_(services.NextClient()),
      peer_(std::move(peer)),
      on_end_(std::move(on_end)),
      heard_at_(steady_clock::now()) {}

void Session::Start(DetachedConnection connection) {
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnOpen(*this); });
  out_.AddRaw(connection.unsent);
  if (connection.encoding != nullptr) TakeEncoding(std::move(connection.encoding));
  if (connection.awaited != nullptr) Await(std::move(connection.awaited));
  next_ = std::move(connection.request);
  in_.Append(connection.already_read);
  if (encoding_ != nullptr || in_.size() > 0) Process();
  if (!end_.with_stream()) WatchSilence();
  StartRead();
}

void Session::Post(Step then) {
  asio::post(context_, Handler(then));
}

void Session::At(Timer& timer, steady_clock::time_point time, Step then) {
  if (!timer) timer.emplace(context_);
  timer->expires_at(time);
  timer->async_wait(Handler(then));
}

// --- reading

void Session::StartRead() {
  if (reading_ || eof_ || closed_) return;
  const bool far_ahead =
      !closing_ && (waiting_ || blocked_ || process_posted_) && in_.size() >= kMaxReadAhead;
  if (far_ahead) return At(watch_timer_, steady_clock::now() + kWatchPeriod, &Session::WatchPeer);
  reading_ = true;
  const std::span<char> room = in_.Room();
  socket_.async_read_some(asio::buffer(room.data(), room.size()),
                          [self = shared_from_this()](const ErrorCode& error, std::size_t count) {
                            self->turn_.Run([&] {
                              if (!self->closed_) self->OnRead(error, count);
                            });
                          });
}

void Session::OnRead(const ErrorCode& error, std::size_t count) {
  reading_ = false;
  in_.Added(count);
  acknowledged_ = false;
  if (leave_) return HandOver();
  if (closing_) in_.Clear();  // reads only until the peer closes
  if (!end_.with_stream()) heard_at_ = steady_clock::now();
  const bool empty_datagram = error == asio::error::eof && !end_.with_stream();
  if (error && !empty_datagram) return EndInput();
  Process();
  StartRead();
}

void Session::EndInput() {
  eof_ = true;
  out_.GiveUpPushes();
  TellInputEnded();
  if (closing_ && fin_sent_) return HardClose();
  Process();
}

void Session::TellInputEnded() {
  if (std::exchange(input_ended_, true)) return;
  input_end_->Note();
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnInputEnded(*this); });
}

void Session::WatchPeer() {
  if (input_end_->Look()) TellInputEnded();  // remaining bytes are still read and executed
  StartRead();
}

void Session::WatchSilence() {
  if (eof_) return;
  if (steady_clock::now() >= heard_at_ + end_.silence) return EndInput();
  At(silence_timer_, heard_at_ + end_.silence, &Session::WatchSilence);
}

// --- requests

// Immediate replies are collected and written together when nothing more can be done.
void Session::Process() {
  if (processing_ || process_posted_) return;
  processing_ = true;
  const Nanoseconds end = services_.clock().Now() + kTurn;
  int handled = 0;
  bool over = false;
  while (MayHandle() && !over && HandleNext()) {
    if (out_.unsent().size() >= OutQueue::kEncodeAhead) Flush();
    over = ++handled == kRequestsAtOnce || (in_.size() > 0 && services_.clock().Now() >= end);
  }
  processing_ = false;
  Flush();
  if (over && MayHandle()) return PostProcess();
  if (waiting_ && encoding_->takes_notes()) WatchWait();
  Acknowledge();
  FinishIfDone();
}

void Session::PostProcess() {
  if (std::exchange(process_posted_, true)) return;
  Post(&Session::Resume);
}

void Session::Resume() {
  process_posted_ = false;
  Process();
  StartRead();
}

/// Handles the next item in the buffer. Returns false if more bytes are needed.
bool Session::HandleNext() {
  if (next_) {
    HandRequest(*std::exchange(next_, std::nullopt), false);
    return true;
  }
  if (in_.size() == 0) return false;
  if (encoding_ == nullptr) {
    const EncodingKind* const kind = Choose(services_.encodings(), in_.bytes());
    if (kind == nullptr) return false;
    TakeEncoding(kind->make(*endpoint_));
  }
  Incoming incoming = encoding_->Decode(in_.bytes());
  in_.Consume(incoming.consumed);
  if (!incoming.answer.empty()) {
    malformed_ = 0;
    out_.AddRaw(incoming.answer);
  }
  if (incoming.ask) {
    const auto answer = std::make_shared<PendingAnswer>();
    Await(answer);
    incoming.ask(*this, [answer](const Message& message) { answer->Give(message); });
    if (incoming.status == DecodeStatus::kLeave) Close("goodbye");
    return true;
  }
  switch (incoming.status) {
    case DecodeStatus::kNeedMore:
    case DecodeStatus::kNothing:
    case DecodeStatus::kHelp:
    case DecodeStatus::kVerbose:
      return incoming.consumed > 0;
    case DecodeStatus::kMessage:
      malformed_ = 0;
      HandRequest(std::move(incoming.message), incoming.changes);
      return true;
    case DecodeStatus::kLeave:
      Close("goodbye");
      return true;
    case DecodeStatus::kBad:
      if (incoming.message.error == static_cast<std::int32_t>(Error::kMalformed)) ++malformed_;
      out_.AddReply(incoming.message);
      if (malformed_ >= kMaxMalformed) {
        Close(std::to_string(kMaxMalformed) + " malformed messages in a row; help lists the commands");
      }
      return true;
    case DecodeStatus::kFatal:
      out_.AddReply(incoming.message);
      Close(incoming.message.text, spdlog::level::warn);
      return true;
  }
  return false;
}

void Session::TakeEncoding(std::unique_ptr<Encoding> encoding) {
  encoding_ = std::move(encoding);
  out_.set_encoding(*encoding_);
  if (endpoint_ != nullptr) encoding_->Attach(*this, *endpoint_);
  out_.AddRaw(encoding_->Greeting());
}

bool Session::Changes(std::int32_t command) const {
  constexpr std::int32_t kSaveWorld = 146;  // returns a text, unlike /simulation's save
  if (endpoint_ == nullptr || command == command::kHello || command == kSaveWorld) return false;
  const CommandSpec* const spec = endpoint_->table().Find(command);
  return spec != nullptr && !IsReadingCommand(spec->name);
}

ReplyFunction Session::AwaitReply() {
  waiting_ = true;
  return [weak = weak_from_this(), serial = ++serial_](const Message& message) {
    if (const std::shared_ptr<Session> self = weak.lock()) self->OnReply(serial, message);
  };
}

void Session::Await(std::shared_ptr<PendingAnswer> answer) {
  asked_ = std::move(answer);
  asked_->GoTo([post = poster_, reply = AwaitReply()](const Message& message) {
    post([reply, message] { reply(message); });
  });
}

void Session::HandRequest(Message request, bool changes) {
  ReplyFunction reply = AwaitReply();
  const std::uint64_t serial = serial_;
  const std::int32_t command = request.command;
  if (const char* const why = services_.WhyReadOnly(peer_); why != nullptr && (changes || Changes(command)))
    return OnReply(serial, ErrorReply(command, Error::kNotAllowed, why));
  const bool ok = CallEndpoint(
      [&](Endpoint& endpoint) { endpoint.OnRequest(*this, std::move(request), std::move(reply)); });
  if (!ok)
    OnReply(serial, ErrorReply(command, Error::kInternal, "internal error: the daemon's log says more"));
}

void Session::OnReply(std::uint64_t serial, const Message& reply) {
  if (!waiting_ || serial != serial_ || closing_ || closed_) return;
  if (reply.text.ends_with(kGoneText) && (asked_again_ = encoding_->AskedAgain(reply))) return;
  waiting_ = false;
  asked_ = nullptr;
  if (const std::string warning = encoding_->Warning(reply); !warning.empty())
    Log(spdlog::level::warn, warning);
  std::string meanwhile;
  next_ = encoding_->Next(reply, meanwhile);
  if (!meanwhile.empty() && !write_dead_) out_.AddRaw(meanwhile);
  if (!next_ && !write_dead_) out_.AddReply(reply);
  if (processing_) return;  // Process() continues
  Flush();
  Acknowledge();
  // The next request, if already received, runs in its own turn: the caller may be walking a list.
  if (next_ || in_.size() > 0 || eof_) PostProcess();
}

// --- writing

bool Session::Push(const UnaskedPtr& message, std::int64_t dropped) {
  if (closing_ || closed_ || write_dead_) return false;
  out_.AddPush(message, dropped);
  if (!processing_ && !blocked_) Flush();
  return !blocked_;
}

void Session::Flush() {
  while (!blocked_ && !closed_ && out_.Fill()) {
    if (write_dead_) {
      out_.Clear();
      break;
    }
    const std::string_view bytes = out_.unsent();
    const ssize_t count =
        ::send(socket_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      out_.Sent(static_cast<std::size_t>(count));
      acknowledged_ = true;  // with the answer
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      blocked_ = true;
      out_.set_blocked(true);
      socket_.async_wait(Socket::wait_write, Handler(&Session::OnWritable));
    } else if (errno != EINTR) {
      write_dead_ = true;
    }
  }
  if (!closing_ || fin_sent_ || blocked_ || closed_) return;
  fin_sent_ = true;
  ::shutdown(socket_.native_handle(), SHUT_WR);
  Post(&Session::AwaitPeersEnd);
}

void Session::Acknowledge() {
  if (waiting_ || closed_ || std::exchange(acknowledged_, true)) return;
  const int yes = 1;
  ::setsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_QUICKACK, &yes, sizeof yes);
}

void Session::OnWritable() {
  blocked_ = false;
  out_.set_blocked(false);
  Flush();
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnTakesMore(*this); });
  Process();
  StartRead();
}

// One timer runs while requests wait; it continues from one request to the next.
void Session::WatchWait() {
  if (verbose_timer_ && verbose_timer_->expiry() > steady_clock::now()) return;
  watched_ = serial_;
  At(verbose_timer_, steady_clock::now() + waiting_note_.Pause(serial_), &Session::TellWaiting);
}

void Session::TellWaiting() {
  if (closing_ || !waiting_) return;
  std::string whom;
  if (watched_ == serial_) CallEndpoint([&whom](Endpoint& endpoint) { whom = endpoint.WaitingFor(); });
  if (watched_ == serial_ && !blocked_) {
    out_.AddRaw(waiting_note_.Line(serial_, whom, steady_clock::now()));
    Flush();
  }
  WatchWait();
}

void Session::Log(spdlog::level::level_enum level, const std::string& text) {
  services_.LogPeer(level, peer_.text, text);
}

}  // namespace coopdyn
