// SPDX-License-Identifier: MIT
// coopdyn bench lockstep: rounds per second over sockets. A round: every robot gets its command, the step
// runs, every reply is there. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds `lockstep` to `bench`. Parsing it sets `chosen` to what measures and returns the exit code.
void AddBenchLockstep(CLI::App& bench, std::function<int()>& chosen);

}  // namespace coopdyn
