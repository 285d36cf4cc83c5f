// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "server/app/options.h"

namespace coopdyn {

void AddModelFolders(SearchPath& path) {
  namespace fs = std::filesystem;
  const auto add = [&path](fs::path folder) {
    if (!folder.has_filename()) folder = folder.parent_path();  // without a trailing slash
    std::error_code code;
    if (fs::is_directory(folder, code) &&
        std::ranges::find(path.model_folders, folder) == path.model_folders.end())
      path.model_folders.push_back(folder);
  };
  const auto add_all = [&add](const char* variable, const char* sub) {
    const char* value = std::getenv(variable);
    std::istringstream folders(value == nullptr ? "" : value);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (!folder.empty()) add(fs::path(folder) / sub);
    }
  };
  for (const char* variable :
       {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "ROS_PACKAGE_PATH"})
    add_all(variable, "");
  add_all("AMENT_PREFIX_PATH", "share");
  if (const char* cache = std::getenv("GZ_FUEL_CACHE_PATH"); cache != nullptr && *cache != '\0')
    path.fuel_folders.emplace_back(cache);
  const char *home = std::getenv("HOME"), *caches = std::getenv("XDG_CACHE_HOME");
  const bool has_home = home != nullptr && *home != '\0';
  // Ignore relative paths (XDG Base Directory Specification).
  if (caches != nullptr && *caches == '/') {
    path.parts_folder = fs::path(caches) / "coopdyn/parts";
  } else if (has_home) {
    path.parts_folder = fs::path(home) / ".cache/coopdyn/parts";
  }
  if (!has_home) return;
  add(fs::path(home) / ".gazebo/models");
  path.fuel_folders.push_back(fs::path(home) / ".gz/fuel");
  path.fuel_folders.push_back(fs::path(home) / ".ignition/fuel");
}

}  // namespace coopdyn
