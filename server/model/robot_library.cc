// SPDX-License-Identifier: MIT
#include <filesystem>
#include <set>
#include <system_error>

#include "server/model/readers.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The robot types on `path`, sorted.
std::vector<std::string> RobotTypes(const SearchPath& path) {
  namespace fs = std::filesystem;
  std::set<std::string> types = {"single", "team2"};
  for (const fs::path& folder : path.folders) {
    for (const char* sub : {".", "robots"}) {
      std::error_code code;
      for (fs::directory_iterator it(folder / sub, code), end; !code && it != end; it.increment(code)) {
        std::error_code ignored;
        if (fs::is_regular_file(it->path() / "model.sdf", ignored))
          types.insert(it->path().filename().string());
      }
    }
  }
  return {types.begin(), types.end()};
}

}  // namespace

std::shared_ptr<const RobotModel> RobotLibrary::Get(const std::string& type, const SourceLine& where,
                                                    Diagnostics& diagnostics) {
  MutexLock lock(mutex_);
  if (const auto known = models_.find(type); known != models_.end()) return known->second;
  const std::optional<std::filesystem::path> file = path_.FindRobot(type);
  if (!file) {
    diagnostics.Error(where, "unknown robot type '" + type + "'" + DidYouMean(type, RobotTypes(path_)));
    return nullptr;
  }
  // A model with errors is not kept: mended, it loads.
  std::shared_ptr<const RobotModel> model = ReadRobotModel(*file, diagnostics);
  if (model != nullptr) models_.emplace(type, model);
  return model;
}

}  // namespace coopdyn
