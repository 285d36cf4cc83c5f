// SPDX-License-Identifier: MIT
// Decodes rows of table `step` (docs/formats.md), in three parts because the second and third need the scene
// that the first names. Each returns the damaged part, e.g. "the poses", or empty. Pure functions of the row.
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
  /// `has_scores`: see HasScores().
  static std::string Select(bool inputs_only, bool has_scores);
  /// Whether the file has column `scores`; older files do not. Throws DatabaseError.
  static bool HasScores(const Database& database);
};

/// Number, time, hash and scene.
std::string DecodeHead(const Statement& row, RecordedStep& step);
/// Commands and broadcasts, checked against the channels and robots of `scene` unless it is null.
std::string DecodeInputs(const Statement& row, const Scene* scene, RecordedStep& step);
/// Channels, readings, poses and scores.
std::string DecodeReadings(const Statement& row, const Scene& scene, RecordedStep& step);

}  // namespace coopdyn
