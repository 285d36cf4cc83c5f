// SPDX-License-Identifier: MIT
// Shared by all exports: the options that select a part of a run, and a file that appears whole or not at
// all: it is written under a temporary name beside its path and renamed at the end. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace coopdyn {

struct ExportOptions {
  std::optional<double> from_s = {};  // simulated time, both ends included; nullopt: to the ends
  std::optional<double> until_s = {};
  /// Names, also of swarms, in any order; nullopt: all. Columns keep the order of the run.
  std::optional<std::vector<std::string>> robots = {};
  std::optional<std::vector<std::string>> objects = {};  // moving things; nullopt: all
  /// Names of scores and of logged numbers; nullopt: all.
  std::optional<std::vector<std::string>> scores = {}, logged = {};
  /// Sensor modules by name or type, of robots that have them; empty: none.
  std::vector<std::string> readings = {};
  double every_s = 0;  // least simulated time between two rows; 0: all
  bool overwrite = false;
};

/// Called periodically with the completed share, 0…1. Returns false to stop.
using ExportProgress = std::function<bool(double share)>;
/// The error of an export stopped by its ExportProgress; it leaves no file behind.
inline constexpr const char* kExportStopped = "stopped; nothing was written";

class ExportFile {
 public:
  /// Creates nothing before Open().
  explicit ExportFile(std::string path) : path_(std::move(path)) {}
  /// Removes the temporary file unless it was committed.
  ~ExportFile();
  ExportFile(const ExportFile&) = delete;
  ExportFile& operator=(const ExportFile&) = delete;

  /// Returns what is wrong and what to do; empty if the file can be written.
  std::string Open(bool overwrite);
  /// Reserves room for `bytes`. Returns an error text; empty on success or if the file system cannot reserve.
  std::string Reserve(std::uint64_t bytes);
  /// Releases the reserved room beyond `bytes`, the size written.
  void Trim(std::uint64_t bytes);
  /// Appends `bytes`. Close() and Commit() return the first error.
  void Write(std::string_view bytes);
  bool failed() const { return !error_.empty(); }
  /// Ends writing. Returns an error text; empty if everything was written.
  std::string Close();
  /// Calls Close() and renames the file to path(). Returns an error text; empty on success.
  std::string Commit();

  const std::string& path() const { return path_; }
  /// The file's name until Commit(), for callers that write it by name.
  const std::string& temporary() const { return temporary_; }

 private:
  void Flush();
  void Fail(int code);

  std::string path_, temporary_;
  bool overwrite_ = false;
  int fd_ = -1;
  std::string buffer_, error_;
};

/// Returns an error if `path` exists; with `overwrite`, only if it is a folder, a recording, or a scenario,
/// world or model file.
std::string CheckFree(const std::string& path, bool overwrite);
/// An unused name beside `path`: PATH.part, PATH.part2, ….
std::string FreeNameBeside(const std::string& path);
/// `lesson1-events.csv` for `lesson1.csv`, suffix "-events.csv".
std::string WithSuffix(const std::string& path, const std::string& suffix);

}  // namespace coopdyn
