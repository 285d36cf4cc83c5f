// SPDX-License-Identifier: MIT
#include "tests/bench/bench_daemon.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace coopdyn {

namespace fs = std::filesystem;

BenchDaemon::BenchDaemon(const BenchDaemonOptions& options) {
  std::string folder = (fs::temp_directory_path() / "coopdyn-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("cannot make a folder " + folder);
  folder_ = folder;
  try {
    Start(options);
  } catch (...) {
    End();
    throw;
  }
}

BenchDaemon::~BenchDaemon() {
  End();
}

void BenchDaemon::Start(const BenchDaemonOptions& options) {
  const fs::path folder = folder_, said = folder / "said";
  for (const auto& [name, text] : options.files) {
    const fs::path file = folder / name;
    fs::create_directories(file.parent_path());
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
  }
  const std::string program = options.program.empty() ? ProgramBeside("coopdyn") : options.program;
  std::vector<std::string> words{
      program,       "serve", folder / "bench.scenario", "--port", "0", "--no-http", "--scenarios", folder_,
      "--log-level", "error"};
  words.insert(words.end(), options.words.begin(), options.words.end());
  if (!options.record.empty()) {
    words.insert(words.end(), {"--record", folder / "bench.run", "--record-what", options.record});
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int out[2];
  if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  pid_ = ::fork();
  if (pid_ == 0) {
    const int log = ::open(said.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(out[1], STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execv(program.c_str(), arguments.data());
    std::_Exit(127);
  }
  ::close(out[1]);
  std::string line;
  for (char c = 0; ::read(out[0], &c, 1) == 1 && c != '\n';) line += c;
  ::close(out[0]);
  constexpr std::string_view kNames = "names=";
  const std::size_t at = line.find(kNames);
  if (at == std::string::npos) {
    std::ifstream stream(said);
    throw std::runtime_error("the daemon " + program +
                             " did not start: " + std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  const std::size_t begin = at + kNames.size();
  address_ = line.substr(begin, line.find(' ', begin) - begin);
}

void BenchDaemon::End() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string ProgramBeside(const std::string& name) {
  return fs::read_symlink("/proc/self/exe").parent_path() / name;
}

}  // namespace coopdyn
