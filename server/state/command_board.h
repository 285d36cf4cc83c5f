// SPDX-License-Identifier: MIT
// Who drives which robot, with what, for how many steps; and who waits for a step. The lockstep contract of
// DESIGN §4 lives here, free of sockets and threads: robot and control threads write commands, the stepping
// thread latches them and gets back whom to answer. One lock; callbacks are never called with it held.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "server/base/mutex.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Names an actuator module for the life of the daemon (kept over reset, and over a load that keeps the
/// robot). 0: none.
using SlotId = std::uint32_t;
/// Wheel speeds left, right, rad/s, after scaling.
using Setpoint = std::array<double, 2>;

/// A connection as the board knows it.
struct Client {
  ClientId id = 0;
  std::string name;          // of `hello`; empty: none
  std::string peer;          // e.g. "127.0.0.1:53120"
  bool input_ended = false;  // may still have requests executed, but owns nothing
};

/// How a wait for a step ended.
enum class StepEnd {
  kRan,
  kReset,     // error 5 `reset`
  kLoad,      // error 5 `load`
  kReplaced,  // another client became owner first: error 6
  kStopping,  // the daemon ends: error 5
};

struct StepResult {
  StepEnd end = StepEnd::kRan;
  FramePtr frame;  // of the step that ended the wait, or the newest
  Mode mode = Mode::kRealtime;
};
/// Called on the stepping thread, or on the thread whose call ended the wait; posts to its own thread and
/// returns.
using StepDone = std::function<void(const StepResult&)>;

/// The board's answer to a request.
struct Verdict {
  Error error = Error::kOk;
  std::string text;        // of the error
  bool answer_now = true;  // false: `done` will be called
  Mode mode = Mode::kRealtime;
  ClientId displaced = 0;  // hello: the connection that was taken over and must get its closing notice
};

/// Whom the world waits for.
struct Awaited {
  std::string robot;
  std::string why;  // "no client", "no command from ana"
  double seconds = 0;
};

/// A deadline that fired: an input of the run.
struct FiredDeadline {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;
};

class CommandBoard {
 public:
  // --- robot threads and the control thread
  // --------------------------------------------------------------------
  /// The slot of `robot`'s drive; 0 if there is no such robot.
  SlotId FindSlot(const std::string& robot) const;
  /// An actuator command: the client becomes owner if there is none. `steps` empty: one step, answered at
  /// once unless in lockstep; given (≥ 1): it stands for that many steps and is answered after the last, in
  /// every mode. If the verdict says answer_now, `done` is never called.
  Verdict Command(SlotId slot, const Client& client, const Setpoint& setpoint, std::optional<int> steps,
                  StepDone done);
  /// `ready` on an actuator module: keeps the set-points; answered after `steps` steps in every mode.
  Verdict Ready(SlotId slot, const Client& client, int steps, StepDone done);
  Verdict Claim(SlotId slot, const Client& client);
  Verdict Release(SlotId slot, const Client& client);
  /// The connection calls itself client.name from now on; takes the module over from an older connection of
  /// that name.
  Verdict Hello(SlotId slot, const Client& client);
  /// End of input: the module is free at once, what is pending still runs.
  void InputEnded(SlotId slot, ClientId client);
  /// The last of the connection, its backlog included: `on_disconnect` acts.
  void Closed(SlotId slot, ClientId client);
  /// Waits for `steps` steps without making anybody ready (`ready` elsewhere, `step n`).
  void WaitSteps(int steps, StepDone done);
  /// Registers a function called after every step before any StepDone of it (subscriptions). Returns its key.
  using StepObserver = std::function<void(const FramePtr&)>;
  std::uint64_t AddObserver(StepObserver observer);
  void RemoveObserver(std::uint64_t key);
  /// Called, without lock, by whoever makes the last awaited robot ready. Set once before threads start.
  void set_all_ready_hook(std::function<void()> hook) { all_ready_hook_ = std::move(hook); }

  struct Owner {
    std::string robot;
    ClientId id = 0;
    std::string name;  // client name, else peer
    bool participates = false;
    bool dropped = false;
  };
  /// All slots in the scene's order.
  std::vector<Owner> Owners() const;
  /// Up to `max` awaited robots, the count of all in `total`. Empty unless in lockstep and not ready.
  std::vector<Awaited> Awaiting(Nanoseconds now, std::size_t max, std::size_t* total) const;

  // --- the stepping thread (holder of the baton)
  // ----------------------------------------------------------------
  /// Lays out the slots for a new scene. Robots of the same name and type keep slot, owner and name; all
  /// waits end with `end` (kReset keeps participants, kLoad takes them from the scene).
  void Configure(const Scene& scene, StepEnd end, FramePtr frame, Nanoseconds now);
  void SetMode(Mode mode, Nanoseconds now);
  Mode mode() const;
  /// Names of the robots to wait for; empty: as in the scenario. Unknown names: error 10, nothing changes.
  Verdict SetParticipants(std::span<const std::string> names, Nanoseconds now);
  /// Zeroes set-points and replaces commands that have not run.
  void StopAll();
  /// Every participant is ready for the next step.
  bool AllReady() const;
  /// Takes the pending set-points in force; the result is by the scene's robot order, valid until
  /// Configure().
  std::span<const Setpoint> Latch();
  /// After the step: answers whom it ends the wait of. Observers first. Calls the callbacks.
  void FinishStep(const FramePtr& frame, Nanoseconds now);
  /// Waiting starts anew (after a pause): deadlines count from `now`.
  void RestartWaiting(Nanoseconds now);
  /// Fires the deadlines of awaited robots that have passed.
  std::vector<FiredDeadline> FireDeadlines(Nanoseconds now);
  /// When the next deadline of an awaited robot fires; INT64_MAX: never.
  Nanoseconds NextDeadline() const;
  /// Ends all waits with kStopping; later ones end at once.
  void Stop(FramePtr frame);

 private:
  struct Pending {
    bool active = false;
    std::optional<Setpoint> setpoint;  // empty: keeps what is in force
    int steps_left = 0;
    bool latched = false;  // was there when the step that runs now began
    ClientId client = 0;
    StepDone done;  // null: answered already
  };
  struct Slot {
    SlotId id = 0;
    std::string robot, type;
    ClientId owner = 0;
    std::string owner_name, owner_peer;
    ClientId former = 0;                      // its input has ended, its requests may still run
    std::optional<LossPolicy> after_pending;  // on_disconnect, once what is pending has run
    std::optional<double> deadline_s;
    LossPolicy on_deadline = LossPolicy::kHold;
    std::optional<LossPolicy> on_disconnect;
    bool participates = false;  // by scenario or set_participants
    bool participates_by_scene = false;
    bool excused =
        false;  // late or without client, by policy hold or stop: not waited for until its next command
    bool dropped = false;  // by policy drop: takes no part until its next command
    Pending pending;
    Setpoint in_force{};
    Nanoseconds waiting_since = 0;
  };
  struct Waiter {
    int steps_left = 0;
    bool latched = false;
    StepDone done;
  };
  struct Observer {
    std::uint64_t key = 0;
    std::shared_ptr<const StepObserver> call;
  };
  using Completions = std::vector<std::pair<StepDone, StepResult>>;

  Slot* Find(SlotId id) REQUIRES(mutex_);
  /// Refuses a client that may not act on `slot`; else makes it owner (unless its input has ended).
  Verdict TakeOwnership(Slot& slot, const Client& client) REQUIRES(mutex_);
  /// Clears what another client has pending, which then gets kReplaced.
  void ReplacePending(Slot& slot, const Client& client, Completions& completions) REQUIRES(mutex_);
  Verdict Place(SlotId id, const Client& client, const Setpoint* setpoint, std::optional<int> steps,
                StepDone done) EXCLUDES(mutex_);
  void ApplyPolicy(Slot& slot, LossPolicy policy) REQUIRES(mutex_);
  bool IsAwaited(const Slot& slot) const REQUIRES(mutex_);
  void EndAllWaits(StepEnd end, const FramePtr& frame, Completions& completions) REQUIRES(mutex_);
  void CountAwaited() REQUIRES(mutex_);
  /// Corrects the count of awaited robots after a change of `slot`; true if that made the last one ready.
  bool NoteChange(const Slot& slot, bool was_awaited) REQUIRES(mutex_);
  static void Call(Completions& completions);

  mutable Mutex mutex_;
  std::vector<Slot> slots_ GUARDED_BY(mutex_);  // the scene's robots in order
  std::vector<Setpoint> latched_;               // stepping thread only
  std::vector<Waiter> waiters_ GUARDED_BY(mutex_);
  std::vector<Observer> observers_ GUARDED_BY(mutex_);
  std::vector<std::size_t> slot_index_ GUARDED_BY(mutex_);  // SlotId → index into slots_, or kNoSlot
  Mode mode_ GUARDED_BY(mutex_) = Mode::kRealtime;
  std::size_t awaited_ GUARDED_BY(mutex_) = 0;  // participants that are not ready
  SlotId next_slot_ GUARDED_BY(mutex_) = 1;
  std::uint64_t next_observer_ GUARDED_BY(mutex_) = 1;
  bool stopping_ GUARDED_BY(mutex_) = false;
  FramePtr last_frame_ GUARDED_BY(mutex_);
  std::function<void()> all_ready_hook_;  // constant after construction
};

}  // namespace coopdyn
