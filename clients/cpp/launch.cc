// SPDX-License-Identifier: MIT
// launch(): starts and ends a private daemon.
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX wants it declared here

namespace coopdyn::client {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kEndTime{10};
constexpr std::chrono::milliseconds kLook{5};
constexpr const char* kReady = "ready names=";

/// An anonymous file that holds `text`.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& text = "") : file_(::memfd_create("coopdyn", MFD_CLOEXEC)) {
    if (file_ < 0 || ::write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw Error(9, std::string("no memory for a daemon: ") + std::strerror(errno));
    ::lseek(file_, 0, SEEK_SET);
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int file() const { return file_; }
  std::string Content() const {
    std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(file_, 0, SEEK_END), 0)), '\0');
    const ssize_t read = ::pread(file_, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(read, 0)));
    while (text.ends_with('\n')) text.pop_back();
    return text;
  }

 private:
  int file_;
};

/// A daemon process; the destructor ends it.
class LaunchedDaemon {
 public:
  LaunchedDaemon(std::vector<std::string> words, const std::string& input) {
    const MemoryFile in(input);
    int out[2];
    if (::pipe2(out, O_CLOEXEC) != 0)
      throw Error(9, std::string("no pipe for a daemon: ") + std::strerror(errno));
    out_ = out[0];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in.file(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, stderr_.file(), STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);  // Ctrl-C must not reach the daemon
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int failed =
        ::posix_spawnp(&process_, words.front().c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(out[1]);
    if (failed == 0) return;
    ::close(out_);
    throw Error(-1, words.front() + " cannot be started: " + std::strerror(failed));
  }
  ~LaunchedDaemon() {
    int signal = SIGTERM;
    for (const auto begin = Clock::now(); ::waitpid(process_, nullptr, WNOHANG) == 0;) {
      if (signal != 0) ::kill(process_, std::exchange(signal, 0));
      if (Clock::now() - begin > kEndTime) ::kill(process_, SIGKILL);
      std::this_thread::sleep_for(kLook);
    }
    ::close(out_);
  }
  LaunchedDaemon(const LaunchedDaemon&) = delete;
  LaunchedDaemon& operator=(const LaunchedDaemon&) = delete;

  /// Waits until the daemon is ready; returns its address.
  std::string Server(double timeout_s) {
    const auto limit =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s));
    for (std::string text;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(limit - Clock::now()).count();
      pollfd waiting{out_, POLLIN, 0};
      if (left <= 0 || ::poll(&waiting, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000))) == 0) {
        if (left > 0) continue;
        throw Error(
            11, "the daemon was not ready within " + Written(timeout_s) + " s: give launch a longer timeout");
      }
      char bytes[4096];
      const ssize_t read = ::read(out_, bytes, sizeof bytes);
      if (read < 0 && errno == EINTR) continue;
      if (read <= 0) throw Error(7, "the daemon did not start:\n" + stderr_.Content());
      text.append(bytes, static_cast<std::size_t>(read));
      const std::size_t at = text.find(kReady),
                        end = at == std::string::npos ? at : text.find(' ', at + std::strlen(kReady));
      if (end != std::string::npos)
        return text.substr(at + std::strlen(kReady), end - at - std::strlen(kReady));
    }
  }

 private:
  MemoryFile stderr_;
  int out_ = -1;
  pid_t process_ = -1;
};

std::string ProgramOf(const std::string& given) {
  if (!given.empty()) return given;
  for (const char* name : {"COOPDYN", "COOPDYN_BINARY"}) {
    if (const char* named = std::getenv(name); named != nullptr && *named != '\0') return named;
  }
  return "coopdyn";
}

}  // namespace

Simulation launch(const std::string& scenario, const LaunchOptions& options) {
  const bool is_text = scenario.find('\n') != std::string::npos;
  std::vector<std::string> words = {
      ProgramOf(options.program), "serve", is_text ? "-" : scenario, "--port", "0", "--with-process",
      std::to_string(::getpid())};
  const auto add = [&words](const std::string& flag, const std::string& value) {
    words.insert(words.end(), {flag, value});
  };
  for (const auto& [key, value] : options.set) add("--set", key + "=" + value);
  if (options.seed) add("--seed", std::to_string(*options.seed));
  if (!options.mode.empty()) add("--mode", options.mode);
  if (!options.record.empty()) add("--record", options.record);
  words.insert(words.end(), options.options.begin(), options.options.end());
  auto daemon = std::make_shared<LaunchedDaemon>(std::move(words), is_text ? scenario : "");
  Simulation sim = connect(daemon->Server(options.timeout), {.seat = ""});
  sim.session_->set_daemon(std::move(daemon));
  return sim;
}

}  // namespace coopdyn::client
