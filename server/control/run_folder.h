// SPDX-License-Identifier: MIT
// The recordings that clients may list and copy: those of one folder. Reads files on its own threads.
// Thread-safe.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/message.h"
#include "server/base/log.h"
#include "server/model/readers.h"
#include "server/net/io_thread.h"

namespace coopdyn {

struct RunFile {
  std::string name;  // with .run
  std::uint64_t bytes = 0;
  std::optional<double> seconds;       // simulated; nullopt: unreadable
  std::optional<std::uint64_t> steps;  // likewise
  bool recording = false;              // being written
  bool has_log = false;                // a part of it is in a log file beside it
};

/// [{"name":…,"bytes":…,"seconds":…,"steps":…,"recording":…,"url":…}]; `page`: the page's URL with a trailing
/// slash, empty: none. RFC 8259.
std::string RunsJson(const std::vector<RunFile>& runs, const std::string& page);

/// A file to copy.
struct RunToCopy {
  Error error = Error::kOk;  // unknown name, or not possible, e.g. because it is being recorded
  std::string text;
  std::filesystem::path file;
  bool temporary = false;  // the receiver removes it
};

class RunFolder {
 public:
  static constexpr std::size_t kMaxListed = 1'000;  // the newest

  /// `present`: path of this program's current recording; empty: none. `path`: search path for loaded
  /// controllers in exports.
  RunFolder(std::filesystem::path folder, SearchPath path, std::function<std::string()> present,
            Logger logger);
  /// Calls Stop().
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Passes the recordings, newest first, to `done`, on one of the folder's threads.
  void List(std::function<void(std::vector<RunFile>)> done);
  /// Passes NAME.run, unless it is being written, or NAME.mat, exported from it, to `done`: once, on any
  /// thread.
  void Open(const std::string& name, std::function<void(const RunToCopy&)> done);
  /// Deletes NAME.run, and what lies beside it of it; `done` gets an error text, empty on success.
  void Delete(const std::string& name, std::function<void(std::string error)> done);
  /// Renames NAME.run to NEW.run. As Delete().
  void Rename(const std::string& name, const std::string& to, std::function<void(std::string error)> done);
  /// Aborts a running export and drops waiting ones. After it returns no `done` runs.
  void Stop();

 private:
  /// A file's data when it was last read.
  struct Known {
    std::uint64_t bytes = 0;
    std::filesystem::file_time_type written;
    RunFile file;
  };

  std::vector<RunFile> ListNow();
  RunFile Look(const std::filesystem::directory_entry& entry);
  /// `exported`: to be read, including its log; else to be copied.
  RunToCopy Find(const std::string& name, bool exported) const;
  /// Why the recording NAME.run cannot be deleted or renamed now; empty if it can.
  std::string Objection(const std::string& name) const;
  /// True if this program is recording to `file`.
  bool IsPresent(const std::filesystem::path& file) const;
  RunToCopy Export(const std::filesystem::path& run);

  const std::filesystem::path folder_;
  const SearchPath path_;
  const std::function<std::string()> present_;
  std::map<std::string, Known> known_;  // used by looks_
  std::atomic<bool> stopping_{false};
  std::filesystem::path exports_;  // holds exports for downloads; used by exporter_
  int exported_ = 0;               // used by exporter_
  // Last: their work uses all other members. looks_ stops first because it posts to exporter_.
  IoThread exporter_;
  IoThread looks_;
};

}  // namespace coopdyn
