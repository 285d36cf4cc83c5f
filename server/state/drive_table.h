// SPDX-License-Identifier: MIT
// The command board's data per actuator: owner, set-points in force, and pending commands. The board decides
// whether a request is allowed and whom a step answers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/base/ids.h"
#include "server/base/input_end.h"
#include "server/model/scenario.h"
#include "server/state/scene.h"

namespace coopdyn {

/// Identifies an actuator module for the life of the daemon (kept over a reset, and over a load that keeps
/// the robot). 0: none.
using SlotId = std::uint32_t;
/// The board's view of a connection.
struct Client {
  ClientId id = 0;
  std::string name;          // from `hello`; empty: none
  std::string peer;          // e.g. "127.0.0.1:53120"
  bool input_ended = false;  // its requests may still run, but it owns nothing
  bool is_team = false;      // a connection to /swarm: takes over only from such connections of its name
  std::string party = {};    // Connection::party()
  std::shared_ptr<InputEnd> input_end = {};  // null: only `input_ended` reports the end
  bool is_remote = false;                    // neither on this machine nor the page

  const std::string& shown() const { return !name.empty() ? name : party.empty() ? peer : party; }
  bool has_ended() const { return input_ended || (input_end != nullptr && input_end->is_known()); }
  /// True if both act as one client.
  bool IsAllyOf(const Client& other) const { return !party.empty() && party == other.party; }
  /// True if this connection seems to belong to the same program as `owner`: same name, or that name followed
  /// by `:…`; without names, same host.
  bool SpeaksFor(const Client& owner) const;
};

struct StepResult;
/// Called on the stepping thread, or on the thread that ended the wait. Posts to its own thread and returns.
using StepDone = std::function<void(const StepResult&)>;

/// A Drive and a Slot per actuator of the scene, in its order. An index is valid until Configure(). Not
/// thread-safe: the CommandBoard's lock guards it.
class DriveTable {
 public:
  static constexpr std::size_t kNoSlot = static_cast<std::size_t>(-1);

  /// The data that every step reads; small, to keep thousands in the cache.
  struct Drive {
    std::uint32_t robot = 0;          // index into the scene's robots
    std::uint32_t first_channel = 0;  // index into the scene's channels
    std::uint32_t channel_count = 0;
    ClientId owner = 0;  // connection; 0: nobody, or a controller
    ClientId pending_from = 0;
    std::uint64_t batch = 0;  // the StepAll() of the pending request; 0: none
    std::int32_t steps_left = 0;
    bool pending = false;       // a command or `ready` for the next step has arrived
    bool has_setpoint = false;  // the pending command has set-points; else those in force stay
    bool latched = false;       // the pending command was latched
    bool has_done = false;      // a caller waits for it: Slot::done
    bool loses_client = false;  // on_disconnect applies once the pending request has run
    bool abandoned = false;     // its client, which had said hello, is gone, and the robot's entry has no
                                // policy
    bool participates = false;  // by scenario or set_participants
    bool excused = false;       // by policy hold or stop: not awaited until its next command
    bool dropped = false;       // by policy drop: not a participant until its next command
    bool driven = false;        // by a loaded controller
    bool has_module = false;    // else it accepts no commands
    bool silenced = false;      // stopped by its watchdog until its next command

    bool is_awaited() const { return participates && !dropped && !excused && !pending; }
  };
  /// The remaining data of an actuator.
  struct Slot {
    static constexpr std::uint32_t kNoMessage = static_cast<std::uint32_t>(-1);

    SlotId id = 0;
    std::string robot, type, module;
    Client owner;                      // of Drive::owner
    std::optional<Nanoseconds> heard;  // when the owner last sent something; nullopt: it is new
    Client former;                     // a client whose input has ended but whose requests may still run; id
                                       // 0: none
    std::string controller;            // while driven
    StepDone done;                     // of the pending request; null: nobody waits
    std::optional<double> deadline_s;
    LossPolicy on_deadline = LossPolicy::kHold;
    std::optional<LossPolicy> on_disconnect;
    std::optional<double> watchdog_s;    // the robot's or the scenario's; 0: none
    bool may_be_awaited = false;         // the robot's entry does not exclude it from `waits_for`
    bool may_participate = false;        // by its entry, ignoring the controller
    std::uint32_t message = kNoMessage;  // index into the messages for the next step
  };

  /// Lays out the slots for a new scene, at rest. Robots of the same name and type keep slot, owner and name,
  /// and with `keep_participants` also their participation. `unloaded`: robots (by index, increasing) whose
  /// controller was unloaded: clients drive them.
  void Configure(const Scene& scene, bool keep_participants, std::span<const int> unloaded = {});

  /// The pending request of a removed slot.
  struct Leaving {
    StepDone done;  // null: nobody waits
    std::uint64_t batch = 0;
  };
  /// Lays out the slots for an edited scene: remaining slots keep all their state.
  std::vector<Leaving> Revise(const Scene& scene, std::span<const int> unloaded);

  std::size_t size() const { return drives_.size(); }
  Drive& drive(std::size_t index) { return drives_[index]; }
  const Drive& drive(std::size_t index) const { return drives_[index]; }
  Slot& slot(std::size_t index) { return slots_[index]; }
  const Slot& slot(std::size_t index) const { return slots_[index]; }
  std::size_t robot_count() const { return first_slots_.size() - 1; }
  /// Index of a robot's first slot, by the robot's index in the scene; size() for robot_count().
  std::size_t first_slot(std::size_t robot) const { return first_slots_[robot]; }
  /// True if any robot has a deadline.
  bool has_deadlines() const { return has_deadlines_; }

  /// The slot's index; kNoSlot if its robot has been removed.
  std::size_t Find(SlotId id) const { return id < slot_index_.size() ? slot_index_[id] : kNoSlot; }
  /// A robot's index in the scene; nullopt if there is none of that name.
  std::optional<std::size_t> FindRobot(const std::string& name) const;
  /// The slot of a robot's module; the robot's first slot if it has no such module. 0: no such robot.
  SlotId FindSlot(const std::string& robot, const std::string& module) const;

  /// The client or controller that drives it; empty: nobody.
  std::string Who(std::size_t index) const;
  /// The robot's name; `robot1/arm` if the robot has several actuator modules.
  std::string NameOf(std::size_t index) const;
  /// "there are robot1, robot2 and 5 more (list shows all)".
  std::string NamesOfRobots() const;
  /// Advice for a robot without client.
  std::string CureForNoClient() const;

  /// True if the client owns it, or did until the client's input ended.
  bool IsOf(std::size_t index, ClientId client) const {
    const ClientId owner = drives_[index].owner;
    return owner == client || (owner == 0 && slots_[index].former.id == client);
  }
  /// If `client` owns the slot, updates the owner's name; if another client of that name does, `client` takes
  /// over. Returns the former owner; 0: none.
  ClientId TakeOver(std::size_t index, const Client& client);

  /// Stores a request of `client`; empty `setpoints`: those in force stay.
  void SetPending(std::size_t index, ClientId client, std::span<const Setpoint> setpoints, int steps);
  void ClearPending(std::size_t index) {
    Drive& drive = drives_[index];
    drive.pending = drive.has_setpoint = drive.latched = false;
    drive.pending_from = 0;
    drive.batch = 0;
    drive.steps_left = 0;
    if (drive.has_done) slots_[index].done = nullptr;
    drive.has_done = false;
  }
  /// Puts the pending set-points in force. `commanded`, one per slot: set to 1 if the slot has new ones.
  void Latch(std::span<std::uint8_t> commanded);
  /// By the scene's channels.
  const std::vector<Setpoint>& in_force() const { return in_force_; }
  /// Ignored unless there is one set-point per channel.
  void SetInForce(std::span<const Setpoint> setpoints) {
    if (setpoints.size() == in_force_.size()) std::ranges::copy(setpoints, in_force_.begin());
  }

  /// True if its set-points in force ask for motion or force.
  bool Moves(std::size_t index) const;
  /// Stops its set-points in force.
  void Stop(std::size_t index);
  /// Also stops the pending set-points.
  void StopPending(std::size_t index);
  void ApplyPolicy(std::size_t index, LossPolicy policy);
  std::size_t CountAwaited() const {
    return static_cast<std::size_t>(std::ranges::count_if(drives_, &Drive::is_awaited));
  }

 private:
  /// The slot's part of all channels.
  auto Of(std::size_t index, auto& channels) const {
    return std::span(channels).subspan(drives_[index].first_channel, drives_[index].channel_count);
  }

  std::vector<Drive> drives_;
  std::vector<Slot> slots_;
  std::vector<Setpoint> in_force_;                        // by the scene's channels
  std::vector<Setpoint> commanded_;                       // of pending requests; by the scene's channels
  std::vector<std::size_t> first_slots_{0};               // by robot, plus the end
  std::vector<std::size_t> slot_index_;                   // SlotId → index, or kNoSlot
  std::unordered_map<std::string, std::size_t> by_name_;  // robot → its index in the scene
  SlotId next_slot_ = 1;
  bool has_deadlines_ = false;
};

}  // namespace coopdyn
