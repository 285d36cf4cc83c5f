// SPDX-License-Identifier: MIT
#include "server/controllers/child_process.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <system_error>

namespace coopdyn {

ChildProcess::ChildProcess(ChildLauncher& launcher, int in_fd, int out_fd) : launcher_(launcher) {
  std::array<int, 2> sockets{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "socketpair");
  }
  socket_ = sockets[0];
  try {
    pid_ = launcher_.Launch({sockets[1], in_fd, out_fd});
  } catch (...) {
    close(sockets[0]);
    close(sockets[1]);
    throw;
  }
  close(sockets[1]);
  watched_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (watched_ >= 0) return;
  const int error = errno;
  kill(pid_, SIGKILL);
  Wait();
  close(socket_);
  throw std::system_error(error, std::generic_category(), "pidfd_open");
}

ChildProcess::~ChildProcess() {
  if (!end_) {
    Kill();
    Wait();
  }
  close(watched_);
  close(socket_);
}

bool ChildProcess::HandOver(int in_fd, int out_fd) {
  const std::array<int, 2> files = {in_fd, out_fd};
  char byte = 0;
  iovec bytes{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(files))> room{};
  msghdr message{};
  message.msg_iov = &bytes;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof(files));
  std::memcpy(CMSG_DATA(header), files.data(), sizeof(files));
  return sendmsg(socket_, &message, MSG_NOSIGNAL | MSG_DONTWAIT) == 1;
}

std::optional<ChildEnd> ChildProcess::Ended() {
  if (!end_ && WaitFor(0)) Wait();
  return end_;
}

bool ChildProcess::WaitFor(Nanoseconds at_most) {
  if (end_) return true;
  pollfd poll_for{watched_, POLLIN, 0};
  return poll(&poll_for, 1, static_cast<int>(at_most / 1'000'000)) == 1;
}

ChildEnd ChildProcess::Wait() {
  if (!end_) end_ = launcher_.AwaitEnd(pid_);
  return *end_;
}

void ChildProcess::Kill() {
  // Not by its number, which may be another's once the launcher's template is gone.
  if (!end_) syscall(SYS_pidfd_send_signal, watched_, SIGKILL, nullptr, 0);
}

void ChildProcess::Leave() {
  if (end_) return;
  launcher_.Leave(pid_);
  end_.emplace();
}

double ChildProcess::cpu_s() const {
  if (end_) return end_->cpu_s;
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace coopdyn
