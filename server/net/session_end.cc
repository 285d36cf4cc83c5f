// SPDX-License-Identifier: MIT
// How a connection ends.
#include <sys/socket.h>

#include <boost/asio/post.hpp>

#include "protocol/command_ids.h"
#include "server/net/session.h"

namespace coopdyn {

namespace asio = boost::asio;

void Session::FinishIfDone() {
  if (eof_ && !closing_ && !waiting_ && !process_posted_ && out_.empty()) HardClose();
}

void Session::Close(const std::string& reason, spdlog::level::level_enum level) {
  if (closing_ || closed_) return;
  if (encoding_ == nullptr) {
    out_.AddRaw("# " + reason + "\n");
  } else {
    Message notice;
    notice.command = command::kClosing;
    notice.text = reason;
    out_.AddNotice(std::move(notice));
  }
  closing_ = true;
  Log(level, "closed: " + reason);
  linger_timer_.emplace(context_, kLinger);
  linger_timer_->async_wait([self = shared_from_this()](const ErrorCode& aborted) {
    if (!aborted) self->HardClose();
  });
  asio::post(context_, [self = shared_from_this()] { self->DeliverClosed(); });
  if (!processing_) Flush();
}

void Session::DeliverClosed() {
  if (endpoint_ == nullptr) return;
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnClosed(*this); });
  endpoint_ = nullptr;
}

void Session::HardClose() {
  if (std::exchange(closed_, true)) return;
  const std::shared_ptr<Session> self = shared_from_this();
  if (interest_ != 0) poller_.Change(socket_.get(), *this, std::exchange(interest_, 0), 0);
  socket_.Reset();
  linger_timer_.reset();
  watch_timer_.reset();
  silence_timer_.reset();
  verbose_timer_.reset();
  DeliverClosed();
  out_.Clear();
  if (on_end_) std::exchange(on_end_, nullptr)(id_);
}

void Session::Abort(const std::string& reason) {
  on_end_ = nullptr;
  if (!closed_) Close(reason);
  if (closed_) return;
  char rest[4096];
  while (::recv(socket_.get(), rest, sizeof rest, MSG_DONTWAIT) > 0) {
  }
  HardClose();
}

void Session::CheckPeerLives() {
  if (closed_ || peer_.trusted || !PeerLooksDead(socket_.get())) return;
  Log(spdlog::level::info, "its machine does not answer any more");
  write_dead_ = true;
  ::shutdown(socket_.get(), SHUT_RDWR);  // reading ends with it
}

void Session::Log(spdlog::level::level_enum level, const std::string& text) {
  services_.LogPeer(level, peer_.text, text);
}

}  // namespace coopdyn
