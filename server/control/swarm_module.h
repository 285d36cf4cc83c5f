// SPDX-License-Identifier: MIT
// /swarm: one connection drives many robots, one step of all of them per round trip. Free of sockets. The
// control thread only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/command_table.h"
#include "server/base/worker_pool.h"
#include "server/control/global_module.h"
#include "server/control/team_commands.h"
#include "server/control/team_readings.h"
#include "server/devices/peer_module.h"
#include "server/devices/step_inbox.h"
#include "server/state/command_board.h"

namespace coopdyn {

/// A connection and its team.
struct TeamPeer : ModulePeer {
  TeamPeer() { client.client.is_team = true; }

  TeamReadings readings;

  std::vector<int> team;               // what it owns: indices into `scene`, increasing
  std::size_t sensors = 0;             // distance sensors of the team's robot with the most
  std::shared_ptr<const Scene> scene;  // of `team`
  std::uint64_t team_revision = 0;     // of the board, when `team` was asked for
  std::uint64_t layout_revision = 0;
  std::vector<std::string> lost;  // robots that others took away, not told yet
  std::vector<int> rows;          // of the reply to step_all
  std::shared_ptr<const Scene> rows_scene;
};

class SwarmModule final : public PeerModule<TeamPeer> {
 public:
  /// Any thread. The guard of `services` is that of the robots' own modules; `threads` compute readings;
  /// `post` runs a function on the control thread.
  SwarmModule(const GlobalServices& services, int threads, StepInbox::Post post);
  /// On the control thread, or when it has stopped.
  ~SwarmModule() override;

 private:
  using Peer = TeamPeer;

  // ReadingSource
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetTeam; }
  bool reads_alike() const override { return false; }

  std::optional<Message> Answer(Peer& peer, const Message& request) override;
  Message Stepped(Peer& peer, const StepResult& result) override;
  void BeforePush(Peer& peer, const Frame& frame) override;
  void Heard(const Peer& peer, Nanoseconds now) override { board().NoteHeardAll(peer.id(), now); }
  void InputEnded(ClientId client) override { board().InputEndedAll(client); }
  void Closed(ClientId client) override { board().ClosedAll(client); }

  std::optional<Message> Change(Peer& peer, const Message& request, const Frame& frame);
  Message Hello(Peer& peer, const Message& request);
  Message ClaimOrRelease(Peer& peer, const Message& request, const Frame& frame);
  std::optional<Message> Ready(Peer& peer, const Message& request);
  std::optional<Message> StepAll(Peer& peer, const Message& request);
  Message Select(Peer& peer, const Message& request, const Frame& frame);
  Message ReadAll(Peer& peer, const Message& request, const Frame& frame);
  Message Team(const Peer& peer, command::Id command) const;
  /// mode, rows, columns and the readings of `rows` in `frame`; or error 8.
  Message Table(const Peer& peer, command::Id command, const Frame& frame, Mode mode,
                std::span<const int> rows);

  /// Brings the peer's team up to date with board and scene. `quiet`: what is missing was given up by the
  /// peer itself.
  void Refresh(Peer& peer, const Frame& frame, bool quiet = false);
  /// Notes which robots of `old` are not in the team any more.
  static void NoteLost(Peer& peer, std::span<const int> old, const std::shared_ptr<const Scene>& old_scene);
  /// `no longer in the team: robot3`; empty if there are none.
  static std::string LostText(std::span<const std::string> lost);
  /// The rows of the reply in the scene of `frame`.
  static void MoveRows(Peer& peer, const Frame& frame);
  /// The robots that the params name, or the whole team without; an error reply if they cannot be told.
  std::optional<Message> FindRows(const Peer& peer, const Message& request, std::vector<int>& rows);
  /// What wants room for more than a reply may have gets error 8.
  static std::optional<Message> RefuseSize(const Peer& peer, command::Id command, const Scene& scene,
                                           std::span<const int> rows);
  /// Distance sensors of the robot with the most, but not less than `at_least`.
  static std::size_t MostSensors(const Scene& scene, std::span<const int> rows, std::size_t at_least);
  /// The slots of all actuators of these robots.
  std::vector<SlotId> SlotsOf(std::span<const int> robots) const;
  void AddSlots(int robot, std::vector<SlotId>& slots) const;

  const CommandTable table_;
  WorkerPool pool_;
  const Peer* pushed_to_ = nullptr;  // whose subscriptions are served

  std::shared_ptr<const Scene> scene_;  // the newest seen
  std::uint64_t layout_revision_ = 0;   // of the board, when slots_ was asked for
  std::vector<SlotId> slots_;           // of the actuators of scene_
  std::vector<int> robot_of_slot_;      // SlotId → index into scene_, −1: none
  std::vector<std::uint32_t> marks_;    // by robot of scene_: named by the request number mark_
  std::uint32_t mark_ = 0;
  TeamCommands commands_;            // of the present request
  std::vector<Setpoint> setpoints_;  // likewise
  StepInbox inbox_;
};

}  // namespace coopdyn
