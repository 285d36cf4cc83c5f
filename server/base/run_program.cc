// SPDX-License-Identifier: MIT
#include "server/base/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>

#include "server/base/printable.h"
#include "server/base/spawn.h"
#include "server/base/words.h"

namespace coopdyn {

namespace {

struct Pipe {
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  ~Pipe() {
    CloseInput();
    ::close(ends[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void CloseInput() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }

  std::array<int, 2> ends{-1, -1};
};

/// Reads both pipes to their ends. False if they hold more than `most` bytes or stay silent for a minute.
bool ReadAll(std::array<int, 2> pipes, std::size_t most, ProgramEnd& end) {
  constexpr int kSilence_ms = 60'000;
  std::array<char, 65'536> buffer{};
  while (pipes[0] >= 0 || pipes[1] >= 0) {
    std::array<pollfd, 2> waits{{{pipes[0], POLLIN, 0}, {pipes[1], POLLIN, 0}}};
    const int ready = ::poll(waits.data(), waits.size(), kSilence_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    for (std::size_t i = 0; i < pipes.size(); ++i) {
      if (waits[i].revents == 0) continue;
      const ssize_t count = ::read(pipes[i], buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) pipes[i] = -1;  // poll() skips it
      if (count > 0) (i == 0 ? end.out : end.error).append(buffer.data(), static_cast<std::size_t>(count));
    }
    if (end.out.size() + end.error.size() > most) return false;
  }
  return true;
}

std::string LastLine(std::string_view text) {
  std::string last;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = Trim(text.substr(0, end));
    if (!line.empty()) last = line;
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  constexpr std::size_t kMost = 300;
  return Printable(last.substr(0, kMost));
}

}  // namespace

bool ProgramEnd::succeeded() const {
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string ProgramEnd::LastWords() const {
  const std::string words = LastLine(error);
  return words.empty() ? LastLine(out) : words;
}

std::optional<ProgramEnd> RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                                     std::size_t most_bytes, NoEnd& why) {
  Pipe out, error;
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  pid_t process = -1;
  const int code = out.ends[0] < 0 || error.ends[0] < 0
                       ? EMFILE
                       : Spawn(program, arguments, {nothing, out.ends[1], error.ends[1]}, process);
  ::close(nothing);
  out.CloseInput();
  error.CloseInput();
  why = NoEnd::kNoProgram;
  if (code != 0) return std::nullopt;
  ProgramEnd end;
  const bool is_whole = ReadAll({out.ends[0], error.ends[0]}, most_bytes, end);
  if (!is_whole) ::kill(-process, SIGKILL);
  end.status = WaitFor(process);
  why = is_whole ? NoEnd::kNone : NoEnd::kTooLong;
  if (!is_whole) return std::nullopt;
  return end;
}

}  // namespace coopdyn
