// SPDX-License-Identifier: MIT
#include "server/naming/name_session.h"

#include <chrono>
#include <string_view>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

namespace coopdyn {
namespace {

namespace asio = boost::asio;

constexpr std::string_view kMagicFamily = "CDS";
constexpr std::size_t kMaxUnwritten = std::size_t{64} << 10;
constexpr std::chrono::seconds kLinger{5};

NameReply TooLong() {
  NameReply reply{"error 8 a line has at most " + std::to_string(NameSession::kMaxLineBytes) + " bytes\n"};
  reply.close = true;
  return reply;
}

}  // namespace

NameSession::NameSession(Socket socket, NameTable& table, NetServices& services, PeerInfo peer,
                         NameContext context, std::function<void()> on_end)
    : socket_(std::move(socket)),
      table_(table),
      services_(services),
      peer_(std::move(peer)),
      context_(std::move(context)),
      on_end_(std::move(on_end)),
      linger_timer_(socket_.get_executor()) {}

void NameSession::Abort() {
  on_end_ = nullptr;
  End();
}

void NameSession::Read() {
  socket_.async_read_some(
      asio::buffer(block_),
      [self = shared_from_this()](const ErrorCode& error, std::size_t count) { self->OnRead(error, count); });
}

void NameSession::OnRead(const ErrorCode& error, std::size_t count) {
  if (ended_) return;
  if (error) return End();
  if (lingering_) return Read();
  in_.append(block_, count);
  AnswerLines();
}

void NameSession::AnswerLines() {
  if (first_bytes_ && in_.starts_with(kMagicFamily)) {
    Take(AnswerMagic(table_));
  } else if (!kMagicFamily.starts_with(in_)) {
    first_bytes_ = false;
  }
  std::size_t begin = 0;
  std::size_t end = 0;
  while (!close_ && !open_ && out_.size() < kMaxUnwritten &&
         (end = in_.find('\n', begin)) != std::string::npos) {
    const std::string_view line = std::string_view(in_).substr(begin, end - begin);
    begin = end + 1;
    context_.now = services_.clock().Now();
    Take(line.size() > kMaxLineBytes ? TooLong() : AnswerNameLine(line, context_, table_));
  }
  in_.erase(0, begin);
  if (!close_ && !open_ && in_.size() > kMaxLineBytes && in_.find('\n') == std::string::npos) Take(TooLong());
  Write();
}

void NameSession::Take(NameReply reply) {
  out_ += reply.text;
  open_ = std::move(reply.open);
  opened_ = std::move(reply.opened);
  close_ = reply.close;
}

void NameSession::Write() {
  if (out_.empty()) return AfterWrite();
  asio::async_write(socket_, asio::buffer(out_),
                    [self = shared_from_this()](const ErrorCode& error, std::size_t) {
                      if (self->ended_) return;
                      if (error) return self->End();
                      self->out_.clear();
                      self->AfterWrite();
                    });
}

void NameSession::AfterWrite() {
  if (open_) return GiveAway();
  if (close_) return Linger();
  if (in_.find('\n') != std::string::npos) return AnswerLines();
  Read();
}

void NameSession::GiveAway() {
  ErrorCode error;
  const int fd = socket_.release(error);
  if (error) return End();
  services_.LogPeer(spdlog::level::debug, peer_.text, "opens " + opened_);
  open_(fd, std::move(in_), peer_);
  End();
}

// Closing with unread input would make the kernel throw the answer away.
void NameSession::Linger() {
  lingering_ = true;
  ErrorCode ignored;
  socket_.shutdown(Socket::shutdown_send, ignored);
  linger_timer_.expires_after(kLinger);
  linger_timer_.async_wait([self = shared_from_this()](const ErrorCode& aborted) {
    if (!aborted) self->End();
  });
  Read();
}

void NameSession::End() {
  if (std::exchange(ended_, true)) return;
  ErrorCode ignored;
  socket_.close(ignored);
  linger_timer_.cancel();
  if (on_end_) std::exchange(on_end_, nullptr)();
}

}  // namespace coopdyn
