// SPDX-License-Identifier: MIT
// The options of a scenario's controller line against those that the controller describes. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/controllers/plugin.h"
#include "server/model/scenario.h"

namespace coopdyn {

/// What is wrong with the options given, with what to write instead; one text each.
std::vector<std::string> CheckOptions(const ControllerChoice& choice,
                                      const ControllerDescription& description);

/// One value for each option described: as given, else as described.
std::vector<double> OptionValues(const ControllerChoice& choice, const ControllerDescription& description);

}  // namespace coopdyn
