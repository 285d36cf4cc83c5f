// SPDX-License-Identifier: MIT
// The hidden command with which `serve` starts the process that runs loaded controllers. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds `controller-child FD` to `app`.
void AddControllerChild(CLI::App& app, std::function<int()>& chosen);

}  // namespace coopdyn
