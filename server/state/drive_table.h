// SPDX-License-Identifier: MIT
// The command board's data by actuator: who drives it, its set-points in force, and what is pending for the
// next steps. The board decides what a request may do and whom a step answers.
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

/// Names an actuator module for the life of the daemon (kept over reset, and over a load that keeps the
/// robot). 0: none.
using SlotId = std::uint32_t;
/// A connection as the board knows it.
struct Client {
  ClientId id = 0;
  std::string name;          // of `hello`; empty: none
  std::string peer;          // e.g. "127.0.0.1:53120"
  bool input_ended = false;  // may still have requests executed, but owns nothing
  bool is_team = false;      // a connection to /swarm: its name takes over only from such ones
  std::string party = {};    // Connection::party()
  std::shared_ptr<InputEnd> input_end = {};  // null: it has ended when `input_ended` says so
  bool is_remote = false;                    // neither of this machine nor the page

  const std::string& shown() const { return !name.empty() ? name : party.empty() ? peer : party; }
  bool has_ended() const { return input_ended || (input_end != nullptr && input_end->is_known()); }
  /// They act as one.
  bool IsAllyOf(const Client& other) const { return !party.empty() && party == other.party; }
  /// It is a connection of the program that `owner` is one of, as far as one can tell: by its name, which may
  /// go on with `:`, without names by its address.
  bool SpeaksFor(const Client& owner) const;
};

struct StepResult;
/// Called on the stepping thread, or on the thread whose call ended the wait; posts to its own thread and
/// returns.
using StepDone = std::function<void(const StepResult&)>;

/// A Drive and a Slot for each of the scene's actuators, in their order. An index is valid until Configure().
/// It has no lock of its own: the CommandBoard guards it with its lock.
class DriveTable {
 public:
  static constexpr std::size_t kNoSlot = static_cast<std::size_t>(-1);

  /// What every step looks at, small so that thousands stay in the cache.
  struct Drive {
    std::uint32_t robot = 0;          // index into the scene
    std::uint32_t first_channel = 0;  // of the scene's channels
    std::uint32_t channel_count = 0;
    ClientId owner = 0;  // connection; 0: nobody, or a controller
    ClientId pending_from = 0;
    std::uint64_t batch = 0;  // the StepAll() that what is pending belongs to; 0: none
    std::int32_t steps_left = 0;
    bool pending = false;       // a command or `ready` for the next step is there
    bool has_setpoint = false;  // it brings set-points; else what is in force is kept
    bool latched = false;       // it was there when the step that runs now began
    bool has_done = false;      // somebody waits for its end: Slot::done
    bool loses_client = false;  // on_disconnect acts once what is pending has run
    bool abandoned = false;     // its client, which had said hello, has gone, and its entry has no policy
    bool participates = false;  // by scenario or set_participants
    bool excused = false;       // by policy hold or stop: not waited for until its next command
    bool dropped = false;       // by policy drop: takes no part until its next command
    bool driven = false;        // by a loaded controller
    bool has_module = false;    // else nobody can command it
    bool silenced = false;      // its watchdog has stopped it: until its next command

    bool is_awaited() const { return participates && !dropped && !excused && !pending; }
  };
  /// The rest.
  struct Slot {
    static constexpr std::uint32_t kNoMessage = static_cast<std::uint32_t>(-1);

    SlotId id = 0;
    std::string robot, type, module;
    Client owner;                      // of Drive::owner
    std::optional<Nanoseconds> heard;  // when the owner said something last; nothing: it has just come
    Client former;                     // its input has ended, its requests may still run; id 0: it was lost
    std::string controller;            // while driven
    StepDone done;                     // of what is pending; null: answered already
    std::optional<double> deadline_s;
    LossPolicy on_deadline = LossPolicy::kHold;
    std::optional<LossPolicy> on_disconnect;
    std::optional<double> watchdog_s;    // its robot's or the scenario's; 0: none
    bool may_be_awaited = false;         // its robot's entry does not leave it out of `waits_for`
    bool may_participate = false;        // by its entry, were it not for the controller
    std::uint32_t message = kNoMessage;  // index into the messages for the next step
  };

  /// Lays out the slots for a new scene, at rest. Robots of the same name and type keep slot, owner and name;
  /// with `keep_participants` also whether they take part.
  /// `unloaded`: robots (by index, increasing) whose controller was taken away: clients drive them.
  void Configure(const Scene& scene, bool keep_participants, std::span<const int> unloaded = {});

  /// What was pending of a slot that is gone.
  struct Leaving {
    StepDone done;  // null: nobody waits
    std::uint64_t batch = 0;
  };
  /// Lays out the slots for an edited scene: those that stay keep all that they have.
  std::vector<Leaving> Revise(const Scene& scene, std::span<const int> unloaded);

  std::size_t size() const { return drives_.size(); }
  Drive& drive(std::size_t index) { return drives_[index]; }
  const Drive& drive(std::size_t index) const { return drives_[index]; }
  Slot& slot(std::size_t index) { return slots_[index]; }
  const Slot& slot(std::size_t index) const { return slots_[index]; }
  std::size_t robot_count() const { return first_slots_.size() - 1; }
  /// Index of the first slot of a robot, given by its index in the scene; of robot_count(): size().
  std::size_t first_slot(std::size_t robot) const { return first_slots_[robot]; }
  /// Some robot has a deadline.
  bool has_deadlines() const { return has_deadlines_; }

  /// Index of a slot; kNoSlot if the robot is gone.
  std::size_t Find(SlotId id) const { return id < slot_index_.size() ? slot_index_[id] : kNoSlot; }
  /// Index of a robot in the scene; empty if none is called that.
  std::optional<std::size_t> FindRobot(const std::string& name) const;
  /// The slot of a module of a robot; if it has none of that name, the robot's first. 0: no such robot.
  SlotId FindSlot(const std::string& robot, const std::string& module) const;

  /// Client or controller that drives it; empty: nobody.
  std::string Who(std::size_t index) const;
  /// Its robot, or, if that has several actuator modules, `robot1/arm`.
  std::string NameOf(std::size_t index) const;
  /// "there are robot1, robot2 and 5 more (list shows all)".
  std::string NamesOfRobots() const;
  /// What to do about a robot without client.
  std::string CureForNoClient() const;

  /// The client owns it, or did until its input ended.
  bool IsOf(std::size_t index, ClientId client) const {
    const ClientId owner = drives_[index].owner;
    return owner == client || (owner == 0 && slots_[index].former.id == client);
  }
  /// If a client owns it, that one is called client.name from now on; `client` takes over from another of
  /// that name. Returns who lost it; 0: nobody.
  ClientId TakeOver(std::size_t index, const Client& client);

  /// Something new is pending from `client`; no `setpoints`: what is in force is kept.
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
  /// Takes the pending set-points in force; `commanded`, one for each slot: 1 if it has new ones.
  void Latch(std::span<std::uint8_t> commanded);
  /// By the scene's channels.
  const std::vector<Setpoint>& in_force() const { return in_force_; }
  /// Ignored if it is not one for each channel.
  void SetInForce(std::span<const Setpoint> setpoints) {
    if (setpoints.size() == in_force_.size()) std::ranges::copy(setpoints, in_force_.begin());
  }

  /// Its set-points in force ask for motion, or a force.
  bool Moves(std::size_t index) const;
  /// Stops its set-points in force.
  void Stop(std::size_t index);
  /// Stops the pending set-points, too.
  void StopPending(std::size_t index);
  void ApplyPolicy(std::size_t index, LossPolicy policy);
  std::size_t CountAwaited() const {
    return static_cast<std::size_t>(std::ranges::count_if(drives_, &Drive::is_awaited));
  }

 private:
  /// The channels of a slot among those of all.
  auto Of(std::size_t index, auto& channels) const {
    return std::span(channels).subspan(drives_[index].first_channel, drives_[index].channel_count);
  }

  std::vector<Drive> drives_;
  std::vector<Slot> slots_;
  std::vector<Setpoint> in_force_;                        // by the scene's channels
  std::vector<Setpoint> commanded_;                       // likewise; of what is pending
  std::vector<std::size_t> first_slots_{0};               // by robot, and one more at the end
  std::vector<std::size_t> slot_index_;                   // SlotId → index, or kNoSlot
  std::unordered_map<std::string, std::size_t> by_name_;  // robot → its index in the scene
  SlotId next_slot_ = 1;
  bool has_deadlines_ = false;
};

}  // namespace coopdyn
