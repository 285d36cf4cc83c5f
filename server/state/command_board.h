// SPDX-License-Identifier: MIT
// Who drives which robot, with what, for how many steps; and who waits for a step. The contract of lockstep
// (docs/protocol.md) lives here, free of sockets and threads: robot and control threads write commands, the
// stepping thread latches them and gets back whom to answer.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"
#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/state/drive_table.h"
#include "server/state/frame.h"

namespace coopdyn {

/// What nobody may do while a recording is played is answered with this.
inline constexpr const char* kPlayingText = "playing a recording: branch of /playback goes on live from here";

/// How a wait for a step ended.
enum class StepEnd {
  kRan,
  kReset,     // error 5 `reset`
  kLoad,      // error 5 `load`
  kRemoved,   // the robot was taken out of the world: error 5
  kReplaced,  // another client became owner first: error 6
  kPaused,    // `pause` ended a `step n`: error 5
  kStopping,  // the daemon ends: error 5
};

struct StepResult {
  StepEnd end = StepEnd::kRan;
  FramePtr frame;  // of the step that ended the wait, or the newest
  Mode mode = Mode::kRealtime;
  std::int64_t ran = 0, asked = 0;  // kPaused: steps of the `step n` that have run, and n
  std::string why = {};             // kStopping
};

/// The connection that owns what somebody else wants.
struct Holder {
  ClientId id = 0;
  std::shared_ptr<InputEnd> input_end = {};
};

/// The board's answer to a request.
struct Verdict {
  Error error = Error::kOk;
  std::string text = {};   // of the error
  bool answer_now = true;  // false: `done` will be called
  Mode mode = Mode::kRealtime;
  ClientId displaced = 0;  // hello: the connection that was taken over and must get its closing notice
  Holder holder = {};      // of kOwned
};

/// Whom the world waits for.
struct Awaited {
  std::string robot;
  std::string why;  // "no client", "no command from ana"
  double seconds = 0;
  std::string cure = {};  // what to do about it; empty: nothing but wait
};

/// What one connection wants of many robots in one step: all of it is accepted, or nothing happens.
struct TeamStep {
  std::span<const SlotId> slots;
  std::span<const Setpoint> setpoints;  // of the channels of `slots`, slot by slot; empty: they keep theirs
  std::span<const SlotId> others = {};  // more of the client's robots: they keep their set-points
};

/// A deadline that fired: an input of the run.
struct FiredDeadline {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;
};

/// A robot whose client has gone, and what that changed: an input of the run.
struct LostClient {
  std::size_t robot = 0;  // index into the scene
  std::string client;     // its name, else peer
  LossPolicy policy = LossPolicy::kStop;
  Nanoseconds silent = 0;  // it is there, but has said nothing for so long; 0: it has gone
};

/// The requests of all connections and what came of them. Any thread: one lock guards all but what the
/// stepping thread alone reads. Callbacks are never called with it held.
///
/// A client owns nothing once its input has ended, even if its connection's thread has yet to read that:
/// before the board refuses a request, it looks for the end of the input of whoever is in the way.
class CommandBoard {
 public:
  // --- robot threads and the control thread
  /// The slot of module `module` of `robot`; if it is no actuator module, or empty, the robot's first slot. 0
  /// if there is no such robot.
  SlotId FindSlot(const std::string& robot, const std::string& module = {}) const;
  /// The slots of the actuators of `scene`, in their order, found by the names of robots and modules.
  std::vector<SlotId> FindSlots(const Scene& scene) const;
  /// Who owns a slot: client name, else peer, or `controller diffuse`; empty: nobody.
  std::string OwnerOf(SlotId slot) const;
  /// The client, not `client` or one of its party, that owns a slot; empty: none does.
  std::string ClientBeside(SlotId slot, const Client& client);
  /// An actuator command: the client becomes owner if there is none. `steps` empty: one step, answered at
  /// once unless in lockstep; given (≥ 1): it stands for that many steps and is answered after the last, in
  /// every mode. If the verdict says answer_now, `done` is never called. `setpoints`: of the slot's channels.
  Verdict Command(SlotId slot, const Client& client, std::span<const Setpoint> setpoints,
                  std::optional<int> steps, StepDone done);
  /// `ready` on an actuator module: keeps the set-points; answered after `steps` steps in every mode.
  Verdict Ready(SlotId slot, const Client& client, int steps, StepDone done);
  Verdict Claim(SlotId slot, const Client& client);
  /// Whether the client may change how the module drives: nobody else owns it.
  Verdict MayTune(SlotId slot, const Client& client);
  Verdict Release(SlotId slot, const Client& client);
  /// The connection calls itself client.name from now on; takes the module over from an older connection of
  /// that name.
  Verdict Hello(SlotId slot, const Client& client);
  /// End of input: the module is free at once, what is pending still runs.
  void InputEnded(SlotId slot, ClientId client);
  /// The connection is gone, and its last request has arrived: `on_disconnect` acts once that has run.
  void Closed(SlotId slot, ClientId client);
  /// `client` has said something on a module of the slot's robot: whoever it speaks for there is not silent.
  void NoteHeard(SlotId slot, const Client& client, Nanoseconds now);
  /// Likewise on a connection to /swarm: of all that it owns.
  void NoteHeardAll(ClientId client, Nanoseconds now);
  /// Whether silence counts. Without lock.
  bool is_real_time() const { return is_real_time_.load(std::memory_order_relaxed); }
  /// The robot broadcasts `message` in the next step; a later call replaces it. While a client drives the
  /// robot, only connections with that client's name may send. Nobody may send for a driver without a name.
  Verdict Send(SlotId slot, const Client& client, const RobotMessage& message);

  // Many robots with one lock: the connections of /swarm. `client.is_team`.
  /// Every participant among the robots is ready for `steps` steps; `done` after the last of them, in every
  /// mode. Unowned ones are claimed. kOwned names the first robot that somebody else owns.
  Verdict StepAll(const TeamStep& step, const Client& client, int steps, StepDone done);
  Verdict ClaimAll(std::span<const SlotId> slots, const Client& client);
  /// Claims whatever nobody owns and no controller drives.
  Verdict ClaimFree(const Client& client);
  /// As Release() of each; unowned ones are left alone.
  Verdict ReleaseAll(std::span<const SlotId> slots, const Client& client);
  /// Zeroes the set-points of these robots if they are the client's, also those still to come.
  void StopTeam(std::span<const SlotId> slots, const Client& client);
  /// All robots of older teams of that name are the client's from now on; returns the older connections.
  std::vector<ClientId> HelloAll(const Client& client);
  /// InputEnded() and Closed() of all that the client owns.
  void InputEndedAll(ClientId client);
  void ClosedAll(ClientId client);
  /// The robots of a client in the scene's order; after the end of its input those that it has left.
  std::vector<SlotId> Team(ClientId client) const;
  /// The run has ended, and stands until Configure(). Without lock.
  void NoteRunEnded() { run_ended_.store(true, std::memory_order_release); }
  bool run_ended() const { return run_ended_.load(std::memory_order_acquire); }
  /// Grows whenever a team loses or gets a robot and with each Configure(). Without lock.
  std::uint64_t team_revision() const { return team_revision_.load(std::memory_order_acquire); }
  /// Grows with each Configure(): slots may be others. Without lock.
  std::uint64_t layout_revision() const { return layout_revision_.load(std::memory_order_acquire); }

  /// Waits for `steps` steps without making anybody ready (`ready` elsewhere).
  /// `asked`: it is for a `step n` of that many steps, which EndSteps() ends; 0: it is not.
  void WaitSteps(std::int64_t steps, StepDone done, std::int64_t asked = 0);
  /// Registers a function called after every step before any StepDone of it (subscriptions). Returns its key.
  using StepObserver = std::function<void(const FramePtr&)>;
  std::uint64_t AddObserver(StepObserver observer);
  void RemoveObserver(std::uint64_t key);
  /// Called, without lock, by whoever makes the last awaited robot ready. Set once before threads start.
  void set_all_ready_hook(std::function<void()> hook) { all_ready_hook_ = std::move(hook); }

  // A program that reads, for which lockstep waits beside robots if the scenario names it: its readers have
  // taken the sample of the last step, or none was due to them.
  /// The reader `name`, called `id` here, has taken the sample of `step`; it gets one every `every` steps.
  void NoteSampleTaken(std::uint64_t id, const std::string& name, std::uint64_t step, int every);
  /// It reads no more.
  void ForgetReader(std::uint64_t id);

  struct Owner {
    std::string robot;
    ClientId id = 0;
    std::string name;  // client name, else peer; or `controller diffuse`, with id 0
    bool participates = false;
    bool dropped = false;
    bool is_team = false;                   // owned through /swarm
    bool driven = false;                    // by a loaded controller
    bool still_moving = false;              // nobody drives it, and its set-points in force are not zero
    bool silenced = false;                  // its watchdog has stopped it: until its next command
    std::optional<Nanoseconds> heard = {};  // in real time: when its client said something last
  };
  /// Of all robots in the scene's order: who owns the first of its actuator modules that is owned.
  std::vector<Owner> Owners() const;
  /// Up to `max` awaited robots, the count of all in `total`. Empty unless in lockstep and not ready.
  std::vector<Awaited> Awaiting(Nanoseconds now, std::size_t max, std::size_t* total) const;

  /// How long the world has waited for a robot in lockstep, since the last reset or load.
  struct Wait {
    std::string robot;
    std::string client;      // name, else peer; empty: nobody
    bool is_team = false;    // owned through /swarm
    Nanoseconds waited = 0;  // from the ends of steps to the robot's commands for the next ones
    Nanoseconds alone = 0;   // of that: when all others were ready
  };
  struct Waits {
    std::vector<Wait> robots;  // that were awaited, in the scene's order
    Nanoseconds total = 0;     // from the ends of steps until all were ready
  };
  /// Of the steps that have run. Empty without MeasureWaits().
  Waits waits() const;
  /// Measures them from now on: reads the clock when a robot becomes ready. Set once before threads start;
  /// `clock` outlives the board.
  void MeasureWaits(const Clock& clock) { wait_clock_ = &clock; }

  // --- the stepping thread (holder of the baton)
  /// Lays out the slots for a new scene. Robots of the same name and type keep slot, owner and name; all
  /// waits end with `end` (kReset keeps participants, kLoad takes them from the scene).
  void Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now);
  /// The scene has been edited: who stays keeps what it has and waits for; waits of who goes end with
  /// kRemoved.
  /// `unloaded`: robots (by index, increasing) whose controller was taken away.
  void Revise(const Scene& scene, std::span<const int> unloaded, FramePtr frame, Nanoseconds now);
  void SetMode(Mode mode, Nanoseconds now);
  Mode mode() const;
  /// Names of the robots to wait for; empty: as in the scenario. Unknown names: error 10, nothing changes.
  Verdict SetParticipants(std::span<const std::string> names, Nanoseconds now);
  /// Set-points to go on from, by the scene's channels; after the Configure() of a restore.
  void SetInForce(std::span<const Setpoint> setpoints);
  /// Set-points in force, by the scene's channels; those of loaded controllers mean nothing.
  std::vector<Setpoint> InForce() const;
  /// While a recording is played nobody drives: commands, claims and broadcasts get error 5, `ready` is
  /// answered after the next frame shown.
  void SetPlaying(bool playing);
  /// Ends the waits of `step n` with kPaused.
  void EndSteps();
  /// Zeroes set-points and replaces commands that have not run.
  /// Also drops broadcasts that wait.
  void StopAll();
  /// The robot (its index in the scene) is driven by the loaded controller `name`, which ends whatever a
  /// client owned or wanted of it. `name` empty: clients drive it from now on; it starts at rest.
  void SetDriven(std::size_t robot, const std::string& name, Nanoseconds now);
  /// Every participant is ready for the next step.
  bool AllReady() const;
  /// Takes the pending set-points in force for step number `step`, which is to run now; the result is by the
  /// scene's channels, valid until Configure(). What is written into it is for this step only.
  std::span<Setpoint> Latch(std::uint64_t step);
  /// By the scene's actuators: 1 if a client's command came in force with the step latched last.
  std::span<const std::uint8_t> LatchedCommands() const { return latched_commands_; }
  /// The broadcasts of the step latched last, by increasing robot; valid until the next Latch().
  std::span<const SentMessage> LatchedMessages() const { return latched_messages_; }
  /// Clients that were lost before the step latched last, if that changed anything; valid until the next
  /// Latch().
  std::span<const LostClient> LatchedLosses() const { return latched_losses_; }
  /// After the step: calls the observers, then answers those whose wait it ends.
  void FinishStep(const FramePtr& frame, Nanoseconds now);
  /// Waiting starts anew (after a pause): deadlines count from `now`.
  void RestartWaiting(Nanoseconds now);
  /// No step is to follow for now: how long it takes to the next command counts for no robot.
  void IgnoreWait();
  /// Fires the deadlines of awaited robots that have passed.
  std::vector<FiredDeadline> FireDeadlines(Nanoseconds now);
  /// In real time, before Latch(): stops the robots that still move though their clients have been silent for
  /// as long as their watchdogs allow. They are among its losses.
  void StopSilent(Nanoseconds now);
  /// When the next deadline of an awaited robot fires; INT64_MAX: never.
  Nanoseconds NextDeadline() const;
  /// Ends all waits with kStopping; later ones end at once, and commands are refused, until Configure().
  /// `why`: what those who wait are told.
  void Stop(FramePtr frame, std::string why = "the daemon is stopping");

 private:
  using Drive = DriveTable::Drive;
  using Slot = DriveTable::Slot;
  static constexpr std::size_t kNoSlot = DriveTable::kNoSlot;

  struct Waiter {
    std::uint64_t batch = 0;  // 0: of nobody's robots
    std::size_t members = 0;  // robots of the batch that nobody has taken yet
    std::int64_t steps_left = 0;
    bool latched = false;
    StepDone done;
    std::int64_t asked = 0;  // of `step n`: n; 0: of something else
  };
  struct Reader {
    std::string name;
    std::uint64_t taken = 0;  // step
    std::uint64_t every = 1;
  };
  struct Observer {
    std::uint64_t key = 0;
    std::shared_ptr<const StepObserver> call;
  };
  /// Whom to call once the lock is gone.
  struct Completions {
    FramePtr frame;
    Mode mode = Mode::kRealtime;
    std::vector<std::pair<StepDone, StepEnd>> calls;
    std::string why = {};  // of kStopping

    void Call() const;
  };

  static Verdict Gone() { return {Error::kNotPossible, "this robot is no longer part of the scenario"}; }
  /// Asks again as long as the holder that it is refused for has ended. `ask`: Verdict().
  template <typename Ask>
  Verdict Insist(const Ask& ask) EXCLUDES(mutex_) {
    while (true) {
      Verdict verdict = ask();
      if (!FreeIfEnded(verdict.holder)) return verdict;
    }
  }
  /// Frees what the holder owns if its input has ended; true then.
  bool FreeIfEnded(const Holder& holder) EXCLUDES(mutex_);
  Verdict TryCommand(SlotId slot, const Client& client, std::span<const Setpoint> setpoints,
                     std::optional<int> steps, StepDone& done) EXCLUDES(mutex_);
  Verdict TryStepAll(const TeamStep& step, const Client& client, int steps, StepDone& done) EXCLUDES(mutex_);
  Verdict TrySend(SlotId slot, const Client& client, const RobotMessage& message) EXCLUDES(mutex_);
  Verdict Owned(std::size_t index, const std::string& why) const REQUIRES(mutex_) {
    return {.error = Error::kOwned,
            .text = table_.slot(index).robot + " is driven by " + table_.Who(index) + why,
            .holder = HolderOf(index)};
  }
  Holder HolderOf(std::size_t index) const REQUIRES(mutex_) {
    return {table_.drive(index).owner, table_.slot(index).owner.input_end};
  }
  /// A client that is neither `client` nor of its party owns it.
  bool IsHeldBeside(std::size_t index, const Client& client) const REQUIRES(mutex_) {
    const ClientId owner = table_.drive(index).owner;
    return owner != 0 && owner != client.id && !client.IsAllyOf(table_.slot(index).owner);
  }
  Verdict NotOwner(std::size_t index) const REQUIRES(mutex_) {
    return Owned(index, ": only its owner can release it");
  }
  /// What keeps `client` from acting on a robot, if anything does.
  std::optional<Verdict> Objection(std::size_t index, const Client& client) const REQUIRES(mutex_);
  std::optional<Verdict> TeamObjection(std::size_t index, const Client& client) const REQUIRES(mutex_);
  /// Makes the client owner, unless its input has ended. @pre no Objection()
  void TakeOwnership(std::size_t index, const Client& client) REQUIRES(mutex_);
  void Disown(std::size_t index) REQUIRES(mutex_);
  /// One robot less that a batch waits for; the last ends it.
  void LeaveBatch(std::uint64_t batch, StepEnd end, Completions& completions) REQUIRES(mutex_);
  /// Clears what another client has pending, which then gets kReplaced.
  void ReplacePending(std::size_t index, const Client& client, Completions& completions) REQUIRES(mutex_);
  /// Clears what is pending; somebody who waits for it gets `end`.
  void EndPending(std::size_t index, StepEnd end, Completions& completions) REQUIRES(mutex_) {
    if (table_.drive(index).has_done) completions.calls.emplace_back(std::move(table_.slot(index).done), end);
    table_.ClearPending(index);
  }
  /// The owner sends no more: the robot is free, what it sent still runs.
  void EndInput(std::size_t index) REQUIRES(mutex_);
  void LoseClient(std::size_t index) REQUIRES(mutex_);
  /// What on_disconnect, or its default, makes of a robot whose client is lost.
  void ApplyLoss(std::size_t index) REQUIRES(mutex_);
  /// Stops a robot without its program.
  /// `silent`: as in LostClient.
  void StopAbandoned(std::size_t index, Nanoseconds silent = 0) REQUIRES(mutex_);
  void NoteLoss(std::size_t index, LossPolicy policy, Nanoseconds silent = 0) REQUIRES(mutex_);
  /// What `client` is heard for among the slots of a robot.
  void HearOn(std::size_t robot, const Client& client, Nanoseconds now) REQUIRES(mutex_);
  void EndAllWaits(StepEnd end, Completions& completions) REQUIRES(mutex_);
  /// Corrects the count of awaited robots after a change of a slot; true if that made the last one ready.
  /// `now`: read when it is first needed, then the same for all changes of one request.
  bool NoteChange(std::size_t index, bool was_awaited, std::optional<Nanoseconds>& now) REQUIRES(mutex_);
  /// The robot of a slot has become ready; `last`: and so are all.
  void NoteReady(std::size_t index, bool last, std::optional<Nanoseconds>& now) REQUIRES(mutex_);
  void ClearMessages() REQUIRES(mutex_);
  /// Why the program that the scenario waits for is not ready for the next step; empty: it is.
  std::string LackOf(const std::string& program) const REQUIRES(mutex_);
  bool IsReady() const REQUIRES(mutex_) {
    return awaited_ == 0 && std::ranges::all_of(programs_, [this](const std::string& program) REQUIRES(
                                                               mutex_) { return LackOf(program).empty(); });
  }
  void NoteTeams() { team_revision_.fetch_add(1, std::memory_order_release); }
  Completions MakeCompletions() const REQUIRES(mutex_) { return {last_frame_, mode_, {}, why_stopping_}; }
  /// True, and `done` is taken, if a recording is played: it is answered after that many frames.
  bool WaitInPlayback(int steps, StepDone& done) EXCLUDES(mutex_);
  Verdict Fine() const REQUIRES(mutex_) { return {.mode = mode_}; }

  mutable Mutex mutex_;
  DriveTable table_ GUARDED_BY(mutex_);
  std::vector<Setpoint> latched_;                         // stepping thread only
  std::vector<std::uint8_t> latched_commands_;            // stepping thread only
  std::vector<SentMessage> latched_messages_;             // stepping thread only
  std::vector<LostClient> latched_losses_;                // stepping thread only
  std::vector<LostClient> losses_ GUARDED_BY(mutex_);     // since the last Latch()
  std::vector<SentMessage> messages_ GUARDED_BY(mutex_);  // for the next step, in order of arrival
  std::vector<Waiter> waiters_ GUARDED_BY(mutex_);
  std::vector<Observer> observers_ GUARDED_BY(mutex_);
  std::vector<std::string> programs_ GUARDED_BY(mutex_);  // that read, and that lockstep waits for
  std::map<std::uint64_t, Reader> readers_ GUARDED_BY(mutex_);
  Mode mode_ GUARDED_BY(mutex_) = Mode::kRealtime;
  std::size_t awaited_ GUARDED_BY(mutex_) = 0;        // participants that are not ready
  std::size_t calls_at_once_ GUARDED_BY(mutex_) = 0;  // the most that one step had to answer
  Nanoseconds waiting_since_ GUARDED_BY(mutex_) = 0;
  Nanoseconds silence_from_ GUARDED_BY(mutex_) = 0;  // silence before that does not count
  struct WaitTimes {
    Nanoseconds waited = 0, alone = 0;
  };
  const Clock* wait_clock_ = nullptr;                     // constant after construction
  std::vector<WaitTimes> wait_times_ GUARDED_BY(mutex_);  // by robot
  Nanoseconds waited_ GUARDED_BY(mutex_) = 0;             // in all
  Nanoseconds waits_from_ GUARDED_BY(mutex_) = 0;         // the end of the step before; 0: it does not count
  Nanoseconds newest_ready_ GUARDED_BY(mutex_) = 0;       // when a robot became ready last,
  Nanoseconds ready_before_ GUARDED_BY(mutex_) = 0;       // and the last one at another time before
  std::uint64_t next_observer_ GUARDED_BY(mutex_) = 1;
  std::uint64_t next_batch_ GUARDED_BY(mutex_) = 1;
  bool stopping_ GUARDED_BY(mutex_) = false;
  std::string why_stopping_ GUARDED_BY(mutex_);
  bool playing_ GUARDED_BY(mutex_) = false;
  FramePtr last_frame_ GUARDED_BY(mutex_);
  std::atomic<std::uint64_t> team_revision_{1};
  std::atomic<std::uint64_t> layout_revision_{1};
  std::atomic<bool> run_ended_{false};
  std::atomic<bool> is_real_time_{false};
  std::function<void()> all_ready_hook_;  // constant after construction
};

}  // namespace coopdyn
