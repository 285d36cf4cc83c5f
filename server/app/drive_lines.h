// SPDX-License-Identifier: MIT
// Sample programs that drive a model; they run unchanged. Pure; any thread.
#pragma once

#include <string>

#include "server/model/robot_model.h"

namespace coopdyn {

/// Programs of a few lines; each line ends with '\n'.
struct DriveLines {
  std::string serve;   // for a shell
  std::string python;  // with clients/python on PYTHONPATH
  std::string matlab;  // with clients/matlab on the path
  std::string yarp;    // for a shell
};

/// Makes programs for `file`, served with `options`, each preceded by a blank. `name`, `model`: a robot in it
/// with sockets; null if it has none. The programs run for about 1 s in steps of `step_s`.
DriveLines DriveLinesFor(const std::string& file, const std::string& options, const std::string& name,
                         const RobotModel* model, double step_s = 0.01);

/// `text` quoted as one shell word.
std::string ShellWord(const std::string& text);

}  // namespace coopdyn
