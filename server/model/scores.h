// SPDX-License-Identifier: MIT
// The scores of a run: [SCORE_n] of a scenario. Immutable once read; thread-safe.
#pragma once

#include <array>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"

namespace coopdyn {

enum class ScoreKind {
  kReach,
  kTime,
  kDistance,
  kTravelled,
  kCollisions,
  kNearest,
  kEnergy,
  kUpright,
  kFormation,
  kCoverage
};
inline const std::array<std::string, 10> kScoreKindWords = {"reach",      "time",    "distance", "travelled",
                                                            "collisions", "nearest", "energy",   "upright",
                                                            "formation",  "coverage"};

/// `until >= 3`: the run ends when the score fulfils this condition.
struct ScoreUntil {
  enum class Relation { kLess, kAtMost, kAtLeast, kGreater };
  Relation relation = Relation::kAtLeast;
  double value = 0;
  bool all = false;  // `until all` of `reach`: at least the number of robots in `of`

  bool Holds(double score) const {
    switch (relation) {
      case Relation::kLess:
        return score < value;
      case Relation::kAtMost:
        return score <= value;
      case Relation::kAtLeast:
        return score >= value;
      default:
        return score > value;
    }
  }
};

/// The condition as written in [SCORE_n]: ">= 3" or "all".
std::string ToString(const ScoreUntil& until);

/// [SCORE_n]
struct ScoreEntry {
  std::string name;
  ScoreKind kind = ScoreKind::kTime;
  std::vector<std::string> of;  // robots, swarms, things, links ROBOT/LINK; empty: all robots
  std::string target;           // reach: the name of a target, a thing or a light, or a target's colour
  double within_m = 0.3;        // reach
  double tilt_rad = std::numbers::pi / 4;  // upright: a robot that leans further has fallen
  double cell_m = 0.25;                    // coverage
  std::optional<ScoreUntil> until;
  std::optional<double> limit_s;  // the run also ends at this simulated time
  SourceLine where;
};

/// The unit of a score of this kind, e.g. "m"; empty for a count.
const char* UnitOf(ScoreKind kind);

/// The value of an undefined score.
inline constexpr double kNoScore = std::numeric_limits<double>::quiet_NaN();
inline constexpr std::size_t kMaxScores = 100;
/// Maximum robots in a formation, whose error is computed over all pairs.
inline constexpr std::size_t kMaxFormation = 100;

}  // namespace coopdyn
