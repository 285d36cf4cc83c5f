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

std::optional<ServerAddress> ParseServerAddress(const std::string& text) {
  ServerAddress address;
  if (text.empty()) return address;
  std::string port;
  if (text.front() == '[') {
    const std::size_t end = text.find(']');
    if (end == std::string::npos) return std::nullopt;
    address.host = text.substr(1, end - 1);
    if (end + 1 < text.size()) {
      if (text[end + 1] != ':') return std::nullopt;
      port = text.substr(end + 2);
    }
  } else if (const std::size_t colon = text.find(':');
             colon != std::string::npos && text.rfind(':') == colon) {
    address.host = text.substr(0, colon);
    port = text.substr(colon + 1);
  } else if (text.find_first_not_of("0123456789") == std::string::npos) {
    port = text;  // of this machine
  } else {
    address.host = text;
  }
  if (address.host.empty()) address.host = "127.0.0.1";
  if (port.empty()) return text.back() == ':' ? std::nullopt : std::optional(address);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || end != port.data() + port.size() || address.port < 1 || address.port > 65535) {
    return std::nullopt;
  }
  return address;
}

RemoteConnection::~RemoteConnection() {
  if (fd_ >= 0) ::close(fd_);
}

std::string RemoteConnection::Connect(const ServerAddress& server) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(server.port);
  if (const int error = ::getaddrinfo(server.host.c_str(), port.c_str(), &hints, &found); error != 0) {
    return "there is no host " + server.host + " (" + ::gai_strerror(error) + "): check its name";
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr && fd_ < 0; address = address->ai_next) {
    fd_ = ConnectTo(*address);
  }
  if (fd_ < 0) {
    return "no daemon answers at " + server.host + ":" + port + " (" + std::strerror(errno) +
           "): start one with coopdyn serve, or say where it is with --server HOST:PORT";
  }
  return {};
}

std::string RemoteConnection::Send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t now = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return std::string("the daemon closed the connection (") + std::strerror(errno) + ")";
    sent += static_cast<std::size_t>(now);
  }
  return {};
}

std::string RemoteConnection::Receive() {
  std::array<char, 65536> bytes;
  for (;;) {
    const ssize_t now = ::recv(fd_, bytes.data(), bytes.size(), 0);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return "the daemon closed the connection";
    buffer_.append(bytes.data(), static_cast<std::size_t>(now));
    return {};
  }
}

std::string RemoteConnection::ReadLine(std::string& line) {
  std::size_t end;
  while ((end = buffer_.find('\n')) == std::string::npos) {
    if (buffer_.size() > kMaxReplyBytes) return "the daemon answered something unreadable";
    if (std::string error = Receive(); !error.empty()) return error;
  }
  line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return {};
}

std::string RemoteConnection::AskNames(const std::string& line, std::vector<std::string>& answer) {
  if (std::string error = Send("NAME_SERVER " + line + "\n"); !error.empty()) return error;
  for (;;) {
    std::string reply;
    if (std::string error = ReadLine(reply); !error.empty()) return error;
    if (reply.starts_with("*** end of message")) return {};
    answer.push_back(std::move(reply));
  }
}

std::string RemoteConnection::Open(const std::string& name) {
  if (std::string error = Send("OPEN " + name + "\n"); !error.empty()) return error;
  std::string reply;
  if (std::string error = ReadLine(reply); !error.empty()) return error;
  return reply == "ok" ? std::string() : reply;
}

std::string RemoteConnection::Call(const Message& request, Message& reply) {
  std::string bytes;
  if (!binary_started_) bytes = kBinaryMagic;
  binary_started_ = true;
  EncodeBinary(request, bytes);
  if (std::string error = Send(bytes); !error.empty()) return error;
  for (;;) {
    Decoded decoded = DecodeBinary(buffer_, kMaxReplyBytes);
    if (decoded.status == DecodeStatus::kNeedMore) {
      if (std::string error = Receive(); !error.empty()) return error;
      continue;
    }
    if (decoded.status != DecodeStatus::kMessage) return "the daemon answered something unreadable";
    buffer_.erase(0, decoded.consumed);
    if (decoded.message.command == -1) return decoded.message.text;  // the closing notice
    if (decoded.message.command != request.command && decoded.message.error == 0) continue;  // a push
    reply = std::move(decoded.message);
    return {};
  }
}

std::string RemoteConnection::CallLine(const std::string& line, std::string& reply) {
  if (std::string error = Send(line + "\n"); !error.empty()) return error;
  do {
    if (std::string error = ReadLine(reply); !error.empty()) return error;
  } while (reply.empty() || reply.front() == '#');
  return {};
}

}  // namespace coopdyn
