// SPDX-License-Identifier: MIT
// /simulation: how the run stands and goes on. Free of sockets. The control thread only.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <unordered_map>

#include "protocol/command_table.h"
#include "server/control/simulation_services.h"
#include "server/devices/module_core.h"
#include "server/devices/step_inbox.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class SimulationModule final : public Endpoint, private ReadingSource, private StepListener {
 public:
  static constexpr std::size_t kMaxListed = 256;  // robots and clients in one status
  static constexpr std::size_t kMaxAwaited = 20;

  /// Any thread. `post` runs a function on the control thread.
  SimulationModule(SimulationServices services, StepInbox::Post post);
  /// On the control thread, or when it has stopped.
  ~SimulationModule() override;

  const CommandTable& table() const override { return table_; }
  void OnOpen(Connection& connection) override;
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override;
  void OnClosed(Connection& connection) override;
  std::string WaitingFor() override;

  /// The text of get_status: robots `first` (from 1) and on, at most `count`.
  std::string StatusText(const Frame& frame, std::size_t first = 1, std::size_t count = kMaxListed) const;

 private:
  /// A connection, and the request that it waits for.
  struct Peer {
    Connection* connection = nullptr;
    ModuleClient client;
    ReplyFunction reply;  // null: nothing is waiting
    command::Id command = 0;
    std::string text;  // of the reply
  };

  // ReadingSource
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetStatus; }
  std::span<const std::string> attachable() const override { return {}; }
  void AppendReading(std::size_t, const Frame&, std::vector<double>&) override {}
  // StepListener
  void OnStepEnd(ClientId client, const StepResult& result) override;
  void OnFrame(const FramePtr& frame, int dropped) override;

  std::optional<Message> Refuse(const Message& request) const;
  /// Answers at once; nothing if the reply comes later (it is kept in `peer`).
  std::optional<Message> Answer(Peer& peer, const Message& request);
  std::optional<Message> Change(Peer& peer, const Message& request);
  std::optional<Message> SetStep(Peer& peer, const Message& request);
  std::optional<Message> Reset(Peer& peer, const Message& request);
  std::optional<Message> Load(Peer& peer, const Message& request);
  /// What `stop_all` has to say about robots that loaded controllers drive.
  std::string GoOnText() const;
  std::optional<Message> ReleaseRobot(Peer& peer, const Message& request);
  /// Hands the edit to the stepping thread; the reply follows.
  std::optional<Message> Push(Peer& peer, EditAction action);
  void OnEditDone(ClientId client, const EditResult& result, bool new_scene);
  Message Stamped(Message reply);
  void ListenForSteps();

  const SimulationServices services_;
  const CommandTable table_;
  ModuleCore core_;
  std::unordered_map<ClientId, Peer> peers_;
  StepInbox inbox_;
};

}  // namespace coopdyn
