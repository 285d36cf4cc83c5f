// SPDX-License-Identifier: MIT
#include "tests/source_dir.h"

namespace coopdyn {

std::string SourceDir() {
  return COOPDYN_SOURCE_DIR;
}

}  // namespace coopdyn
