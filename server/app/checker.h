// SPDX-License-Identifier: MIT
// What `coopdyn check` and the page's editor say about a file: the readers' diagnostics, then what physics
// and controllers have to say, and a summary. Any thread.
#pragma once

#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/model/readers.h"
#include "server/model/settings.h"
#include "server/state/frame.h"

namespace coopdyn {

struct Checked {
  FramePtr frame;                           // the first one, for a picture; null: it cannot be built
  std::vector<std::string> lines;           // what is in it, in short; empty with errors
  std::shared_ptr<const RobotModel> model;  // of a robot's file; null for any other, and with errors
};

/// Checks a scenario, a world or a robot model. `controllers`: what they say too, which starts them.
/// `settings`: of a scenario.
Checked CheckFile(const std::string& file, RobotLibrary& robots, Diagnostics& diagnostics,
                  bool controllers = true, const Settings& settings = {});
/// Checks the text of a scenario that names other files by bare names only.
Checked CheckScenarioText(const std::string& text, const std::string& name, RobotLibrary& robots,
                          Diagnostics& diagnostics);

}  // namespace coopdyn
