// SPDX-License-Identifier: MIT
#include "server/web/module_link.h"

#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <string_view>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

namespace asio = boost::asio;
using boost::system::error_code;

std::shared_ptr<ModuleLink> ModuleLink::Open(asio::io_context& context, const NameEntry& entry,
                                             PeerInfo peer) {
  std::array<int, 2> ends{-1, -1};
  if (!entry.adopt ||
      ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) != 0) {
    return nullptr;
  }
  UniqueFd near(ends[0]);
  UniqueFd far(ends[1]);
  const std::shared_ptr<ModuleLink> link(new ModuleLink(context));
  error_code failed;
  link->socket_.assign(asio::local::stream_protocol(), near.get(), failed);
  if (failed) return nullptr;
  near.Release();
  entry.adopt(far.Release(), std::string(kBinaryMagic), std::move(peer), nullptr);
  link->Read();
  return link;
}

ModuleLink::~ModuleLink() = default;

void ModuleLink::Call(const Message& request, ReplyFunction reply) {
  std::string refusal;
  if (!open_) {
    refusal = closing_reason_.empty() ? "the module has closed the connection" : closing_reason_;
  } else if (outgoing_.size() > kMaxOutgoingBytes) {
    refusal = "too many unsent requests for this module: wait for replies before sending more";
  }
  if (!refusal.empty()) {
    const Error error = open_ ? Error::kTooLarge : Error::kNotPossible;
    asio::post(socket_.get_executor(),
               [reply = std::move(reply), answer = ErrorReply(request.command, error, std::move(refusal))] {
                 reply(answer);
               });
    return;
  }
  replies_.push_back({request.command, std::move(reply)});
  EncodeBinary(request, outgoing_);
  Write();
}

void ModuleLink::Close() {
  if (!open_) return;
  open_ = false;
  replies_.clear();
  on_push_ = nullptr;
  error_code ignored;
  socket_.close(ignored);
}

void ModuleLink::Abandon(const std::string& reason) {
  if (!open_) return;
  asio::post(socket_.get_executor(), [reason, replies = std::move(replies_)] {
    for (const Waiting& waiting : replies) {
      waiting.reply(ErrorReply(waiting.command, Error::kNotPossible, reason));
    }
  });
  replies_.clear();
  Close();
}

void ModuleLink::Read() {
  socket_.async_read_some(asio::buffer(chunk_),
                          [self = shared_from_this()](error_code failed, std::size_t count) {
                            if (!self->open_) return;
                            if (failed) return self->Fail();
                            self->incoming_.append(self->chunk_.data(), count);
                            self->TakeMessages();
                            if (self->open_) self->Read();
                          });
}

void ModuleLink::TakeMessages() {
  std::size_t used = 0;
  while (open_) {
    const Decoded decoded = DecodeBinary(std::string_view(incoming_).substr(used), kMaxReplyBytes);
    if (decoded.status == DecodeStatus::kNeedMore) break;
    if (decoded.status != DecodeStatus::kMessage) {
      closing_reason_ = "the module sent an unreadable message: " + decoded.message.text;
      return Fail();
    }
    used += decoded.consumed;
    Deliver(decoded.message);
  }
  incoming_.erase(0, used);
}

void ModuleLink::Deliver(const Message& message) {
  // Unsolicited messages have negative commands; so does the reply to an unreadable request, −2.
  const bool pushed = message.command < 0 && message.command != command::kUnreadable;
  if (message.command == command::kClosing) closing_reason_ = message.text;
  if (pushed || replies_.empty()) {
    const PushFunction on_push = on_push_;
    if (on_push) on_push(message);
    return;
  }
  const ReplyFunction reply = std::move(replies_.front().reply);
  replies_.pop_front();
  reply(message);
}

void ModuleLink::Write() {
  if (write_pending_ || outgoing_.empty()) return;
  write_pending_ = true;
  writing_.clear();
  writing_.swap(outgoing_);
  asio::async_write(socket_, asio::buffer(writing_),
                    [self = shared_from_this()](error_code failed, std::size_t) {
                      self->write_pending_ = false;
                      // On failure, the reading side sees the end too, after the module's last messages.
                      if (!failed && self->open_) self->Write();
                    });
}

void ModuleLink::Fail() {
  if (!open_) return;
  open_ = false;
  error_code ignored;
  socket_.close(ignored);
  if (closing_reason_.empty()) closing_reason_ = "the module has closed the connection";
  std::deque<Waiting> replies = std::move(replies_);
  replies_.clear();
  for (const Waiting& waiting : replies) {
    waiting.reply(ErrorReply(waiting.command, Error::kNotPossible, closing_reason_));
  }
}

}  // namespace coopdyn
