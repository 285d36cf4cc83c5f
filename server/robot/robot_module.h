// SPDX-License-Identifier: MIT
// One module of a robot: a device with its connections, by the rules of docs/protocol.md. Free of sockets.
// The robot's thread only.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/devices/peer_module.h"
#include "server/robot/robot_core.h"

namespace coopdyn {

class RobotModule final : public PeerModule<ModulePeer> {
 public:
  /// Module `index` of `robot`, which outlives it. Any thread.
  RobotModule(RobotCore& robot, std::size_t index);
  ~RobotModule() override;

  std::string DriverBeside(const Connection& connection) const override;

 private:
  using Peer = ModulePeer;

  // ReadingSource
  Message Read(const Message& request, const Frame& frame) override;
  const Frame& Shown(const Frame& frame) override;
  command::Id first_reading() const override { return device_.first_reading(); }
  std::span<const std::string> attachable() const override { return robot_.module_names(); }
  void AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) override;

  std::optional<Message> Refuse(const Message& request) const override;
  std::optional<Message> Answer(Peer& peer, const Message& request) override;
  Message Stepped(Peer& peer, const StepResult& result) override;
  std::string NewOwner() override;
  void Heard(const Peer& peer, Nanoseconds now) override {
    board().NoteHeard(slot_, peer.client.client, now);
  }
  void InputEnded(ClientId client) override;
  void Closed(ClientId client) override;

  std::optional<Message> Drive(Peer& peer, const Message& request, Actuation actuation);
  /// Changes control parameters of joints, between two steps.
  std::optional<Message> Tune(Peer& peer, const Message& request, edit::TuneJoints tuning);
  /// Requests a picture from the render thread.
  void Draw(Peer& peer, ImageRequest picture);
  Message Send(Peer& peer, const Message& request, const RobotMessage& message);
  std::optional<Message> Ready(Peer& peer, const Message& request);
  Message Hello(Peer& peer, const Message& request);
  Message ClaimOrRelease(Peer& peer, const Message& request);
  /// Device::StepNote(), or kAborted once the run has ended.
  std::string StepNote(const Frame& frame, int robot) const;
  /// The reply to `verdict`; nullopt if the board will call back.
  std::optional<Message> Settle(Peer& peer, const Verdict& verdict);

  RobotCore& robot_;
  const Device& device_;
  const std::vector<SlotId> slots_;  // of a device that drives all: all slots of its robot
  const SlotId slot_;                // the first; for a module without actuators, the robot's first
  const std::size_t index_;          // among the robot's modules
};

}  // namespace coopdyn
