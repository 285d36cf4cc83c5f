// SPDX-License-Identifier: MIT
#include "server/model/mjcf.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "server/base/printable.h"
#include "server/base/run_program.h"
#include "server/base/spawn.h"
#include "server/base/words.h"
#include "server/model/model_source.h"
#include "server/model/readers.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "coopdyn-mjcf";
constexpr std::string_view kFolder = "coopdyn-mjcf-";
constexpr const char* kMark = ".coopdyn-meshes";
constexpr std::size_t kMostSdfBytes = 64u << 20;

void ForgetLines(XmlNode& node) {
  node.where.line = 0;
  for (XmlNode& child : node.children) ForgetLines(child);
}

/// Reports the lines `warning: …`. Returns the rest as one line.
std::string TakeWarnings(std::string_view text, const SourceLine& where, Diagnostics& diagnostics) {
  constexpr std::string_view kWarning = "warning: ";
  constexpr std::size_t kMost = 500;
  std::string rest;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (line.starts_with(kWarning))
      diagnostics.Warning(where, Printable(line.substr(kWarning.size())));
    else if (!line.empty())
      rest += (rest.empty() ? "" : "; ") + std::string(line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return Printable(rest, kMost);
}

std::string WhyEnded(const ProgramEnd& end, const std::string& said) {
  if (WIFSIGNALED(end.status) && WTERMSIG(end.status) == SIGXCPU)
    return "libmujoco takes more than 60 s of CPU time for it: simplify it";
  if (WIFSIGNALED(end.status) && WTERMSIG(end.status) == SIGKILL)
    return "the program that reads it was killed: is there too little memory?";
  if (!WIFEXITED(end.status)) return "libmujoco crashed: the file, or one that it names, is damaged";
  return "libmujoco: " + (said.empty() ? "it cannot be read" : said);
}

bool IsStatic(const XmlNode& model) {
  return model.TextOf("static") == "true";
}

/// Locks `folder` until the result is closed. Returns -1 if another process holds the lock, or if the folder
/// cannot be opened.
int Lock(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0 || ::flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  ::close(file);
  return -1;
}

/// True if a MeshFolder of this user made `folder`, by its name, permissions and mark file.
bool IsMeshFolder(const fs::path& folder) {
  struct stat is {};
  constexpr std::size_t kLetters = 6;  // of mkdtemp()
  const std::string name = folder.filename().string();
  return name.starts_with(kFolder) && name.size() == kFolder.size() + kLetters &&
         ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
         (is.st_mode & 07777) == 0700 && ::lstat((folder / kMark).c_str(), &is) == 0 && S_ISREG(is.st_mode);
}

/// Removes unlocked folders beside `own`. Keeps young folders, which may not be locked yet.
void RemoveLeft(const fs::path& own) {
  constexpr auto kYoung = std::chrono::minutes(10);
  std::error_code code;
  const auto now = fs::last_write_time(own, code);
  for (fs::directory_iterator it(own.parent_path(), code), end; !code && it != end; it.increment(code)) {
    std::error_code other;
    const fs::path& folder = it->path();
    if (!IsMeshFolder(folder)) continue;
    if (const auto made = it->last_write_time(other); other || now - made < kYoung) continue;
    const int lock = Lock(folder);
    if (lock < 0) continue;
    fs::remove_all(folder, other);
    ::close(lock);
  }
}

}  // namespace

MeshFolder::MeshFolder() {
  std::error_code code;
  std::string name = (fs::temp_directory_path(code) / kFolder).string() + "XXXXXX";
  if (code || ::mkdtemp(name.data()) == nullptr) return;
  path_ = name;
  lock_ = Lock(path_);
  std::ofstream(path_ / kMark) << "coopdyn removes this folder when nobody uses it\n";
  RemoveLeft(path_);
}

MeshFolder::~MeshFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

bool IsMjcf(std::string_view text) {
  return RootElement(text) == "mujoco";
}

std::optional<std::string> TranslateMjcf(const fs::path& file, const SearchPath& path, const fs::path& meshes,
                                         const std::string& prefix, Diagnostics& diagnostics) {
  const SourceLine where{file.string(), 0};
  const auto fail = [&](const std::string& text) {
    diagnostics.Error(where, text);
    return std::nullopt;
  };
  if (path.IsUpload(file)) return fail(kNoMjcfUploads);
  const fs::path program = OwnProgram(kProgram);
  if (program.empty()) {
    return fail(
        std::string("MuJoCo's files are read by the program ") + kProgram +
        ", which is not beside coopdyn: install libmujoco-dev and build again (./start), or write SDF "
        "where there is one: coopdyn convert FILE");
  }
  if (meshes.empty()) return fail("its meshes cannot be stored in the folder for temporary files");
  NoEnd why = NoEnd::kNone;
  const auto end = RunProgram(program, {file.string(), meshes.string(), prefix}, kMostSdfBytes, why);
  if (why == NoEnd::kNoProgram) return fail(program.string() + " cannot be started");
  if (!end) return fail(std::string(kProgram) + " wrote nothing for a minute, or more than 64 MiB");
  const std::string said = TakeWarnings(end->error, where, diagnostics);
  if (!end->succeeded()) return fail(WhyEnded(*end, said));
  return end->out;
}

std::optional<XmlNode> ReadMjcf(const fs::path& file, const SearchPath& path, const MeshFolder& meshes,
                                Diagnostics& diagnostics) {
  const auto text = TranslateMjcf(file, path, meshes.path(), meshes.path().string() + "/", diagnostics);
  auto root = text ? ParseXml(*text, file.string(), diagnostics) : std::nullopt;
  if (root) ForgetLines(*root);
  return root;
}

std::optional<XmlNode> ReadMjcfRobot(const fs::path& file, const SearchPath& path, const MeshFolder& meshes,
                                     Diagnostics& diagnostics) {
  auto root = ReadMjcf(file, path, meshes, diagnostics);
  XmlNode* const world = root ? root->Child("world") : nullptr;
  if (world == nullptr) return std::nullopt;
  std::vector<XmlNode> models;
  for (XmlNode& child : world->children) {
    if (child.name == "model" && !IsStatic(child)) models.push_back(std::move(child));
  }
  std::vector<std::string> names;
  for (const XmlNode& model : models) names.push_back(model.Attribute("name"));
  const auto is_driven = [](const XmlNode& one) {
    return HasAny(one, "effort") || HasAny(one, "coopdyn:thruster");
  };
  if (std::ranges::count_if(models, is_driven) == 1)
    std::erase_if(models, [&](const XmlNode& one) { return !is_driven(one); });
  if (models.size() != 1) {
    const std::string name = file.filename().string();
    diagnostics.Error(
        {file.string(), 0},
        models.empty()
            ? "nothing in it moves, so it is no robot: serve it as a world (coopdyn serve " + name + ")"
            : "it holds several robots, " + JoinNames(names) + ": name one of them, type " + name + "#" +
                  names.front() + ", or serve the file itself (coopdyn serve " + name + ")");
    return std::nullopt;
  }
  std::erase_if(models.front().children, [](const XmlNode& one) { return one.name == "pose"; });
  root->children = std::move(models);
  return root;
}

Resources ResourcesOf(const SearchPath& path, const fs::path& file, const MeshFolder& meshes) {
  Resources resources(path, file);
  resources.Allow(meshes.path());
  return resources;
}

}  // namespace coopdyn
