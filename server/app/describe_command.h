// SPDX-License-Identifier: MIT
// `coopdyn describe`: a page of Markdown about a robot, a module or a scenario, made from the model, the
// command table or the scenario itself. docs/reference holds what it prints. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds the command to `app`.
void AddDescribe(CLI::App& app, std::function<int()>& chosen);

}  // namespace coopdyn
