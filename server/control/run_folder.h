// SPDX-License-Identifier: MIT
// The recordings that clients may see and copy: those of one folder. Files are looked into on threads of its
// own. All calls from any thread.
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
  std::optional<double> seconds;       // simulated; empty: it cannot be read
  std::optional<std::uint64_t> steps;  // likewise
  bool recording = false;              // it is being written
  bool has_log = false;                // a part of it stands in a log beside it
};

/// [{"name":…,"bytes":…,"seconds":…,"steps":…,"recording":…,"url":…}]; `page`: the page's URL with a slash at
/// its end, empty: there is none. RFC 8259.
std::string RunsJson(const std::vector<RunFile>& runs, const std::string& page);

/// A file to be copied.
struct RunToCopy {
  Error error = Error::kOk;  // no such name; not possible: it is being recorded, …
  std::string text;
  std::filesystem::path file;
  bool temporary = false;  // the receiver removes it
};

class RunFolder {
 public:
  static constexpr std::size_t kMaxListed = 1'000;  // the newest

  /// `present`: the path of the file that this program is recording to; empty: none. `path`: where exports
  /// look for loaded controllers.
  RunFolder(std::filesystem::path folder, SearchPath path, std::function<std::string()> present,
            Logger logger);
  /// Stop().
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Hands the recordings, newest first, to `done`, on a thread of the folder.
  void List(std::function<void(std::vector<RunFile>)> done);
  /// Hands NAME.run, if it is not being written, or NAME.mat, made of it, to `done`: once, on any thread.
  void Open(const std::string& name, std::function<void(const RunToCopy&)> done);
  /// Ends an export that is being made. From its return on no `done` runs any more; what waits is dropped.
  void Stop();

 private:
  /// A file as it was when it was looked into.
  struct Known {
    std::uint64_t bytes = 0;
    std::filesystem::file_time_type written;
    RunFile file;
  };

  std::vector<RunFile> ListNow();
  RunFile Look(const std::filesystem::directory_entry& entry);
  /// `exported`: to be read, which also takes what stands in a log beside it; else to be copied.
  RunToCopy Find(const std::string& name, bool exported) const;
  /// This program is recording to `file`.
  bool IsPresent(const std::filesystem::path& file) const;
  RunToCopy Export(const std::filesystem::path& run);

  const std::filesystem::path folder_;
  const SearchPath path_;
  const std::function<std::string()> present_;
  std::map<std::string, Known> known_;  // looks_
  std::atomic<bool> stopping_{false};
  std::filesystem::path exports_;  // what is made for downloads; exporter_
  int exported_ = 0;               // exporter_
  // Last: what they run uses the rest. The one that looks ends first: it posts to the other.
  IoThread exporter_;
  IoThread looks_;
};

}  // namespace coopdyn
