// SPDX-License-Identifier: MIT
#include "clients/cpp/connection.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "clients/cpp/words.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::size_t kLeastRoom = 16384;  // initial size of the receive buffer

}  // namespace

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

void Require(const Message& reply, std::size_t params, std::size_t data) {
  if (reply.params.size() < params || reply.data.size() < data + 2)
    throw Error(7, "a reply of the daemon has too few values");
}

double TimeOf(const Message& reply) {
  return reply.data[reply.data.size() - 2];
}

std::int64_t StepOf(const Message& reply) {
  return Whole(reply.data.back());
}

Connection::Connection(const Address& address, std::string module, bool drives, int team_number)
    : address_(address), module_(std::move(module)), drives_(drives), team_number_(team_number) {}

void Connection::Open() {
  Close();
  socket_ = address_.OpenModule(module_, After(address_.timeout_s()));
  try {
    if (!WriteAll(fd(), std::string(kBinaryMagic))) throw Closed("", address_.LossHint());
    Ask({.command = command::kHello,
         .text = address_.HelloText(drives_, team_number_),
         .timeout_s = address_.timeout_s()});
  } catch (...) {
    Close();
    throw;
  }
}

void Connection::Close() {
  socket_ = Socket();
  busy_ = false;
  have_ = 0;
  pushes.clear();
}

bool Connection::Alive() {
  if (!is_open() || busy_) return false;
  try {
    TryRead();
  } catch (const Error&) {
    return false;
  }
  return true;
}

void Connection::KeepOpen() {
  if (!Alive()) Open();
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
  if (WriteAll(fd(), out_)) return;
  while (TryRead()) {
  }  // throws the daemon's closing notice, if it sent one
  Close();
  throw Closed("", address_.LossHint());
}

/// Removes and returns the first complete message.
std::optional<Message> Connection::Decode() {
  Decoded decoded = DecodeBinary({in_.data(), have_}, kMaxReplyBytes);
  if (decoded.status == DecodeStatus::kNeedMore) return std::nullopt;
  if (decoded.status != DecodeStatus::kMessage) {
    Close();
    throw Error(7, "the bytes received are not a coopdyn message");
  }
  have_ -= decoded.consumed;
  std::memmove(in_.data(), in_.data() + decoded.consumed, have_);
  return std::move(decoded.message);
}

std::optional<Message> Connection::TryRead() {
  while (true) {
    while (std::optional<Message> message = Decode()) {
      if (message->command >= 0 || message->error != 0) {
        busy_ = false;
        return message;
      }
      if (message->command == command::kClosing) {
        Close();
        throw Closed(message->text, address_.LossHint());
      }
      pushes.push_back(std::move(*message));
    }
    if (have_ == in_.size()) in_.resize(std::max(kLeastRoom, 2 * have_));
    const ssize_t n = recv(fd(), in_.data() + have_, in_.size() - have_, 0);
    if (n > 0) {
      have_ += static_cast<std::size_t>(n);
      continue;
    }
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return std::nullopt;
    Close();
    throw Closed("", address_.LossHint());
  }
}

Message Connection::Receive(double timeout_s, Polling* polling) {
  Deadline now = Clock::now();
  const Deadline deadline = After(timeout_s, now);
  if (polling) polling->Start(now);
  while (true) {
    std::optional<Message> reply = TryRead();
    now = Clock::now();
    const bool polls = polling && polling->ShouldPollAgain(now);
    if (reply) return std::move(*reply);
    if (polls) continue;
    if (now >= deadline) {
      Close();
      throw Error(kTimedOut, "no answer from " + module_ + " within " + Written(timeout_s) +
                                 " s; is the daemon stopped or overloaded?");
    }
    WaitReadable({fd()}, SecondsUntil(deadline, now));
  }
}

Message Connection::Ask(Request request, Polling* polling) {
  Send(request.command, std::move(request.params), request.data, std::move(request.text));
  return Checked(Receive(request.timeout_s, polling));
}

void Connection::FinishSending() {
  TryRead();  // closing with unread bytes would reset the connection and lose sent ones
  if (is_open()) shutdown(fd(), SHUT_WR);
}

void Connection::AwaitEnd(Deadline deadline) {
  char bytes[4096];
  while (is_open() && WaitReadable({fd()}, SecondsUntil(deadline)) &&
         recv(fd(), bytes, sizeof(bytes), 0) > 0) {
  }
}

}  // namespace coopdyn::client
