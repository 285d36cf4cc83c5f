// SPDX-License-Identifier: MIT
#include "server/net/session.h"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>

#include <boost/asio/post.hpp>

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

// One turn, before other connections have theirs: at most this many requests, and none begins after this
// time.
constexpr int kRequestsAtOnce = 256;
constexpr Nanoseconds kTurn = 500'000;
constexpr milliseconds kWatchPeriod{20};

}  // namespace

Session::Session(asio::io_context& context, UniqueFd socket, ConnectionEnd end, Endpoint& endpoint,
                 NetServices& services, PeerInfo peer, std::function<void(ClientId)> on_end)
    : context_(context),
      poller_(SocketPoller::Of(context)),
      socket_(std::move(socket)),
      end_(end),
      endpoint_(&endpoint),
      services_(services),
      id_(services.NextClient()),
      peer_(std::move(peer)),
      on_end_(std::move(on_end)) {}

void Session::Start(std::string_view already_read, std::unique_ptr<Encoding> encoding) {
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnOpen(*this); });
  if (encoding != nullptr) TakeEncoding(std::move(encoding));
  in_.Append(already_read);
  if (in_.size() > 0 || encoding_ != nullptr) Process();
  if (!end_.with_stream()) {
    heard_at_ = steady_clock::now();
    WatchSilence();
  }
  StartRead();
}

// --- reading
// ------------------------------------------------------------------------------------------------------

void Session::ChangeInterest() {
  const std::uint32_t wanted =
      (reading_ ? std::uint32_t{EPOLLIN} : 0U) | (blocked_ ? std::uint32_t{EPOLLOUT} : 0U);
  if (closed_ || poller_.Change(socket_.get(), *this, interest_, wanted)) {
    interest_ = wanted;
  } else {
    Log(spdlog::level::err, "cannot be waited for: the machine has no memory left");
    asio::post(context_, [self = shared_from_this()] { self->HardClose(); });
  }
}

void Session::OnReady(std::uint32_t events) {
  const std::shared_ptr<Session> self = shared_from_this();
  constexpr std::uint32_t kEnd = EPOLLERR | EPOLLHUP;
  if (blocked_ && (events & (EPOLLOUT | kEnd)) != 0) OnWritable();
  if (reading_ && (events & (EPOLLIN | kEnd)) != 0) Read();
}

void Session::StartRead() {
  if (eof_ || closed_) return;
  const bool far_ahead =
      !closing_ && (waiting_ || blocked_ || process_posted_) && in_.size() >= kMaxReadAhead;
  if (reading_ == far_ahead) {
    reading_ = !far_ahead;
    ChangeInterest();
  }
  if (far_ahead) WatchPeer();
}

void Session::Read() {
  const std::span<char> room = in_.Room();
  const ssize_t count = ::recv(socket_.get(), room.data(), room.size(), MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return;
  if (count > 0) in_.Added(static_cast<std::size_t>(count));
  if (closing_) in_.Clear();  // only waiting for the peer to close
  if (!end_.with_stream()) heard_at_ = steady_clock::now();
  if (count < 0 || (count == 0 && end_.with_stream())) return EndInput();
  Process();
  StartRead();
}

void Session::EndInput() {
  eof_ = true;
  reading_ = false;
  ChangeInterest();
  TellInputEnded();
  if (closing_ && fin_sent_) return HardClose();
  Process();
}

void Session::TellInputEnded() {
  if (std::exchange(input_ended_, true)) return;
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnInputEnded(*this); });
}

// While reading rests because the client is far ahead, its end is looked for from time to time.
void Session::WatchPeer() {
  if (input_ended_) return;
  if (!watch_timer_) watch_timer_.emplace(context_);
  watch_timer_->expires_after(kWatchPeriod);
  watch_timer_->async_wait([self = shared_from_this()](const ErrorCode& aborted) {
    if (aborted || self->closed_) return;
    pollfd state{self->socket_.get(), POLLRDHUP, 0};
    if (::poll(&state, 1, 0) > 0 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0) {
      self->TellInputEnded();  // what is still to be read is read and executed in its turn
    }
    self->StartRead();
  });
}

void Session::WatchSilence() {
  if (!silence_timer_) silence_timer_.emplace(context_);
  silence_timer_->expires_at(heard_at_ + end_.silence);
  silence_timer_->async_wait([self = shared_from_this()](const ErrorCode& aborted) {
    if (aborted || self->closed_ || self->eof_) return;
    if (steady_clock::now() < self->heard_at_ + self->end_.silence) return self->WatchSilence();
    self->EndInput();
  });
}

// --- requests
// -----------------------------------------------------------------------------------------------------

// Replies given at once are collected and written together when nothing more can be done.
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
  FinishIfDone();
}

void Session::PostProcess() {
  if (std::exchange(process_posted_, true)) return;
  asio::post(context_, [self = shared_from_this()] {
    self->process_posted_ = false;
    if (self->closed_) return;
    self->Process();
    self->StartRead();
  });
}

/// Handles the next thing in the buffer. Returns false if more must come first.
bool Session::HandleNext() {
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
  switch (incoming.status) {
    case DecodeStatus::kNeedMore:
    case DecodeStatus::kNothing:
    case DecodeStatus::kHelp:
    case DecodeStatus::kVerbose:
      return incoming.consumed > 0;
    case DecodeStatus::kMessage:
      malformed_ = 0;
      HandRequest(std::move(incoming.message));
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
  out_.AddRaw(encoding_->Greeting());
}

void Session::HandRequest(Message request) {
  waiting_ = true;
  const std::uint64_t serial = ++serial_;
  const std::int32_t command = request.command;
  ReplyFunction reply = [weak = weak_from_this(), serial](Message message) {
    if (const std::shared_ptr<Session> self = weak.lock()) self->OnReply(serial, std::move(message));
  };
  const bool ok = CallEndpoint(
      [&](Endpoint& endpoint) { endpoint.OnRequest(*this, std::move(request), std::move(reply)); });
  if (!ok)
    OnReply(serial, ErrorReply(command, Error::kInternal, "internal error: the daemon's log says more"));
}

void Session::OnReply(std::uint64_t serial, Message reply) {
  if (!waiting_ || serial != serial_ || closing_ || closed_) return;
  waiting_ = false;
  if (!write_dead_) out_.AddReply(reply);
  if (processing_) return;  // Process() goes on
  Flush();
  // The next request, if it is there already, in its own turn: whoever replies may be walking a list.
  if (in_.size() > 0 || eof_) PostProcess();
}

// --- writing
// ------------------------------------------------------------------------------------------------------

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
    const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      out_.Sent(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      return WaitWritable();
    } else if (errno != EINTR) {
      write_dead_ = true;
    }
  }
  if (!closing_ || fin_sent_ || blocked_ || closed_) return;
  // All is written. The socket is closed only when the peer has closed its side: closing with unread input
  // would make its kernel throw the notice away.
  fin_sent_ = true;
  ::shutdown(socket_.get(), SHUT_WR);
  asio::post(context_, [self = shared_from_this()] {
    if (self->closed_) return;
    if (self->eof_ || self->write_dead_ || !self->end_.with_stream()) return self->HardClose();
    self->in_.Clear();
    self->StartRead();
  });
}

void Session::WaitWritable() {
  blocked_ = true;
  out_.set_blocked(true);
  ChangeInterest();
}

void Session::OnWritable() {
  blocked_ = false;
  out_.set_blocked(false);
  ChangeInterest();
  Flush();
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnTakesMore(*this); });
  Process();
  StartRead();
}

// One timer runs while requests wait; it goes on from one request to the next.
void Session::WatchWait() {
  if (!verbose_timer_) verbose_timer_.emplace(context_);
  if (verbose_timer_->expiry() > steady_clock::now()) return;
  verbose_timer_->expires_after(waiting_note_.Pause(serial_));
  verbose_timer_->async_wait([self = shared_from_this(), serial = serial_](const ErrorCode& aborted) {
    if (aborted || self->closed_ || self->closing_ || !self->waiting_) return;
    if (serial == self->serial_) self->TellWaiting();
    self->WatchWait();
  });
}

void Session::TellWaiting() {
  std::string whom;
  CallEndpoint([&whom](Endpoint& endpoint) { whom = endpoint.WaitingFor(); });
  if (blocked_) return;
  out_.AddRaw(waiting_note_.Line(serial_, whom, steady_clock::now()));
  Flush();
}

}  // namespace coopdyn
