// SPDX-License-Identifier: MIT
// An endpoint that acts as its requests say and remembers the events. Called on the io thread; `Saw()` etc.
// from the test's thread.
#pragma once

#include <deque>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/base/mutex.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class ScriptedEndpoint : public Endpoint {
 public:
  static constexpr std::int32_t kEcho = 500, kHold = 501, kThrow = 502, kBig = 503, kTwice = 504,
                                kPushes = 505, kDrop = 506;

  ScriptedEndpoint()
      : table_("test", {Spec(kEcho, "echo"), Spec(kHold, "hold"), Spec(kThrow, "throw"), Spec(kBig, "big"),
                        Spec(kTwice, "twice"), Spec(kPushes, "pushes"), Spec(kDrop, "drop")}) {}

  const std::string& path() const override { return path_; }
  const CommandTable& table() const override { return table_; }

  void OnOpen(Connection& connection) override {
    connections_[connection.id()] = &connection;
    Note("open " + connection.peer() + (connection.trusted() ? " trusted" : ""));
  }

  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override {
    Message answer;
    answer.command = request.command;
    answer.data = {request.data.empty() ? 0.0 : request.data[0], 0.25, 7};
    Note("request " + std::to_string(request.command) +
         (request.data.empty() ? "" : " " + std::to_string(static_cast<int>(request.data[0]))) +
         (connection.output_ended() ? " of the deaf" : ""));
    switch (request.command) {
      case kHold:
        held_.push_back({std::move(reply), std::move(answer)});
        return;
      case kThrow:
        throw std::runtime_error("scripted");
      case kBig:
        answer.data.assign(static_cast<std::size_t>(request.data.at(0)), 1.5);
        break;
      case kTwice:
        reply(answer);
        break;
      case kPushes:
        for (int i = 1; i <= static_cast<int>(request.data.at(0)); ++i) connection.Push(PushOf(i), 0);
        break;
      case kDrop:  // take another connection over
        for (auto& [id, other] : connections_) {
          if (id != connection.id()) other->Close("taken over");
        }
        break;
      default:
        answer.text = request.text;
        break;
    }
    reply(std::move(answer));
  }

  void OnInputEnded(Connection& connection) override {
    Note(connection.input_ended() ? "input ended" : "input ended, but not said so");
  }

  void OnClosed(Connection& connection) override {
    connections_.erase(connection.id());
    Note("closed");
  }

  std::string WaitingFor() override { return "robot2 (no client), 1.2 s"; }

  static UnaskedPtr PushOf(int i) {
    Message push;
    push.command = -kEcho;
    push.data = {static_cast<double>(i), 0.25, 7};
    return boost::make_local_shared<UnaskedMessage>(std::move(push));
  }

  // --- io thread ---
  std::size_t held() const { return held_.size(); }
  /// Replies with this text, unless empty.
  void ReleaseOne(const std::string& text = {}) {
    auto [reply, answer] = std::move(held_.front());
    held_.pop_front();
    if (!text.empty()) answer.text = text;
    reply(std::move(answer));
  }
  const std::map<ClientId, Connection*>& connections() const { return connections_; }

  // --- any thread ---
  int Count(const std::string& event) {
    MutexLock lock(mutex_);
    int count = 0;
    for (const std::string& one : events_) count += one.starts_with(event) ? 1 : 0;
    return count;
  }
  std::vector<std::string> events() {
    MutexLock lock(mutex_);
    return events_;
  }

 private:
  static CommandSpec Spec(std::int32_t id, std::string name) {
    CommandSpec spec;
    spec.id = id;
    spec.name = std::move(name);
    spec.help = "For tests.";
    spec.data = {{"values", "m", true, true, {}}};
    spec.reply_data = {{"first", "m", false, false, {}}};
    return spec;
  }

  void Note(std::string event) {
    MutexLock lock(mutex_);
    events_.push_back(std::move(event));
  }

  const std::string path_ = "/robot1/test";
  CommandTable table_;
  std::deque<std::pair<ReplyFunction, Message>> held_;
  std::map<ClientId, Connection*> connections_;
  Mutex mutex_;
  std::vector<std::string> events_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
