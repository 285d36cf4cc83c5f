// SPDX-License-Identifier: MIT
#include <filesystem>
#include <set>
#include <system_error>

#include "server/model/readers.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr std::string_view kRobot = "robot";

/// The robot types on `path` and of `embedded` texts, sorted.
std::vector<std::string> RobotTypes(const SearchPath& path, const std::vector<SourceText>& embedded) {
  namespace fs = std::filesystem;
  std::set<std::string> types = {"single", "team2"};
  for (const SourceText& source : embedded) {
    if (source.kind == kRobot) types.insert(source.name);
  }
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
  // A model with errors is not kept: mended, it loads.
  std::shared_ptr<const RobotModel> model;
  if (const SourceText* source = Embedded(kRobot, type)) {
    model = ReadRobotModelText(source->text, source->file, type, diagnostics);
  } else if (const std::optional<std::filesystem::path> file = path_.FindRobot(type)) {
    model = ReadRobotModel(*file, diagnostics);
  } else {
    diagnostics.Error(where,
                      "unknown robot type '" + type + "'" + DidYouMean(type, RobotTypes(path_, embedded_)));
  }
  if (model != nullptr) models_.emplace(type, model);
  return model;
}

bool RobotLibrary::Has(const std::string& type) const {
  return Embedded(kRobot, type) != nullptr || path_.FindRobot(type).has_value();
}

const SourceText* RobotLibrary::Embedded(std::string_view kind, std::string_view name) const {
  for (const SourceText& source : embedded_) {
    if (source.kind == kind && source.name == name) return &source;
  }
  return nullptr;
}

}  // namespace coopdyn
