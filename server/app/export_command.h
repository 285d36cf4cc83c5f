// SPDX-License-Identifier: MIT
// `coopdyn export RUN --to csv|mat|png|mp4`: a recorded run for other programs. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Adds the command to `app`.
void AddExport(CLI::App& app, std::function<int()>& chosen);

}  // namespace coopdyn
