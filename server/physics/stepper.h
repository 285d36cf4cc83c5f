// SPDX-License-Identifier: MIT
// The physics thread, and the rule of which thread may step. The thread that holds the baton owns the physics
// world and is the only writer of frames. Usually the physics thread holds it. In lockstep, the robot thread
// whose command makes the last robot ready takes the baton, if it is free, and runs the steps itself, so a
// round trip costs no thread switch (docs/decisions.md).
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/mutex.h"
#include "server/physics/simulation.h"
#include "server/state/command_board.h"
#include "server/state/doorbell.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/run_control.h"
#include "server/state/run_journal.h"
#include "server/state/world_history.h"
#include "server/timing/pace.h"

namespace coopdyn {

/// The right to step. Robot threads only try to take it and never wait for it. Any thread.
class CAPABILITY("baton") Baton {
 public:
  void Take() ACQUIRE() {
    while (!TryTake()) taken_.wait(true, std::memory_order_relaxed);
  }
  bool TryTake() TRY_ACQUIRE(true) { return !taken_.exchange(true, std::memory_order_acquire); }
  void Pass() RELEASE() {
    taken_.store(false, std::memory_order_release);
    taken_.notify_one();
  }

 private:
  std::atomic<bool> taken_{false};
};

/// How the run starts. These options of the command line override the scenario.
struct RunOptions {
  std::optional<Mode> mode;
  std::optional<Nanoseconds> step;
  std::optional<double> speed;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::optional<std::uint64_t> steps;  // instead of duration_s: number of steps, of the initial length
  bool paused = false;
  bool stop_on_controller_failure = false;
  bool ends_daemon = false;  // when the run ends; else the world stands still, and a reset restarts it
};

class Stepper {
 public:
  struct Boards {
    FrameBoard& frames;
    CommandBoard& commands;
    EditQueue& edits;
    RunControl& control;
    Doorbell& bell;
  };

  Stepper(Boards boards, const Clock& clock, Logger logger, RunOptions options, StepHelpers helpers = {});

  /// Builds the world of `scenario` and publishes frame 0. Returns false, with errors, if it cannot be built.
  /// Call before Run().
  bool Start(std::shared_ptr<const Scenario> scenario, Diagnostics& diagnostics) EXCLUDES(baton_);
  /// Builds the world of `state`, continues from it, and publishes its frame. Otherwise as Start().
  bool StartFrom(const SavedStatePtr& state, Diagnostics& diagnostics) EXCLUDES(baton_);
  /// Until Run(), commands of clients run no steps, so a recording starts with the first step.
  void WaitForRun() EXCLUDES(baton_);
  /// A live run that was replaced by the playback of a recording.
  struct PutAside {
    Edit edit;            // the Play, not yet answered
    SavedStatePtr state;  // of the live run, for a later Restore
  };
  /// The physics thread's loop: steps until `stop` is requested (ring the bell after that) or a Play replaces
  /// the run. No thread steps after it has returned.
  std::optional<PutAside> Run(std::stop_token stop) EXCLUDES(baton_);
  /// Applies `edit` (a Restore) that ended a playback; use it instead of Start(), before Run(). Returns
  /// whether the run is live now.
  bool TakeOver(Edit edit) EXCLUDES(baton_);
  /// Runs the steps that have become possible on the calling thread, if the baton is free, for a limited
  /// time. Wakes the physics thread for the rest. Any thread, no lock held.
  void StepHere() EXCLUDES(baton_);
  /// Total time spent so far in each phase of stepping. Any thread.
  PhaseTimes phase_times() EXCLUDES(baton_);
  /// Sets the callback for the end of the run, called on the stepping thread. RunControl::end() has the
  /// reason. Call before Start().
  void set_on_ended(std::function<void()> on_ended) { on_ended_ = std::move(on_ended); }

 private:
  // Each handles one kind of edit and returns its reply.
  EditResult Apply(const edit::Run&) REQUIRES(baton_);
  EditResult Apply(const edit::Pause&) REQUIRES(baton_);
  EditResult Apply(const edit::Step&) REQUIRES(baton_);
  EditResult Apply(const edit::SetMode&) REQUIRES(baton_);
  EditResult Apply(const edit::SetStep&) REQUIRES(baton_);
  EditResult Apply(const edit::SetSpeed&) REQUIRES(baton_);
  EditResult Apply(const edit::SetParticipants&) REQUIRES(baton_);
  EditResult Apply(const edit::StopAll&) REQUIRES(baton_);
  EditResult Apply(const edit::UnloadController&) REQUIRES(baton_);
  EditResult Apply(const edit::TuneJoints& tuning) REQUIRES(baton_);
  EditResult Apply(const edit::Reset&) REQUIRES(baton_);
  EditResult Apply(const edit::Load&) REQUIRES(baton_);
  EditResult Apply(const edit::Restore&) REQUIRES(baton_);
  EditResult Apply(const edit::Play&) REQUIRES(baton_);
  EditResult Apply(const edit::Change& change) REQUIRES(baton_);
  EditResult Apply(const edit::Undo&) REQUIRES(baton_);
  EditResult Apply(const edit::Redo&) REQUIRES(baton_);
  EditResult Apply(const edit::SetJournal&) REQUIRES(baton_);
  EditResult Apply(const edit::Note&) REQUIRES(baton_);
  EditResult Apply(const edit::Log& log) REQUIRES(baton_);
  EditResult Apply(const edit::EndRun& end) REQUIRES(baton_);
  EditResult Apply(const edit::Save&) REQUIRES(baton_);
  /// Handles any kind of edit. Refuses edits for a playback.
  EditResult ApplyAny(const EditAction& action) REQUIRES(baton_);

  /// Applies pending edits up to the first Play, which ends the run.
  void ApplyEdits() REQUIRES(baton_);
  void ApplyEdit(Edit& edit) REQUIRES(baton_);
  /// Does the work that is due now and returns the time of the next check. Sets `put_aside` if a Play
  /// replaced the run.
  Nanoseconds WorkOnce(const std::stop_token& stop, UrgentThread& thread, std::optional<PutAside>& put_aside)
      EXCLUDES(baton_);
  Nanoseconds StepIfDue(Nanoseconds now) REQUIRES(baton_);
  void StepNow(Nanoseconds now) REQUIRES(baton_);
  /// Reports stopped controllers. `step`: they stopped in the step after frame `step`, which becomes an input
  /// of the run; nullopt: they were stopped before the first step.
  void NoteStoppedControllers(const std::vector<StoppedController>& controllers,
                              std::optional<std::uint64_t> step) REQUIRES(baton_);
  /// Reports the clients that were lost before the last latched step.
  void NoteLostClients() REQUIRES(baton_);
  void NoteStopped(const std::string& robot, const char* by, const std::string& why) REQUIRES(baton_);
  void NotifyEnded() REQUIRES(baton_);
  /// Ends the run: no step follows. The caller must call NotifyEnded() afterwards.
  void EndRun(RunEnd why, std::string text) REQUIRES(baton_);
  /// The reply to requests to step after the run has ended.
  std::string EndedText() const REQUIRES(baton_);
  /// Releases resources of the controllers: no step follows immediately on this thread.
  void RestControllers() REQUIRES(baton_);
  std::unique_ptr<Simulation> BuildSimulation(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                              Diagnostics& diagnostics) REQUIRES(baton_);
  /// Publishes the simulation's frame, which does not follow from the previous one, and resets everything
  /// that counts steps. The controllers already run. `state`: the state from which the run continues; null:
  /// the start.
  void Install(StepEnd end, const SavedState* state = nullptr) REQUIRES(baton_);
  /// Restores which controllers are unloaded, and the set-points in force, from `state`.
  void TakeDrives(const SavedState& state, Nanoseconds now) REQUIRES(baton_);
  /// Restores `present` after a Restore() has failed for `why`, and returns the reply.
  EditResult RefuseRestore(const std::string& why, const SavedState& present) REQUIRES(baton_);
  /// Handles controllers that cannot return to the present state, for `why`: their robots stand still.
  /// `stopped`: the controllers that failed; empty if unknown (then all). Returns text to append to the
  /// reply.
  std::string LoseControllers(const std::string& why, std::vector<StoppedController> stopped)
      REQUIRES(baton_);
  /// Installs `state`, to which the simulation has been restored.
  void InstallState(const SavedState& state, StepEnd end) REQUIRES(baton_);
  SavedStatePtr SaveState() const REQUIRES(baton_);
  static Nanoseconds LengthOf(const SavedState& state) {
    return state.step_length.value_or(state.frame->step_length);
  }
  std::uint64_t NextEpoch() const;
  /// Applies `change` and installs the new scene. Fills `entry` for the history. `adds_event`: adds an event.
  EditResult ChangeWorld(WorldChange change, WorldHistory::Entry& entry, bool adds_event = true)
      REQUIRES(baton_);
  /// Stores a number that was logged at `now`. Returns false if there are too many names.
  bool LogNumber(const std::string& name, double value, const Frame& now) REQUIRES(baton_);
  /// Stores the numbers that controllers logged when they saw `seen`, the frame before the newest.
  void NoteLogs(std::span<const Supervision::Log> logs, const Frame& seen) REQUIRES(baton_);
  /// Executes the supervisor's requests, after the step in which it made them.
  void Supervise(const Supervision& supervision) REQUIRES(baton_);
  void WriteInput(std::uint64_t step, std::variant<RunEdit, RobotEvent, WorldInput> what) REQUIRES(baton_);
  /// Takes step, speed and duration from the scenario, unless the command line sets them.
  void TakeOptions(const SimulationOptions& said) REQUIRES(baton_);
  /// Adds an event for each robot that has left the floor since the last call. `first`: adds none.
  void NoteFloorLeft(const Frame& frame, bool first) REQUIRES(baton_);
  bool may_step() const REQUIRES(baton_) {
    return simulation_ != nullptr && !ended_ && !stopping_ && (!paused_ || allowed_steps_ > 0);
  }
  /// The newest frame. @pre there is a simulation
  const Frame& frame() const REQUIRES(baton_) { return *simulation_->frame(); }
  double speed() const REQUIRES(baton_);  // ≤ 0: no limit
  void RestartPace(Nanoseconds now) REQUIRES(baton_);
  PhaseTimes AllTimes() const REQUIRES(baton_);
  /// Counts islands that the step did not solve exactly, and adds an event for the first.
  void NoteUnsolved() REQUIRES(baton_);
  /// Adds up the costs of a step that began at `began` and was written to the journal from `told` to
  /// `written`.
  void NoteCosts(Nanoseconds began, Nanoseconds told, Nanoseconds written) REQUIRES(baton_);
  /// No step follows immediately: the time until the next one does not count as idle or waiting.
  void IgnoreRest() REQUIRES(baton_);
  /// Publishes the run's status; unless `always`, at most once per kStatusEvery.
  void PublishStatus(Nanoseconds now, bool always) REQUIRES(baton_);
  void AddEvent(const char* level, std::string text) REQUIRES(baton_);

  const Boards boards_;
  const Clock& clock_;
  const Logger logger_;
  const RunOptions options_;
  const StepHelpers helpers_;
  std::function<void()> on_ended_;

  Baton baton_;
  std::unique_ptr<Simulation> simulation_ GUARDED_BY(baton_);
  WorldHistory history_ GUARDED_BY(baton_);
  RunJournal* journal_ GUARDED_BY(baton_) = nullptr;
  Mode mode_ GUARDED_BY(baton_) = Mode::kRealtime;
  Nanoseconds step_length_ GUARDED_BY(baton_) = kDefaultStep;
  std::array<std::optional<double>, 3> speeds_ GUARDED_BY(baton_);  // explicit, by mode
  bool paused_ GUARDED_BY(baton_) = false;
  std::int64_t allowed_steps_ GUARDED_BY(baton_) = 0;  // while paused
  bool waits_for_run_ GUARDED_BY(baton_) = false;
  bool ended_ GUARDED_BY(baton_) = false;
  bool stopping_ GUARDED_BY(baton_) = false;
  std::optional<PutAside> put_aside_ GUARDED_BY(baton_);  // until Run() returns it
  std::optional<Nanoseconds> duration_ GUARDED_BY(baton_);
  Pacer pacer_ GUARDED_BY(baton_);
  RateMeter rate_ GUARDED_BY(baton_);
  RunStatus status_ GUARDED_BY(baton_);
  Nanoseconds status_at_ GUARDED_BY(baton_) = 0;
  Nanoseconds next_watchdog_at_ GUARDED_BY(baton_) = 0;  // the next check for silent clients
  Nanoseconds idle_since_ GUARDED_BY(baton_) = 0;        // end of the last step; 0: idle time does not count
  PhaseTimes times_before_ GUARDED_BY(baton_);           // AllTimes() when the costs were reset
  bool has_deadlines_ GUARDED_BY(baton_) = false;
  Nanoseconds next_check_at_ GUARDED_BY(baton_) = 0;          // the physics thread sleeps until then
  std::vector<char> off_floor_ GUARDED_BY(baton_);            // 1: yes; by robot
  std::optional<std::uint64_t> moved_at_ GUARDED_BY(baton_);  // step of the supervisor's last moves
  std::string not_moved_ GUARDED_BY(baton_);   // why the supervisor's last moves failed, as in the last event
  bool logs_lost_ GUARDED_BY(baton_) = false;  // an event has reported it
};

}  // namespace coopdyn
