// SPDX-License-Identifier: MIT
// The files of a recording: lesson1.run and, after resets and loads, lesson1-2.run and so on. Names that are
// taken are skipped, except the one that the user gave.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <system_error>

#include "server/record/recorder.h"
#include "server/record/run_writer.h"

namespace coopdyn {

/// One thread calls Make() and NoteMade(); any thread may call the rest.
class RecordingFiles {
 public:
  /// `options` must outlive it.
  explicit RecordingFiles(const RecorderOptions& options) : options_(options) {}

  /// The user's name for 1; lesson1-2.run for 2.
  std::string Name(int number) const {
    const std::string& file = options_.file;
    if (number == 1) return file;
    const std::string end = file.ends_with(".run") ? ".run" : "";
    return file.substr(0, file.size() - end.size()) + "-" + std::to_string(number) + end;
  }
  bool IsTaken(int number) const { return Exists(Name(number)); }
  /// Why the first file cannot be made; empty if it can.
  std::string WhyNone() const {
    const std::string& file = options_.file;
    if (const std::string error = WhyNoRunFile(file, options_.overwrite); !error.empty()) return error;
    if (Exists(file)) return {};
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) return "cannot make " + file + ": " + std::generic_category().message(errno);
    ::close(descriptor);
    ::unlink(file.c_str());
    return {};
  }
  /// Whether the disk has enough room for a recording.
  bool HasRoom() const {
    const auto& free = options_.free_bytes;
    return (free ? free(options_.file) : FreeBytes(options_.file)) >= options_.room_bytes;
  }
  /// Makes the file with this number or, if its name has been taken meanwhile, the next free one. Null, with
  /// `error` set, if it cannot be made.
  std::unique_ptr<RunWriter> Make(const SavedState& state, int number, std::string& error) {
    RunWriterOptions options;
    options.overwrite = options_.overwrite && !has_made_;
    const RecordWhat what = options_.what.value_or(DefaultRecordWhat(state.frame->scene->robots.size()));
    options.header = HeaderOf(*state.frame, state.mode, what, options_.pose_every);
    options.draw = options_.draw;
    options.durable = options_.durable;
    options.header.version = options_.version;
    options.header.command = options_.command;
    options.header.started = options_.started;
    options.header.build = build_;
    options.header.libraries = libraries_;
    options.header.cpu = CpuName();
    while (true) {
      const std::string file = Name(number++);
      std::unique_ptr<RunWriter> writer = RunWriter::Create(file, options, state, error);
      if (writer != nullptr || !has_made_ || !Exists(file)) return writer;
    }
  }
  /// The first file has content: never overwrite from now on.
  void NoteMade() { has_made_ = true; }

 private:
  static bool Exists(const std::string& file) {
    struct stat found {};
    return ::lstat(file.c_str(), &found) == 0;
  }
  static std::uint64_t FreeBytes(const std::string& file) {
    std::error_code failed;
    const auto disk = std::filesystem::space(std::filesystem::absolute(file).parent_path(), failed);
    return failed ? std::numeric_limits<std::uint64_t>::max() : disk.available;
  }

  const RecorderOptions& options_;
  const std::string build_ = BuildId();  // computed before the run because it reads the whole program
  const std::vector<PluginHash> libraries_ = LibrariesHere();
  bool has_made_ = false;
};

}  // namespace coopdyn
