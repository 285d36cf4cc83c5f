// SPDX-License-Identifier: MIT
// SDF worlds as scenarios. One thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

/// The text of the scenario that the world in `file` means: what stands still and is simple becomes things,
/// the rest robots, whose models `library` has from now on. Nothing with errors.
std::optional<std::string> ScenarioOfSdfWorld(const std::filesystem::path& file, RobotLibrary& library,
                                              Diagnostics& diagnostics);

}  // namespace coopdyn
