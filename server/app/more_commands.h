// SPDX-License-Identifier: MIT
// Commands that bring their own options: bench, new-controller. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds them to `app`. Parsing one of them sets `chosen` to what does it and returns the exit code.
void AddMoreCommands(CLI::App& app, std::function<int()>& chosen);

}  // namespace coopdyn
