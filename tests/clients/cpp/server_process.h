// SPDX-License-Identifier: MIT
// A daemon for a test: the real one, or the scripted one of tests/clients/python/fake_daemon.py.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/source_dir.h"

namespace coopdyn::client {

/// A child process whose first line on stdout is `ready names=HOST:PORT …`. The destructor ends it.
class ServerProcess {
 public:
  static ServerProcess Real(const std::string& scenario, std::vector<std::string> options) {
    const char* binary = std::getenv("COOPDYN_BINARY");
    if (binary == nullptr) throw std::runtime_error("COOPDYN_BINARY is not set");
    std::vector<std::string> command = {
        binary,        "serve", SourceDir() + "/scenarios/" + scenario + ".scenario", "--port", "0",
        "--log-level", "error"};
    command.insert(command.end(), options.begin(), options.end());
    return ServerProcess(command);
  }
  /// `coopdyn VERB …`, e.g. play RUN.
  static ServerProcess Command(std::vector<std::string> words) {
    const char* binary = std::getenv("COOPDYN_BINARY");
    if (binary == nullptr) throw std::runtime_error("COOPDYN_BINARY is not set");
    words.insert(words.begin(), binary);
    words.insert(words.end(), {"--port", "0"});
    return ServerProcess(words);
  }
  static ServerProcess Fake(std::vector<std::string> options) {
    std::vector<std::string> command = {"python3", SourceDir() + "/tests/clients/python/fake_daemon.py"};
    command.insert(command.end(), options.begin(), options.end());
    return ServerProcess(command);
  }
  ~ServerProcess() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    close(stdin_);
    close(stdout_);
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  const std::string& server() const { return server_; }

 private:
  explicit ServerProcess(const std::vector<std::string>& command) {
    int in[2], out[2];
    if (pipe(in) != 0 || pipe(out) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(in[0], 0);
      dup2(out[1], 1);
      for (const int fd : {in[0], in[1], out[0], out[1]}) close(fd);
      std::vector<char*> arguments;
      for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    stdin_ = in[1];
    stdout_ = out[0];
    std::string line;
    for (char c = 0; read(stdout_, &c, 1) == 1 && c != '\n';) line += c;
    const std::size_t names = line.find("names=");
    if (names == std::string::npos) throw std::runtime_error("the server did not get ready: " + line);
    server_ = line.substr(names + 6, line.find(' ', names) - names - 6);
  }

  pid_t pid_ = -1;
  int stdin_ = -1, stdout_ = -1;
  std::string server_;
};

}  // namespace coopdyn::client
