// SPDX-License-Identifier: MIT
// `controller NAME option=value …` of a [ROBOT_n] or [SWARM_n].
#pragma once

#include <filesystem>
#include <optional>

#include "server/model/readers.h"
#include "server/model/section_reader.h"

namespace coopdyn {

/// The controller that the section names, its file found; empty if it names none, or with errors reported.
/// `beside`: the scenario's folder; nothing if the text came over a socket, and then only a bare name on
/// the library's path will do. What a recording names and is not there any more is a warning: its `file` is
/// empty.
ControllerChoice ReadController(SectionReader& reader, const RobotLibrary& library,
                                const std::optional<std::filesystem::path>& beside);

}  // namespace coopdyn
