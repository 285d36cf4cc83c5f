// SPDX-License-Identifier: MIT
// coopdyn verify: is a recorded run what it says; or, are two runs the same. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds it to `app`. Parsing it sets `chosen` to what does it and returns the exit code.
void AddVerify(CLI::App& app, std::function<int()>& chosen);

}  // namespace coopdyn
