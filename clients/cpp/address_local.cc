// SPDX-License-Identifier: MIT
// The unix socket on which a daemon that listens to its own machine only can be reached as on its port: an
// exchange costs half of what it does by TCP.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "clients/cpp/address.h"

namespace coopdyn::client {

#ifdef __linux__

namespace {

bool IsTcpForced() {
  const char* const forced = std::getenv("COOPDYN_TCP");
  return forced != nullptr && *forced != '\0' && std::strcmp(forced, "0") != 0;
}

/// Anybody of this machine can take the name when no daemon has it: what listens must be of this user, or
/// root's.
bool IsOfThisUser(int fd) {
  ucred who{};
  socklen_t size = sizeof(who);
  return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 && (who.uid == geteuid() || who.uid == 0);
}

}  // namespace

int Address::DialLocal() const {
  if ((host_ != "127.0.0.1" && host_ != "localhost" && host_ != "::1") || IsTcpForced()) return -1;
  const std::string name = "coopdyn-" + std::to_string(port_);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());  // after a zero: the abstract namespace
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), length) == 0 && IsOfThisUser(fd)) return fd;
  close(fd);
  return -1;
}

#else

int Address::DialLocal() const {
  return -1;
}

#endif

}  // namespace coopdyn::client
