// SPDX-License-Identifier: MIT
// Where the source tree is that was built. A function: as a definition of each test's compile command it
// would keep ccache from using the objects of another clone.
#pragma once

#include <string>

namespace coopdyn {

std::string SourceDir();

}  // namespace coopdyn
