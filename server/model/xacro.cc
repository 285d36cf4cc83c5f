// SPDX-License-Identifier: MIT
#include "server/model/xacro.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "server/base/printable.h"
#include "server/base/spawn.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// What comes out of `pipe` until its end; nothing if it is more than `most`, or nothing comes for a minute.
std::optional<std::string> ReadAll(int pipe, std::size_t most) {
  constexpr int kSilence_ms = 60'000;
  std::string text;
  std::array<char, 65'536> buffer{};
  while (true) {
    pollfd wait{pipe, POLLIN, 0};
    const int ready = ::poll(&wait, 1, kSilence_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return std::nullopt;
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
    if (text.size() > most) return std::nullopt;
  }
}

/// The last line that says something.
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

bool IsXacro(std::string_view text, const std::filesystem::path& file) {
  if (file.extension() == ".xacro") return true;
  constexpr std::string_view kBegin = "<!--", kEnd = "-->";
  while (!text.empty()) {
    const std::size_t comment = text.find(kBegin);
    if (text.substr(0, comment).find("<xacro:") != std::string_view::npos) return true;
    if (comment == std::string_view::npos) break;
    const std::size_t end = text.find(kEnd, comment + kBegin.size());
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + kEnd.size());
  }
  return false;
}

std::optional<std::string> ExpandXacro(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto fail = [&](const std::string& text) {
    diagnostics.Error({file.string(), 0}, text);
    return std::nullopt;
  };
  std::array<int, 2> out{-1, -1};
  if (::pipe2(out.data(), O_CLOEXEC) != 0) return fail("xacro cannot be started: there is no pipe for it");
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  pid_t process = -1;
  // Its complaints come out where its text would.
  const int code =
      Spawn("xacro", {std::filesystem::absolute(file).string()}, {nothing, out[1], out[1]}, process);
  ::close(nothing);
  ::close(out[1]);
  if (code != 0) {
    ::close(out[0]);
    return fail(
        "this is xacro, and there is no program xacro here: install it (ros-…-xacro, or pip install xacro), "
        "or write it out where there is one: xacro FILE > robot.urdf");
  }
  const auto text = ReadAll(out[0], kMaxModelBytes);
  ::close(out[0]);
  if (!text) ::kill(-process, SIGKILL);
  const int status = WaitFor(process);
  if (!text) return fail("xacro wrote nothing for a minute, or more than 4 MiB");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return fail("xacro: " + LastLine(*text));
  const std::size_t start = text->find("<?xml");  // warnings may stand before it
  return start == std::string::npos ? *text : text->substr(start);
}

}  // namespace coopdyn
