// SPDX-License-Identifier: MIT
// The part shared by the modules of the whole simulation: readings open to all, edits between two steps. Free
// of sockets. The control thread only.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "protocol/command_table.h"
#include "server/base/clock.h"
#include "server/base/wrong_tokens.h"
#include "server/devices/connection_roster.h"
#include "server/devices/peer_module.h"
#include "server/devices/step_inbox.h"
#include "server/state/command_board.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"

namespace coopdyn {

/// The services of every global module; all outlive it.
struct GlobalServices {
  CommandBoard& board;
  const FrameBoard& frames;
  EditQueue& edits;
  ConnectionRoster& roster;
  const TokenGuard& guard;  // requires the token; /swarm uses the robots' guard
  const Clock& clock;
  std::string version;
  /// Brings up the robots' modules of a scene, then calls `done` on the control thread. Null: there are none.
  std::function<void(std::shared_ptr<const Scene>, std::function<void()> done)> apply_scene = nullptr;
  /// Tells everybody what a client, `by`, has done to the run. Null: nobody is told.
  std::function<void(const Frame&, std::string deed, const std::string& by)> tell = nullptr;
};

class GlobalModule : public PeerModule<ModulePeer> {
 public:
  /// On the control thread, or after it has stopped.
  ~GlobalModule() override;

 protected:
  using Peer = ModulePeer;
  /// Called with the result of an edit, on this thread, before its reply.
  using AfterEdit = std::function<void(const EditResult&)>;

  /// Any thread. `post` runs a function on the control thread.
  GlobalModule(GlobalServices services, CommandTable table, StepInbox::Post post);

  /// Answers a command that only reads and so needs no token; nullopt if the reply comes later.
  virtual std::optional<Message> ReadLater(Peer& peer, const Message& request);
  /// Executes one of the module's own commands that change state, for a client with that right. Returns the
  /// answer; nullopt if the reply comes later.
  virtual std::optional<Message> Change(Peer& peer, const Message& request) = 0;

  /// What the command with this result did to the run, for others to read, such as "reset"; empty: nothing
  /// that concerns them.
  virtual std::string DeedOf(command::Id /*command*/, const EditResult& /*result*/) const { return {}; }

  /// Passes the edit to the stepping thread. The reply follows: empty, or the peer's text.
  std::optional<Message> Push(Peer& peer, EditAction action, AfterEdit after = nullptr);
  /// A callback for the result of a slow operation. Call it once, from any thread: it calls `after`, then
  /// replies.
  std::function<void(const EditResult&)> Later(const Peer& peer, AfterEdit after = nullptr);
  /// Later() for edits that may change the robots: waits until all robots serve, then calls `then`, also
  /// after an error, and replies.
  std::function<void(const EditResult&)> LaterAllServe(const Peer& peer,
                                                       std::function<void()> then = nullptr);
  EditQueue& edits() { return edits_; }

 private:
  std::optional<Message> Answer(Peer& peer, const Message& request) override;
  Message Stepped(Peer& peer, const StepResult& result) override;
  void OnEditDone(ClientId client, const EditResult& result, const AfterEdit& after);

  EditQueue& edits_;
  const decltype(GlobalServices::apply_scene) apply_scene_;
  const decltype(GlobalServices::tell) tell_;
  const CommandTable table_;
  StepInbox inbox_;
};

}  // namespace coopdyn
