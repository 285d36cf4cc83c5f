// SPDX-License-Identifier: MIT
#include "server/app/uploads.h"

#include <spdlog/fmt/fmt.h>
#include <sys/random.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "protocol/ascii.h"
#include "server/base/printable.h"
#include "server/model/mjcf.h"
#include "server/model/text_file.h"
#include "server/model/values.h"
#include "server/model/xacro.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr int kMostTries = 1000;

bool IsNameCharacter(char c) {
  return IsDigit(c) || IsLower(c) || IsUpper(c) || c == '-' || c == '_' || c == '.';
}

/// Makes a folder that only this user can access.
bool MakeFolder(const fs::path& folder) {
  std::error_code failed;
  if (fs::is_directory(fs::symlink_status(folder, failed))) return true;
  return ::mkdir(folder.c_str(), S_IRWXU) == 0;
}

}  // namespace

fs::path Uploads::ChooseFolder() {
  std::array<unsigned char, 8> bytes{};
  std::error_code failed;
  const fs::path temporary = fs::temp_directory_path(failed);
  if (failed || ::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
  return temporary / fmt::format("coopdyn-{:02x}", fmt::join(bytes, ""));
}

Uploads::~Uploads() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

std::string Uploads::Objection(const std::string& name, const std::string& text) {
  const std::string extension = ToLower(fs::path(name).extension().string());
  const bool bare = !name.empty() && name.size() <= kMaxName && name.front() != '.' && name.front() != '-' &&
                    std::all_of(name.begin(), name.end(), IsNameCharacter);
  if (!bare) {
    return fmt::format(
        "an uploaded file needs a name of letters, digits, _, - and ., without folders, at most {} "
        "characters: not '{}'",
        kMaxName, Printable(name));
  }
  Diagnostics ignored;
  const std::string read = DecodeText(text, {}, ignored).value_or(text);  // decoded as its reader will
  if (IsMjcf(read))  // could name any file of this machine
    return kNoMjcfUploads;
  if (IsXacro(read, name))  // could too
    return kNoXacroUploads;
  if (extension == ".world" || extension == ".sdf" || extension == ".urdf") return {};
  if (extension == ".scenario" || extension == ".xml")
    return "a scenario needs no upload: send its text to /simulation with load_scenario";
  return "only .world, .sdf and .urdf can be sent, and the text of a scenario to /simulation: not '" +
         Printable(name) + "'";
}

std::string Uploads::FreeName(const std::string& stem, const std::string& extension, bool robot) const {
  for (int i = 1; i <= kMostTries; ++i) {
    std::string name = i == 1 ? stem : fmt::format("{}_{}", stem, i);
    const bool taken = robot ? path_.FindRobot(name).has_value()
                             : path_.FindScenario(name + extension) || path_.FindWorld(name + extension, {});
    if (!taken) return name;
  }
  return {};
}

bool Uploads::Write(const fs::path& file, const std::string& text) {
  for (const fs::path& folder : {folder_, file.parent_path().parent_path(), file.parent_path()}) {
    if (!MakeFolder(folder)) return false;
  }
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  return out.good();
}

Upload Uploads::Keep(const std::string& name, const std::string& text) {
  if (std::string objection = Objection(name, text); !objection.empty()) return {400, std::move(objection)};
  if (files_ >= kMaxFiles || bytes_ + text.size() > kMaxBytes) {
    return {413, fmt::format("this daemon keeps at most {} files and {} MiB of uploads: put the files into a "
                             "folder and start it with --scenarios FOLDER",
                             kMaxFiles, kMaxBytes >> 20)};
  }
  const fs::path given(name);
  std::string extension = ToLower(given.extension().string());
  const bool xml = IsXml(text);
  if (extension != ".world" && !xml) return {400, Printable(name) + " holds no XML: it must begin with <"};
  const bool robot = xml && extension != ".world" && text.find("<world") == std::string::npos;
  if (robot && text.find("<robot") != std::string::npos) extension = ".urdf";
  const std::string stem = FreeName(given.stem().string(), extension, robot);
  if (folder_.empty() || stem.empty()) return {507, "there is no room for uploads"};
  Upload upload;
  upload.kind = robot ? "robot" : "world";
  upload.name = robot ? stem : stem + extension;
  upload.file = robot ? folder_ / "robots" / stem / ("model" + extension) : folder_ / "worlds" / upload.name;
  if (!Write(upload.file, text)) return {507, "the file cannot be written to " + folder_.string()};
  ++files_;
  bytes_ += text.size();
  return upload;
}

void Uploads::Remove(const Upload& upload) {
  std::error_code ignored;
  const std::uint64_t bytes = fs::file_size(upload.file, ignored);
  if (!ignored) bytes_ -= std::min(bytes_, bytes);
  --files_;
  fs::remove_all(upload.kind == "robot" ? upload.file.parent_path() : upload.file, ignored);
}

fs::path Uploads::Scratch(const std::string& name, const std::string& text) {
  if (folder_.empty() || !Objection(name, text).empty()) return {};
  const fs::path file = folder_ / "checked" / "now" / name;
  return Write(file, text) ? file : fs::path();
}

}  // namespace coopdyn
