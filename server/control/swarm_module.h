// SPDX-License-Identifier: MIT
// /swarm: one connection drives many robots, with one step of all per round trip. Free of sockets. The
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

  std::vector<int> team;               // robots that it owns: indices into `scene`, increasing
  std::size_t sensors = 0;             // largest number of distance sensors of a robot in the team
  std::shared_ptr<const Scene> scene;  // of `team`
  std::uint64_t team_revision = 0;     // of the board, at the last update of `team`
  std::uint64_t layout_revision = 0;
  std::vector<std::string> lost;  // robots lost to other clients, not yet reported
  std::vector<int> rows;          // of the reply to step_all
  std::shared_ptr<const Scene> rows_scene;
};

class SwarmModule final : public PeerModule<TeamPeer> {
 public:
  /// Any thread. The guard of `services` is that of the robots' own modules. `threads`: number of threads
  /// that compute readings. `post` runs a function on the control thread.
  SwarmModule(const GlobalServices& services, int threads, StepInbox::Post post);
  /// On the control thread, or after it has stopped.
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
  /// Mode, rows, columns and the readings of `rows` in `frame`; or error 8.
  Message Table(const Peer& peer, command::Id command, const Frame& frame, Mode mode,
                std::span<const int> rows);

  /// Updates the peer's team from board and scene. `quiet`: the peer itself gave up missing robots.
  void Refresh(Peer& peer, const Frame& frame, bool quiet = false);
  /// Records the robots of `old` that are no longer in the team.
  static void NoteLost(Peer& peer, std::span<const int> old, const std::shared_ptr<const Scene>& old_scene);
  /// `no longer in the team: robot3`; empty if none.
  static std::string LostText(std::span<const std::string> lost);
  /// Converts the reply's rows to the scene of `frame`.
  static void MoveRows(Peer& peer, const Frame& frame);
  /// The robots that the params name; without params the whole team. Returns an error reply if they are not
  /// valid.
  std::optional<Message> FindRows(const Peer& peer, const Message& request, std::vector<int>& rows);
  /// Error 8 if the reply would be too large.
  static std::optional<Message> RefuseSize(const Peer& peer, command::Id command, const Scene& scene,
                                           std::span<const int> rows);
  /// The largest number of distance sensors of a robot, but at least `at_least`.
  static std::size_t MostSensors(const Scene& scene, std::span<const int> rows, std::size_t at_least);
  /// The slots of all actuators of these robots.
  std::vector<SlotId> SlotsOf(std::span<const int> robots) const;
  void AddSlots(int robot, std::vector<SlotId>& slots) const;

  const CommandTable table_;
  WorkerPool pool_;
  const Peer* pushed_to_ = nullptr;  // the peer whose subscriptions are being served

  std::shared_ptr<const Scene> scene_;  // newest scene seen
  std::uint64_t layout_revision_ = 0;   // of the board, at the last update of slots_
  std::vector<SlotId> slots_;           // of the actuators of scene_
  std::vector<int> robot_of_slot_;      // SlotId → index into scene_, −1: none
  std::vector<std::uint32_t> marks_;    // by robot of scene_: mark_ of the last request that named it
  std::uint32_t mark_ = 0;
  TeamCommands commands_;            // of the current request
  std::vector<Setpoint> setpoints_;  // of the current request
  StepInbox inbox_;
};

}  // namespace coopdyn
