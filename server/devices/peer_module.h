// SPDX-License-Identifier: MIT
// Connection handling shared by the modules of robots and of the simulation: the connections, the one pending
// request of each, delayed replies, subscriptions. Free of sockets. One thread: the inbox's.
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "protocol/command_table.h"
#include "server/base/clock.h"
#include "server/base/wrong_tokens.h"
#include "server/devices/connection_roster.h"
#include "server/devices/module_core.h"
#include "server/devices/step_inbox.h"
#include "server/net/endpoint.h"
#include "server/state/command_board.h"

namespace coopdyn {

/// A connection and its pending request.
struct ModulePeer {
  Connection* connection = nullptr;
  ModuleClient client;
  ReplyFunction reply;  // null: no request is pending
  command::Id command = 0;
  std::string text;  // text of the reply

  ClientId id() const { return client.client.id; }
};

/// The services of every module; all outlive it.
struct ModuleServices {
  CommandBoard& board;
  ConnectionRoster& roster;
  const TokenGuard& guard;
  const Clock& clock;
  std::string version;
};

/// `Peer` may extend the data kept per connection.
template <std::derived_from<ModulePeer> Peer>
class PeerModule : public Endpoint, protected ReadingSource, private StepListener {
 public:
  const std::string& path() const final { return path_; }
  const CommandTable& table() const final { return table_; }

  void OnOpen(Connection& connection) final {
    Peer& peer = peers_[connection.id()];
    peer.connection = &connection;
    peer.client.client.id = connection.id();
    peer.client.client.peer = connection.peer();
    peer.client.client.input_ended = connection.input_ended();
    peer.client.client.input_end = connection.input_end();
    peer.client.client.is_remote = !connection.trusted();
    peer.client.trusted = connection.trusted();
    services_.roster.Add({connection.id(), path_, connection.peer(), {}});
  }

  void OnRequest(Connection& connection, Message request, ReplyFunction reply) final {
    const StepInbox::Scope scope(inbox_, connection.id());
    Peer* const peer = FindPeer(connection.id());
    if (peer == nullptr) return;
    if (std::optional<Message> refusal = Refuse(request)) {
      reply(std::move(*refusal));
      return;
    }
    if (connection.output_ended() && ModuleCore::OnlyReads(*table_.Find(request.command))) {
      reply(ReplyTo(request.command));
      return;
    }
    peer->client.client.input_ended = connection.input_ended();
    if (peer->client.client.party != connection.party()) peer->client.client.party = connection.party();
    if (board().is_real_time()) Heard(*peer, services_.clock.Now());
    peer->command = request.command;
    peer->text.clear();
    peer->reply = std::move(reply);
    std::optional<Message> answer = Answer(*peer, request);
    if (!answer) {
      if (const std::optional<StepResult> ended = inbox_.TakeOwn()) EndWait(*peer, *ended);
      return;
    }
    const bool done = answer->error == 0;
    Finish(*peer, std::move(*answer));
    OnAnswered(request, done);
  }

  void OnTakesMore(Connection& /*connection*/) final { inbox_.TakesMore(); }

  void OnInputEnded(Connection& connection) final {
    const StepInbox::Scope scope(inbox_);
    Peer* const peer = FindPeer(connection.id());
    if (peer == nullptr) return;
    peer->client.client.input_ended = true;
    InputEnded(connection.id());
  }

  void OnClosed(Connection& connection) final {
    const StepInbox::Scope scope(inbox_);
    recent_ = nullptr;
    peers_.erase(connection.id());
    services_.roster.Remove(connection.id());
    ListenForSteps();
    Closed(connection.id());
  }

  std::string WaitingFor() final {
    std::size_t total = 0;
    return DescribeWaiting(board().Awaiting(services_.clock.Now(), 1, &total));
  }

  /// Closes the client's connection with a notice, if it belongs to this module.
  void CloseClient(ClientId client, const std::string& reason) {
    if (Peer* const peer = FindPeer(client)) peer->connection->Close(reason);
  }

 protected:
  /// Any thread. `table` and `inbox` may be members of the derived class. Its destructor must close the inbox
  /// or call StopListening().
  PeerModule(ModuleServices services, std::string path, const CommandTable& table, StepInbox& inbox)
      : services_(std::move(services)),
        path_(std::move(path)),
        table_(table),
        inbox_(inbox),
        core_(table_, *this, services_.guard, services_.version) {}

  /// The error reply to an invalid request; nullopt if it is valid.
  virtual std::optional<Message> Refuse(const Message& request) const { return core_.Refuse(request); }
  /// The immediate answer; nullopt if the reply comes later, by Finish() or at the end of a wait.
  virtual std::optional<Message> Answer(Peer& peer, const Message& request) = 0;
  /// Called after the reply of Answer() to `request`; `done`: it was no error.
  virtual void OnAnswered(const Message& /*request*/, bool /*done*/) {}
  /// The reply to the pending request of `peer` after the step has run.
  virtual Message Stepped(Peer& peer, const StepResult& result) {
    return core_.StepReply(peer.client, peer.command, std::move(peer.text), *result.frame, result.mode);
  }
  /// The client that has replaced another one whose wait ended with kReplaced; empty if not known.
  virtual std::string NewOwner() { return {}; }
  /// In real time, before Answer(): reports to the board that the client is alive.
  virtual void Heard(const Peer& /*peer*/, Nanoseconds /*now*/) {}
  /// Called before the subscriptions of `peer` are served.
  virtual void BeforePush(Peer& /*peer*/, const Frame& /*frame*/) {}
  /// The client's input has ended, or its connection is closed.
  virtual void InputEnded(ClientId /*client*/) {}
  virtual void Closed(ClientId /*client*/) {}
  // ReadingSource, for modules without attachable readings
  std::span<const std::string> attachable() const override { return {}; }
  void AppendReading(std::size_t, const Frame&, std::vector<double>&) override {}

  /// Answers the common commands, and every request before the first frame. Otherwise sets `frame` to the
  /// newest one and returns nullopt.
  std::optional<Message> AnswerCommon(Peer& peer, const Message& request, FramePtr& frame) {
    frame = inbox_.Current();
    if (frame == nullptr)
      return ErrorReply(request.command, Error::kNotPossible, "the simulation has not begun yet");
    const Mode mode = request.command == command::kGetTime ? board().mode() : Mode::kRealtime;
    std::optional<Message> common = core_.AnswerCommon(peer.client, request, *frame, mode);
    if (common) ListenForSteps();
    return common;
  }
  /// `hello`: stores name and token. Returns an error reply, or nullopt on success.
  std::optional<Message> TakeHello(Peer& peer, const Message& request) {
    std::optional<Message> refusal = core_.TakeHello(peer.client, request, services_.clock.Now());
    if (!refusal) services_.roster.SetName(peer.id(), peer.client.client.name);
    return refusal;
  }
  /// A successful reply to `request`, stamped with the newest frame.
  Message Done(const Message& request, std::string text = {}) {
    Message reply = ReplyTo(request.command, std::move(text));
    ModuleCore::Stamp(reply, *inbox_.Current());
    return reply;
  }
  /// The callback for the board; Stepped() makes the reply when the wait ends.
  StepDone Waiter(const Peer& peer) { return inbox_.Waiter(*this, peer.id()); }
  /// Null if the connection is gone or has no pending request.
  Peer* FindWaiting(ClientId client) {
    Peer* const peer = FindPeer(client);
    return peer != nullptr && peer->reply ? peer : nullptr;
  }
  /// Replies to the pending request of `peer`.
  static void Finish(Peer& peer, Message reply) { std::exchange(peer.reply, nullptr)(std::move(reply)); }

  /// Sends `reading` again to its subscribers although no step has run.
  void PushAgain(command::Id reading) {
    const StepInbox::Scope scope(inbox_);
    const FramePtr frame = inbox_.Current();
    for (auto& [id, peer] : peers_) core_.PushAgain(*peer.connection, peer.client, reading, frame);
    core_.ForgetReadings();
  }

  /// Ends all subscriptions at the inbox.
  void StopListening() { inbox_.Unsubscribe(*this); }

  CommandBoard& board() { return services_.board; }
  StepInbox& inbox() { return inbox_; }
  ModuleCore& core() { return core_; }

 private:
  void EndWait(Peer& peer, const StepResult& result) {
    if (peer.connection->output_ended()) return Finish(peer, ReplyTo(peer.command));
    if (result.end == StepEnd::kRan) return Finish(peer, Stepped(peer, result));
    Finish(peer,
           WaitEnded(peer.command, result, result.end == StepEnd::kReplaced ? NewOwner() : std::string()));
  }
  // StepListener
  void OnStepEnd(ClientId client, const StepResult& result) final {
    if (Peer* const peer = FindWaiting(client)) EndWait(*peer, result);
  }
  bool OnFrame(const FramePtr& frame, int dropped) final {
    bool taken = false;
    for (auto& [id, peer] : peers_) {
      if (peer.client.subscriptions.empty()) continue;
      BeforePush(peer, *frame);
      taken |= core_.PushDue(*peer.connection, peer.client, frame, dropped);
    }
    core_.ForgetReadings();
    return taken || !ModuleCore::MayKeep(*frame);
  }

  /// Null if the connection is gone.
  Peer* FindPeer(ClientId client) {
    if (recent_ != nullptr && recent_->id() == client) return recent_;
    const auto found = peers_.find(client);
    return found == peers_.end() ? nullptr : recent_ = &found->second;
  }
  void ListenForSteps() {
    bool subscribed = false;
    for (const auto& [id, peer] : peers_) subscribed |= !peer.client.subscriptions.empty();
    if (subscribed) {
      inbox_.Subscribe(*this);
    } else {
      inbox_.Unsubscribe(*this);
    }
  }

  const ModuleServices services_;
  const std::string path_;
  const CommandTable& table_;
  StepInbox& inbox_;
  ModuleCore core_;
  std::unordered_map<ClientId, Peer> peers_;
  Peer* recent_ = nullptr;  // of peers_: usually the next one needed
};

}  // namespace coopdyn
