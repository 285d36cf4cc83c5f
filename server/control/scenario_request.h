// SPDX-License-Identifier: MIT
// Reads the scenario that a client names or sends. Reads files, which can take seconds; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "protocol/message.h"
#include "server/model/readers.h"

namespace coopdyn {

struct ScenarioRead {
  std::shared_ptr<const Scenario> scenario;  // null: error
  Error error = Error::kOk;
  std::string text;  // the diagnostics, one a line; warnings if it could be read
};

/// Never throws: what goes wrong is an error.
/// `text`: a bare name on the search path, or the text of a file if it has a line end or a '['. `seed`: of
/// `--seed`, if it was given.
ScenarioRead ReadRequestedScenario(const std::string& text, RobotLibrary& robots,
                                   std::optional<std::uint64_t> seed = std::nullopt);
/// The file of `current` again, from disk. Error 5 if it came as a text.
ScenarioRead ReadScenarioAgain(const Scenario& current, RobotLibrary& robots,
                               std::optional<std::uint64_t> seed = std::nullopt);

}  // namespace coopdyn
