// SPDX-License-Identifier: MIT
#include "server/app/more_commands.h"

#include <CLI/CLI.hpp>

namespace coopdyn {

void AddMoreCommands(CLI::App& /*app*/, std::function<int()>& /*chosen*/) {}

}  // namespace coopdyn
