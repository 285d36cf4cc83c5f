// SPDX-License-Identifier: MIT
// What the modules that concern the whole simulation do alike: their connections, the requests that wait, the
// common commands, edits between two steps. Free of sockets. The control thread only.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "protocol/command_table.h"
#include "server/base/clock.h"
#include "server/devices/connection_roster.h"
#include "server/devices/module_core.h"
#include "server/devices/step_inbox.h"
#include "server/devices/token_guard.h"
#include "server/net/endpoint.h"
#include "server/state/command_board.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"

namespace coopdyn {

/// What every global module acts on; all outlives it.
struct GlobalServices {
  CommandBoard& board;
  const FrameBoard& frames;
  EditQueue& edits;
  ConnectionRoster& roster;
  const TokenGuard& guard;  // required
  const Clock& clock;
  std::string version;
};

class GlobalModule : public Endpoint, private ReadingSource, private StepListener {
 public:
  /// On the control thread, or when it has stopped.
  ~GlobalModule() override;

  const CommandTable& table() const override { return table_; }
  void OnOpen(Connection& connection) override;
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override;
  void OnClosed(Connection& connection) override;
  std::string WaitingFor() override;

 protected:
  /// A connection, and the request that it waits for.
  struct Peer {
    ModuleClient client;
    ReplyFunction reply;  // null: nothing is waiting
    command::Id command = 0;
    std::string text;  // of the reply

    ClientId id() const { return client.client.id; }
  };
  /// Called with the result of an edit, on this thread, before its reply.
  using AfterEdit = std::function<void(const EditResult&)>;

  /// Any thread. `post` runs a function on the control thread.
  GlobalModule(GlobalServices services, CommandTable table, StepInbox::Post post);

  /// Answers a get-command, without time_s and step.
  Message Read(const Message& request, const Frame& frame) override = 0;
  command::Id first_reading() const override = 0;
  /// The error reply to a request that cannot be; nothing if it is fine.
  virtual std::optional<Message> Refuse(const Message& request) const { return core_.Refuse(request); }
  /// Commands that need no right: those that get_ something.
  virtual bool IsReading(const CommandSpec& spec) const { return spec.name.starts_with("get_"); }
  /// Answers a reading; nothing if the reply comes later.
  virtual std::optional<Message> ReadLater(Peer& peer, const Message& request);
  /// Acts on one of the module's own commands that change something, from a client who may: answers at once,
  /// or nothing if the reply comes later.
  virtual std::optional<Message> Change(Peer& peer, const Message& request) = 0;
  /// After the reply to `request`.
  virtual void OnAnswered(const Message& /*request*/, const Message& /*reply*/) {}

  /// Hands the edit to the stepping thread; the reply follows: empty, or the peer's text.
  std::optional<Message> Push(Peer& peer, EditAction action, AfterEdit after = nullptr);
  /// What to call, once, from any thread, with the result of something that takes its time: the reply
  /// follows, after `after`.
  std::function<void(const EditResult&)> Later(const Peer& peer, AfterEdit after = nullptr);
  /// For edit::Step and its like: the reply follows when the wait ends.
  StepDone Waiter(const Peer& peer) { return inbox_.Waiter(*this, peer.id()); }
  /// A reply without error to `request`, stamped with the newest frame.
  Message Done(const Message& request, std::string text = {});
  const std::string& path() const { return path_; }

 private:
  // ReadingSource
  std::span<const std::string> attachable() const override { return {}; }
  void AppendReading(std::size_t, const Frame&, std::vector<double>&) override {}
  // StepListener
  void OnStepEnd(ClientId client, const StepResult& result) override;
  void OnFrame(const FramePtr& frame, int dropped) override;

  /// Answers at once; nothing if the reply comes later (it is kept in `peer`).
  std::optional<Message> Answer(Peer& peer, const Message& request);
  void OnEditDone(ClientId client, const EditResult& result, const AfterEdit& after);
  void ListenForSteps();

  const GlobalServices services_;
  const CommandTable table_;
  const std::string path_;  // "/simulation"
  ModuleCore core_;
  std::unordered_map<ClientId, Peer> peers_;
  StepInbox inbox_;
};

}  // namespace coopdyn
