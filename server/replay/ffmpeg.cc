// SPDX-License-Identifier: MIT
#include "server/replay/ffmpeg.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <string_view>

#include "server/base/spawn.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr const char* kProgram = "ffmpeg";
constexpr const char* kNotInstalled =
    "ffmpeg is not installed: install it (Debian: apt install ffmpeg), or make pictures with --to png";

/// The whole content of `file`.
std::string ReadAll(int file) {
  std::string text;
  std::array<char, 4096> part;
  for (ssize_t got; (got = ::pread(file, part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

/// The last line that is not empty.
std::string LastLine(const std::string& text) {
  const auto end = text.find_last_not_of("\r\n \t");
  if (end == std::string::npos) return {};
  const auto before = text.find_last_of("\r\n", end);
  const auto begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, end + 1 - begin);
}

/// Whether this ffmpeg has the encoder libx264; `error` if it cannot be started.
bool HasX264(std::string& error) {
  const int said = ::memfd_create("encoders", MFD_CLOEXEC);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  pid_t process = -1;
  const int code =
      Spawn(kProgram, {"-hide_banner", "-loglevel", "error", "-encoders"}, {nothing, said, nothing}, process);
  std::string text;
  if (code == ENOENT) {
    error = kNotInstalled;
  } else if (code != 0) {
    error = fmt::format("ffmpeg cannot be started: {}", std::strerror(code));
  } else {
    WaitFor(process);
    text = ReadAll(said);
  }
  ::close(said);
  ::close(nothing);
  return text.find(" libx264 ") != std::string::npos;
}

/// Formats without exponent, for ffmpeg.
std::string Digits(double value) {
  std::array<char, 400> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed).ptr;
  return {digits.data(), end};
}

}  // namespace

std::vector<std::string> FfmpegArguments(const VideoFormat& format, bool x264, const std::string& out) {
  std::vector<std::string> words = SplitWords(
      fmt::format("-hide_banner -loglevel error -f rawvideo -pix_fmt rgb24 -s {}x{} -r {} -i - -an",
                  format.width, format.height, Digits(format.fps)));
  if (x264) words.insert(words.end(), {"-c:v", "libx264"});
  words.insert(words.end(), {"-pix_fmt", "yuv420p", "-f", "mp4", "-y", "file:" + out});
  return words;
}

Ffmpeg::~Ffmpeg() {
  if (pictures_ >= 0) ::close(pictures_);
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    WaitFor(process_);
  }
  if (messages_ >= 0) ::close(messages_);
}

std::string Ffmpeg::Start(const VideoFormat& format, const std::string& out) {
  std::string error;
  const bool x264 = HasX264(error);
  if (!error.empty()) return error;
  messages_ = ::memfd_create("ffmpeg", MFD_CLOEXEC);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0 || messages_ < 0 || nothing < 0)
    return fmt::format("ffmpeg cannot be started: {}", std::strerror(errno));
  pictures_ = ends[1];
  const int code =
      Spawn(kProgram, FfmpegArguments(format, x264, out), {ends[0], nothing, messages_}, process_);
  ::close(ends[0]);
  ::close(nothing);
  if (code == 0) return {};
  process_ = -1;
  return fmt::format("ffmpeg cannot be started: {}", std::strerror(code));
}

std::string Ffmpeg::Write(std::span<const std::uint8_t> rgb) {
  while (!rgb.empty()) {
    const ssize_t written = ::write(pictures_, rgb.data(), rgb.size());
    if (written >= 0) {
      rgb = rgb.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {  // ffmpeg has exited: its messages tell why
      const std::string error = Finish();
      return error.empty() ? "ffmpeg ended before the last picture" : error;
    }
  }
  return {};
}

std::string Ffmpeg::Finish() {
  ::close(pictures_);
  pictures_ = -1;
  const int status = WaitFor(process_);
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  const std::string said = LastLine(ReadAll(messages_));
  if (!said.empty()) return "ffmpeg failed: " + said;
  return WIFSIGNALED(status) ? fmt::format("ffmpeg failed: ended by signal {}", WTERMSIG(status))
                             : fmt::format("ffmpeg failed with code {}", WEXITSTATUS(status));
}

}  // namespace coopdyn
