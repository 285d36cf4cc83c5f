// SPDX-License-Identifier: MIT
#include "server/base/spawn.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>
#include <system_error>
#include <vector>

namespace coopdyn {

int Spawn(const std::string& program, const std::vector<std::string>& arguments,
          const std::array<int, 3>& streams, pid_t& process, SpawnApart apart) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  for (int i = 0; i < 3; ++i)
    posix_spawn_file_actions_adddup2(&files, streams[static_cast<std::size_t>(i)], i);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  sigset_t none, ours;  // those that we may ignore
  sigemptyset(&none);
  sigemptyset(&ours);
  for (const int one : {SIGPIPE, SIGCHLD, SIGXFSZ}) sigaddset(&ours, one);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &ours);
  posix_spawnattr_setpgroup(&attributes, 0);
  const int apart_flag = apart == SpawnApart::kSession ? POSIX_SPAWN_SETSID : POSIX_SPAWN_SETPGROUP;
  posix_spawnattr_setflags(&attributes,
                           static_cast<short>(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | apart_flag));
  const int code = ::posix_spawnp(&process, program.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return code;
}

std::filesystem::path OwnProgram(const std::string& name) {
  std::error_code code;
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
  for (std::filesystem::path folder = own; folder.has_relative_path(); folder = folder.parent_path()) {
    const bool is_ours = folder == own || std::filesystem::exists(folder / "CMakeCache.txt", code);
    if (is_ours && std::filesystem::exists(folder / name, code)) return folder / name;
  }
  return {};
}

int WaitFor(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace coopdyn
