// SPDX-License-Identifier: MIT
// Reads [SCORE_n] of a scenario. One thread.
#pragma once

#include <optional>

#include "server/model/scenario.h"
#include "server/model/section_reader.h"

namespace coopdyn {

/// Nothing with an error.
std::optional<ScoreEntry> ReadScore(SectionReader& reader);

/// Reports names in the scores of `scenario`, which has been read, that nothing has, and scores of one name.
void CheckScores(const Scenario& scenario, Diagnostics& diagnostics);

}  // namespace coopdyn
