// SPDX-License-Identifier: MIT
#include "server/host/program_run.h"

#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/json.hpp>

#include "server/base/spawn.h"
#include "server/host/json_fields.h"
#include "server/net/peer.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
namespace json = boost::json;
using boost::system::error_code;
using Stream = asio::local::stream_protocol;

constexpr std::size_t kMaxPacket = std::size_t{64} << 10;
constexpr std::int64_t kMostLines = 1'000'000;  // of a program
constexpr int kPacketsAtOnce = 16;
constexpr std::chrono::milliseconds kPause{20};  // between kConnectionsAtOnce
constexpr std::chrono::seconds kStopTime{5};     // for the process to end when it was asked to

struct Packet {
  char kind = 0;  // 0: the other end has gone
  std::string text;
  UniqueFd fd;
};

/// Nothing to read: errno is EAGAIN, and `kind` is 'W'.
Packet Receive(int from) {
  std::string bytes(kMaxPacket, '\0');
  iovec part{bytes.data(), bytes.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t count = ::recvmsg(from, &message, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return {.kind = 'W', .text = {}, .fd = {}};
  if (count <= 0) return {};
  Packet packet{.kind = bytes[0], .text = bytes.substr(1, static_cast<std::size_t>(count) - 1), .fd = {}};
  const cmsghdr* const rights = CMSG_FIRSTHDR(&message);
  if (rights != nullptr && rights->cmsg_level == SOL_SOCKET && rights->cmsg_type == SCM_RIGHTS) {
    int passed = -1;
    std::memcpy(&passed, CMSG_DATA(rights), sizeof passed);
    packet.fd = UniqueFd(passed);
  }
  return packet;
}

ProgramOutcome ReadEnd(const std::string& text) {
  const json::object end = ObjectIn(text);
  const json::value* const error = end.if_contains("error");
  const json::value* const line = end.if_contains("line");
  const std::int64_t number = line != nullptr && line->is_int64() ? line->as_int64() : 0;
  return {TextIn(end, "sentence"), error != nullptr && error->is_bool() && error->as_bool(),
          number > 0 && number < kMostLines ? static_cast<int>(number) : 0};
}

}  // namespace

struct ProgramRun::Impl : std::enable_shared_from_this<ProgramRun::Impl> {
  Impl(asio::io_context& c, Handlers h) : handlers(std::move(h)), talk(c), door(c), pause(c), patience(c) {}

  void Listen() {
    talk.async_wait(asio::posix::stream_descriptor::wait_read,
                    [self = shared_from_this()](const error_code& failed) {
                      if (!failed && self->process != 0) self->TakePackets();
                    });
  }

  void TakePackets() {
    for (int i = 0; i < kPacketsAtOnce && process != 0; ++i) {
      Packet packet = Receive(talk.native_handle());
      if (packet.kind == 'W') break;
      if (packet.kind == 0) return End();
      if (packet.kind == 'E') end = ReadEnd(packet.text);
      if (packet.kind == 'O') handlers.print(packet.text);
      if (packet.kind == 'L' && packet.fd && !door.is_open()) {
        error_code failed;
        door.assign(Stream(), packet.fd.get(), failed);
        if (failed) continue;
        packet.fd.Release();
        Accept(0);
      }
    }
    if (process != 0) Listen();
  }

  void Accept(int taken) {
    if (taken == kConnectionsAtOnce) {
      pause.expires_after(kPause);
      return pause.async_wait([self = shared_from_this()](const error_code& aborted) {
        if (!aborted) self->Accept(0);
      });
    }
    door.async_accept([self = shared_from_this(), taken](const error_code& failed, Stream::socket socket) {
      if (self->process == 0 || failed == asio::error::operation_aborted) return;
      error_code lost;
      UniqueFd fd(failed ? -1 : socket.release(lost));
      if (!fd || lost) return self->Accept(kConnectionsAtOnce);  // out of descriptors: later
      SetClientSocketOptions(fd.get());
      self->handlers.connected(std::move(fd));
      self->Accept(taken + 1);
    });
  }

  /// Waits for the process, which has ended or is killed.
  void Reap() {
    const pid_t ended = std::exchange(process, 0);
    if (ended == 0) return;
    ::kill(ended, SIGKILL);
    WaitFor(ended);
    error_code ignored;
    talk.close(ignored);
    door.close(ignored);
    pause.cancel();
    patience.cancel();
  }

  void End() {
    Reap();
    const auto ended = std::move(handlers.ended);
    ended(std::move(end));
  }

  Handlers handlers;
  asio::posix::stream_descriptor talk;
  Stream::acceptor door;
  asio::steady_timer pause, patience;
  pid_t process = 0;  // 0: it has ended, or was never there
  ProgramOutcome end{"The program was ended from outside.", true, 0};
};

ProgramRun::ProgramRun(asio::io_context& context, Handlers handlers)
    : impl_(std::make_shared<Impl>(context, std::move(handlers))) {}

ProgramRun::~ProgramRun() {
  impl_->Reap();
}

std::string ProgramRun::Start(const std::vector<std::string>& words, const std::string& log) {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return std::string("the program cannot be started: ") + std::strerror(errno);
  const UniqueFd far(ends[1]);
  impl_->talk.assign(ends[0]);
  const UniqueFd nothing(::open("/dev/null", O_RDWR | O_CLOEXEC));
  const UniqueFd lines(::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  pid_t process = 0;
  const int error = Spawn(words.front(), {words.begin() + 1, words.end()},
                          {far.get(), nothing.get(), lines.get()}, process, SpawnApart::kSession);
  if (error != 0) return words.front() + " cannot be started: " + std::strerror(error);
  impl_->process = process;
  impl_->Listen();
  return {};
}

void ProgramRun::Stop() {
  if (impl_->process == 0) return;
  ::shutdown(impl_->talk.native_handle(), SHUT_WR);
  impl_->patience.expires_after(kStopTime);
  impl_->patience.async_wait([weak = std::weak_ptr(impl_)](const error_code& aborted) {
    const std::shared_ptr<Impl> impl = weak.lock();
    if (!aborted && impl && impl->process != 0) ::kill(impl->process, SIGKILL);
  });
}

}  // namespace coopdyn
