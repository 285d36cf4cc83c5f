// SPDX-License-Identifier: MIT
// The path of the built source tree. A function, because a definition in each test's compile command would
// keep ccache from using another clone's objects.
#pragma once

#include <string>

namespace coopdyn {

std::string SourceDir();

}  // namespace coopdyn
