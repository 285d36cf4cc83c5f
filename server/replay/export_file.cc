// SPDX-License-Identifier: MIT
#include "server/replay/export_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "server/record/run_open.h"

namespace coopdyn {

namespace fs = std::filesystem;

namespace {

/// What `path` is if it is a file that no export makes, whose loss would destroy work; else null.
const char* Source(const std::string& path) {
  constexpr std::array<std::array<const char*, 2>, 3> kKinds{
      {{".scenario", "a scenario"}, {".world", "a world"}, {".sdf", "a model"}}};
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return nullptr;
  // With a log, the recorder may not have written to the file itself yet.
  if (BeginsAsRecording(path) || !UnmergedLog(path).empty()) return "a recording";
  for (const auto& [ending, kind] : kKinds) {
    if (fs::path(path).extension() == ending) return kind;
  }
  return nullptr;
}

}  // namespace

std::string CheckFree(const std::string& path, bool overwrite) {
  struct stat status {};
  if (path.empty()) return "--out: write the name of a file";
  if (::lstat(path.c_str(), &status) != 0) return {};
  if (S_ISDIR(status.st_mode)) return path + " is a folder: write the name of a file with --out";
  if (const char* source = Source(path); source != nullptr) {
    return path + " is " + source + ", which export never overwrites: choose another --out";
  }
  if (!overwrite) return path + " is there already: --force overwrites it, --out PATH writes elsewhere";
  return {};
}

std::string FreeNameBeside(const std::string& path) {
  struct stat status {};
  std::string name = path + ".part";
  for (int i = 2; ::lstat(name.c_str(), &status) == 0; ++i) name = fmt::format("{}.part{}", path, i);
  return name;
}

std::string WithSuffix(const std::string& path, const std::string& suffix) {
  const fs::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + suffix)).string();
}

ExportFile::~ExportFile() {
  if (fd_ >= 0) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void ExportFile::Fail(int code) {
  if (error_.empty()) error_ = fmt::format("{} cannot be written: {}", path_, std::strerror(code));
}

std::string ExportFile::Open(bool overwrite) {
  overwrite_ = overwrite;
  error_ = CheckFree(path_, overwrite);
  if (!error_.empty()) return error_;
  do {
    temporary_ = FreeNameBeside(path_);
    fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (fd_ < 0 && errno == EEXIST);
  if (fd_ < 0) {
    const int code = errno;
    temporary_.clear();
    Fail(code);
  }
  return error_;
}

std::string ExportFile::Reserve(std::uint64_t bytes) {
  if (::fallocate(fd_, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0) return {};
  const int code = errno;
  if (code != ENOSPC && code != EDQUOT && code != EFBIG) return {};
  return fmt::format("{} cannot be written: {} MB are needed: {}", path_, bytes / 1'000'000 + 1,
                     std::strerror(code));
}

void ExportFile::Trim(std::uint64_t bytes) {
  if (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0) Fail(errno);
}

void ExportFile::Write(std::string_view bytes) {
  constexpr std::size_t kBuffer = 1 << 16;
  if (failed()) return;
  buffer_ += bytes;
  if (buffer_.size() >= kBuffer) Flush();
}

void ExportFile::Flush() {
  std::string_view rest = buffer_;
  while (!rest.empty() && !failed()) {
    const ssize_t written = ::write(fd_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      Fail(errno);
    }
  }
  buffer_.clear();
}

std::string ExportFile::Close() {
  Flush();
  // Some file systems report a full disk only at close.
  if (fd_ >= 0 && ::close(fd_) != 0) Fail(errno);
  fd_ = -1;
  return error_;
}

std::string ExportFile::Commit() {
  if (!Close().empty()) return error_;
  const unsigned flags = overwrite_ ? 0 : RENAME_NOREPLACE;
  int moved = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), flags);
  if (moved != 0 && errno == EINVAL) moved = std::rename(temporary_.c_str(), path_.c_str());
  if (moved != 0) {
    Fail(errno);
    return error_;
  }
  temporary_.clear();
  return {};
}

}  // namespace coopdyn
