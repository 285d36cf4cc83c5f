// SPDX-License-Identifier: MIT
#include "server/model/resources.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "server/base/diagnostics.h"
#include "server/model/fuel.h"
#include "server/model/readers.h"
#include "server/model/sdf_parts.h"
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

constexpr int kLevels = 4;  // levels above a model in which to look for its package

bool IsIn(const fs::path& folder, const fs::path& file) {
  return std::ranges::mismatch(folder, file).in1 == folder.end();
}

/// True if the folder is a ROS package or a Gazebo model.
bool HasMark(const fs::path& folder) {
  std::error_code code;
  return std::ranges::any_of(std::array{"package.xml", "manifest.xml", "model.config"},
                             [&](const char* name) { return fs::exists(folder / name, code); });
}

/// The folder of the ROS package to which `file` belongs.
std::optional<fs::path> PackageOf(const fs::path& file) {
  fs::path folder = file.parent_path();
  for (int level = 0; level < kLevels && folder.has_filename(); ++level, folder = folder.parent_path()) {
    std::error_code code;
    if (fs::exists(folder / "package.xml", code) || fs::exists(folder / "manifest.xml", code)) return folder;
  }
  return std::nullopt;
}

/// True if the ROS package in `folder` has the name `name`, by its package.xml or else by its folder.
bool IsCalled(const fs::path& folder, const std::string& name) {
  Diagnostics ignored;
  const fs::path file = folder / "package.xml";
  const auto text = ReadTextFile(file.string(), {}, ignored);
  tinyxml2::XMLDocument document;
  const bool is_good = text && IsModelSize(*text, file.string(), ignored) &&
                       document.Parse(text->c_str(), text->size()) == tinyxml2::XML_SUCCESS;
  const auto* root = is_good ? document.RootElement() : nullptr;
  const auto* said = root == nullptr ? nullptr : root->FirstChildElement("name");
  const bool says = said != nullptr && said->GetText() != nullptr;
  return name == (says ? std::string(Trim(said->GetText())) : folder.filename().string());
}

/// True for folders directly below / or /home. They hold arbitrary files, so they are never packages.
bool HoldsAll(const fs::path& folder) {
  const fs::path above = folder.parent_path();
  return above == above.root_path() || above == "/home";
}

/// Converts ROS's `$(find PKG)/FILE` to package://PKG/FILE.
std::string WithoutFind(const std::string& uri) {
  for (const std::string start :
       {"$(find ", "file://$(find ", "$(find-pkg-share ", "file://$(find-pkg-share "}) {
    const std::size_t end = uri.find(')');
    if (!uri.starts_with(start) || end == std::string::npos) continue;
    return "package://" + std::string(Trim(uri.substr(start.size(), end - start.size()))) +
           uri.substr(end + 1);
  }
  return uri;
}

/// `uri` without spaces and line ends at both ends.
std::string Trimmed(const std::string& uri) {
  constexpr const char* kSpaces = " \t\r\n";
  const std::size_t first = uri.find_first_not_of(kSpaces);
  return first == std::string::npos ? "" : uri.substr(first, uri.find_last_not_of(kSpaces) - first + 1);
}

bool IsByName(const std::string& scheme) {
  return scheme == "model" || scheme == "package";
}

/// The scheme of a URI, in lower case, and the rest.
std::pair<std::string, std::string> Split(const std::string& uri) {
  const std::size_t colon = uri.find("://");
  const std::string scheme = colon == std::string::npos ? "" : ToLower(uri.substr(0, colon));
  std::string rest = colon == std::string::npos ? uri : uri.substr(colon + 3);
  std::replace(rest.begin(), rest.end(), '\\', '/');
  if (IsByName(scheme)) rest.erase(0, rest.find_first_not_of('/'));
  return {scheme, rest};
}

}  // namespace

Resources::Resources(const SearchPath& path, const fs::path& model_file)
    : folders_(path.folders),
      model_folders_(path.model_folders),
      fuel_folders_(path.fuel_folders),
      is_strict_(path.is_strict),
      parts_folder_(path.parts_folder) {
  for (const auto* folders : {&folders_, &model_folders_, &fuel_folders_}) {
    for (const fs::path& folder : *folders) {
      if (const auto root = Canonical(folder)) roots_.push_back(*root);
    }
  }
  const auto file = Canonical(model_file);
  if (!file) return;
  model_folder_ = file->parent_path();
  roots_.push_back(model_folder_);
  package_ = PackageOf(*file);
  if (package_) roots_.push_back(*package_);
}

void Resources::Allow(const fs::path& folder) {
  if (const auto root = Canonical(folder)) roots_.push_back(*root);
}

bool Resources::IsInside(const fs::path& file) const {
  return std::ranges::any_of(roots_, [&file](const fs::path& root) { return IsIn(root, file); });
}

/// The package of a file outside the roots, which was found in a folder named like the URI's package. Files
/// that it names are in the same package.
std::optional<fs::path> Resources::PackageAround(const fs::path& from) const {
  const auto file = Canonical(from);
  if (!file || IsInside(*file) || model_folder_.empty()) return std::nullopt;
  for (fs::path up = file->parent_path(); up.has_filename(); up = up.parent_path()) {
    if (HasMark(up) || IsIn(up, model_folder_)) return up;
  }
  return std::nullopt;
}

/// Adds the possible places of NAME/FILE, named by a file in `folder`.
void Resources::AddNamed(const std::string& path, const fs::path& folder, std::vector<Place>& places) const {
  const fs::path name = *fs::path(path).begin();
  const fs::path inner = fs::path(path).lexically_relative(name);
  for (const fs::path& one : folders_) {
    for (const char* sub : kModelFolders) places.push_back({one / sub / path, {}});
    if (one.filename() == name) places.push_back({one / inner, {}});
  }
  for (const fs::path& one : model_folders_) {
    places.push_back({one / path, {}});
    if (one.filename() == name) places.push_back({one / inner, {}});
  }
  fs::path below = folder;
  int level = 0;
  for (fs::path up = folder; up.has_filename(); below = up, up = up.parent_path(), ++level) {
    const bool is_near = level <= kLevels && !HoldsAll(up);
    const auto root = is_near ? Canonical(up) : std::nullopt;
    if (ToLower(up.filename().string()) == ToLower(name.string())) {  // Fuel stores names in lower case
      places.push_back({up / inner, root});
      places.push_back({below / inner, {}});  // Fuel's layout: NAME/VERSION/FILE
    }
    // A neighbour of the package or model.
    const bool is_name = name != "." && name != ".." && name != "/";
    for (const fs::path& beside : {up, up / "models"}) {
      if (is_near && is_name && HasMark(beside / name))
        places.push_back({beside / path, Canonical(beside / name)});
    }
  }
  if (package_ && IsCalled(*package_, name.string())) places.push_back({*package_ / inner, {}});
  places.push_back({folder / path, {}});  // as in PyBullet
}

std::optional<fs::path> Resources::FindFuel(const std::string& uri, std::string& why) const {
  const auto address = FuelAddressOf(uri);
  if (!address) {
    why = "'" + uri + "' is not fetched: copy it beside the model and write its relative path";
    return std::nullopt;
  }
  for (const fs::path& cache : fuel_folders_) {
    const auto folder = FuelFolderIn(cache, *address);
    const auto found = folder ? Canonical(*folder / address->file) : std::nullopt;
    if (found && IsInside(*found)) return found;
  }
  std::string looked;
  for (const fs::path& cache : fuel_folders_) looked += (looked.empty() ? "" : ", ") + cache.string();
  // Only suggest a command if the URL is safe inside shell quotes.
  const bool plain = address->url.find_first_of("'\\") == std::string::npos;
  why = "there is no '" + uri + "' in the cache of Gazebo (looked for in " +
        (looked.empty() ? "no folder, as HOME is not set" : looked) + "): coopdyn fetches nothing; " +
        (plain ? "write gz fuel download -u '" + address->url + "'" : "fetch it with gz fuel download") +
        ", or copy the model to a folder on the search path and name it by model://NAME";
  return std::nullopt;
}

std::string Resources::WhereLooked(const fs::path& folder, bool by_name) const {
  constexpr std::size_t kMost = 6;
  std::vector<fs::path> looked = {folder};
  if (package_) looked.push_back(*package_);
  looked.insert(looked.end(), folders_.begin(), folders_.end());
  if (by_name) looked.insert(looked.end(), model_folders_.begin(), model_folders_.end());
  std::vector<std::string> names;
  for (const fs::path& one : looked) {
    std::string name = one.lexically_normal().string();
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
  return text;
}

std::optional<fs::path> Resources::Find(const std::string& written, const fs::path& from,
                                        std::string& why) const {
  const std::string given = Trimmed(written);
  const auto [scheme, rest] = Split(WithoutFind(given));
  const bool by_name = IsByName(scheme);
  std::vector<Place> tried;
  if (rest.empty()) {
    why = "an empty URI: write model://NAME/FILE, package://NAME/FILE or a path in the model's folder";
    return std::nullopt;
  }
  std::error_code code;
  fs::path folder = fs::absolute(from, code).lexically_normal().parent_path();
  if (code) folder = from.parent_path();
  if (by_name) {
    AddNamed(rest, folder, tried);
  } else if (scheme.empty() || scheme == "file") {
    const auto package = PackageAround(from);
    if (fs::path(rest).is_absolute()) {
      tried.push_back({rest, {}});
      tried.push_back({folder / fs::path(rest).relative_path(), package});
    } else {
      tried.push_back({folder / rest, package});
      for (const fs::path& one : folders_) tried.push_back({one / rest, {}});
      if (package_) tried.push_back({*package_ / rest, {}});
      if (scheme.empty()) AddNamed(rest, folder, tried);  // a model's bare name, as in PX4
    }
  } else {
    return FindFuel(given, why);
  }
  bool outside = false;
  for (const auto& [path, root] : tried) {
    const auto found = Canonical(path);
    if (!found) continue;
    if (IsInside(*found) || (root && IsIn(*root, *found))) return found;
    outside = true;
  }
  why = outside
            ? "'" + given +
                  "' lies outside the model's folder and the search path: copy it there, or name its folder "
                  "with --scenarios or COOPDYN_PATH"
            : "there is no '" + given +
                  "' in the model's folder or on the search path: add it, or name the folder that holds it "
                  "with --scenarios or COOPDYN_PATH (looked for in " +
                  WhereLooked(folder, by_name) + ")";
  return std::nullopt;
}

std::optional<fs::path> PathInFolder(const std::string& uri) {
  const auto [scheme, rest] = Split(WithoutFind(uri));
  if (rest.empty() || (!scheme.empty() && scheme != "file" && !IsByName(scheme))) return std::nullopt;
  return fs::path(rest).relative_path();
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
      // Accept only bare names: a model must not refer to other folders.
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
