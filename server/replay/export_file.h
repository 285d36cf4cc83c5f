// SPDX-License-Identifier: MIT
// What all exports share: what is chosen of a run, and a file that is there whole or not at all: written
// beside its place under another name, put in place at the end. One thread.
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
  std::optional<double> from_s = {};  // simulated time, both ends included; nothing: to the ends
  std::optional<double> until_s = {};
  /// Names, also of swarms, in any order; nothing: all. The columns stand in the order of the run.
  std::optional<std::vector<std::string>> robots = {};
  std::optional<std::vector<std::string>> objects = {};  // of things that move; nothing: all
  /// Names of scores and of logged numbers; nothing: all.
  std::optional<std::vector<std::string>> scores = {}, logged = {};
  /// Sensors' modules by name or type, of robots that have them; nothing: none.
  std::vector<std::string> readings = {};
  double every_s = 0;  // least simulated time between two rows; 0: all
  bool overwrite = false;
};

/// Called now and then with the share done, 0…1. False: stop.
using ExportProgress = std::function<bool(double share)>;
/// The error of an export that its ExportProgress has stopped; nothing is left behind.
inline constexpr const char* kExportStopped = "stopped; nothing was written";

class ExportFile {
 public:
  /// Nothing is made before Open().
  explicit ExportFile(std::string path) : path_(std::move(path)) {}
  /// Removes what was written, unless it was committed.
  ~ExportFile();
  ExportFile(const ExportFile&) = delete;
  ExportFile& operator=(const ExportFile&) = delete;

  /// What is wrong, and what to do; empty if it can be written.
  std::string Open(bool overwrite);
  /// Makes sure that there is room for `bytes`; an error text, empty if so or if the file system cannot tell.
  std::string Reserve(std::uint64_t bytes);
  /// Gives back the room beyond `bytes`, which is all that was written.
  void Trim(std::uint64_t bytes);
  /// The first error is kept for Commit().
  void Write(std::string_view bytes);
  bool failed() const { return !error_.empty(); }
  /// Ends writing: an error text, empty if all of it is on the disk.
  std::string Close();
  /// Close(), and puts the file in its place: an error text, empty if it is there.
  std::string Commit();

  const std::string& path() const { return path_; }
  /// Where it is until then, for those who write it by name.
  const std::string& temporary() const { return temporary_; }

 private:
  void Flush();
  void Fail(int code);

  std::string path_, temporary_;
  bool overwrite_ = false;
  int fd_ = -1;
  std::string buffer_, error_;
};

/// An error if there is something at `path` already; with `overwrite` only if it is a folder, a recording, or
/// a file that runs are made of.
std::string CheckFree(const std::string& path, bool overwrite);
/// A name beside `path` that nothing has: PATH.part, PATH.part2, ….
std::string FreeNameBeside(const std::string& path);
/// `lesson1-events.csv` for `lesson1.csv`, suffix "-events.csv".
std::string WithSuffix(const std::string& path, const std::string& suffix);

}  // namespace coopdyn
