// SPDX-License-Identifier: MIT
#include "clients/cpp/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <sstream>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/error.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {

std::string Error::name() const {
  static constexpr const char* kNames[] = {
      "error",     "unknown_command", "wrong_params", "wrong_data",   "out_of_range", "not_possible", "owned",
      "malformed", "too_large",       "internal",     "no_such_name", "timed_out",    "not_allowed"};
  if (code_ == kNoConnection) return "connection";
  return code_ >= 1 && code_ <= 12 ? kNames[code_] : kNames[0];
}

Message Checked(Message reply, const std::string& who) {
  if (reply.error == kNotPossible && (reply.text == "reset" || reply.text == kLoad))
    throw WorldReset(reply.text);
  if (reply.error != 0)
    throw Error(reply.error,
                who + (reply.text.empty() ? std::string(ErrorMeaning(reply.error)) : reply.text));
  return reply;
}

Connection::Connection(const Address& address, std::string module, bool drives)
    : address_(address), module_(std::move(module)), drives_(drives) {}

Connection::Connection(const Address& address, std::string module, int team_number)
    : address_(address),
      module_(std::move(module)),
      drives_(true),
      number_(team_number),
      bulk_(BulkReader()) {}

void Connection::Open() {
  Close();
  fd_ = address_.OpenModule(module_, After(address_.timeout_s()));
  try {
    if (!WriteAll(fd_, std::string(kBinaryMagic))) throw Closed("");
    Request(command::kHello, {}, {}, address_.HelloText(drives_, number_), address_.timeout_s());
  } catch (...) {
    Close();
    throw;
  }
}

void Connection::Close() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
  busy_ = false;
  in_.clear();
  if (bulk_) bulk_->Clear();
  pushes.clear();
}

bool Connection::Alive() {
  if (fd_ < 0 || busy_) return false;
  try {
    TryRead();
  } catch (const Error&) {
    return false;
  }
  return true;
}

void Connection::Send(std::int32_t command, std::vector<std::int32_t> params, std::span<const double> data,
                      std::string text) {
  request_.command = command;
  request_.params = std::move(params);
  request_.data.assign(data.begin(), data.end());
  request_.text = std::move(text);
  out_.clear();
  EncodeBinary(request_, out_);
  busy_ = true;
  if (WriteAll(fd_, out_)) return;
  while (TryRead()) {
  }  // throws what the daemon said before it closed, if anything
  Close();
  throw Closed("");
}

std::optional<Message> Connection::TryReadBulk() {
  try {
    while (std::optional<Message> message = bulk_->Read(fd_)) {
      if (message->command >= 0 || message->error != 0) {
        busy_ = false;
        return message;
      }
      if (message->command == command::kClosing) throw Closed(message->text);
    }
  } catch (const Error&) {
    Close();
    throw;
  }
  return std::nullopt;
}

std::optional<Message> Connection::TryRead() {
  if (bulk_) return TryReadBulk();
  while (true) {
    if (!in_.empty()) {
      Decoded decoded = DecodeBinary(in_, kMaxReplyBytes);
      if (decoded.status == DecodeStatus::kMessage) {
        in_.erase(0, decoded.consumed);
        Message& message = decoded.message;
        if (message.command < 0 && message.error == 0) {
          if (message.command == command::kClosing) {
            Close();
            throw Closed(message.text);
          }
          pushes.push_back(std::move(message));
          continue;
        }
        busy_ = false;
        return std::move(message);
      }
      if (decoded.status != DecodeStatus::kNeedMore) {
        Close();
        throw Error(7, "the bytes received are not a coopdyn message");
      }
    }
    char bytes[16384];
    const ssize_t n = recv(fd_, bytes, sizeof(bytes), 0);
    if (n > 0) {
      in_.append(bytes, static_cast<std::size_t>(n));
      continue;
    }
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return std::nullopt;
    Close();
    throw Closed("");
  }
}

Message Connection::Receive(double timeout_s, double spin_s) {
  Deadline now = Clock::now();
  const Deadline deadline = After(timeout_s, now), spin_until = After(spin_s, now);
  while (true) {
    if (std::optional<Message> reply = TryRead()) return std::move(*reply);
    now = Clock::now();
    if (now < spin_until) continue;
    if (now >= deadline) {
      Close();
      std::ostringstream why;
      why << "no answer from " << module_ << " within " << timeout_s
          << " s; is the daemon stopped or overloaded?";
      throw Error(11, why.str());
    }
    WaitReadable({fd_}, Until(deadline, now));
  }
}

Message Connection::Request(std::int32_t command, std::vector<std::int32_t> params,
                            std::span<const double> data, std::string text, double timeout_s, double spin_s) {
  Send(command, std::move(params), data, std::move(text));
  return Checked(Receive(timeout_s, spin_s));
}

void Connection::FinishSending() {
  TryRead();  // what is unread would make closing a reset, which loses what was sent
  if (fd_ >= 0) shutdown(fd_, SHUT_WR);
}

void Connection::AwaitEnd(std::chrono::steady_clock::time_point deadline) {
  using std::chrono::milliseconds;
  std::array<char, 4096> bytes;
  for (;;) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd waiting{fd_, POLLIN, 0};
    if (fd_ < 0 || poll(&waiting, 1, std::max(0, static_cast<int>(left.count()))) != 1) return;
    if (recv(fd_, bytes.data(), bytes.size(), 0) <= 0) return;
  }
}

}  // namespace coopdyn::client
