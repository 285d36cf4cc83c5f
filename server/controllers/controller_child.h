// SPDX-License-Identifier: MIT
// The main program of the controllers' process: `coopdyn controller-child 3`.
#pragma once

namespace coopdyn {

/// Makes copies of this process as the daemon asks for them over the socket `fd` (child_launcher.h), until it
/// is gone. Each copy serves it until it is told to end, and ends at once when the daemon is gone. Returns
/// the exit code of whichever process returns.
int RunControllerChild(int fd);

}  // namespace coopdyn
