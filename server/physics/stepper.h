// SPDX-License-Identifier: MIT
// The physics thread, and the rule of who may step. Whoever holds the baton owns the physics world and is the
// one writer of frames. That is the physics thread; in lockstep the robot thread whose command makes the last
// robot ready takes the baton, if it is free, and runs the steps itself: a round trip then costs no thread
// switch (docs/decisions.md).
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

/// The right to step. Not a lock that code waits behind: robot threads only try. Any thread.
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

/// How the run starts; from the command line over the scenario.
struct RunOptions {
  std::optional<Mode> mode;
  std::optional<Nanoseconds> step;
  std::optional<double> speed;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::optional<std::uint64_t> steps;  // instead of duration_s: the end, in steps of the first length
  bool paused = false;
  bool stop_on_controller_failure = false;
  bool ends_daemon = false;  // the end of the run. Else the world stands, and a reset starts it again
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

  /// Builds the world of `scenario` and publishes frame 0. False, with errors, if it cannot be built. Before
  /// Run().
  bool Start(std::shared_ptr<const Scenario> scenario, Diagnostics& diagnostics) EXCLUDES(baton_);
  /// Builds the world of `state`, goes on from there and publishes its frame. As Start() otherwise.
  bool StartFrom(const SavedStatePtr& state, Diagnostics& diagnostics) EXCLUDES(baton_);
  /// Clients that are served before Run() make no step: what is to be recorded does not begin before its
  /// recording.
  void WaitForRun() EXCLUDES(baton_);
  /// A live run that has given way to a recording.
  struct PutAside {
    Edit edit;            // the Play that did it, to be answered
    SavedStatePtr state;  // of the run, for a Restore
  };
  /// The physics thread: steps until `stop` is requested (ring the bell after), or until a Play. Returns when
  /// nothing steps any more.
  std::optional<PutAside> Run(std::stop_token stop) EXCLUDES(baton_);
  /// Instead of Start(): `edit` (a Restore) ended a playback. True if the run is live now. Before Run().
  bool TakeOver(Edit edit) EXCLUDES(baton_);
  /// Runs the steps that have just become possible on the calling thread if the baton is free and time
  /// allows; wakes the physics thread for what is left. Any thread, no lock held.
  void StepHere() EXCLUDES(baton_);
  /// How long the parts of stepping have taken so far. Any thread.
  PhaseTimes phase_times() EXCLUDES(baton_);
  /// Called on the stepping thread when the run has ended: RunControl::end() says why. Set before Start().
  void set_on_ended(std::function<void()> on_ended) { on_ended_ = std::move(on_ended); }

 private:
  // Each handles one kind of edit and returns what to answer.
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
  /// The same for any kind; what is for a playback is refused.
  EditResult ApplyAny(const EditAction& action) REQUIRES(baton_);

  /// Up to the first Play, which ends the run.
  void ApplyEdits() REQUIRES(baton_);
  void ApplyEdit(Edit& edit) REQUIRES(baton_);
  /// Does what is due now and returns when to look again. `put_aside`: set if the run has given way.
  Nanoseconds WorkOnce(const std::stop_token& stop, UrgentThread& thread, std::optional<PutAside>& put_aside)
      EXCLUDES(baton_);
  Nanoseconds StepIfDue(Nanoseconds now) REQUIRES(baton_);
  void StepNow(Nanoseconds now) REQUIRES(baton_);
  /// Takes note of controllers that have stopped: in the step after frame `step`, which is an input of the
  /// run; or, without, from the start.
  void NoteStoppedControllers(const std::vector<StoppedController>& controllers,
                              std::optional<std::uint64_t> step) REQUIRES(baton_);
  /// Takes note of the clients that were lost before the step latched last.
  void NoteLostClients() REQUIRES(baton_);
  void NoteStopped(const std::string& robot, const char* by, const std::string& why) REQUIRES(baton_);
  void TellEnded() REQUIRES(baton_);
  /// No step is to follow; TellEnded() is due.
  void EndRun(RunEnd why, std::string text) REQUIRES(baton_);
  /// Why nothing steps while the run has ended.
  std::string EndedText() const REQUIRES(baton_);
  /// No step follows at once on this thread.
  void RestControllers() REQUIRES(baton_);
  std::unique_ptr<Simulation> BuildSimulation(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                              Diagnostics& diagnostics) REQUIRES(baton_);
  /// The simulation stands at a frame that does not follow from the one before: publishes it and begins anew
  /// whatever goes by steps. Its controllers run already. `state`: from which it goes on; null: the start.
  void Install(StepEnd end, const SavedState* state = nullptr) REQUIRES(baton_);
  /// Who drives, and with what, as in `state`.
  void TakeDrives(const SavedState& state, Nanoseconds now) REQUIRES(baton_);
  /// The answer to a Restore() that has failed for `why`, after which the run goes on from `present`, as it
  /// was.
  EditResult RefuseRestore(const std::string& why, const SavedState& present) REQUIRES(baton_);
  /// The controllers do not take the state that they had just now, for `why`: their robots stand. `stopped`:
  /// as the controllers say; empty if they do not know which. Returns what to answer.
  std::string LoseControllers(const std::string& why, std::vector<StoppedController> stopped)
      REQUIRES(baton_);
  /// Puts `state`, to which the simulation has been restored, in force.
  void InstallState(const SavedState& state, StepEnd end) REQUIRES(baton_);
  SavedStatePtr SaveState() const REQUIRES(baton_);
  static Nanoseconds LengthOf(const SavedState& state) {
    return state.step_length.value_or(state.frame->step_length);
  }
  std::uint64_t NextEpoch() const;
  /// Makes `change` and puts the new scene in force; `entry` is for the history. `tells`: an event says so.
  EditResult ChangeWorld(WorldChange change, WorldHistory::Entry& entry, bool tells = true) REQUIRES(baton_);
  /// Keeps a number that was logged at `now`. False: there are too many names.
  bool LogNumber(const std::string& name, double value, const Frame& now) REQUIRES(baton_);
  /// What controllers have logged of `seen`, the frame before the newest.
  void NoteLogs(std::span<const Supervision::Log> logs, const Frame& seen) REQUIRES(baton_);
  /// What the supervisor wants is done, after the step in which it said so.
  void Supervise(const Supervision& supervision) REQUIRES(baton_);
  void WriteInput(std::uint64_t step, std::variant<RunEdit, RobotEvent, WorldInput> what) REQUIRES(baton_);
  /// Takes mode, step, speed and duration of the scenario, as far as it says them and the command line does
  /// not.
  void TakeOptions(const SimulationOptions& said) REQUIRES(baton_);
  /// Says of each robot that has left the floor since the last call; `first`: stays silent.
  void NoteFloorLeft(const Frame& frame, bool first) REQUIRES(baton_);
  bool may_step() const REQUIRES(baton_) {
    return simulation_ != nullptr && !ended_ && !stopping_ && (!paused_ || allowed_steps_ > 0);
  }
  /// The newest frame. @pre there is a simulation
  const Frame& frame() const REQUIRES(baton_) { return *simulation_->frame(); }
  double speed() const REQUIRES(baton_);  // ≤ 0: no limit
  void RestartPace(Nanoseconds now) REQUIRES(baton_);
  PhaseTimes AllTimes() const REQUIRES(baton_);
  /// Counts what the step has not solved exactly, and tells the first.
  void NoteUnsolved() REQUIRES(baton_);
  /// A step that began at `began` and was told to the journal from `told` to `written` is over.
  void NoteCosts(Nanoseconds began, Nanoseconds told, Nanoseconds written) REQUIRES(baton_);
  /// No step follows at once: the time until the next one costs nobody anything.
  void IgnoreRest() REQUIRES(baton_);
  /// Publishes how the run stands; unless `always`, at most each kStatusEvery.
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
  Nanoseconds watches_at_ GUARDED_BY(baton_) = 0;  // the next look for silent clients
  Nanoseconds rests_from_ GUARDED_BY(baton_) = 0;  // the end of the step before; 0: it does not count
  PhaseTimes times_before_ GUARDED_BY(baton_);     // AllTimes() when costs began anew
  bool has_deadlines_ GUARDED_BY(baton_) = false;
  Nanoseconds looks_again_at_ GUARDED_BY(baton_) = 0;         // until then the physics thread sleeps
  std::vector<char> off_floor_ GUARDED_BY(baton_);            // 1: yes; by robot
  std::optional<std::uint64_t> moved_at_ GUARDED_BY(baton_);  // step of the supervisor's last moves
  std::string not_moved_ GUARDED_BY(baton_);                  // why, as the last event said
  bool logs_lost_ GUARDED_BY(baton_) = false;                 // an event has said so
};

}  // namespace coopdyn
