// SPDX-License-Identifier: MIT
// Reads [SCORE_n] of a scenario. One thread.
#pragma once

#include <optional>

#include "server/model/scenario.h"
#include "server/model/section_reader.h"

namespace coopdyn {

/// Reports an error and returns nullopt on failure.
std::optional<ScoreEntry> ReadScore(SectionReader& reader);

/// Reports unknown names in the scores of `scenario`, and scores with the same name. @pre all of `scenario`
/// has been read
void CheckScores(const Scenario& scenario, Diagnostics& diagnostics);

}  // namespace coopdyn
