// SPDX-License-Identifier: MIT
// The lines by which somebody drives a model for the first time: they run as they stand. Pure; any thread.
#pragma once

#include <string>

#include "server/model/robot_model.h"

namespace coopdyn {

/// Programs of a few lines; each line ends in '\n'.
struct DriveLines {
  std::string serve;   // for a shell
  std::string python;  // with clients/python on PYTHONPATH
  std::string matlab;  // with clients/matlab on the path
  std::string yarp;    // for a shell
};

/// `file`: what is served, with `options` (each begins with a blank). `name`, `model`: of a robot in it with
/// sockets; a null model: it has none. The programs run for about 1 s in steps of `step_s`.
DriveLines DriveLinesFor(const std::string& file, const std::string& options, const std::string& name,
                         const RobotModel* model, double step_s = 0.01);

/// `text` as one word of a shell.
std::string ShellWord(const std::string& text);

}  // namespace coopdyn
