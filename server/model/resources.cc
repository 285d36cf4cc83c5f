// SPDX-License-Identifier: MIT
#include "server/model/resources.h"
#include "server/model/sdf_parts.h"

#include <tinyxml2.h>

#include <algorithm>
#include <system_error>

#include "server/base/diagnostics.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr const char* kModelFolders[] = {"", "robots", "models", "worlds", "scenarios"};

std::optional<fs::path> Canonical(const fs::path& path) {
  std::error_code code;
  fs::path found = fs::canonical(path, code);
  if (code) return std::nullopt;
  return found;
}

/// The folder of the ROS package to which `file` belongs.
std::optional<fs::path> PackageOf(const fs::path& file) {
  constexpr int kLevels = 4;
  fs::path folder = file.parent_path();
  for (int level = 0; level < kLevels && folder.has_filename(); ++level, folder = folder.parent_path()) {
    std::error_code code;
    if (fs::exists(folder / "package.xml", code) || fs::exists(folder / "manifest.xml", code)) return folder;
  }
  return std::nullopt;
}

}  // namespace

Resources::Resources(std::vector<fs::path> folders, const fs::path& model_file)
    : folders_(std::move(folders)) {
  for (const fs::path& folder : folders_) {
    if (const auto root = Canonical(folder)) roots_.push_back(*root);
  }
  const auto file = Canonical(model_file);
  if (!file) return;
  roots_.push_back(file->parent_path());
  package_ = PackageOf(*file);
  if (package_) roots_.push_back(*package_);
}

bool Resources::IsInside(const fs::path& file) const {
  return std::ranges::any_of(roots_, [&file](const fs::path& root) {
    const auto [in_root, in_file] = std::ranges::mismatch(root, file);
    return in_root == root.end();
  });
}

std::optional<fs::path> Resources::Find(const std::string& uri, const fs::path& from,
                                        std::string& why) const {
  std::vector<fs::path> tried;
  const std::size_t colon = uri.find("://");
  const std::string scheme = colon == std::string::npos ? "" : ToLower(uri.substr(0, colon));
  std::string rest = colon == std::string::npos ? uri : uri.substr(colon + 3);
  std::replace(rest.begin(), rest.end(), '\\', '/');
  if (scheme == "model" || scheme == "package") rest.erase(0, rest.find_first_not_of('/'));
  if (rest.empty()) {
    why = "an empty URI: write model://NAME/FILE, package://NAME/FILE or a path in the model's folder";
    return std::nullopt;
  }
  std::error_code code;
  fs::path folder = fs::absolute(from, code).parent_path();
  if (code) folder = from.parent_path();
  if (scheme == "model" || scheme == "package") {
    const fs::path path(rest);
    const fs::path name = *path.begin();
    const fs::path inner = path.lexically_relative(name);
    for (const fs::path& one : folders_) {
      for (const char* sub : kModelFolders) tried.push_back(one / sub / path);
      if (one.filename() == name) tried.push_back(one / inner);
    }
    for (fs::path up = folder; up.has_filename(); up = up.parent_path()) {
      if (up.filename() == name) tried.push_back(up / inner);
    }
    if (package_) tried.push_back(*package_ / inner);
    tried.push_back(folder / path);  // as PyBullet has it
  } else if (scheme.empty() || scheme == "file") {
    if (fs::path(rest).is_absolute()) {
      tried.emplace_back(rest);
      tried.push_back(folder / fs::path(rest).relative_path());
    } else {
      tried.push_back(folder / rest);
      for (const fs::path& one : folders_) tried.push_back(one / rest);
      if (package_) tried.push_back(*package_ / rest);
    }
  } else {
    why = "'" + uri + "' is not fetched: copy it beside the model and write its relative path";
    return std::nullopt;
  }
  bool outside = false;
  for (const fs::path& path : tried) {
    const auto found = Canonical(path);
    if (!found) continue;
    if (IsInside(*found)) return found;
    outside = true;
  }
  why = outside
            ? "'" + uri +
                  "' lies outside the model's folder and the search path: copy it there, or name its folder "
                  "with --scenarios or COOPDYN_PATH"
            : "there is no '" + uri +
                  "' in the model's folder or on the search path: add it, or name the folder that holds it "
                  "with "
                  "--scenarios or COOPDYN_PATH";
  return std::nullopt;
}

std::optional<fs::path> ModelFileIn(const fs::path& folder) {
  std::error_code code;
  const fs::path config = folder / "model.config";
  if (fs::is_regular_file(config, code)) {
    Diagnostics ignored;
    const auto text = ReadTextFile(config.string(), {}, ignored);
    tinyxml2::XMLDocument document;
    if (text && IsModelSize(*text, config.string(), ignored) &&
        document.Parse(text->c_str(), text->size()) == tinyxml2::XML_SUCCESS &&
        document.RootElement() != nullptr) {
      double newest = -1;
      std::string file;
      for (const auto* sdf = document.RootElement()->FirstChildElement("sdf"); sdf != nullptr;
           sdf = sdf->NextSiblingElement("sdf")) {
        const double version = sdf->DoubleAttribute("version", 0);
        if (sdf->GetText() == nullptr || version <= newest) continue;
        newest = version;
        file = std::string(Trim(sdf->GetText()));
      }
      // A bare name: a model's folder says nothing about other folders.
      const bool bare = !file.empty() && file.find('/') == std::string::npos && file.front() != '.';
      if (bare && fs::is_regular_file(folder / file, code)) return folder / file;
    }
  }
  for (const char* name : {"model.sdf", "model.urdf"}) {
    if (fs::is_regular_file(folder / name, code)) return folder / name;
  }
  return std::nullopt;
}

}  // namespace coopdyn
