// SPDX-License-Identifier: MIT
#include "server/app/remote_connection.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "protocol/codec.h"
#include "server/app/commands.h"

namespace coopdyn {

namespace {

constexpr int kConnectTimeoutMs = 3000;

/// Connects without waiting longer than the timeout; -1 with errno on failure.
int ConnectTo(const addrinfo& address) {
  const int fd = ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  if (::connect(fd, address.ai_addr, address.ai_addrlen) != 0) {
    pollfd waiting{fd, POLLOUT, 0};
    int error = errno;
    if (error == EINPROGRESS) {
      socklen_t size = sizeof error;
      if (::poll(&waiting, 1, kConnectTimeoutMs) == 1) {
        ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
      } else {
        error = ETIMEDOUT;
      }
    }
    if (error != 0) {
      ::close(fd);
      errno = error;
      return -1;
    }
  }
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

}  // namespace

std::shared_ptr<ServerOptions> AddServerOptions(CLI::App& command) {
  auto options = std::make_shared<ServerOptions>();
  command
      .add_option("--server", options->server,
                  "HOST[:PORT] of the daemon (default: this machine, port 10000)")
      ->envname("COOPDYN_SERVER");
  command.add_option("--token", options->token, "The daemon's token, from another machine")
      ->envname("COOPDYN_TOKEN");
  return options;
}

ServerAddress::ServerAddress(const std::string& text) {
  const RemoteError wrong(kExitWrongUse, "--server is HOST or HOST:PORT, e.g. labserver:10000, not " + text);
  const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t end = text.starts_with('[') ? text.find(']') : 0;
  if (end == std::string::npos) throw wrong;
  const std::size_t colon = text.find(':', end);
  // "::1" without brackets has no port.
  const bool has_port =
      colon != std::string::npos && (end > 0 || text.find(':', colon + 1) == std::string::npos);
  std::string name = has_port ? text.substr(0, colon) : digits ? "" : text;
  if (end > 0) {
    if (name.size() != end + 1) throw wrong;
    name = name.substr(1, end - 1);
  }
  if (!name.empty()) host = name;
  const std::string number = has_port ? text.substr(colon + 1) : digits ? text : "";
  if (number.empty() && !has_port) return;
  const auto [last, error] = std::from_chars(number.data(), number.data() + number.size(), port);
  if (error != std::errc() || last != number.data() + number.size() || port < 1 || port > 65535) throw wrong;
}

RemoteConnection::RemoteConnection(const ServerAddress& server) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(server.port);
  if (const int error = ::getaddrinfo(server.host.c_str(), port.c_str(), &hints, &found); error != 0) {
    throw RemoteError(kExitNoDaemon,
                      "there is no host " + server.host + " (" + ::gai_strerror(error) + "): check its name");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr && fd_ < 0; address = address->ai_next) {
    fd_ = ConnectTo(*address);
  }
  if (fd_ < 0) {
    throw RemoteError(kExitNoDaemon,
                      "no daemon answers at " + server.host + ":" + port + " (" + std::strerror(errno) +
                          "): start one with coopdyn serve, or say where it is with --server HOST:PORT");
  }
}

RemoteConnection::~RemoteConnection() {
  if (fd_ >= 0) ::close(fd_);
}

void RemoteConnection::Send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t now = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) {
      throw RemoteError(kExitErrors,
                        std::string("the daemon closed the connection (") + std::strerror(errno) + ")");
    }
    sent += static_cast<std::size_t>(now);
  }
}

void RemoteConnection::Receive() {
  std::array<char, 65536> bytes;
  ssize_t now;
  do {
    now = ::recv(fd_, bytes.data(), bytes.size(), 0);
  } while (now < 0 && errno == EINTR);
  if (now <= 0) throw RemoteError(kExitErrors, "the daemon closed the connection");
  buffer_.append(bytes.data(), static_cast<std::size_t>(now));
}

std::string RemoteConnection::ReadLine() {
  std::size_t end;
  while ((end = buffer_.find('\n')) == std::string::npos) {
    if (buffer_.size() > kMaxReplyBytes) {
      throw RemoteError(kExitErrors, "the daemon answered something unreadable");
    }
    Receive();
  }
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

std::vector<std::string> RemoteConnection::AskNames(const std::string& line) {
  Send("NAME_SERVER " + line + "\n");
  std::vector<std::string> answer;
  for (std::string reply = ReadLine(); !reply.starts_with("*** end of message"); reply = ReadLine()) {
    answer.push_back(std::move(reply));
  }
  return answer;
}

void RemoteConnection::Open(const std::string& name) {
  Send("OPEN " + name + "\n");
  if (const std::string reply = ReadLine(); reply != "ok") throw RemoteError(kExitErrors, reply);
}

Message RemoteConnection::Call(const Message& request) {
  std::string bytes;
  if (!binary_started_) bytes = kBinaryMagic;
  binary_started_ = true;
  EncodeBinary(request, bytes);
  Send(bytes);
  for (;;) {
    Decoded decoded = DecodeBinary(buffer_, kMaxReplyBytes);
    if (decoded.status == DecodeStatus::kNeedMore) {
      Receive();
      continue;
    }
    if (decoded.status != DecodeStatus::kMessage) {
      throw RemoteError(kExitErrors, "the daemon answered something unreadable");
    }
    buffer_.erase(0, decoded.consumed);
    if (decoded.message.command == -1) throw RemoteError(kExitErrors, decoded.message.text);  // it closes
    const bool pushed = decoded.message.command != request.command && decoded.message.error == 0;
    if (!pushed) return std::move(decoded.message);
  }
}

std::string RemoteConnection::CallLine(const std::string& line) {
  Send(line + "\n");
  std::string reply;
  do {
    reply = ReadLine();
  } while (reply.empty() || reply.front() == '#');
  return reply;
}

}  // namespace coopdyn
