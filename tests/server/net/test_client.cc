// SPDX-License-Identifier: MIT
#include "test_client.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cstddef>
#include <cstring>
#include <filesystem>

#include "protocol/codec.h"
#include "server/net/peer.h"

namespace coopdyn {
namespace {

bool WaitFor(int fd, short events) {
  pollfd state{fd, events, 0};
  return ::poll(&state, 1, TestClient::kPatience_ms) > 0;
}

}  // namespace

TestClient TestClient::Connect(int port, const std::string& ip) {
  sockaddr_storage storage{};
  socklen_t size = 0;
  if (ip.find(':') != std::string::npos) {
    auto* v6 = reinterpret_cast<sockaddr_in6*>(&storage);
    v6->sin6_family = AF_INET6;
    v6->sin6_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET6, ip.c_str(), &v6->sin6_addr);
    size = sizeof *v6;
  } else {
    auto* v4 = reinterpret_cast<sockaddr_in*>(&storage);
    v4->sin_family = AF_INET;
    v4->sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, ip.c_str(), &v4->sin_addr);
    size = sizeof *v4;
  }
  UniqueFd fd(::socket(storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (fd && ::connect(fd.get(), reinterpret_cast<sockaddr*>(&storage), size) != 0) fd.Reset();
  SetClientSocketOptions(fd.get());
  return TestClient(std::move(fd));
}

TestClient TestClient::ConnectLocal(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (fd && ::connect(fd.get(), reinterpret_cast<sockaddr*>(&address), size) != 0) fd.Reset();
  return TestClient(std::move(fd));
}

std::string TestClient::address() const {
  return ToString(LocalAddress(fd_.get()));
}

bool TestClient::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    if (!WaitFor(fd_.get(), POLLOUT)) return false;
    const ssize_t count = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && errno != EAGAIN) return false;
    if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

std::size_t TestClient::SendSome(std::string_view bytes) {
  const ssize_t count = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return count < 0 ? 0 : static_cast<std::size_t>(count);
}

bool TestClient::More() {
  char block[65536];
  if (ended_ || !WaitFor(fd_.get(), POLLIN)) return false;
  const ssize_t count = ::recv(fd_.get(), block, sizeof block, 0);
  if (count <= 0) {
    ended_ = true;
    return false;
  }
  buffer_.append(block, static_cast<std::size_t>(count));
  return true;
}

std::string TestClient::Line() {
  std::size_t end = 0;
  while ((end = buffer_.find('\n')) == std::string::npos) {
    if (!More()) return ended_ ? "<end>" : "<nothing>";
  }
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

std::string TestClient::Exactly(std::size_t count) {
  while (buffer_.size() < count && More()) {
  }
  std::string bytes = buffer_.substr(0, count);
  buffer_.erase(0, count);
  return bytes;
}

std::string TestClient::Rest() {
  while (More()) {
  }
  return std::exchange(buffer_, {}) + (ended_ ? "" : "<nothing>");
}

Message TestClient::Frame() {
  Decoded decoded;
  while ((decoded = DecodeBinary(buffer_, kMaxReplyBytes)).status == DecodeStatus::kNeedMore) {
    if (!More()) return ErrorReply(0, Error::kTimedOut, ended_ ? "<end>" : "<nothing>");
  }
  buffer_.erase(0, decoded.consumed);
  return std::move(decoded.message);
}

void TestClient::EndInput() {
  ::shutdown(fd_.get(), SHUT_WR);
}

void TestClient::Reset() {
  const linger at_once{1, 0};
  setsockopt(fd_.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  Close();
}

HeldPort::HeldPort() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const int yes = 1;
  ::setsockopt(fd_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  socklen_t size = sizeof address;
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) return;
  if (::getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0)
    port_ = ntohs(address.sin_port);
}

std::pair<UniqueFd, UniqueFd> SocketPair(int type) {
  int fds[2] = {-1, -1};
  if (::socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, fds) != 0) return {};
  return {UniqueFd(fds[0]), UniqueFd(fds[1])};
}

int OpenDescriptors() {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++count;
  return count;
}

}  // namespace coopdyn
