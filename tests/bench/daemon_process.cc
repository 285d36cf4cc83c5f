// SPDX-License-Identifier: MIT
#include "daemon_process.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "protocol/codec.h"

namespace coopdyn {

namespace {

[[noreturn]] void Fail(const char* what) {
  std::perror(what);
  std::exit(1);
}

}  // namespace

DaemonProcess::DaemonProcess(const std::string& scenario_text, const std::vector<std::string>& options) {
  file_ = "/tmp/coopdyn-bench-" + std::to_string(::getpid()) + ".scenario";
  std::ofstream(file_) << scenario_text;
  int out[2];
  if (::pipe(out) != 0) Fail("pipe");
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(out[1], STDOUT_FILENO);
    ::close(out[0]);
    std::vector<std::string> words{COOPDYN_BINARY, "serve",       file_,         "--port", "0",
                                   "--no-http",    "--no-render", "--log-level", "error"};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (std::freopen("/dev/null", "w", stderr) == nullptr) std::_Exit(1);
    ::execv(COOPDYN_BINARY, arguments.data());
    std::_Exit(1);
  }
  ::close(out[1]);
  std::string line;
  char c;
  while (::read(out[0], &c, 1) == 1 && c != '\n') line += c;
  const std::size_t at = line.find("names=127.0.0.1:");
  if (at == std::string::npos) Fail("the daemon did not start");
  name_port_ = std::atoi(line.c_str() + at + 16);
}

DaemonProcess::~DaemonProcess() {
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
  ::unlink(file_.c_str());
}

int DaemonProcess::Open(const std::string& module) const {
  const int fd = ConnectTo(name_port_);
  SendAll(fd, "OPEN " + module + "\n");
  char answer[3];
  if (::recv(fd, answer, sizeof answer, MSG_WAITALL) != 3) Fail("OPEN");
  SendAll(fd, std::string(kBinaryMagic));
  return fd;
}

int ConnectTo(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) Fail("connect");
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

void SendAll(int fd, const std::string& bytes) {
  if (::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size()))
    Fail("send");
}

}  // namespace coopdyn
