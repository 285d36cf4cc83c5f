// SPDX-License-Identifier: MIT
#include "server/app/python_programs.h"

#include <cstdlib>

#include "server/app/options.h"

namespace coopdyn {

namespace fs = std::filesystem;

std::string PythonProgram() {
  const char* const named = std::getenv("COOPDYN_PYTHON");
  if (named != nullptr && *named != '\0') return named;
  // Debian's own Python has Debian's Dask and matplotlib.
  return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

fs::path FolderWithClient(const std::string& name) {
  for (const fs::path& folder : DataPath({}).folders) {
    if (fs::is_directory(folder / "clients" / name)) return folder;
  }
  return {};
}

}  // namespace coopdyn
