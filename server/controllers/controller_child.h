// SPDX-License-Identifier: MIT
// The main program of the controllers' process: `coopdyn controller-child 3`.
#pragma once

namespace coopdyn {

/// Serves the daemon that started this process until it is told to end; ends the process at once when the
/// daemon is gone. Files: `fd` a socket to the daemon, then the areas `in` and `out`. Returns the exit code.
int RunControllerChild(int fd);

}  // namespace coopdyn
