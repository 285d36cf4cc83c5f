// SPDX-License-Identifier: MIT
// `coopdyn bench recording`: what recording costs, how long it takes to find a moment again, to verify the
// run, and to begin anew.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds the command to `bench`. Parsing it sets `chosen`.
void AddBenchRecording(CLI::App& bench, std::function<int()>& chosen);

}  // namespace coopdyn
