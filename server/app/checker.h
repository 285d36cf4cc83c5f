// SPDX-License-Identifier: MIT
// Checks a file for `coopdyn check` and the page's editor: diagnostics of the readers, of physics and of
// controllers, and a summary. Any thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/readers.h"
#include "server/model/settings.h"
#include "server/state/frame.h"

namespace coopdyn {

struct Checked {
  FramePtr frame;                           // first frame, for a picture; null if it cannot be built
  std::vector<std::string> lines;           // summary of the contents; empty with errors
  std::shared_ptr<const RobotModel> model;  // of a robot model file; else, or with errors, null
};

/// Checks a scenario, a world or a robot model. `controllers`: also checks, and so starts, loaded
/// controllers. `settings` apply to a scenario.
Checked CheckFile(const std::string& file, RobotLibrary& robots, Diagnostics& diagnostics,
                  bool controllers = true, const Settings& settings = {});
/// Checks the text of a scenario that may name other files only by bare names.
Checked CheckScenarioText(const std::string& text, const std::string& name, RobotLibrary& robots,
                          Diagnostics& diagnostics);

}  // namespace coopdyn
