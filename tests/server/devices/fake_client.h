// SPDX-License-Identifier: MIT
// A client of an endpoint without a socket: sends lines of the text form, keeps all replies and pushes in
// order.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class FakeClient final : public Connection {
 public:
  FakeClient(Endpoint& endpoint, ClientId id, bool trusted = true)
      : endpoint_(endpoint), id_(id), peer_("peer:" + std::to_string(id)), trusted_(trusted) {
    endpoint_.OnOpen(*this);
  }
  ~FakeClient() override {
    if (open_) CloseNow();
  }

  /// Sends a named or full line; appends its reply to `received` when it arrives.
  void Send(const std::string& line) {
    const Decoded decoded = DecodeText(line + "\n", endpoint_.table(), false);
    if (decoded.status != DecodeStatus::kMessage)
      throw std::invalid_argument(line + ": " + decoded.message.text);
    SendMessage(decoded.message);
  }
  void SendMessage(Message message) {
    ++waiting_;
    endpoint_.OnRequest(*this, std::move(message), [this](Message reply) {
      --waiting_;
      received.push_back(std::move(reply));
    });
  }
  /// Sends a line and returns the reply, which must arrive immediately.
  Message Ask(const std::string& line) {
    Send(line);
    if (waiting_ != 0) throw std::logic_error("no reply yet to " + line);
    return received.back();
  }
  void EndInput() {
    input_ended_ = true;
    endpoint_.OnInputEnded(*this);
  }
  /// Stops accepting replies.
  void EndOutput() { output_ended_ = true; }
  void CloseNow() {
    open_ = false;
    endpoint_.OnClosed(*this);
  }

  bool is_waiting() const { return waiting_ > 0; }
  std::vector<Message> pushes() const {
    std::vector<Message> list;
    std::copy_if(received.begin(), received.end(), std::back_inserter(list),
                 [](const Message& message) { return message.command < 0; });
    return list;
  }

  ClientId id() const override { return id_; }
  const std::string& peer() const override { return peer_; }
  bool trusted() const override { return trusted_; }
  bool input_ended() const override { return input_ended_; }
  bool output_ended() const override { return output_ended_; }
  bool Push(const UnaskedPtr& message, std::int64_t dropped) override {
    if (!reads) {
      unread.push_back(message);
    } else if (message->message() != nullptr) {
      received.push_back(*message->message());
      if (dropped > 0) received.back().text = "dropped " + std::to_string(dropped);
    }
    return reads;
  }
  void Close(const std::string& reason) override { closed_because = reason; }

  std::vector<Message> received;  // replies and pushes in order
  std::string closed_because;     // the closing notice
  bool reads = true;              // else pushes wait in `unread`
  std::vector<UnaskedPtr> unread;

 private:
  Endpoint& endpoint_;
  const ClientId id_;
  const std::string peer_;
  const bool trusted_;
  bool input_ended_ = false;
  bool output_ended_ = false;
  bool open_ = true;
  int waiting_ = 0;
};

/// A thread's queue, run on demand.
class FakeThread {
 public:
  std::function<void(std::function<void()>)> poster() {
    return [this](std::function<void()> work) { posted_.push_back(std::move(work)); };
  }
  std::size_t posted() const { return posted_.size(); }
  void Run() {
    while (!posted_.empty()) {
      const auto work = std::move(posted_.front());
      posted_.erase(posted_.begin());
      work();
    }
  }

 private:
  std::vector<std::function<void()>> posted_;
};

/// The step that a reply or push reports.
inline double StepOf(const Message& message) {
  return message.data.empty() ? -1 : message.data.back();
}

}  // namespace coopdyn
