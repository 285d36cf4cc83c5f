// SPDX-License-Identifier: MIT
// One module of a robot: a device with its connections, by the rules of DESIGN §4 and §5. Free of sockets.
// The robot's thread only.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>

#include "server/devices/module_core.h"
#include "server/devices/step_inbox.h"
#include "server/net/endpoint.h"
#include "server/robot/robot_core.h"

namespace coopdyn {

class RobotModule final : public Endpoint, private ReadingSource, private StepListener {
 public:
  /// Module number `index` of `robot`, which outlives it. Any thread.
  RobotModule(RobotCore& robot, std::size_t index);
  ~RobotModule() override;

  /// "/robot1/motors"
  const std::string& path() const { return path_; }
  const CommandTable& table() const override { return device_.table(); }
  void OnOpen(Connection& connection) override;
  void OnRequest(Connection& connection, Message request, ReplyFunction reply) override;
  void OnInputEnded(Connection& connection) override;
  void OnClosed(Connection& connection) override;
  std::string WaitingFor() override;
  /// Closes that connection with a notice, if it is one of this module's.
  void CloseClient(ClientId client, const std::string& reason);

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
  command::Id first_reading() const override { return device_.first_reading(); }
  std::span<const std::string> attachable() const override { return robot_.module_names(); }
  void AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) override;
  // StepListener
  void OnStepEnd(ClientId client, const StepResult& result) override;
  void OnFrame(const FramePtr& frame, int dropped) override;

  /// Answers what needs no step; nothing if the request must wait (and has its reply in `peer`).
  std::optional<Message> Answer(Peer& peer, const Message& request);
  std::optional<Message> Drive(Peer& peer, const Message& request, Actuation actuation);
  Message Send(Peer& peer, const Message& request, const RobotMessage& message);
  std::optional<Message> Ready(Peer& peer, const Message& request);
  Message Hello(Peer& peer, const Message& request);
  Message ClaimOrRelease(Peer& peer, const Message& request);
  /// The reply that `verdict` allows now; nothing if the board will call back.
  std::optional<Message> Settle(Peer& peer, const Verdict& verdict);
  /// Null: the connection is gone.
  Peer* FindPeer(ClientId client);
  void ListenForSteps();
  CommandBoard& board() { return robot_.services().board; }

  RobotCore& robot_;
  const Device& device_;
  const std::string path_;
  ModuleCore core_;
  std::unordered_map<ClientId, Peer> peers_;
  Peer* recent_ = nullptr;  // of peers_: mostly the same one is meant again
};

}  // namespace coopdyn
