// SPDX-License-Identifier: MIT
// What is to happen to the run or the world between two steps, in arrival order. Any thread pushes; the
// stepping thread takes, applies, and calls back.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/message.h"
#include "server/base/mutex.h"
#include "server/state/command_board.h"
#include "server/state/doorbell.h"
#include "server/state/run_journal.h"
#include "server/state/saved_state.h"

namespace coopdyn {

namespace edit {
struct Run {};
struct Pause {};
/// Allows `steps` more steps while paused (error 5 otherwise); `done` when they have run, or were undone by
/// reset or load.
struct Step {
  int steps = 1;
  StepDone done;
};
struct Reset {
  std::optional<std::uint64_t> seed;  // empty: the same
};
/// Replaces the scenario. If its physics cannot be built nothing changes and the reply's text has the
/// diagnostics.
struct Load {
  std::shared_ptr<const Scenario> scenario;
};
struct SetMode {
  Mode mode;
};
struct SetStep {
  Nanoseconds step;
};
struct SetSpeed {
  double factor;  // ≤ 0: no limit
};
struct SetParticipants {
  std::vector<std::string> names;
};
struct StopAll {};
/// From now on every step goes to `journal`, whose Begin() is called with this edit; null: to none. A journal
/// outlives the edit that takes it away.
struct SetJournal {
  RunJournal* journal = nullptr;
};
/// An event of level `note`.
struct Note {
  std::string text;
};
/// The result has all that decides how the run goes on from here.
struct Save {};
/// Goes on from `state`, also if another scenario was in force; ends a playback.
struct Restore {
  SavedStatePtr state;
};
/// Playback: shows the step at or before `time`; the nearest end if it lies outside.
struct Seek {
  Nanoseconds time = 0;
};
/// Playback: stands that many recorded steps further on (below 0: back).
struct Skip {
  int steps = 1;
};
struct SetPlaySpeed {
  double factor = 1;  // −4…64, not 0
};
struct SetLoop {
  bool loop = false;
};
/// Takes the loaded controller of `robot` away; clients may drive it from then on.
struct UnloadController {
  std::string robot;
};
}  // namespace edit

using EditAction = std::variant<edit::Run, edit::Pause, edit::Step, edit::Reset, edit::Load, edit::SetMode,
                                edit::SetStep, edit::SetSpeed, edit::SetParticipants, edit::StopAll,
                                edit::UnloadController, edit::SetJournal, edit::Note, edit::Save,
                                edit::Restore, edit::Seek, edit::Skip, edit::SetPlaySpeed, edit::SetLoop>;

struct EditResult {
  Error error = Error::kOk;
  std::string text;
  FramePtr frame;                 // the newest after the edit
  SavedStatePtr saved = nullptr;  // of Save
};

struct Edit {
  EditAction action;
  /// Called once on the stepping thread, without locks; for Step only if it is refused. May be null.
  std::function<void(const EditResult&)> done;
};

class EditQueue {
 public:
  explicit EditQueue(Doorbell& bell) : bell_(bell) {}
  /// Any thread. After Close() the edit is answered at once with error 5.
  void Push(Edit edit) EXCLUDES(mutex_);
  /// All that wait, in order. Stepping thread.
  std::vector<Edit> TakeAll() EXCLUDES(mutex_);
  /// The first that waits, if any; the others stay in their order. Stepping thread.
  std::optional<Edit> TakeNext() EXCLUDES(mutex_);
  bool empty() const EXCLUDES(mutex_);
  /// Refuses what waits and what comes.
  void Close() EXCLUDES(mutex_);

 private:
  Doorbell& bell_;
  mutable Mutex mutex_;
  std::vector<Edit> edits_ GUARDED_BY(mutex_);
  bool closed_ GUARDED_BY(mutex_) = false;
};

}  // namespace coopdyn
