// SPDX-License-Identifier: MIT
// Who listens on a TCP port of this machine, from /proc. Any thread.
#pragma once

#include <string>

namespace coopdyn {

/// "nc (pid 77)"; empty if nobody listens there or it cannot be seen (another user's process).
std::string PortHolder(int port);

}  // namespace coopdyn
