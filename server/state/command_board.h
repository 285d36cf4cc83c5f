// SPDX-License-Identifier: MIT
// Records who drives which robot, with which set-points, for how many steps, and who waits for a step.
// Implements the contract of lockstep (docs/protocol.md), free of sockets and threads: robot and control
// threads write commands; the stepping thread latches them and receives the callbacks of those to answer.
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

/// The answer to requests that are not possible while a recording is played.
inline constexpr const char* kPlayingText = "playing a recording: branch of /playback goes on live from here";

/// How a wait for a step ended.
enum class StepEnd {
  kRan,
  kReset,     // error 5 `reset`
  kLoad,      // error 5 `load`
  kRemoved,   // the robot was removed from the world: error 5
  kReplaced,  // another client became owner first: error 6
  kPaused,    // `pause` ended a `step n`: error 5
  kStopping,  // the daemon shuts down: error 5
};

struct StepResult {
  StepEnd end = StepEnd::kRan;
  FramePtr frame;  // of the step that ended the wait, else the newest
  Mode mode = Mode::kRealtime;
  std::int64_t ran = 0, asked = 0;  // kPaused: number of steps run, and n of `step n`
  std::string why = {};             // kStopping
};

/// The connection that owns what another client requests.
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
  ClientId displaced = 0;  // hello: the connection that was taken over; it must receive its closing notice
  Holder holder = {};      // for kOwned
};

/// Somebody the world waits for.
struct Awaited {
  std::string robot;
  std::string why;  // "no client", "no command from ana"
  double seconds = 0;
  std::string cure = {};  // how to end the wait; empty: only by waiting
};

/// One connection's request to many robots for one step: accepted as a whole or not at all.
struct TeamStep {
  std::span<const SlotId> slots;
  std::span<const Setpoint> setpoints;  // for the channels of `slots`, slot by slot; empty: unchanged
  std::span<const SlotId> others = {};  // more of the client's robots, with unchanged set-points
};

/// A deadline that fired; an input of the run.
struct FiredDeadline {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;
};

/// A robot whose client was lost, and the effect; an input of the run.
struct LostClient {
  std::size_t robot = 0;  // index into the scene's robots
  std::string client;     // its name, else peer
  LossPolicy policy = LossPolicy::kStop;
  Nanoseconds silent = 0;  // > 0: the client is connected but has been silent this long; 0: it is gone
};

/// The requests of all connections and their state. Thread-safe: one lock guards everything except the
/// stepping thread's own members. Callbacks run without that lock.
///
/// A client owns nothing once its input has ended, even if its connection's thread has yet to notice: before
/// the board refuses a request, it checks whether the input of the client in the way has ended.
class CommandBoard {
 public:
  // --- robot threads and the control thread
  /// The slot of `module` of `robot`; the robot's first slot if `module` is empty or no actuator module. 0 if
  /// there is no such robot.
  SlotId FindSlot(const std::string& robot, const std::string& module = {}) const;
  /// The slots of the scene's actuators, in their order, looked up by robot and module names.
  std::vector<SlotId> FindSlots(const Scene& scene) const;
  /// The slot's owner: client name, else peer, or `controller diffuse`; empty: nobody.
  std::string OwnerOf(SlotId slot) const;
  /// The client that owns a slot, if it is neither `client` nor of its party; else empty.
  std::string ClientBeside(SlotId slot, const Client& client);
  /// An actuator command; makes the client the owner if there is none. Without `steps`: one step, answered at
  /// once unless in lockstep. With `steps` (≥ 1): valid for that number of steps and answered after the last,
  /// in every mode. If the verdict has answer_now, `done` is never called. `setpoints`: of the slot's
  /// channels.
  Verdict Command(SlotId slot, const Client& client, std::span<const Setpoint> setpoints,
                  std::optional<int> steps, StepDone done);
  /// `ready` on an actuator module: keeps the set-points; answered after `steps` steps in every mode.
  Verdict Ready(SlotId slot, const Client& client, int steps, StepDone done);
  Verdict Claim(SlotId slot, const Client& client);
  /// Whether the client may change how the module drives: true if no other client owns it.
  Verdict MayTune(SlotId slot, const Client& client);
  Verdict Release(SlotId slot, const Client& client);
  /// Names the connection client.name from now on. Takes the module over from an older connection of that
  /// name.
  Verdict Hello(SlotId slot, const Client& client);
  /// End of input: frees the module at once; the pending request still runs.
  void InputEnded(SlotId slot, ClientId client);
  /// The connection is gone and its last request has arrived. Applies `on_disconnect` once that request has
  /// run.
  void Closed(SlotId slot, ClientId client);
  /// `client` has sent something to a module of the slot's robot: its program is not silent.
  void NoteHeard(SlotId slot, const Client& client, Nanoseconds now);
  /// Likewise for a connection to /swarm, for every robot that it owns.
  void NoteHeardAll(ClientId client, Nanoseconds now);
  /// Whether silence counts. Lock-free.
  bool is_real_time() const { return is_real_time_.load(std::memory_order_relaxed); }
  /// Makes the robot broadcast `message` in the next step; a later call replaces it. While a client drives
  /// the robot, only connections with that client's name may send. Nobody may send for a nameless driver.
  Verdict Send(SlotId slot, const Client& client, const RobotMessage& message);

  // Many robots under one lock, for the connections of /swarm. @pre `client.is_team`
  /// Makes every participant among the robots ready for `steps` steps; calls `done` after the last of them,
  /// in every mode. Claims unowned robots. kOwned names the first robot that another client owns.
  Verdict StepAll(const TeamStep& step, const Client& client, int steps, StepDone done);
  Verdict ClaimAll(std::span<const SlotId> slots, const Client& client);
  /// Claims all robots without owner and controller.
  Verdict ClaimFree(const Client& client);
  /// Release() of each; ignores unowned robots.
  Verdict ReleaseAll(std::span<const SlotId> slots, const Client& client);
  /// Zeroes the current and pending set-points of those robots that the client owns.
  void StopTeam(std::span<const SlotId> slots, const Client& client);
  /// Gives the client all robots of older teams of its name; returns the older connections.
  std::vector<ClientId> HelloAll(const Client& client);
  /// InputEnded() and Closed() for all robots that the client owns.
  void InputEndedAll(ClientId client);
  void ClosedAll(ClientId client);
  /// The client's robots in the scene's order; after the end of its input, those that it has left.
  std::vector<SlotId> Team(ClientId client) const;
  /// The run has ended, until Configure(). Lock-free.
  void NoteRunEnded() { run_ended_.store(true, std::memory_order_release); }
  bool run_ended() const { return run_ended_.load(std::memory_order_acquire); }
  /// Grows whenever a team loses or gains a robot, and with each Configure(). Lock-free.
  std::uint64_t team_revision() const { return team_revision_.load(std::memory_order_acquire); }
  /// Grows with each Configure(), which may change slots. Lock-free.
  std::uint64_t layout_revision() const { return layout_revision_.load(std::memory_order_acquire); }

  /// Waits for `steps` steps without making anybody ready (`ready` on other modules). `asked`: n if the wait
  /// is for a `step n`, which EndSteps() ends; else 0.
  void WaitSteps(std::int64_t steps, StepDone done, std::int64_t asked = 0);
  /// Registers a function called after every step, before any StepDone of that step (subscriptions). Returns
  /// its key.
  using StepObserver = std::function<void(const FramePtr&)>;
  std::uint64_t AddObserver(StepObserver observer);
  void RemoveObserver(std::uint64_t key);
  /// Called, without lock, by the thread that makes the last awaited robot ready. Set once before threads
  /// start.
  void set_all_ready_hook(std::function<void()> hook) { all_ready_hook_ = std::move(hook); }

  // Programs that only read. Lockstep also waits for those that the scenario names: a program is ready when
  // its readers have acknowledged the sample of the last step, or none was due.
  /// Reader `name`, identified by `id`, acknowledged `step`; it receives every `every`th step.
  void NoteSampleTaken(std::uint64_t id, const std::string& name, std::uint64_t step, int every);
  /// The reader has stopped reading.
  void ForgetReader(std::uint64_t id);

  struct Owner {
    std::string robot;
    ClientId id = 0;
    std::string name;  // client name, else peer; or `controller diffuse`, with id 0
    bool participates = false;
    bool dropped = false;
    bool is_team = false;                   // owned through /swarm
    bool driven = false;                    // by a loaded controller
    bool still_moving = false;              // nobody drives it, but its set-points in force are not zero
    bool silenced = false;                  // stopped by its watchdog until its next command
    std::optional<Nanoseconds> heard = {};  // real time only: when its client last sent something
  };
  /// For each robot, in the scene's order, the owner of its first owned actuator module.
  std::vector<Owner> Owners() const;
  /// Up to `max` awaited robots; `total` receives the number of all. Empty unless lockstep waits.
  std::vector<Awaited> Awaiting(Nanoseconds now, std::size_t max, std::size_t* total) const;

  /// How long lockstep has waited for a robot since the last reset or load.
  struct Wait {
    std::string robot;
    std::string client;      // name, else peer; empty: no client
    bool is_team = false;    // owned through /swarm
    Nanoseconds waited = 0;  // from ends of steps to the robot's next commands
    Nanoseconds alone = 0;   // the part of `waited` when all other robots were ready
  };
  struct Waits {
    std::vector<Wait> robots;  // all robots that were awaited, in the scene's order
    Nanoseconds total = 0;     // from ends of steps until all robots were ready
  };
  /// For the steps run so far. Empty without MeasureWaits().
  Waits waits() const;
  /// Starts measuring waits: reads the clock when a robot becomes ready. Call once before threads start;
  /// `clock` outlives the board.
  void MeasureWaits(const Clock& clock) { wait_clock_ = &clock; }

  // --- the stepping thread (holder of the baton)
  /// Lays out the slots for a new scene. Robots of the same name and type keep slot, owner and name. Ends all
  /// waits with `end` (kReset keeps participants, kLoad uses those of the scene).
  void Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now);
  /// Adapts to an edited scene: remaining robots keep their state and waits; waits for removed robots end
  /// with kRemoved. `unloaded`: robots (by index, increasing) whose controller was unloaded.
  void Revise(const Scene& scene, std::span<const int> unloaded, FramePtr frame, Nanoseconds now);
  void SetMode(Mode mode, Nanoseconds now);
  Mode mode() const;
  /// The names of the robots to wait for; empty: as in the scenario. Unknown names: error 10, no change.
  Verdict SetParticipants(std::span<const std::string> names, Nanoseconds now);
  /// Sets the set-points in force, by the scene's channels; after the Configure() of a restore.
  void SetInForce(std::span<const Setpoint> setpoints);
  /// Set-points in force, by the scene's channels; meaningless for loaded controllers.
  std::vector<Setpoint> InForce() const;
  /// While a recording is played nobody drives: commands, claims and broadcasts fail with error 5; `ready` is
  /// answered after the next frame shown.
  void SetPlaying(bool playing);
  /// Ends the waits of `step n` with kPaused.
  void EndSteps();
  /// Zeroes set-points, replaces commands that have not run, and drops pending broadcasts.
  void StopAll();
  /// Hands the robot (index into the scene) to the loaded controller `name`: ends any client's ownership and
  /// pending requests. `name` empty: clients drive it from now on, starting at rest.
  void SetDriven(std::size_t robot, const std::string& name, Nanoseconds now);
  /// True if every participant is ready for the next step.
  bool AllReady() const;
  /// Puts the pending set-points in force for step `step`, which runs next. Returns them by the scene's
  /// channels, valid until Configure(). Values written into the result apply to this step only.
  std::span<Setpoint> Latch(std::uint64_t step);
  /// By the scene's actuators: 1 if the last Latch() put a client's command in force.
  std::span<const std::uint8_t> LatchedCommands() const { return latched_commands_; }
  /// The broadcasts of the last latched step, by increasing robot; valid until the next Latch().
  std::span<const SentMessage> LatchedMessages() const { return latched_messages_; }
  /// Clients lost before the last latched step, if that changed anything; valid until the next Latch().
  std::span<const LostClient> LatchedLosses() const { return latched_losses_; }
  /// After the step: calls the observers, then the StepDones of waits that the step ends.
  void FinishStep(const FramePtr& frame, Nanoseconds now);
  /// Restarts all waiting times (after a pause): deadlines count from `now`.
  void RestartWaiting(Nanoseconds now);
  /// No step follows for now: the time until the next command counts for no robot.
  void IgnoreWait();
  /// Fires the expired deadlines of awaited robots.
  std::vector<FiredDeadline> FireDeadlines(Nanoseconds now);
  /// In real time, before Latch(): stops moving robots whose clients have been silent for as long as their
  /// watchdogs allow. LatchedLosses() includes them.
  void StopSilent(Nanoseconds now);
  /// Time of the next deadline of an awaited robot; INT64_MAX: none.
  Nanoseconds NextDeadline() const;
  /// Ends all waits with kStopping, and until Configure() also later waits, at once, and refuses commands.
  /// `why`: the reason given to those who wait.
  void Stop(FramePtr frame, std::string why = "the daemon is stopping");

 private:
  using Drive = DriveTable::Drive;
  using Slot = DriveTable::Slot;
  static constexpr std::size_t kNoSlot = DriveTable::kNoSlot;

  struct Waiter {
    std::uint64_t batch = 0;  // 0: not from StepAll()
    std::size_t members = 0;  // robots of the batch not yet replaced or removed
    std::int64_t steps_left = 0;
    bool latched = false;
    StepDone done;
    std::int64_t asked = 0;  // n of a `step n`; else 0
  };
  struct Reader {
    std::string name;
    std::uint64_t taken = 0;  // last acknowledged step
    std::uint64_t every = 1;
  };
  struct Observer {
    std::uint64_t key = 0;
    std::shared_ptr<const StepObserver> call;
  };
  /// Callbacks to call after unlocking.
  struct Completions {
    FramePtr frame;
    Mode mode = Mode::kRealtime;
    std::vector<std::pair<StepDone, StepEnd>> calls;
    std::string why = {};  // for kStopping

    void Call() const;
  };

  static Verdict Gone() { return {Error::kNotPossible, "this robot is no longer part of the scenario"}; }
  /// Retries while the holder that blocks the request has in fact ended. `ask` returns a Verdict.
  template <typename Ask>
  Verdict Insist(const Ask& ask) EXCLUDES(mutex_) {
    while (true) {
      Verdict verdict = ask();
      if (!FreeIfEnded(verdict.holder)) return verdict;
    }
  }
  /// If the holder's input has ended, frees everything that it owns and returns true.
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
  /// True if a client other than `client` and its party owns it.
  bool IsHeldBeside(std::size_t index, const Client& client) const REQUIRES(mutex_) {
    const ClientId owner = table_.drive(index).owner;
    return owner != 0 && owner != client.id && !client.IsAllyOf(table_.slot(index).owner);
  }
  Verdict NotOwner(std::size_t index) const REQUIRES(mutex_) {
    return Owned(index, ": only its owner can release it");
  }
  /// The reason why `client` may not act on a robot, if any.
  std::optional<Verdict> Objection(std::size_t index, const Client& client) const REQUIRES(mutex_);
  std::optional<Verdict> TeamObjection(std::size_t index, const Client& client) const REQUIRES(mutex_);
  /// Makes the client the owner, unless its input has ended. @pre no Objection()
  void TakeOwnership(std::size_t index, const Client& client) REQUIRES(mutex_);
  void Disown(std::size_t index) REQUIRES(mutex_);
  /// Removes one robot from a batch; ends the batch's wait with `end` if it was the last.
  void LeaveBatch(std::uint64_t batch, StepEnd end, Completions& completions) REQUIRES(mutex_);
  /// Clears another client's pending request, which ends with kReplaced.
  void ReplacePending(std::size_t index, const Client& client, Completions& completions) REQUIRES(mutex_);
  /// Clears the pending request; a waiting caller receives `end`.
  void EndPending(std::size_t index, StepEnd end, Completions& completions) REQUIRES(mutex_) {
    if (table_.drive(index).has_done) completions.calls.emplace_back(std::move(table_.slot(index).done), end);
    table_.ClearPending(index);
  }
  /// The owner sends no more: frees the robot; requests already sent still run.
  void EndInput(std::size_t index) REQUIRES(mutex_);
  void LoseClient(std::size_t index) REQUIRES(mutex_);
  /// Applies on_disconnect, or its default, to a robot whose client is lost.
  void ApplyLoss(std::size_t index) REQUIRES(mutex_);
  /// Stops a robot whose program is gone or silent. `silent`: as in LostClient.
  void StopAbandoned(std::size_t index, Nanoseconds silent = 0) REQUIRES(mutex_);
  void NoteLoss(std::size_t index, LossPolicy policy, Nanoseconds silent = 0) REQUIRES(mutex_);
  /// Notes that `client` was heard, for those slots of a robot for whose owners it speaks.
  void HearOn(std::size_t robot, const Client& client, Nanoseconds now) REQUIRES(mutex_);
  void EndAllWaits(StepEnd end, Completions& completions) REQUIRES(mutex_);
  /// Updates the count of awaited robots after a slot has changed; returns true if all are ready now. `now`:
  /// read on first use, then shared by all changes of one request.
  bool NoteChange(std::size_t index, bool was_awaited, std::optional<Nanoseconds>& now) REQUIRES(mutex_);
  /// The slot's robot has become ready; `last`: all robots are now ready.
  void NoteReady(std::size_t index, bool last, std::optional<Nanoseconds>& now) REQUIRES(mutex_);
  void ClearMessages() REQUIRES(mutex_);
  /// Why a program that the scenario waits for is not ready for the next step; empty if it is.
  std::string LackOf(const std::string& program) const REQUIRES(mutex_);
  bool IsReady() const REQUIRES(mutex_) {
    return awaited_ == 0 && std::ranges::all_of(programs_, [this](const std::string& program) REQUIRES(
                                                               mutex_) { return LackOf(program).empty(); });
  }
  void NoteTeams() { team_revision_.fetch_add(1, std::memory_order_release); }
  Completions MakeCompletions() const REQUIRES(mutex_) { return {last_frame_, mode_, {}, why_stopping_}; }
  /// In playback, queues `done` to be called after `steps` frames and returns true.
  bool WaitInPlayback(int steps, StepDone& done) EXCLUDES(mutex_);
  Verdict Fine() const REQUIRES(mutex_) { return {.mode = mode_}; }

  mutable Mutex mutex_;
  DriveTable table_ GUARDED_BY(mutex_);
  std::vector<Setpoint> latched_;                         // stepping thread only
  std::vector<std::uint8_t> latched_commands_;            // stepping thread only
  std::vector<SentMessage> latched_messages_;             // stepping thread only
  std::vector<LostClient> latched_losses_;                // stepping thread only
  std::vector<LostClient> losses_ GUARDED_BY(mutex_);     // since the last Latch()
  std::vector<SentMessage> messages_ GUARDED_BY(mutex_);  // for the next step, by arrival
  std::vector<Waiter> waiters_ GUARDED_BY(mutex_);
  std::vector<Observer> observers_ GUARDED_BY(mutex_);
  std::vector<std::string> programs_ GUARDED_BY(mutex_);  // reading programs that lockstep waits for
  std::map<std::uint64_t, Reader> readers_ GUARDED_BY(mutex_);
  Mode mode_ GUARDED_BY(mutex_) = Mode::kRealtime;
  std::size_t awaited_ GUARDED_BY(mutex_) = 0;        // participants that are not ready
  std::size_t calls_at_once_ GUARDED_BY(mutex_) = 0;  // largest number of answers to one step
  Nanoseconds waiting_since_ GUARDED_BY(mutex_) = 0;
  Nanoseconds silence_from_ GUARDED_BY(mutex_) = 0;  // earlier silence does not count
  struct WaitTimes {
    Nanoseconds waited = 0, alone = 0;
  };
  const Clock* wait_clock_ = nullptr;                     // constant after construction
  std::vector<WaitTimes> wait_times_ GUARDED_BY(mutex_);  // by robot
  Nanoseconds waited_ GUARDED_BY(mutex_) = 0;             // total
  Nanoseconds waits_from_ GUARDED_BY(mutex_) = 0;         // end of the last step; 0: not measuring
  Nanoseconds newest_ready_ GUARDED_BY(mutex_) = 0;       // when the last robot became ready
  Nanoseconds ready_before_ GUARDED_BY(mutex_) = 0;       // the latest earlier time at which one did
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
