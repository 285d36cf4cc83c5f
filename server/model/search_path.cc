// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>
#include <string_view>
#include <system_error>

#include "server/model/readers.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// `file`, or the file beside it that is called the same but for upper and lower case, as Windows would find
/// it.
std::optional<fs::path> ExistingFile(const fs::path& file) {
  std::error_code code;
  if (fs::is_regular_file(file, code)) return file;
  const std::string wanted = ToLower(file.filename().string());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::optional<fs::path> found;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const fs::path& path = it->path();
    std::error_code ignored;
    if (ToLower(path.filename().string()) != wanted || !fs::is_regular_file(path, ignored)) continue;
    const fs::path same = file.has_parent_path() ? path : path.filename();
    if (!found || same < *found) found = same;
  }
  return found;
}

/// `\` means `/`; a drive's letter goes.
std::string WithSlashes(std::string name, bool& absolute) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const bool drive = name.size() >= 2 && name[1] == ':' &&
                     ((name[0] >= 'a' && name[0] <= 'z') || (name[0] >= 'A' && name[0] <= 'Z'));
  absolute = drive || name.starts_with('/');
  return drive ? name.substr(2) : name;
}

/// `name` with each of `extensions`, or as it is if it has one of them.
std::vector<std::string> WithExtensions(const std::string& name,
                                        std::initializer_list<std::string_view> extensions) {
  for (const std::string_view extension : extensions) {
    if (ToLower(name).ends_with(extension)) return {name};
  }
  std::vector<std::string> names;
  for (const std::string_view extension : extensions) names.push_back(name + std::string(extension));
  return names;
}

bool IsBareWord(const std::string& type) {
  return !type.empty() && type.size() <= 63 && type.front() != '.' &&
         type.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.") ==
             std::string::npos;
}

/// Where a controller's file may lie, in the order in which they are tried.
std::vector<fs::path> ControllerFolders(const SearchPath& path, const fs::path& beside) {
  std::vector<fs::path> roots;
  if (!beside.empty()) roots.push_back(beside);
  roots.insert(roots.end(), path.folders.begin(), path.folders.end());
  std::vector<fs::path> folders;
  for (const fs::path& root : roots) {
    folders.push_back(root / "controllers");
    folders.push_back(root);
  }
  return folders;
}

}  // namespace

bool IsBareName(const std::string& name) {
  return !name.empty() && name.find_first_of("/\\:") == std::string::npos && !name.starts_with('.');
}

std::optional<fs::path> SearchPath::FindScenario(const std::string& name) const {
  bool absolute = false;
  const std::string file = WithSlashes(name, absolute);
  if (file.empty()) return std::nullopt;
  // Who writes a path may call the file as he likes.
  if (file.find('/') != std::string::npos) {
    if (auto found = ExistingFile(file)) return found;
  }
  for (const std::string& candidate : WithExtensions(file, {".scenario", ".world"})) {
    if (const auto found = ExistingFile(candidate)) return found;
    if (absolute) continue;
    for (const fs::path& folder : folders) {
      for (const char* sub : {".", "scenarios", "worlds"}) {
        if (const auto found = ExistingFile((folder / sub / candidate).lexically_normal())) return found;
      }
    }
  }
  return std::nullopt;
}

std::optional<fs::path> SearchPath::FindWorld(const std::string& name, const fs::path& beside) const {
  bool absolute = false;
  const std::string file = WithSlashes(name, absolute);
  if (file.empty()) return std::nullopt;
  const std::string base = fs::path(file).filename().string();
  std::vector<std::string> tried = {file};
  if (base != file && !base.empty()) tried.push_back(base);
  for (const std::string& text : tried) {
    for (const std::string& candidate : WithExtensions(text, {".world"})) {
      if (fs::path(candidate).is_absolute()) {
        if (const auto found = ExistingFile(candidate)) return found;
        continue;
      }
      if (!beside.empty()) {
        if (const auto found = ExistingFile((beside / candidate).lexically_normal())) return found;
      }
      for (const fs::path& folder : folders) {
        for (const char* sub : {".", "worlds", "scenarios"}) {
          if (const auto found = ExistingFile((folder / sub / candidate).lexically_normal())) return found;
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<fs::path> SearchPath::FindRobot(const std::string& type) const {
  if (!IsBareWord(type)) return std::nullopt;
  for (const fs::path& folder : folders) {
    for (const char* sub : {".", "robots"}) {
      const fs::path file = (folder / sub / type / "model.sdf").lexically_normal();
      std::error_code code;
      if (fs::is_regular_file(file, code)) return file;
    }
  }
  return std::nullopt;
}

std::optional<fs::path> SearchPath::FindController(const std::string& name, const fs::path& beside) const {
  if (!IsBareWord(name)) return std::nullopt;
  for (const fs::path& folder : ControllerFolders(*this, beside)) {
    const fs::path file = (folder / (name + ".so")).lexically_normal();
    std::error_code code;
    if (fs::is_regular_file(file, code)) return file;
  }
  return std::nullopt;
}

std::vector<std::string> SearchPath::ControllerNames(const fs::path& beside) const {
  std::set<std::string> names;
  for (const fs::path& folder : ControllerFolders(*this, beside)) {
    std::error_code code;
    for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
      if (it->path().extension() == ".so") names.insert(it->path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> SearchPath::ScenarioNames() const {
  std::set<std::string> names;
  for (const fs::path& folder : folders) {
    for (const char* sub : {".", "scenarios"}) {
      std::error_code code;
      for (fs::directory_iterator it(folder / sub, code), end; !code && it != end; it.increment(code)) {
        if (it->path().extension() == ".scenario") names.insert(it->path().stem().string());
      }
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace coopdyn
