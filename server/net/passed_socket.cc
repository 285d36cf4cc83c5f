// SPDX-License-Identifier: MIT
#include "server/net/passed_socket.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using Descriptor = asio::posix::stream_descriptor;

constexpr char kTrusted = 't', kStranger = 's', kYields = 'y';
constexpr char kEndOfPeer = '\n';

bool IsKind(char c) {
  return c == 'N' || c == 'P' || c == 'T' || c == 'G' || c == 'A';
}

/// False: the path is too long.
bool SetPath(sockaddr_un& address, const std::string& path) {
  address.sun_family = AF_UNIX;
  if (path.size() + 1 > sizeof address.sun_path) return false;
  std::copy(path.begin(), path.end(), address.sun_path);
  return true;
}

bool IsOurs(int fd) {
  ucred who{};
  socklen_t size = sizeof who;
  return ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 &&
         (who.uid == ::geteuid() || who.uid == 0);
}

}  // namespace

std::string EncodePassed(const PassedSocket& passed) {
  std::string bytes(1, static_cast<char>(passed.kind));
  bytes += passed.peer.yields ? kYields : passed.peer.trusted ? kTrusted : kStranger;
  bytes += passed.peer.text + kEndOfPeer;
  return bytes + passed.already_read;
}

std::optional<PassedSocket> DecodePassed(std::string_view bytes) {
  const std::size_t end = bytes.find(kEndOfPeer);
  if (end == std::string_view::npos || end < 2 || !IsKind(bytes[0])) return std::nullopt;
  const char trust = bytes[1];
  if (trust != kTrusted && trust != kStranger && trust != kYields) return std::nullopt;
  PassedSocket passed{.kind = static_cast<PassedKind>(bytes[0])};
  passed.peer.text = bytes.substr(2, end - 2);
  passed.peer.trusted = trust != kStranger;
  passed.peer.yields = trust == kYields;
  passed.already_read = bytes.substr(end + 1);
  return passed;
}

int SendPassed(int to, const PassedSocket& passed) {
  std::string bytes = EncodePassed(passed);
  if (bytes.size() > PassedSocket::kMaxBytes) return EMSGSIZE;
  iovec part{bytes.data(), bytes.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  if (passed.fd) {
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    cmsghdr* const rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(sizeof(int));
    const int fd = passed.fd.get();
    std::memcpy(CMSG_DATA(rights), &fd, sizeof fd);
  }
  while (::sendmsg(to, &message, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

UniqueFd ConnectToDoor(const std::string& path) {
  sockaddr_un address{};
  if (!SetPath(address, path)) {
    errno = ENAMETOOLONG;
    return {};
  }
  UniqueFd fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int room = static_cast<int>(4 * PassedSocket::kMaxBytes);
  ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
  if (!fd || ::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return {};
  return fd;
}

struct PassedDoor::Impl : std::enable_shared_from_this<PassedDoor::Impl> {
  Impl(asio::io_context& c, TakeFunction t) : context(c), take(std::move(t)) {}

  void Accept() {
    listening->async_wait(Descriptor::wait_read, [self = shared_from_this()](const auto& error) {
      if (error || !self->take) return;
      UniqueFd fd(
          ::accept4(self->listening->native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (fd && IsOurs(fd.get())) {
        const auto sender = std::make_shared<Descriptor>(self->context, fd.get());
        fd.Release();
        self->senders.push_back(sender);
        self->Receive(sender);
      }
      self->Accept();
    });
  }

  void Receive(const std::shared_ptr<Descriptor>& sender) {
    sender->async_wait(Descriptor::wait_read, [self = shared_from_this(), sender](const auto& error) {
      if (error || !self->take) return;
      if (self->ReceiveOne(sender->native_handle())) return self->Receive(sender);
      std::erase(self->senders, sender);
    });
  }

  /// False: the sender has gone.
  bool ReceiveOne(int from) {
    std::vector<char> bytes(PassedSocket::kMaxBytes);
    iovec part{bytes.data(), bytes.size()};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t count = ::recvmsg(from, &message, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) return false;
    UniqueFd fd;
    for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr; each = CMSG_NXTHDR(&message, each)) {
      int passed = -1;
      if (each->cmsg_level != SOL_SOCKET || each->cmsg_type != SCM_RIGHTS) continue;
      std::memcpy(&passed, CMSG_DATA(each), sizeof passed);
      fd = UniqueFd(passed);
    }
    std::optional<PassedSocket> passed = DecodePassed({bytes.data(), static_cast<std::size_t>(count)});
    if (!passed || (message.msg_flags & MSG_TRUNC) != 0) return true;
    const bool wants_socket = passed->kind == PassedKind::kNames || passed->kind == PassedKind::kPage;
    if (wants_socket != static_cast<bool>(fd)) return true;
    if (fd) ::fcntl(fd.get(), F_SETFL, ::fcntl(fd.get(), F_GETFL) | O_NONBLOCK);
    passed->fd = std::move(fd);
    take(std::move(*passed));
    return true;
  }

  asio::io_context& context;
  TakeFunction take;  // empty: closed
  std::optional<Descriptor> listening;
  std::vector<std::shared_ptr<Descriptor>> senders;
  std::string path;
};

PassedDoor::PassedDoor(asio::io_context& context, TakeFunction take)
    : impl_(std::make_shared<Impl>(context, std::move(take))) {}

PassedDoor::~PassedDoor() {
  impl_->take = nullptr;
  boost::system::error_code ignored;
  if (impl_->listening) impl_->listening->close(ignored);
  for (const auto& sender : impl_->senders) sender->close(ignored);
  if (!impl_->path.empty()) ::unlink(impl_->path.c_str());
}

std::string PassedDoor::Listen(const std::string& path) {
  sockaddr_un address{};
  if (!SetPath(address, path))
    return path + " is too long for a socket: at most " + std::to_string(sizeof address.sun_path - 1) +
           " bytes";
  if (ConnectToDoor(path)) return path + " belongs to another daemon that runs";
  ::unlink(path.c_str());
  UniqueFd fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd || ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0 || ::listen(fd.get(), SOMAXCONN) != 0)
    return path + ": " + std::strerror(errno);
  impl_->path = path;
  impl_->listening.emplace(impl_->context, fd.get());
  fd.Release();
  asio::post(impl_->context, [impl = impl_] { impl->Accept(); });
  return {};
}

}  // namespace coopdyn
