// SPDX-License-Identifier: MIT
// A last line of the terminal that the log does not run into. Any thread.
#pragma once

#include <string>

#include "server/base/log.h"

namespace coopdyn {

/// Shows `text` below what the logger of a `LogBackend` writes to stderr, a terminal, in the place of the
/// text before; empty: nothing any more. What is wider than the terminal is cut. No other logger shows it.
void ShowBelowLog(const Logger& logger, const std::string& text);

}  // namespace coopdyn
