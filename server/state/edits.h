// SPDX-License-Identifier: MIT
// Edits that the stepping thread, or a player, can apply between two steps. Plain values; any thread.
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

// Edits of how the run continues. Each success is an input of the run (RunInput).
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
/// Unloads the controller of `robot`; clients may drive the robot from then on.
struct UnloadController {
  std::string robot;
};

/// `set_compliance`, `set_profile` or `set_gains` of a control board.
struct TuneJoints {
  std::string robot, module;
  std::int32_t command = 0;          // the command's id
  std::vector<std::int32_t> joints;  // of the board, from 1; empty: all
  std::vector<double> values;        // joint by joint
};

// Edits that replace the world: the next frame does not follow from the last one, and a journal starts anew.
struct Reset {
  std::optional<std::uint64_t> seed;  // empty: unchanged
  /// Redrawn for `seed` if the scenario has random keys; else null.
  std::shared_ptr<const Scenario> scenario = nullptr;
};
/// Replaces the scenario. If its physics cannot be built, nothing changes and the reply's text has the
/// diagnostics.
struct Load {
  std::shared_ptr<const Scenario> scenario;
};
/// Continues from `state`, even one of another scenario; ends a playback.
struct Restore {
  SavedStatePtr state;
};
/// Ends the live run or playback and plays `recording`, loading its scenario. The result has the state of the
/// live run, if there was one.
struct Play {
  std::shared_ptr<RunReader> recording;
};

// Edits of the world within the run. Each success is an input of the run: the resulting WorldChange.
struct Change {
  WorldChange change;
};
/// Takes back the last change not yet taken back.
struct Undo {};
/// Repeats the change last taken back by Undo or a reset.
struct Redo {};

// Edits of a playback.
/// Shows the step at or before `time`; the nearest end if `time` lies outside.
struct Seek {
  Nanoseconds time = 0;
};
/// Moves by `steps` recorded steps (below 0: back).
struct Skip {
  int steps = 1;
};
struct SetPlaySpeed {
  double factor = 1;  // kMinPlaySpeed…kMaxPlaySpeed, not 0
};
struct SetLoop {
  bool loop = false;
};

// Edits of the record of the run; the run itself is unaffected.
/// Sends every later step to `journal`, whose Begin() is called with this edit; null: to none. A journal
/// outlives the edit that replaces it.
struct SetJournal {
  RunJournal* journal = nullptr;
};
/// An event of level `note`.
struct Note {
  std::string text;
};
/// A named number that does not affect the run.
struct Log {
  std::string name;
  double value = 0;
};
/// Ends the run here because it has reached its goal.
struct EndRun {
  std::string why;
};
/// The result has the complete state of the run.
struct Save {};

}  // namespace edit

using RunEdit = std::variant<edit::Run, edit::Pause, edit::Step, edit::SetMode, edit::SetStep, edit::SetSpeed,
                             edit::SetParticipants, edit::StopAll, edit::UnloadController, edit::TuneJoints>;
using WorldEdit = std::variant<edit::Reset, edit::Load, edit::Restore, edit::Play>;
using SceneEdit = std::variant<edit::Change, edit::Undo, edit::Redo>;
using PlaybackEdit = std::variant<edit::Seek, edit::Skip, edit::SetPlaySpeed, edit::SetLoop>;
using RecordEdit = std::variant<edit::SetJournal, edit::Note, edit::Log, edit::EndRun, edit::Save>;

using EditAction = std::variant<RunEdit, WorldEdit, SceneEdit, PlaybackEdit, RecordEdit>;

/// The `T` in a variant of variants; null if it holds another type.
template <typename T, typename... Kinds>
const T* As(const std::variant<Kinds...>& variant) {
  const auto same = [](const auto& value) -> const T* {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, T>) return &value;
    return nullptr;
  };
  return std::visit([&same](const auto& kind) { return std::visit(same, kind); }, variant);
}

}  // namespace coopdyn
