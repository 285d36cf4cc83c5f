// SPDX-License-Identifier: MIT
#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include "server/model/experiment.h"
#include "server/model/readers.h"
#include "server/model/resources.h"
#include "server/model/sdf_world.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(path, code);
}

/// Calls visit(path) for all entries of each subfolder of each folder.
template <typename Visit>
void ForAll(const std::vector<fs::path>& folders, std::initializer_list<const char*> subs, Visit visit) {
  for (const fs::path& folder : folders) {
    for (const char* sub : subs) {
      std::error_code code;
      for (fs::directory_iterator it(folder / sub, code), end; !code && it != end; it.increment(code)) {
        visit(it->path());
      }
    }
  }
}

/// `file`, or a file in its folder whose name differs only in case, as on Windows.
std::optional<fs::path> ExistingFile(const fs::path& file) {
  if (IsFile(file)) return file;
  const std::string wanted = ToLower(file.filename().string());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::optional<fs::path> found;
  ForAll({folder}, {""}, [&](const fs::path& path) {
    if (ToLower(path.filename().string()) != wanted || !IsFile(path)) return;
    const fs::path same = file.has_parent_path() ? path : path.filename();
    if (!found || same < *found) found = same;
  });
  return found;
}

/// The first of these files that exists.
std::optional<fs::path> FirstFile(const std::vector<fs::path>& folders,
                                  std::initializer_list<const char*> subs, const fs::path& name) {
  for (const fs::path& folder : folders) {
    for (const char* sub : subs) {
      const fs::path file = (folder / sub / name).lexically_normal();
      if (IsFile(file)) return file;
    }
  }
  return std::nullopt;
}

/// The names of files with this extension, sorted, without the extension.
std::vector<std::string> Stems(const std::vector<fs::path>& folders, std::initializer_list<const char*> subs,
                               const char* extension) {
  std::set<std::string> names;
  ForAll(folders, subs, [&](const fs::path& path) {
    if (path.extension() == extension) names.insert(path.stem().string());
  });
  return {names.begin(), names.end()};
}

/// True if the file's content is an experiment: many other files end in .xml, too.
bool IsExperimentFile(const fs::path& path) {
  constexpr std::size_t kHead = 16'384;
  std::error_code code;
  if (!fs::is_regular_file(path, code)) return false;
  std::ifstream stream(path, std::ios::binary);
  std::string head(kHead, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(kHead));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return IsExperiment(head, "");
}

/// ExistingFile() in the first subfolder of a folder that has it.
std::optional<fs::path> ExistingFile(const std::vector<fs::path>& folders,
                                     std::initializer_list<const char*> subs, const fs::path& name) {
  for (const fs::path& folder : folders) {
    for (const char* sub : subs) {
      if (const auto found = ExistingFile((folder / sub / name).lexically_normal())) return found;
    }
  }
  return std::nullopt;
}

/// Replaces `\` by `/` and removes a drive letter.
std::string WithSlashes(std::string name, bool& absolute) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const bool drive = name.size() >= 2 && name[1] == ':' &&
                     ((name[0] >= 'a' && name[0] <= 'z') || (name[0] >= 'A' && name[0] <= 'Z'));
  absolute = drive || name.starts_with('/');
  return drive ? name.substr(2) : name;
}

/// Returns `name` alone if it ends with one of `extensions`, else `name` once with each extension.
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

/// Folders, in order, in which a controller may be, directly or in a subfolder `controllers`.
std::vector<fs::path> ControllerFolders(const SearchPath& path, const fs::path& beside) {
  std::vector<fs::path> folders = path.folders;
  if (!beside.empty()) folders.insert(folders.begin(), beside);
  return folders;
}

constexpr std::string_view kRobot = "robot";

/// The robot types on `path` and of `embedded` texts, sorted.
std::vector<std::string> RobotTypes(const SearchPath& path, const std::vector<SourceText>& embedded) {
  std::set<std::string> types = {"single", "team2"};
  for (const SourceText& source : embedded) {
    if (source.kind == kRobot) types.insert(source.name);
  }
  for (std::string& name : path.RobotNames()) types.insert(std::move(name));
  return {types.begin(), types.end()};
}

}  // namespace

bool IsBareName(const std::string& name) {
  return !name.empty() && name.find_first_of("/\\:") == std::string::npos && !name.starts_with('.');
}

std::optional<fs::path> SearchPath::FindScenario(const std::string& name) const {
  bool absolute = false;
  const std::string file = WithSlashes(name, absolute);
  if (file.empty()) return std::nullopt;
  // A path may have any extension.
  if (file.find('/') != std::string::npos) {
    if (auto found = ExistingFile(file)) return found;
  }
  for (const std::string& candidate :
       WithExtensions(file, {".scenario", ".world", ".sdf", ".xml", ".urdf", ".xacro"})) {
    if (const auto found = ExistingFile(candidate)) return found;
    if (absolute) continue;
    if (const auto found = ExistingFile(folders, {".", "scenarios", "worlds"}, candidate)) return found;
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
      if (const auto found = ExistingFile(folders, {".", "worlds", "scenarios"}, candidate)) return found;
    }
  }
  return std::nullopt;
}

std::optional<fs::path> SearchPath::FindRobot(const std::string& type) const {
  if (!IsBareWord(type)) return std::nullopt;
  for (const fs::path& folder : folders) {
    for (const char* sub : {".", "robots"}) {
      if (const auto file = ModelFileIn((folder / sub / type).lexically_normal())) return file;
    }
  }
  return std::nullopt;
}

std::optional<fs::path> SearchPath::FindController(const std::string& name, const fs::path& beside) const {
  if (!IsBareWord(name)) return std::nullopt;
  return FirstFile(ControllerFolders(*this, beside), {"controllers", "."}, name + ".so");
}

bool SearchPath::IsUpload(const fs::path& file) const {
  if (uploads.empty()) return false;
  const auto plain = [](const fs::path& one) {
    std::error_code code;
    return fs::weakly_canonical(one, code);
  };
  const fs::path folder = plain(uploads), inside = plain(file);
  return std::ranges::mismatch(folder, inside).in1 == folder.end();
}

std::vector<std::string> SearchPath::ControllerNames(const fs::path& beside) const {
  return Stems(ControllerFolders(*this, beside), {"controllers", "."}, ".so");
}

std::vector<std::string> SearchPath::ScenarioNames() const {
  std::set<std::string> names;
  ForAll(folders, {".", "scenarios"}, [&names](const fs::path& path) {
    const fs::path extension = path.extension();
    if (extension == ".scenario" || (extension == ".xml" && IsExperimentFile(path)))
      names.insert(path.stem().string());
  });
  return {names.begin(), names.end()};
}

std::vector<std::string> SearchPath::WorldNames() const {
  return Stems(folders, {".", "worlds"}, ".world");
}

std::vector<std::string> SearchPath::RobotNames() const {
  std::set<std::string> names;
  ForAll(folders, {".", "robots"}, [&names](const fs::path& folder) {
    if (ModelFileIn(folder)) names.insert(folder.filename().string());
  });
  return {names.begin(), names.end()};
}

bool IsModelPath(const std::string& type) {
  const std::string lower = ToLower(type);
  return type.find_first_of("/\\#") != std::string::npos || lower.ends_with(".sdf") ||
         lower.ends_with(".urdf") || lower.ends_with(".xacro") || lower.ends_with(".xml");
}

std::string WorldModelType(const fs::path& world, const std::string& model) {
  return world.string() + "#" + model;
}

std::string ModelOfWorldType(const std::string& type) {
  const std::size_t mark = type.rfind('#');
  const bool is_folders = mark != std::string::npos && type.find_first_of("/\\", mark) != std::string::npos;
  return mark == std::string::npos || is_folders ? "" : type.substr(mark + 1);
}

std::string ShortWorldModelType(const fs::path& world, const std::string& model) {
  std::string stem = world.stem().string();
  std::ranges::replace_if(
      stem, [](char c) { return c == ' ' || c == '\t'; }, '_');  // a type is one word
  return stem + "." + model;
}

std::string TypeFromAnywhere(const RobotModel& model) {
  const fs::path file = fs::absolute(model.file);
  if (IsModelPath(model.type)) {
    const std::string part = ModelOfWorldType(model.type);
    return part.empty() ? file.string() : WorldModelType(file, part);
  }
  // The type of a robot on the search path is its folder's name.
  const std::string in_world = ShortWorldModelType(file, "");
  if (!model.type.starts_with(in_world) || file.parent_path().filename() == model.type) return model.type;
  return WorldModelType(file, model.type.substr(in_world.size()));
}

namespace {

/// The file of a type that is a path.
fs::path ModelPath(const std::string& type, const fs::path& beside) {
  bool absolute = false;
  fs::path path = (beside / WithSlashes(type, absolute)).lexically_normal();
  std::error_code code;
  if (fs::is_directory(path, code)) return ModelFileIn(path).value_or(path / "model.sdf");
  return path;
}

/// The models of the robots in a world or an experiment, by name.
std::optional<std::map<std::string, std::shared_ptr<const RobotModel>>> ModelsOf(const fs::path& world,
                                                                                 const SearchPath& path,
                                                                                 Diagnostics& diagnostics) {
  if (IsExperimentFile(world)) {
    auto models = ReadExperimentModels(world, path, diagnostics);
    if (diagnostics.has_errors()) return std::nullopt;
    return models;
  }
  std::optional<SdfWorld> read = ReadSdfWorld(world, path, diagnostics);
  if (!read) return std::nullopt;
  return std::move(read->models);
}

}  // namespace

std::shared_ptr<const RobotModel> RobotLibrary::Get(const std::string& type, const SourceLine& where,
                                                    Diagnostics& diagnostics,
                                                    const std::optional<fs::path>& beside) {
  MutexLock lock(mutex_);
  const bool is_path = IsModelPath(type) && Embedded(kRobot, type) == nullptr;
  const std::string key = is_path && beside ? ModelPath(type, *beside).string() : type;
  if (const auto known = models_.find(key); known != models_.end()) return known->second;
  const std::string part = is_path ? ModelOfWorldType(key) : "";
  const fs::path world = part.empty() ? fs::path() : fs::path(key.substr(0, key.rfind('#')));
  // Do not cache a model with errors: it must load after it has been fixed.
  std::shared_ptr<const RobotModel> model;
  if (const SourceText* source = Embedded(kRobot, type)) {
    model = ReadRobotModelText(source->text, source->file, type, diagnostics, nullptr, path_.parts_folder);
  } else if (auto known = part.empty() ? nullptr : KnownOfWorld(world, part)) {
    model = std::move(known);
  } else if (is_path && !beside) {
    diagnostics.Error(
        where, "over a socket a robot's type is a bare name on the search path, not the path '" + type + "'");
  } else if (is_path && IsFile(key)) {
    model = ReadRobotModel(key, path_, diagnostics);
  } else if (!part.empty() && IsFile(world)) {
    const auto read = ModelsOf(world, path_, diagnostics);
    if (!read) return nullptr;
    std::vector<std::string> names;
    for (const auto& [name, robot] : *read) names.push_back(name);
    if (const auto found = read->find(part); found != read->end())
      model = found->second;
    else
      diagnostics.Error(where, world.string() + " has no robot '" + part + "'" + DidYouMean(part, names));
  } else if (is_path) {
    diagnostics.Error(where, "there is no robot model " + key);
  } else if (const std::optional<fs::path> file = path_.FindRobot(type)) {
    model = ReadRobotModel(*file, path_, diagnostics);
  } else {
    const std::string name = IsBareName(type) ? type : "NAME";
    diagnostics.Error(where, "unknown robot type '" + type + "'" +
                                 DidYouMean(type, RobotTypes(path_, embedded_)) +
                                 " (a robot of your own is a folder robots/" + name +
                                 " in a folder that --scenarios or COOPDYN_PATH names)");
  }
  if (model != nullptr && model->type != type) {
    auto named = std::make_shared<RobotModel>(*model);
    named->type = type;
    model = std::move(named);
  }
  if (model != nullptr) models_.emplace(key, model);
  return model;
}

std::shared_ptr<const RobotModel> RobotLibrary::KnownOfWorld(const fs::path& world,
                                                             const std::string& part) const {
  const auto known = models_.find(ShortWorldModelType(world, part));
  const bool is_same = known != models_.end() && fs::absolute(known->second->file) == fs::absolute(world);
  return is_same ? known->second : nullptr;
}

void RobotLibrary::Add(const std::string& type, std::shared_ptr<const RobotModel> model) {
  MutexLock lock(mutex_);
  models_.insert_or_assign(type, std::move(model));
  made_of_.erase(type);
}

void RobotLibrary::AddMade(const std::string& type, const std::string& text,
                           std::shared_ptr<const RobotModel> model) {
  MutexLock lock(mutex_);
  models_.insert_or_assign(type, std::move(model));
  made_of_.insert_or_assign(type, text);
}

bool RobotLibrary::IsMade(const std::string& type, const std::string& text) const {
  MutexLock lock(mutex_);
  const auto known = made_of_.find(type);
  return known != made_of_.end() && known->second == text;
}

bool RobotLibrary::Has(const std::string& type, const std::optional<fs::path>& beside) const {
  if (Embedded(kRobot, type) != nullptr) return true;
  if (IsModelPath(type)) {
    const std::string file = beside ? ModelPath(type, *beside).string() : "";
    return IsFile(ModelOfWorldType(file).empty() ? file : file.substr(0, file.rfind('#')));
  }
  return path_.FindRobot(type).has_value();
}

const SourceText* RobotLibrary::Embedded(std::string_view kind, std::string_view name) const {
  for (const SourceText& source : embedded_) {
    if (source.kind == kind && source.name == name) return &source;
  }
  return nullptr;
}

}  // namespace coopdyn
