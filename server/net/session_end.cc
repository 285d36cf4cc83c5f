// SPDX-License-Identifier: MIT
// How a session ends, or moves to another module.
#include <sys/socket.h>

#include <chrono>
#include <utility>

#include "protocol/command_ids.h"
#include "server/net/session.h"

namespace coopdyn {

void Session::FinishIfDone() {
  if (!eof_ || !MayHandle() || process_posted_ || next_) return;
  if (in_.size() > 0 && encoding_ != nullptr) {
    in_.Clear();
    out_.AddReply(
        ErrorReply(command::kUnreadable, Error::kMalformed,
                   "the connection ended in the middle of a message, which was not executed (a line of text "
                   "ends with a newline)"));
    Flush();
  }
  if (out_.empty()) HardClose();
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
  input_end_->Note();  // first: the client, once it sees the end, may reclaim its robot on another connection
  Log(level, "closed: " + reason);
  At(linger_timer_, std::chrono::steady_clock::now() + kLinger, &Session::HardClose);
  Post(&Session::DeliverClosed);
  if (!processing_) Flush();
}

// All output is written. Closes the socket only when the peer has closed its side: if unread input remained,
// the peer's kernel would discard the notice.
void Session::AwaitPeersEnd() {
  if (eof_ || write_dead_ || !end_.with_stream()) return HardClose();
  in_.Clear();
  StartRead();
}

void Session::DeliverClosed() {
  if (endpoint_ == nullptr) return;
  CallEndpoint([this](Endpoint& endpoint) { endpoint.OnClosed(*this); });
  endpoint_ = nullptr;
}

void Session::HardClose() {
  if (std::exchange(closed_, true)) return;
  const std::shared_ptr<Session> self = shared_from_this();
  ErrorCode ignored;
  input_end_->Forget();
  socket_.close(ignored);
  StopTimers();
  DeliverClosed();
  if (leave_) std::exchange(leave_, nullptr)({});
  out_.Clear();
  if (on_end_) std::exchange(on_end_, nullptr)(id_);
}

bool Session::may_leave() const {
  const bool has_ended = write_dead_ || closing_ || closed_ || leave_;
  return !has_ended && (encoding_ == nullptr || encoding_->outlives_module());
}

void Session::Leave(std::function<void(DetachedConnection)> done) {
  leave_ = std::move(done);
  if (!reading_) return HandOver();
  // Bytes may already be in the buffer and OnRead() be queued.
  ErrorCode ignored;
  socket_.cancel(ignored);
}

void Session::HandOver() {
  const std::shared_ptr<Session> self = shared_from_this();
  closed_ = true;
  input_end_->Forget();
  DeliverClosed();
  StopTimers();
  DetachedConnection connection{.already_read = std::string(in_.bytes()), .peer = peer_};
  if (asked_ != nullptr) asked_->GoTo(nullptr);
  connection.awaited = std::move(asked_);
  connection.request = std::move(asked_again_);
  out_.set_blocked(false);
  while (out_.Fill()) {
    connection.unsent += out_.unsent();
    out_.Sent(out_.unsent().size());
  }
  connection.encoding = std::move(encoding_);
  ErrorCode error;
  connection.fd = UniqueFd(socket_.release(error));
  if (on_end_) std::exchange(on_end_, nullptr)(id_);
  std::exchange(leave_, nullptr)(std::move(connection));
}

void Session::StopTimers() {
  for (Timer* timer : {&linger_timer_, &watch_timer_, &verbose_timer_, &silence_timer_}) timer->reset();
}

void Session::Abort(const std::string& reason) {
  on_end_ = nullptr;
  if (!closed_) Close(reason);
  if (closed_) return;
  char rest[4096];
  while (::recv(socket_.native_handle(), rest, sizeof rest, MSG_DONTWAIT) > 0) {
  }
  HardClose();
}

void Session::CheckPeerLives() {
  if (closed_ || peer_.trusted || !PeerLooksDead(socket_.native_handle())) return;
  Log(spdlog::level::info, "its machine no longer answers");
  write_dead_ = true;
  ::shutdown(socket_.native_handle(), SHUT_RDWR);  // also ends the pending read
}

}  // namespace coopdyn
