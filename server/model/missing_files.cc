// SPDX-License-Identifier: MIT
#include "server/model/missing_files.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "server/base/words.h"
#include "server/model/resources.h"
#include "server/model/text_file.h"
#include "server/model/xml_tree.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// `text` without blanks and line ends at both ends.
std::string WithoutBlanks(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

class Gatherer {
 public:
  Gatherer(const Resources& resources, std::vector<std::string>& missing)
      : resources_(resources), missing_(missing) {}

  void Read(const fs::path& file) {
    constexpr std::size_t kMostFiles = 200;
    if (read_.size() >= kMostFiles || !read_.insert(file).second) return;
    Diagnostics ignored;
    const auto text = ReadTextFile(file.string(), {}, ignored);
    const auto root = text ? ParseXml(*text, file.string(), ignored) : std::nullopt;
    if (root) Visit(*root, file);
  }

 private:
  void Visit(const XmlNode& node, const fs::path& file) {
    if (node.name == "uri" || node.name == "albedo_map" || node.name == "yarpConfigurationFile")
      Look(node.text, file);
    if (node.Has("filename") && node.name != "plugin") Look(node.Attribute("filename"), file);
    for (const XmlNode& child : node.children) Visit(child, file);
  }

  void Look(const std::string& written, const fs::path& file) {
    const std::string uri = WithoutBlanks(written);  // as the readers see it
    std::string why;
    if (uri.empty() || !seen_.insert(uri).second) return;
    const auto found = resources_.Find(uri, file, why);
    std::error_code code;
    if (!found) {
      missing_.push_back(uri);
    } else if (fs::is_directory(*found, code)) {
      if (const auto model = ModelFileIn(*found)) Read(*model);
    } else if (const std::string end = ToLower(found->extension().string());
               end == ".sdf" || end == ".urdf") {
      Read(*found);
    }
  }

  const Resources& resources_;
  std::vector<std::string>& missing_;
  std::set<fs::path> read_;
  std::set<std::string> seen_;
};

/// `below` and all folders in it, breadth first.
std::vector<fs::path> AllFolders(const fs::path& below) {
  constexpr std::size_t kMost = 100'000;
  constexpr int kDeepest = 12;
  std::vector<std::pair<int, fs::path>> all = {{0, below}};
  std::error_code code;
  const auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator it(below, options, code), end;
       !code && it != end && all.size() < kMost; it.increment(code)) {
    std::error_code ignored;
    if (it->is_symlink(ignored) || !it->is_directory(ignored)) continue;
    if (it.depth() + 1 >= kDeepest || it->path().filename().string().starts_with('.'))
      it.disable_recursion_pending();
    all.emplace_back(it.depth() + 1, it->path());
  }
  std::ranges::sort(all);
  std::vector<fs::path> folders;
  for (auto& [depth, folder] : all) folders.push_back(std::move(folder));
  return folders;
}

}  // namespace

std::vector<std::string> MissingUris(const fs::path& file, const SearchPath& path) {
  std::vector<std::string> missing;
  const Resources resources(path, file);
  Gatherer(resources, missing).Read(file);
  return missing;
}

FoundFolders FoldersWith(const std::vector<std::string>& uris, const fs::path& below) {
  FoundFolders found;
  const std::vector<fs::path> folders = AllFolders(below);
  for (const std::string& uri : uris) {
    const std::optional<fs::path> inner = PathInFolder(uri);
    const auto has = [&](const fs::path& folder) {
      std::error_code code;
      return inner && fs::exists(folder / *inner, code);
    };
    if (std::ranges::any_of(found.folders, has)) continue;
    const auto first = std::ranges::find_if(folders, has);
    if (first == folders.end())
      found.nowhere.push_back(uri);
    else
      found.folders.push_back(*first);
  }
  return found;
}

}  // namespace coopdyn
