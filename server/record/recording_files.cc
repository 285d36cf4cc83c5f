// SPDX-License-Identifier: MIT
#include "server/record/recording_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <system_error>

namespace coopdyn {

namespace {

bool Exists(const std::string& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) == 0;
}

std::uint64_t FreeBytes(const std::string& file) {
  std::error_code failed;
  const auto disk = std::filesystem::space(std::filesystem::absolute(file).parent_path(), failed);
  return failed ? std::numeric_limits<std::uint64_t>::max() : disk.available;
}

}  // namespace

std::string RecordingFiles::Name(int number) const {
  const std::string& file = options_.file;
  if (number == 1) return file;
  const std::string end = file.ends_with(".run") ? ".run" : "";
  return file.substr(0, file.size() - end.size()) + "-" + std::to_string(number) + end;
}

bool RecordingFiles::IsTaken(int number) const {
  return Exists(Name(number));
}

std::string RecordingFiles::WhyNone() const {
  const std::string& file = options_.file;
  if (const std::string error = WhyNoRunFile(file, options_.overwrite); !error.empty()) return error;
  if (Exists(file)) return {};
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return "cannot make " + file + ": " + std::generic_category().message(errno);
  ::close(descriptor);
  ::unlink(file.c_str());
  return {};
}

bool RecordingFiles::HasRoom() const {
  const auto& free = options_.free_bytes;
  return (free ? free(options_.file) : FreeBytes(options_.file)) >= options_.room_bytes;
}

std::unique_ptr<RunWriter> RecordingFiles::Make(const SavedState& state, int number, std::string& error) {
  RunWriterOptions options;
  options.overwrite = options_.overwrite && !has_made_;
  const RecordWhat what = options_.what.value_or(DefaultRecordWhat(state.frame->scene->robots.size()));
  options.header = HeaderOf(*state.frame, state.mode, what, options_.pose_every);
  options.header.version = options_.version;
  options.header.command = options_.command;
  options.header.started = options_.started;
  options.header.build = build_;
  options.header.cpu = CpuName();
  while (true) {
    const std::string file = Name(number++);
    std::unique_ptr<RunWriter> writer = RunWriter::Create(file, options, state, error);
    if (writer != nullptr || !has_made_ || !Exists(file)) return writer;
  }
}

}  // namespace coopdyn
