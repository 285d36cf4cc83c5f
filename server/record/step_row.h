// SPDX-License-Identifier: MIT
// From a row of the table `step` (docs/formats.md) to a step. The parts in turn, since the second and the
// third need the scene that the first names. Each returns what is damaged, e.g. "the poses"; empty: nothing.
// Pure functions of what the row holds.
#pragma once

#include <string>

#include "server/record/recorded_step.h"
#include "server/record/sqlite_db.h"
#include "server/state/scene.h"

namespace coopdyn {

struct StepColumns {
  enum {
    kStep,
    kTime,
    kHash,
    kScene,
    kCommands,
    kMessages,
    kChannels,
    kDistances,
    kTargets,
    kPoses,
    kScores
  };
  /// "SELECT … FROM step" with these columns; `inputs_only`: without readings, poses and scores.
  /// `has_scores`: HasScores().
  static std::string Select(bool inputs_only, bool has_scores);
  /// Older files do not have that column. Throws DatabaseError.
  static bool HasScores(const Database& database);
};

/// Number, time, hash and scene.
std::string DecodeHead(const Statement& row, RecordedStep& step);
/// Commands and broadcasts, of channels and robots of `scene`; null: they are not compared with any.
std::string DecodeInputs(const Statement& row, const Scene* scene, RecordedStep& step);
/// Channels, readings, poses and scores.
std::string DecodeReadings(const Statement& row, const Scene& scene, RecordedStep& step);

}  // namespace coopdyn
