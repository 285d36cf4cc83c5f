// SPDX-License-Identifier: MIT
// A scenario in one line, as `coopdyn check` prints it. Pure; any thread.
#pragma once

#include <string>

#include "server/model/scenario.h"

namespace coopdyn {

/// For example: 5 robots (coopbot), 12 objects (9 static), 2 targets, floor 20 x 20 m, realtime 10 ms
std::string Summary(const Scenario& scenario);

}  // namespace coopdyn
