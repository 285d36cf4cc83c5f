// SPDX-License-Identifier: MIT
// What the stepping thread, or a player, can be asked to do between two steps. Plain values; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "server/model/scenario.h"
#include "server/state/frame.h"
#include "server/state/world_change.h"

namespace coopdyn {

class RunJournal;

inline constexpr double kMinPlaySpeed = -4, kMaxPlaySpeed = 64;
inline bool IsPlaySpeed(double factor) {
  return factor >= kMinPlaySpeed && factor <= kMaxPlaySpeed && factor != 0;
}
inline constexpr const char* kNoPlaySpeed =
    " is not possible: a recording is played at -4 to 64 times its speed, below 0 backwards; pause holds it";

class RunReader;

namespace edit {

// How the run goes on. Each one that succeeds is an input of the run (RunInput).
struct Run {};
struct Pause {};
/// Allows `steps` more steps while paused (error 5 otherwise).
struct Step {
  int steps = 1;
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
/// Takes the loaded controller of `robot` away; clients may drive it from then on.
struct UnloadController {
  std::string robot;
};

/// `set_compliance`, `set_profile` or `set_gains` of a control board.
struct TuneJoints {
  std::string robot, module;
  std::int32_t command = 0;          // the number of that command
  std::vector<std::int32_t> joints;  // of the board, from 1; empty: all
  std::vector<double> values;        // joint by joint
};

// What stands in the world: the next frame does not follow from the one before, and a journal begins anew.
struct Reset {
  std::optional<std::uint64_t> seed;  // empty: the same
  /// Drawn for `seed`, if the scenario has random keys; else null.
  std::shared_ptr<const Scenario> scenario = nullptr;
};
/// Replaces the scenario. If its physics cannot be built nothing changes and the reply's text has the
/// diagnostics.
struct Load {
  std::shared_ptr<const Scenario> scenario;
};
/// Goes on from `state`, also if another scenario was in force; ends a playback.
struct Restore {
  SavedStatePtr state;
};
/// Ends the live run, or the playback: plays `recording` (its scenario is loaded). The result has the state
/// of the live run, if there was one.
struct Play {
  std::shared_ptr<RunReader> recording;
};

// What stands in the world, as it goes on. Each one that succeeds is an input of the run: the WorldChange
// that it came to.
struct Change {
  WorldChange change;
};
/// Takes back the last change that was not taken back yet.
struct Undo {};
/// Makes the change again that was taken back last, by Undo or by a reset.
struct Redo {};

// What a playback shows.
/// The step at or before `time`; the nearest end if it lies outside.
struct Seek {
  Nanoseconds time = 0;
};
/// Stands that many recorded steps further on (below 0: back).
struct Skip {
  int steps = 1;
};
struct SetPlaySpeed {
  double factor = 1;  // kMinPlaySpeed…kMaxPlaySpeed, not 0
};
struct SetLoop {
  bool loop = false;
};

// What is kept of the run, which goes on as it is.
/// From now on every step goes to `journal`, whose Begin() is called with this edit; null: to none. A journal
/// outlives the edit that takes it away.
struct SetJournal {
  RunJournal* journal = nullptr;
};
/// An event of level `note`.
struct Note {
  std::string text;
};
/// A named number, which the run does not look at.
struct Log {
  std::string name;
  double value = 0;
};
/// The run ends here, as it has reached what it was for.
struct EndRun {
  std::string why;
};
/// The result has all that decides how the run goes on from here.
struct Save {};

}  // namespace edit

using RunEdit = std::variant<edit::Run, edit::Pause, edit::Step, edit::SetMode, edit::SetStep, edit::SetSpeed,
                             edit::SetParticipants, edit::StopAll, edit::UnloadController, edit::TuneJoints>;
using WorldEdit = std::variant<edit::Reset, edit::Load, edit::Restore, edit::Play>;
using SceneEdit = std::variant<edit::Change, edit::Undo, edit::Redo>;
using PlaybackEdit = std::variant<edit::Seek, edit::Skip, edit::SetPlaySpeed, edit::SetLoop>;
using RecordEdit = std::variant<edit::SetJournal, edit::Note, edit::Log, edit::EndRun, edit::Save>;

using EditAction = std::variant<RunEdit, WorldEdit, SceneEdit, PlaybackEdit, RecordEdit>;

/// The `T` in a variant of variants; null if it holds something else.
template <typename T, typename... Kinds>
const T* As(const std::variant<Kinds...>& variant) {
  const auto same = [](const auto& value) -> const T* {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, T>) return &value;
    return nullptr;
  };
  return std::visit([&same](const auto& kind) { return std::visit(same, kind); }, variant);
}

}  // namespace coopdyn
