// SPDX-License-Identifier: MIT
#include "server/control/run_folder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/json.hpp>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "protocol/json_text.h"
#include "server/base/printable.h"
#include "server/naming/run_names.h"
#include "server/record/run_open.h"
#include "server/record/run_reader.h"
#include "server/replay/export_tables.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr std::string_view kMatExtension = ".mat";

/// The refusal to copy `name` alone, after a reader failed to merge its log.
std::string TwoFilesText(const std::string& name, const fs::path& log) {
  return fmt::format(
      "{0} alone is not the whole recording: its log {1} could not be made part of it; the disk is full, its "
      "folder cannot be written to, or another program has {0} open: make room or close that program and try "
      "again, or copy {0} and {1} together on the server",
      name, log.filename().string());
}

}  // namespace

std::string RunsJson(const std::vector<RunFile>& runs, const std::string& page) {
  json::array list;
  for (const RunFile& run : runs) {
    const bool whole = run.steps && !run.recording && !run.has_log;
    const std::string url = whole ? RunUrl(page, run.name) : "";
    list.push_back({{"name", run.name},
                    {"bytes", run.bytes},
                    {"seconds", run.seconds ? json::value(*run.seconds) : json::value(nullptr)},
                    {"steps", run.steps ? json::value(*run.steps) : json::value(nullptr)},
                    {"recording", run.recording},
                    {"url", url.empty() ? json::value(nullptr) : json::value(url)}});
  }
  return JsonText(list);
}

RunFolder::RunFolder(fs::path folder, SearchPath path, std::function<std::string()> present, Logger logger)
    : folder_(std::move(folder)),
      path_(std::move(path)),
      present_(std::move(present)),
      exporter_("export", logger),
      looks_("runs", logger) {}

RunFolder::~RunFolder() {
  Stop();
  std::error_code ignored;
  if (!exports_.empty()) fs::remove_all(exports_, ignored);
}

void RunFolder::Stop() {
  stopping_ = true;
  looks_.Stop();
  exporter_.Stop();
}

void RunFolder::List(std::function<void(std::vector<RunFile>)> done) {
  looks_.Post([this, done = std::move(done)] { done(ListNow()); });
}

std::vector<RunFile> RunFolder::ListNow() {
  std::vector<fs::directory_entry> entries;
  std::error_code failed;
  for (fs::directory_iterator it(folder_, failed), end; !failed && it != end; it.increment(failed)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    const bool named_well = name.ends_with(kRunExtension) && IsRunName(name);
    if (named_well && it->is_regular_file(ignored)) entries.push_back(*it);
  }
  std::sort(entries.begin(), entries.end(), [](const fs::directory_entry& a, const fs::directory_entry& b) {
    std::error_code ignored;
    const auto time_a = a.last_write_time(ignored), time_b = b.last_write_time(ignored);
    return time_a != time_b ? time_a > time_b : a.path() < b.path();
  });
  if (entries.size() > kMaxListed) entries.resize(kMaxListed);
  std::vector<RunFile> files;
  for (const fs::directory_entry& entry : entries) files.push_back(Look(entry));
  return files;
}

RunFile RunFolder::Look(const fs::directory_entry& entry) {
  std::error_code ignored;
  const std::string name = entry.path().filename().string();
  const std::uint64_t bytes = entry.file_size(ignored);
  const fs::file_time_type written = entry.last_write_time(ignored);
  Known& known = known_[name];
  const bool same = known.file.name == name && known.bytes == bytes && known.written == written;
  if (same && !known.file.recording && !known.file.has_log) return known.file;
  known = {bytes, written, {name, bytes, {}, {}, false, false}};
  std::string error;
  if (const std::unique_ptr<RunReader> reader = RunReader::Open(entry.path().string(), error)) {
    const RunExtent extent = reader->extent();
    known.file.seconds = ToSeconds(extent.end - extent.begin);
    known.file.steps = extent.steps;
    known.file.recording = reader->growing();
  }
  known.file.recording |= IsPresent(entry.path());
  if (const std::string log = UnmergedLog(entry.path().string()); !log.empty()) {
    known.file.has_log = true;
    const std::uintmax_t more = fs::file_size(log, ignored);
    if (!ignored) known.file.bytes += more;
  }
  return known.file;
}

void RunFolder::Open(const std::string& name, std::function<void(const RunToCopy&)> done) {
  const bool exported = name.ends_with(kMatExtension);
  const std::string run =
      exported ? WithRunExtension(name.substr(0, name.size() - kMatExtension.size())) : name;
  looks_.Post([this, run, exported, done = std::move(done)] {
    const RunToCopy found = Find(run, exported);
    if (!exported || found.error != Error::kOk) return done(found);
    exporter_.Post([this, file = found.file, done] { done(Export(file)); });
  });
}

std::string RunFolder::Objection(const std::string& name) const {
  std::error_code ignored;
  const fs::path file = folder_ / name;
  const std::string recorded = name + " is being recorded: stop the recording first";
  if (IsRunName(name) && IsPresent(file)) return recorded;  // its file may come later
  if (!IsRunName(name) || !fs::is_regular_file(file, ignored)) {
    return "there is no recording " + Printable(name) + ": list names them";
  }
  std::string unreadable;  // a damaged one may go
  const std::unique_ptr<RunReader> reader = RunReader::Open(file.string(), unreadable);
  return reader != nullptr && reader->growing() ? recorded : "";
}

void RunFolder::Delete(const std::string& name, std::function<void(std::string error)> done) {
  looks_.Post([this, name = WithRunExtension(name), done = std::move(done)] {
    if (std::string objection = Objection(name); !objection.empty()) return done(std::move(objection));
    std::error_code failed, ignored;
    const std::string log = UnmergedLog((folder_ / name).string());
    fs::remove(folder_ / name, failed);
    if (!log.empty() && !failed) fs::remove(log, ignored);
    done(failed ? name + " cannot be deleted: " + failed.message() : "");
  });
}

void RunFolder::Rename(const std::string& name, const std::string& to,
                       std::function<void(std::string error)> done) {
  looks_.Post([this, name = WithRunExtension(name), to = WithRunExtension(to), done = std::move(done)] {
    if (std::string objection = Objection(name); !objection.empty()) return done(std::move(objection));
    if (std::string objection = RunNameObjection(to); !objection.empty()) return done(std::move(objection));
    std::error_code failed;
    if (!UnmergedLog((folder_ / name).string()).empty()) {
      return done(name + " was not closed: play it once, then rename it");
    }
    if (fs::exists(folder_ / to, failed)) return done(to + " is there already: choose another name");
    fs::rename(folder_ / name, folder_ / to, failed);
    done(failed ? name + " cannot be renamed: " + failed.message() : "");
  });
}

bool RunFolder::IsPresent(const fs::path& file) const {
  const fs::path present = present_();
  std::error_code ignored;
  // The file may not exist yet.
  return !present.empty() && (present == file || fs::equivalent(file, present, ignored));
}

RunToCopy RunFolder::Find(const std::string& name, bool exported) const {
  if (!name.ends_with(kRunExtension) || !IsRunName(name)) {
    return {Error::kNoSuchName, "there is no recording of that name: /runs lists them", {}};
  }
  const fs::path file = folder_ / name;
  if (IsPresent(file)) {
    return {Error::kNotPossible, name + " is being recorded: stop the recording first", {}};
  }
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return {Error::kNoSuchName, "there is no recording of that name: /runs lists them", {}};
  }
  std::string error;
  const std::unique_ptr<RunReader> reader = RunReader::Open(file.string(), error);
  if (reader == nullptr) return {Error::kNotPossible, error, {}};
  const std::string log = UnmergedLog(file.string());
  if (!log.empty() && !exported) return {Error::kNotPossible, TwoFilesText(name, log), {}};
  if (!reader->growing()) return {Error::kOk, {}, file};
  return {Error::kNotPossible, name + " is being recorded, or open in another program: end that first", {}};
}

RunToCopy RunFolder::Export(const fs::path& run) {
  std::string error;
  const std::unique_ptr<RunReader> reader = RunReader::Open(run.string(), error);
  if (reader == nullptr) return {Error::kNotPossible, error, {}};
  Diagnostics diagnostics;
  if (reader->LoadScenario(path_, diagnostics) == nullptr) {
    return {Error::kNotPossible, diagnostics.ToString(), {}};
  }
  std::error_code failed;
  if (exports_.empty() || !fs::is_directory(exports_, failed)) {
    // A private folder, unreadable for other users of this machine, because runs may be confidential.
    std::string folder = (fs::temp_directory_path(failed) / "coopdyn-mat-XXXXXX").string();
    if (failed || ::mkdtemp(folder.data()) == nullptr) {
      return {Error::kNotPossible, "no temporary file can be made: set TMPDIR to a folder with room", {}};
    }
    exports_ = folder;
  }
  const fs::path out = exports_ / fmt::format("{}.mat", ++exported_);
  ExportOptions options;
  options.overwrite = true;
  error = ExportMat(*reader, options, out.string(), [this](double) { return !stopping_; });
  if (!error.empty()) return {Error::kNotPossible, error, {}};
  return {Error::kOk, {}, out, true};
}

}  // namespace coopdyn
